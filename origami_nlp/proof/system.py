"""The KKT system of a stratum at states in doubles, and bounds of how it changes beside them.

F = [k (x - rest) - A' lam ; g] in (x, lam), g the closure of the model, A its Jacobian; J = [[K - lam . g'', -A'], [A,
0]].  Hinge laws have their torque in place of k (x - rest), and its slope in K: between states it is one of the slopes
between, so that a torque with kinks is treated like one without.

Derivatives.  With q the product of all folds, half the axes c_i / 2 (a quarter on a mirror) stand for derivatives: d q
/ dx_i dx_j dx_k = (c_i / 2) (c_j / 2) (c_k / 2) q, i <= j <= k; where closure is that a rotated normal N keeps an
angle, c_i x (c_j x (c_k x N)).  So the p-th derivative in the directions i, j, ... is at most beta_i beta_j ... in
size, and the second and third ones are known at the state.

Rounding.  N folds in doubles are off by at most `FOLD` u each, azimuths of creases by what the sectors before them may
be off.  The vector part of q, and the z of axes, are sums of products that each hold the sine of a fold or of half of
one, and every error in them is relative to such a term: near the flat state they are known to that share of the bound.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import INDEPENDENT, cross
from origami_nlp.problem import FoldedRays, Kinematics, Model
from origami_nlp.proof.law_torques import LawTorques, torques_of
from origami_nlp.proof.rows import SECTORS, UNIT

FOLD = 40
"""Rounding units of a fold in doubles: sines to 8, creases to 8, a 4 x 4 product and a rotated vector."""


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
        Within fold limits.
    """

    def __init__(self, model: Model) -> None:
        self.kinematics = Kinematics(model)
        self.n, self.m = model.size, model.equation_count
        self.flat = model.structure.flat_piece
        self.k, self.rest = model.parameters.stiffness, model.parameters.rest
        self.laws = torques_of(model, model.multiplicity, 1.0)
        rays = [r for r, has in enumerate(model.structure.has_crease) if has]
        dihedral = model.structure.kind == "D"
        last = len(model.structure.has_crease) - 1
        on_mirror = np.isin(rays, (0, last)) & dihedral
        self.factor = np.where(on_mirror, 0.5, 1.0)
        self.entries = {3: (1, 2, 3), 2: (1, 3)}.get(self.m, None if dihedral else (0,))
        self.beta = self.factor * (1.0 if self.entries is None else 0.5)
        # creases are off by their azimuths: a sector's doubt for each sector before them
        n = len(rays)
        self.noise = UNIT * (FOLD * (n + 4) + 2 * SECTORS * n**2)
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

    def closure(self, x: np.ndarray) -> np.ndarray:
        """Return the Jacobian of closure, [R, m, n]."""
        return self.vanishing(self.kinematics.fold(x))[1]

    def vanishing(self, at: FoldedRays) -> tuple[np.ndarray, np.ndarray]:
        """Return g [R, m] and its Jacobian [R, m, n]."""
        return self.kinematics.closure(at)

    def curvature(self, at: FoldedRays, lam: np.ndarray) -> np.ndarray:
        """Return lam . g'', [R, n, n]."""
        return self.kinematics.closure_hessian(at, lam)

    def at(
        self, x: np.ndarray, lam: np.ndarray, pins: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return F [R, n + m], J [R, n + m, n + m], rows of pinned variables those of 1, and the lift [R]."""
        n, m = self.n, self.m
        folded = self.kinematics.fold(x)
        g, a = self.vanishing(folded)
        h = -self.curvature(folded, lam)
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
        return np.concatenate([np.where(free, force, 0.0), g], axis=1), jacobian, folded.lift

    def local(self, x: np.ndarray, lam: np.ndarray, pins: np.ndarray) -> BoxDerivatives:
        """Return the system at states, with its second and third derivatives."""
        f, jacobian, _ = self.at(x, lam, pins)
        free = pins == 0
        beta = np.where(free, self.beta, 0.0)
        bb = beta[:, :, None] * beta[:, None, :]
        size = np.abs(lam).sum(axis=1)
        second, third = self._derivatives(x, lam)
        both = free[:, :, None] & free[:, None, :]
        second = np.where(both[:, None], second, 0.0)
        bent = np.abs(np.einsum("rm,rmij->rij", lam, second))
        third = np.where(both[:, :, :, None] & free[:, None, None, :], np.abs(third), 0.0).sum(
            axis=3
        )
        bent = bent + bb * (4 * self.noise * size)[:, None, None]
        third = third + bb * (4 * self.noise * size * beta.sum(axis=1))[:, None, None]
        second = np.abs(second) + 4 * self.noise * bb[:, None]
        a = jacobian[:, self.n :, : self.n] * free[:, None]
        fuzz = self._fuzz(x, lam)
        law = None if self.laws is None else LawBends(self.laws, x, free)
        return BoxDerivatives(
            f, jacobian, fuzz, a, second, bent, third, beta, size, self.noise, law
        )

    def force(self, x: np.ndarray, lam: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return k (x - rest) - A' lam of all variables, and what rounding and doubt leave in it, [R, n]."""
        value = self.torque(x) - np.einsum("rm,rmn->rn", lam, self.closure(x))
        return value, self._fuzz(x, lam)[:, : self.n]

    def _fuzz(self, x: np.ndarray, lam: np.ndarray) -> np.ndarray:
        """What rounding and doubt leave in F at most, [R, n + m]; less near the flat state (see above)."""
        size = np.abs(lam)
        near = np.ones(len(x))
        if self.m > 1 and self.flat:
            near = np.minimum(1.0, np.abs(x).sum(axis=1))
            # the rows of closure are x, y, z or x, z of q; A's row z is of the size of the folds
            size = np.concatenate([size[:, :-1], near[:, None] * size[:, -1:]], axis=1)
        torque = self.most + 4.0 * self.beta * size.sum(axis=1)[:, None]
        return self.noise * np.concatenate([torque, near[:, None] + np.zeros((1, self.m))], axis=1)

    def start(self, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
        """Return the multipliers [R, m] that balance the free variables best."""
        a = self.closure(x) * (pins == 0)[:, None]
        torque = np.where(pins == 0, self.torque(x), 0.0)
        return (np.linalg.pinv(a.transpose(0, 2, 1), rcond=INDEPENDENT) @ torque[:, :, None])[
            :, :, 0
        ]

    def _derivatives(self, x: np.ndarray, lam: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """g'' [R, m, n, n] and lam . g''' [R, n, n, n]."""
        n = self.n
        folded = self.kinematics.fold(x)
        c = folded.axes[:, :n] * self.beta[:, None]
        # derivatives commute, products do not: the earlier crease stands on the left
        i, j, k = np.sort(np.indices((n, n, n)), axis=0)
        if self.entries is None:
            normal = cross(folded.rays[:, -1], folded.rays[:, -2])
            first = cross(c, normal[:, None])
            two = cross(c[:, :, None], first[:, None, :])
            second = two[..., 1][:, None]
            # lam e2 . (c_i x v) = -(c_i x e2) . v lam
            lever = -cross(c, np.array([0.0, 1.0, 0.0])) * lam[:, :1, None]
        else:
            first = _left(c, folded.end[:, None])
            two = _left(c[:, :, None], first[:, None, :])
            second = np.moveaxis(two[..., list(self.entries)], -1, 1)
            weight = np.zeros((len(x), 4))
            weight[:, list(self.entries)] = lam
            lever = -_left(c, weight[:, None])
        three = np.einsum("ria,rjka->rijk", lever, two)
        p, q = np.sort(np.indices((n, n)), axis=0)
        return second[:, :, p, q], three[:, i, j, k]

    def least_slope(self, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
        """Return the smallest singular value of closure on the free variables, [R]; 0 where these are too few."""
        if not len(x):
            return np.zeros(0)
        a = self.closure(x) * (pins == 0)[:, None]
        return np.linalg.svd(a, compute_uv=False)[:, -1]


def _left(c: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Multiply quaternions [..., 4] by vectors [..., 3] from the left."""
    w, v = q[..., :1], q[..., 1:]
    scalar = -(c * v).sum(axis=-1, keepdims=True)
    return np.concatenate([scalar + 0 * w, w * c + cross(c, v)], axis=-1)
