"""The KKT system of a stratum at states in doubles, and bounds of how it changes beside them.

F = [k (x - rest) - A' lam ; g] in (x, lam), g the closure of the vertex, A its Jacobian; J = [[K - lam . g'', -A'], [A,
0]].

Closure g are the rows of the piece (`pieces`) that are of first order, each about the state that it is asked at: B_0
and the frame of the first mirror stay those of that state.  A zero of these beside it closes.  A B_0 and B_0 / B are
unit quaternions with one vector part, so that their scalars are equal but for their sign, and both are positive within
the boxes of roots, where half chains turn by less than pi / 2; n_1 and N have two entries in common, and the third is
positive of both; one equation is all there is for D_n and C_n.  And at a closed state the slopes of g are those of
closure times a matrix that is regular as long as these scalars, or entries, are not zero: multipliers exist for both or
for neither.

Derivatives of order p in the directions i, j, ... are at most beta_i beta_j ... in size (`rows`): beta = 1/2 a fold
where g is of quaternions, 1 where of vectors, half of that on a mirror.

Rounding.  Axes and products are known to what `rows` says of chains of so many steps; near the flat state the vector
part of the product of folds is known to that share of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import INDEPENDENT
from origami_nlp.proof.pieces import piece_of
from origami_nlp.proof.reduced import Gap, ReducedVertex
from origami_nlp.proof.rows import CREASE, Triples, pairs


@dataclass(frozen=True, eq=False)
class BoxDerivatives:
    """The system at R states, and what its derivatives are there.

    Attributes
    ----------
    force
        k (x - rest) - A' lam of all variables, [R, n].
    f, jacobian
        Shape [R, n + m] and [R, n + m, n + m]; rows and columns of pinned variables are those of 1.
    fuzz
        What rounding, and doubt of sectors, leave in `f` at most, of pinned variables in `force`, [R, n + m].
    a
        Jacobian of closure, of free variables (0 for others), [R, m, n].
    k, beta
        Stiffness and beta of free variables (0 for others), [R, n].
    size
        sum |lam|, [R].
    noise
        What rounding and doubt leave in entries of A and g'', of size 1.
    """

    force: np.ndarray
    f: np.ndarray
    jacobian: np.ndarray
    fuzz: np.ndarray
    a: np.ndarray
    k: np.ndarray
    beta: np.ndarray
    size: np.ndarray
    noise: float

    def change(self, mu: np.ndarray) -> np.ndarray:
        """Bound |J(Z) - J(z0)| / t on Z = z0 +- t (1, ..., mu, ...): [R, n + m, n + m]."""
        m = self.a.shape[1]
        s = self.beta.sum(axis=1)
        return self._bordered(m * mu + s * self.size, s, m)

    def doubt(self) -> np.ndarray:
        """Bound what rounding and doubt leave in J, [R, n + m, n + m]."""
        noise = 4 * self.noise * np.ones(len(self.f))
        return self._bordered(noise * (1 + self.size), noise, self.a.shape[1])

    def _bordered(self, corner: np.ndarray, side: np.ndarray, m: int) -> np.ndarray:
        """[[corner beta_i beta_j, side beta_i], [side beta_j, 0]], of m rows of closure."""
        b = self.beta
        n = b.shape[1]
        out = np.zeros((len(b), n + m, n + m))
        out[:, :n, :n] = corner[:, None, None] * b[:, :, None] * b[:, None, :]
        out[:, :n, n:] = side[:, None, None] * b[:, :, None]
        out[:, n:, :n] = side[:, None, None] * b[:, None, :]
        return out


class BoxKkt:
    """The KKT system of a vertex, over states of any stratum.

    Parameters
    ----------
    vertex
        Of a flat sheet.
    gaps
        Those that are closed.
    """

    def __init__(self, vertex: ReducedVertex, gaps: tuple[Gap, ...] = ()) -> None:
        self.piece = piece = piece_of(vertex)
        chain = piece.chain
        self.n, self.equations = vertex.size, piece.pivots
        self.m = piece.pivots + len(gaps)
        self.k, self.rest = vertex.problem.parameters.stiffness, piece.rest
        self.gaps = Triples(chain, [chain.closed(*g.rays, kind=g.kind) for g in gaps])
        self.sines = np.array(
            [math.sin(piece.sectors[g.rays[1]]) if g.rays[1:] else 1.0 for g in gaps]
        )
        weight = np.ones(self.n)
        weight[chain.variable[chain.folds > 0]] = chain.folds[chain.folds > 0]
        self.beta = weight * (1.0 if gaps or piece.by_vectors else 0.5)
        # three axes or rays of a chain, and the product of its folds
        self.noise = 3 * CREASE * chain.around + chain.loop_rounding
        if gaps:
            self.noise *= 4 / float(self.sines.min())

    def vanishing(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return g [R, m] at states [R, n], its Jacobian [R, m, n] and g'' [R, m, n, n]."""
        folded = self.piece.chain.fold(x.T, np.ones(x.T.shape))
        rows = [self.piece.equations(folded)]
        if len(self.sines):
            rows.append(self.gaps.at(folded))
        g, a, bends = (np.concatenate([r.parts[i] for r in rows]) for i in range(3))
        first, second, number = pairs(self.n)
        bends = bends * np.where(first == second, 2.0, 1.0)[:, None]
        g, a, bends = (np.moveaxis(v, -1, 0) for v in (g, a, bends))
        scale = np.concatenate([np.ones(self.equations), 1 / self.sines])
        return g * scale, a * scale[:, None], bends[:, :, number] * scale[:, None, None]

    def closes(self, x: np.ndarray) -> np.ndarray:
        """Return whether zeros of g at states [R, n] are closed, and not of the other lift, [R]."""
        return self.piece.closes(self.piece.chain.fold(x.T, np.ones(x.T.shape)))

    def at(self, x: np.ndarray, lam: np.ndarray, pins: np.ndarray) -> BoxDerivatives:
        """Return the system at states [R, n] with multipliers [R, m] on strata [R, n]."""
        n, m = self.n, self.m
        g, a, second = self.vanishing(x)
        h = -np.einsum("rm,rmij->rij", lam, second)
        i = np.arange(n)
        h[:, i, i] += self.k
        force = self.k * (x - self.rest) - np.einsum("rm,rmn->rn", lam, a)
        free = pins == 0
        jacobian = np.zeros((len(x), n + m, n + m))
        jacobian[:, :n, :n] = h
        jacobian[:, :n, n:] = -a.transpose(0, 2, 1)
        jacobian[:, n:, :n] = a
        pinned = np.concatenate([~free, np.zeros((len(x), m), dtype=bool)], axis=1)
        jacobian[pinned] = 0.0
        # rows and columns of pinned variables become those of 1: one shape of matrix for all strata
        jacobian.transpose(0, 2, 1)[pinned] = 0.0
        diagonal = np.arange(n + m)
        jacobian[:, diagonal, diagonal] += pinned
        return BoxDerivatives(
            force,
            np.concatenate([np.where(free, force, 0.0), g], axis=1),
            jacobian,
            self._fuzz(x, lam),
            a * free[:, None],
            np.where(free, self.k, 0.0),
            np.where(free, self.beta, 0.0),
            np.abs(lam).sum(axis=1),
            self.noise,
        )

    def _fuzz(self, x: np.ndarray, lam: np.ndarray) -> np.ndarray:
        """What rounding and doubt leave in F at most, [R, n + m]; less of closure near the flat state."""
        near = np.ones(len(x))
        if self.piece.near_flat and self.m == self.equations:
            near = np.minimum(1.0, np.abs(x).sum(axis=1))
        torque = 7.0 * self.k + 4.0 * self.beta * np.abs(lam).sum(axis=1)[:, None]
        return self.noise * np.concatenate([torque, near[:, None] + np.zeros((1, self.m))], axis=1)

    def start(self, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
        """Return the multipliers [R, m] that balance the free variables best."""
        a = self.vanishing(x)[1] * (pins == 0)[:, None]
        torque = np.where(pins == 0, self.k * (x - self.rest), 0.0)
        return (np.linalg.pinv(a.transpose(0, 2, 1), rcond=INDEPENDENT) @ torque[:, :, None])[
            :, :, 0
        ]

    def least_slope(self, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
        """Return the smallest singular value of closure on the free variables, [R]; 0 where these are too few."""
        if not len(x):
            return np.zeros(0)
        a = self.vanishing(x)[1] * (pins == 0)[:, None]
        return np.linalg.svd(a, compute_uv=False)[:, -1]
