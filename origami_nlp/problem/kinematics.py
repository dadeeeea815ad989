"""The closed forms of a folded vertex for many states at once: every derivative is a product of deformed creases.

With q the product of all folds and c_i the deformed creases (the axis about which crease i turns what follows it),

    dq/dphi_i = 1/2 c_i q,      d2q/dphi_i dphi_j = 1/4 c_i c_j q    (i <= j, quaternion products),
    dc_r/dphi_i = c_i x c_r     (i before r, else 0),

so that closure, which is linear in q (or in a vector that q carries), and gaps, which are triple products of
rays, have first and second derivatives without another fold.  NumPy arrays over K states, no CasADi: it is
thousands of states that this is for, and a second derivation of what `closure` and `gaps` say in symbols.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from origami_nlp.numerics import cross, quaternion as quat
from origami_nlp.problem.posed import PosedProblem

OPEN = -1
"""No gap in this slot."""
FEW, LONG = 32, 24
"""Up to so many states of a chain of more rays than this are folded by products of neighbours: fewer calls."""


@dataclass(frozen=True, eq=False)
class FoldedRays:
    """K folded pieces.

    Attributes
    ----------
    rays
        Deformed rays of the piece, for C_n also of its images, then four that span the mirrors, shape [K, R + 4, 3].
    axes
        Deformed creases, shape [K, E, 3].
    end
        Quaternion of the piece up to its last ray, shape [K, 4].
    lift
        Positive on the lift q = +1, shape [K].
    """

    rays: np.ndarray
    axes: np.ndarray
    end: np.ndarray
    lift: np.ndarray


class Kinematics:
    """Closure and gaps of a scene's vertex, and their derivatives, at states [K, n].

    Parameters
    ----------
    model
        The posed scene: its structure and sector angles are read.

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp import examples
    >>> from origami_nlp.problem import Kinematics, Model
    >>> model = Model(examples.degree6("pi/3", ratio=1))
    >>> at = Kinematics(model).fold(np.zeros((1, 4)))
    >>> Kinematics(model).closure(at)[0].shape
    (1, 2)
    """

    def __init__(self, model: PosedProblem) -> None:
        s = model.structure
        self.size, self.equations = model.size, model.equation_count
        self._cyclic, self._order = s.kind == "C", s.turn
        sectors = np.array(model.parameters.sectors)
        count = len(s.has_crease)
        # C_n: the images belong to the same strip, folded on; D_n: the wedge
        periods = s.order if self._cyclic and s.gaps else 1
        rays = count * periods
        azimuth = np.concatenate([[0.0], np.cumsum(np.tile(sectors, periods))])[:rays]
        if not self._cyclic and s.flat_piece:
            azimuth[-1] = math.pi / s.order
        has = np.tile(s.has_crease, periods)
        self._flat = np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=1)
        self._flat[0] = (1.0, 0.0, 0.0)
        self._right = from_the_right(self._flat)
        self._period = count
        self.ray_of_crease = np.flatnonzero(has)
        on_mirror = np.isin(self.ray_of_crease, (0, rays - 1)) & (not self._cyclic)
        self._factor = np.where(on_mirror, 0.5, 1.0)
        self._variable = np.arange(len(self.ray_of_crease)) % self.size
        self._first = int(has[:count].sum())  # creases of the modelled piece
        # creases before each ray; the four extra rays: e3, e1 fixed, and e3 and the last ray carried along
        before = np.concatenate([[0], np.cumsum(has)])[:rays]
        self._before = np.concatenate([before, [0, 0, len(on_mirror), len(on_mirror)]])
        self._pose_end(sectors, s.turn, s.flat_piece)
        self._pose_gaps(model, sectors, rays)

    def _pose_end(self, sectors: np.ndarray, order: Fraction, flat_sheet: bool) -> None:
        """What turns the folded piece on to its end, and the linear forms of closure."""
        turn = math.pi / order
        excess = 0.0 if flat_sheet else float(sectors.sum()) - turn * (2 if self._cyclic else 1)
        if self._cyclic and order > 1:
            excess += 2 * turn
        self._onward = (math.cos(excess / 2), 0.0, 0.0, math.sin(excess / 2))
        self._mirror = np.array([[0.0, 0.0, 1.0], [math.cos(turn), math.sin(turn), 0.0]])
        if order == 1:
            self._mirror[1] = (-1.0, 0.0, 0.0)
        self._level = math.cos(turn)
        rows = {("C", 1): (1, 2, 3), ("D", 1): (1, 3), ("C", 2): (0,)}
        kind = "C" if self._cyclic else "D"
        self._entries = rows.get(
            (kind, 1 if order == 1 else 2)
        )  # of q; None: a vector that q carries
        self._lever_of = np.hstack(
            [_CONJUGATED[e] for e in self._entries or ()] or [np.zeros((4, 0))]
        )

    def _pose_gaps(self, model: PosedProblem, sectors: np.ndarray, rays: int) -> None:
        """Each gap as a triple product of three rays over a sine."""
        gaps = model.structure.gaps
        self._three = np.zeros((len(gaps) + 1, 3), dtype=int)
        self._over = np.zeros(len(gaps) + 1)  # the last row is that of an empty slot
        fixed, carried = (rays, rays + 1), (rays + 3, rays + 2)
        for index, gap in enumerate(gaps):
            if gap.type == "facet-pair":
                k, j = gap.rays
                self._three[index] = j, (j + 1) % rays, k
                self._over[index] = 1 / math.sin(sectors[j % len(sectors)])
            else:
                r, side = gap.rays
                self._three[index] = *(carried if side else fixed), r
                self._over[index] = 1.0
        # in the order in which creases carry them along: p, q and r
        order = np.argsort(self._before[self._three], axis=1, kind="stable")
        # an odd permutation of three rays changes the sign of their triple product
        even = (order[:, 1] - order[:, 0]) % 3 == 1
        self._three = np.take_along_axis(self._three, order, axis=1)
        self._over *= np.where(even, 1.0, -1.0)
        p, q, r = self._before[self._three].T[..., None]
        e = np.arange(len(self._variable))
        # creases before p turn all three rays together, those from r on turn none: only what lies between counts
        self._spans = np.stack([(p <= e) & (e < q), (q <= e) & (e < r)], axis=1).astype(float)

    def tables(self) -> dict[str, Any]:
        """Return what compiled descents read: numbers, and arrays by name."""
        count = len(self._flat)
        crease = np.full(count, -1)
        crease[self.ray_of_crease] = np.arange(len(self.ray_of_crease))
        return {
            "n": self.size,
            "m": self.equations,
            "rays": count,
            "creases": len(self._variable),
            "period": self._period,
            "first": self._first,
            "plane": self._cyclic and self._order == 1,
            "shifted": self._cyclic and self._order > 1,
            "entries": len(self._entries or ()),
            "level": self._level,
            "flat": self._flat[:, :2],
            "crease": crease,
            "factor": self._factor,
            "variable": self._variable,
            "onward": self._onward,
            "mirror": self._mirror,
            "entry": self._entries or (),
            "lever": self._lever_of,
            "three": self._three,
            "over": self._over,
            "before": self._before[self._three],
        }

    def fold(self, x: np.ndarray) -> FoldedRays:
        """Fold states x [K, n] [rad]."""
        count = len(self._flat)
        turns = np.zeros((count, len(x)))
        turns[self.ray_of_crease] = self._factor[:, None] * x.T[self._variable]
        # few states of a long chain: levels of products of neighbours, rather than one crease after the other
        together = len(x) <= FEW and count > LONG
        before = _in_levels(self._flat, turns) if together else products(self._right, turns)
        end = np.array(quat.multiply([*before[self._period]], self._onward))
        rays = np.empty((3, count + 4, len(x)))
        turn_in_plane(before[:-1], self._flat, rays[:, :count])
        rays[:, count : count + 2] = np.eye(3)[:, (2, 0), None]
        if self._cyclic and self._order == 1:  # no mirror, no wall: nothing asks for these
            rays[:, count + 2 :] = 0.0
        else:
            rays[:, count + 2 :] = quat.rotate([*end[:, None]], [*self._mirror.T[..., None]])
        rays = np.ascontiguousarray(rays.T)
        lift = end[0] if self._cyclic and self._order == 1 else np.ones(len(x))
        return FoldedRays(rays, rays[:, self.ray_of_crease], end.T, lift)

    def closure(self, at: FoldedRays) -> tuple[np.ndarray, np.ndarray]:
        """Return the equations [K, m] and their Jacobian [K, m, n]."""
        c = at.axes[:, : self._first] * self._factor[: self._first, None]
        if self._entries is None:
            normal = cross(at.rays[:, -1], at.rays[:, -2])
            value = normal[:, 1:2] + self._level
            # crease i turns all that follows: dN/dphi_i = c_i x N, so d(e2 . N)/dphi_i = c_i . (N x e2)
            lever = np.stack([-normal[:, 2], np.zeros(len(c)), normal[:, 0]], axis=-1)  # N x e2
            return value, (c @ lever[:, :, None]).transpose(0, 2, 1)
        value = at.end[:, self._entries]
        if self._cyclic and self._order > 1:
            value = value - self._level
        # dq/dphi_i = c_i q / 2, c_i as a quaternion without scalar part
        return value, 0.5 * self._levers(at)[..., 1:] @ c.transpose(0, 2, 1)

    def closure_hessian(self, at: FoldedRays, weights: np.ndarray) -> np.ndarray:
        """Return the Hessian of weights . equations, weights [K, m], shape [K, n, n]."""
        f = self._factor[: self._first]
        c = at.axes[:, : self._first] * f[:, None]
        if self._entries is None:
            normal = cross(at.rays[:, -1], at.rays[:, -2])
            # e2 . (c_i x (c_j x N)) = (e2 x c_i) . (c_j x N) for i <= j: the earlier crease carries the later one
            arm = np.zeros_like(c)
            arm[..., 0], arm[..., 2] = c[..., 2], -c[..., 0]  # e2 x c_i
            h = weights[:, :, None] * (arm @ cross(c, normal[:, None]).transpose(0, 2, 1))
        else:
            # <weights, c_i c_j q> = (-c_i . c_j, c_i x c_j) . (a, b), and (c_i x c_j) . b = c_j . (b x c_i)
            lever = weights[:, None] @ self._levers(at)
            h = 0.25 * (cross(lever[..., 1:], c) - lever[..., :1] * c) @ c.transpose(0, 2, 1)
        return _symmetric(h)

    def _levers(self, at: FoldedRays) -> np.ndarray:
        """Scalar and vector of e conj(q) for the entries e of q that closure takes: <e, p q> = (e conj(q)) . p."""
        return np.asarray((at.end @ self._lever_of).reshape(len(at.end), self.equations, 4))

    def gaps(self, at: FoldedRays, slots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return gaps [K, S] of the positions in `Structure.gaps` that `slots` [K, S] names, and gradients [K, S, n].

        Facet pairs are without sign; an empty slot (`OPEN`) is zero.
        """
        p, q, r = np.moveaxis(
            at.rays[np.arange(len(slots))[:, None, None], self._three[slots]], 2, 0
        )
        pq, qr, pr = ((u * v).sum(axis=-1, keepdims=True) for u, v in ((p, q), (q, r), (p, r)))
        over = self._over[slots]
        # turning q and r on is turning p back: -p x (q x r); turning r on: r x (p x q)
        levers = over[..., None, None] * np.stack([pq * r - pr * q, qr * p - pr * q], axis=2)
        c = (at.axes * self._factor[:, None]).transpose(0, 2, 1)
        per_crease = ((levers @ c[:, None]) * self._spans[slots]).sum(axis=2)
        value = over * (p * cross(q, r)).sum(axis=-1)
        return value, self._by_variable(per_crease)

    def _by_variable(self, per_crease: np.ndarray) -> np.ndarray:
        """Sum what belongs to creases [..., E] over the images of each variable, [..., n]."""
        if per_crease.shape[-1] == self.size:
            return per_crease
        return per_crease.reshape(*per_crease.shape[:-1], -1, self.size).sum(axis=-2)


def from_the_right(axes: np.ndarray) -> np.ndarray:
    """Return q -> q b for unit axes b = (x, y, 0), shape [R, 3], as matrices [R, 4, 4]."""
    out = np.zeros((len(axes), 4, 4))
    for matrix, (bx, by, _) in zip(out, axes, strict=True):
        matrix[:] = [[0, -bx, -by, 0], [bx, 0, 0, -by], [by, 0, 0, bx], [0, by, -bx, 0]]
    return out


def products(right: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Multiply turns [R, K] [rad] about axes (`from_the_right`): the product before each, and of all, [R + 1, 4, K]."""
    cosine, sine = np.cos(0.5 * turns), np.sin(0.5 * turns)
    before = np.empty((len(right) + 1, 4, turns.shape[1]))
    before[0] = np.array(quat.IDENTITY, dtype=float)[:, None]
    for r, b in enumerate(right):
        before[r + 1] = cosine[r] * before[r] + sine[r] * (b @ before[r])
    return before


def _in_levels(flat: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Return the same by products of 1, 2, 4, ... neighbours (Hillis and Steele, Comm. ACM 29, 1986)."""
    before = np.zeros((4, len(flat) + 1, turns.shape[1]))
    before[0, 0], before[0, 1:] = 1.0, np.cos(0.5 * turns)
    before[1:3, 1:] = flat[:, :2].T[..., None] * np.sin(0.5 * turns)
    step = 1
    while step < before.shape[1]:
        before[:, step:] = quat.multiply([*before[:, :-step]], [*before[:, step:]])
        step *= 2
    return before.swapaxes(0, 1)


def turn_in_plane(q: np.ndarray, flat: np.ndarray, out: np.ndarray) -> None:
    """Write vectors (x, y, 0), [R, 3], turned by quaternions q [R, 4, K], into out [3, R, K]."""
    w, a, b, c = q.swapaxes(0, 1)
    x, y = flat[:, 0, None], flat[:, 1, None]
    # twice the cross product, as `quaternion.rotate`
    tx, ty, tz = (-2 * y) * c, (2 * x) * c, (2 * y) * a - (2 * x) * b
    out[0] = x + w * tx + b * tz - c * ty
    out[1] = y + w * ty + c * tx - a * tz
    out[2] = w * tz + a * ty - b * tx


_CONJUGATED = np.zeros((4, 4, 4))
"""For each unit quaternion e the matrix [4, 4] that takes q to e conj(q), from the right."""
for _e, _signs in enumerate(((1, -1, -1, -1), (1, 1, 1, -1), (1, -1, 1, 1), (1, 1, -1, 1))):
    for _to, (_from, _sign) in enumerate(zip(np.arange(4) ^ _e, _signs, strict=True)):
        _CONJUGATED[_e, _from, _to] = _sign


def _symmetric(h: np.ndarray) -> np.ndarray:
    """Return the symmetric matrices with the upper triangles of h [K, n, n]."""
    n = h.shape[-1]
    return np.asarray(
        h * np.triu(np.ones((n, n))) + (h * np.triu(np.ones((n, n)), 1)).swapaxes(1, 2)
    )
