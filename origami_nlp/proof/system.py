"""The KKT system of a stratum at states in doubles, and bounds of how it changes beside them.

F = [k (x - rest) - A' lam ; g] in (x, lam), g the closure of the model, A its Jacobian; J = [[K - lam . g'', -A'], [A,
0]].  Hinge laws have their torque in place of k (x - rest), and its slope in K: between states it is one of the slopes
between, so that a torque with kinks is treated like one without.

Closure g are the rows of the piece (`pieces`) that are of first order, each about the state that it is asked at: B_0
and the frame of the first mirror stay those of that state.  A zero of these beside it closes.  A B_0 and B_0 / B are
unit quaternions with one vector part, so that their scalars are equal but for their sign, and both are positive within
the boxes of roots, where half chains turn by less than pi / 2; n_1 and N have two entries in common, and the third is
positive of both; one equation is all there is for D_n and C_n.  And at a closed state the slopes of g are those of
closure times a matrix that is regular as long as these scalars, or entries, are not zero: multipliers exist for both or
for neither.

Derivatives of order p in the directions i, j, ... are at most beta_i beta_j ... in size (`rows`): beta = 1/2 a fold
where g is of quaternions, 1 where of vectors, half of that on a mirror.  The second ones are known at the state.

Rounding.  Axes and products are known to what `rows` says of chains of so many steps; near the flat state the vector
part of the product of folds is known to that share of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import INDEPENDENT
from origami_nlp.problem import Model
from origami_nlp.proof.law_torques import LawTorques, torques_of
from origami_nlp.proof.pieces import piece_of
from origami_nlp.proof.rows import CREASE, Triples, pairs


@dataclass(frozen=True, eq=False)
class LawBends:
    """How the stiffness of hinge laws changes beside R states.

    Attributes
    ----------
    laws
        Of the variables.
    x, free
        The states, and which variables are free, [R, n].
    """

    laws: LawTorques
    x: np.ndarray
    free: np.ndarray

    def within(self, reach: np.ndarray | float) -> np.ndarray:
        """Bound |change of stiffness| / t beside the states, t <= reach [R]: [R, n]."""
        reach = np.zeros(len(self.x)) + reach
        return np.where(self.free, self.laws.bends(self.x, reach), 0.0)

    @property
    def ripple(self) -> np.ndarray:
        """What is not known of stiffness, [R, n]."""
        return np.where(self.free, self.laws.ripple, 0.0)


@dataclass(frozen=True, eq=False)
class BoxDerivatives:
    """The system at R states, and what its derivatives are there.

    Attributes
    ----------
    f, jacobian
        Shape [R, n + m] and [R, n + m, n + m]; rows and columns of pinned variables are those of 1.
    fuzz
        What rounding, and doubt of sectors, leave in `f` at most, [R, n + m].
    a
        Jacobian of closure, of free variables (0 for others), [R, m, n].
    second
        |g''|, of free variables, [R, m, n, n].
    bent
        |lam . g''|, [R, n, n].
    third
        sum_k |lam . g'''_ijk|, [R, n, n].
    beta
        beta of free variables, [R, n].
    size
        sum |lam|, [R].
    law
        How the stiffness of hinge laws changes; None for linear springs.
    noise
        What rounding and doubt leave in entries of A, g'' and g''', of size 1.
    """

    f: np.ndarray
    jacobian: np.ndarray
    fuzz: np.ndarray
    a: np.ndarray
    second: np.ndarray
    bent: np.ndarray
    third: np.ndarray
    beta: np.ndarray
    size: np.ndarray
    noise: float
    law: LawBends | None = None

    def change(self, mu: np.ndarray, within: np.ndarray | float) -> np.ndarray:
        """Bound |J(Z) - J(z0)| / t on Z = z0 +- t (1, ..., mu, ...), t <= `within` (shape [R]): [R, n + m, n + m]."""
        m = self.a.shape[1]
        b, s = self.beta, self.beta.sum(axis=1)
        bb = b[:, :, None] * b[:, None, :]
        # Taylor about z0: lam . g''' t and d lam . g'' are known, terms of order four, and of three times d lam,
        # bounded
        later = within * (0.5 * self.size * s**2 + m * mu * s)
        corner = self.third + mu[:, None, None] * self.second.sum(axis=1)
        corner = corner + bb * later[:, None, None]
        if self.law is not None:
            i = np.arange(corner.shape[1])
            corner[:, i, i] += self.law.within(within)
        side = self.second.sum(axis=3) + (0.5 * within * s**2)[:, None, None] * b[:, None]
        return _bordered(corner, side)

    def doubt(self) -> np.ndarray:
        """Bound what rounding and doubt leave in J, [R, n + m, n + m]."""
        b = self.beta
        corner = b[:, :, None] * b[:, None, :] * (4 * self.noise * (1 + self.size))[:, None, None]
        if self.law is not None:
            i = np.arange(corner.shape[1])
            corner[:, i, i] += self.law.ripple
        side = 4 * self.noise * b[:, None] + np.zeros((1, self.a.shape[1], 1))
        return _bordered(corner, side)


def _bordered(corner: np.ndarray, side: np.ndarray) -> np.ndarray:
    """[[corner, side'], [side, 0]]."""
    m, n = side.shape[1:]
    out = np.zeros((len(corner), n + m, n + m))
    out[:, :n, :n], out[:, n:, :n] = corner, side
    out[:, :n, n:] = side.transpose(0, 2, 1)
    return out


class BoxKkt:
    """The KKT system of a model, over states of any stratum.

    Parameters
    ----------
    model
        Of a flat sheet.
    gaps
        Positions in `Structure.gaps` that are closed.
    """

    def __init__(self, model: Model, gaps: tuple[int, ...] = ()) -> None:
        self.piece = piece = piece_of(model)
        chain = piece.chain
        self.n, self.equations = model.size, piece.pivots
        self.m = piece.pivots + len(gaps)
        self.k, self.rest = model.parameters.stiffness, model.parameters.rest
        self.laws = torques_of(model, model.multiplicity, 1.0)
        known = [model.structure.gaps[i] for i in gaps]
        self.gaps = Triples(
            chain,
            [
                chain.behind(*g.rays)  # type: ignore[misc]
                if g.pair is None
                else chain.gap(*chain.shortest(*g.rays))  # type: ignore[misc]
                for g in known
            ],
        )
        self.sines = np.array(
            [1.0 if g.pair is None else math.sin(piece.sectors[g.rays[1]]) for g in known]
        )
        weight = np.ones(self.n)
        weight[chain.variable[chain.folds > 0]] = chain.folds[chain.folds > 0]
        self.beta = weight * (1.0 if gaps or piece.by_vectors else 0.5)
        # three axes or rays of a chain, and the product of its folds
        self.noise = 3 * CREASE * chain.around + chain.loop_rounding
        if gaps:
            self.noise *= 4 / float(self.sines.min())
        # what torques are sums of, and what is not known of a law, as a share of `noise`
        self.most = 7.0 * self.k
        if self.laws is not None:
            self.most = self.laws.most + self.laws.drift / self.noise

    def torque(self, x: np.ndarray) -> np.ndarray:
        """Return k (x - rest), or the torques of laws, at states [R, n]."""
        return self.k * (x - self.rest) if self.laws is None else self.laws.at(x)[0]

    def stiffness(self, x: np.ndarray) -> np.ndarray:
        """Return how torques change with fold angles at states [R, n], [R, n] or [n]."""
        return self.k if self.laws is None else self.laws.at(x)[1]

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

    def at(
        self, x: np.ndarray, lam: np.ndarray, pins: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return F [R, n + m], J [R, n + m, n + m], rows of pinned variables those of 1, and g'' [R, m, n, n]."""
        n, m = self.n, self.m
        g, a, second = self.vanishing(x)
        h = -np.einsum("rm,rmij->rij", lam, second)
        i = np.arange(n)
        h[:, i, i] += self.stiffness(x)
        force = self.torque(x) - np.einsum("rm,rmn->rn", lam, a)
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
        return np.concatenate([np.where(free, force, 0.0), g], axis=1), jacobian, second

    def local(self, x: np.ndarray, lam: np.ndarray, pins: np.ndarray) -> BoxDerivatives:
        """Return the system at states, with its second derivatives and a bound of the third."""
        f, jacobian, second = self.at(x, lam, pins)
        free = pins == 0
        beta = np.where(free, self.beta, 0.0)
        bb = beta[:, :, None] * beta[:, None, :]
        size = np.abs(lam).sum(axis=1)
        both = free[:, :, None] & free[:, None, :]
        second = np.where(both[:, None], second, 0.0)
        bent = np.abs(np.einsum("rm,rmij->rij", lam, second))
        bent = bent + bb * (4 * self.noise * size)[:, None, None]
        third = bb * (size * beta.sum(axis=1))[:, None, None]
        second = np.abs(second) + 4 * self.noise * bb[:, None]
        a = jacobian[:, self.n :, : self.n] * free[:, None]
        fuzz = self._fuzz(x, lam)
        law = None if self.laws is None else LawBends(self.laws, x, free)
        return BoxDerivatives(
            f, jacobian, fuzz, a, second, bent, third, beta, size, self.noise, law
        )

    def force(self, x: np.ndarray, lam: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return k (x - rest) - A' lam of all variables, and what rounding and doubt leave in it, [R, n]."""
        value = self.torque(x) - np.einsum("rm,rmn->rn", lam, self.vanishing(x)[1])
        return value, self._fuzz(x, lam)[:, : self.n]

    def _fuzz(self, x: np.ndarray, lam: np.ndarray) -> np.ndarray:
        """What rounding and doubt leave in F at most, [R, n + m]; less of closure near the flat state."""
        near = np.ones(len(x))
        if self.piece.near_flat and self.m == self.equations:
            near = np.minimum(1.0, np.abs(x).sum(axis=1))
        torque = self.most + 4.0 * self.beta * np.abs(lam).sum(axis=1)[:, None]
        return self.noise * np.concatenate([torque, near[:, None] + np.zeros((1, self.m))], axis=1)

    def start(self, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
        """Return the multipliers [R, m] that balance the free variables best."""
        a = self.vanishing(x)[1] * (pins == 0)[:, None]
        torque = np.where(pins == 0, self.torque(x), 0.0)
        return (np.linalg.pinv(a.transpose(0, 2, 1), rcond=INDEPENDENT) @ torque[:, :, None])[
            :, :, 0
        ]

    def least_slope(self, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
        """Return the smallest singular value of closure on the free variables, [R]; 0 where these are too few."""
        if not len(x):
            return np.zeros(0)
        a = self.vanishing(x)[1] * (pins == 0)[:, None]
        return np.linalg.svd(a, compute_uv=False)[:, -1]
