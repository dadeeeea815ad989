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

import numpy as np

from origami_nlp.numerics import cross, quaternion as quat
from origami_nlp.programme.posed import Posed

OPEN = -1
"""No gap in this slot."""
FEW, LONG = 32, 24
"""Up to so many states of a chain of more rays than this are folded by products of neighbours: fewer calls."""


@dataclass(frozen=True, eq=False)
class Folded:
    """K folded pieces.

    Attributes
    ----------
    rays
        Deformed rays of the piece, for C_n also of its images, then four that span the mirrors, shape [K, R + 4, 3].
    axes
        Deformed creases, shape [K, E, 3].
    end
        Quaternion of the piece up to its last ray, shape [K, 4].
    sheet
        Positive on the sheet q = +1, shape [K].
    """

    rays: np.ndarray
    axes: np.ndarray
    end: np.ndarray
    sheet: np.ndarray


class Kinematics:
    """Closure and gaps of a scene's vertex, and their derivatives, at states [K, n].

    Parameters
    ----------
    model
        The posed scene: its structure and sector angles are read.

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp import Model, examples
    >>> from origami_nlp.programme import Kinematics
    >>> model = Model(examples.degree6("pi/3", ratio=1))
    >>> at = Kinematics(model).fold(np.zeros((1, 4)))
    >>> Kinematics(model).closure(at)[0].shape
    (1, 2)
    """

    def __init__(self, model: Posed) -> None:
        s = model.structure
        self.size, self.equations = model.size, model.equation_count
        self._cyclic, self._order = s.kind == "C", s.order
        sectors = np.array(model.parameters.sectors)
        count = len(s.has_crease)
        # C_n: the images belong to the same strip, folded on; D_n: the wedge
        periods = s.order if self._cyclic and s.gaps else 1
        rays = count * periods
        azimuth = np.concatenate([[0.0], np.cumsum(np.tile(sectors, periods))])[:rays]
        if not self._cyclic and s.flat_sheet:
            azimuth[-1] = math.pi / s.order
        has = np.tile(s.has_crease, periods)
        self._flat = np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=1)
        self._flat[0] = (1.0, 0.0, 0.0)
        self._has = has
        # q b for the quaternion q of what comes before and the unit crease b = (x, y, 0)
        self._right = np.zeros((rays, 4, 4))
        for matrix, (bx, by, _) in zip(self._right, self._flat, strict=True):
            matrix[:] = [[0, -bx, -by, 0], [bx, 0, 0, -by], [by, 0, 0, bx], [0, by, -bx, 0]]
        self._period = count
        self.ray_of_crease = np.flatnonzero(has)
        on_mirror = np.isin(self.ray_of_crease, (0, rays - 1)) & (not self._cyclic)
        self._factor = np.where(on_mirror, 0.5, 1.0)
        self._variable = np.arange(len(self.ray_of_crease)) % self.size
        self._first = int(has[:count].sum())  # creases of the modelled piece
        # creases before each ray; the four extra rays: e3, e1 fixed, and e3 and the last ray carried along
        before = np.concatenate([[0], np.cumsum(has)])[:rays]
        self._before = np.concatenate([before, [0, 0, len(on_mirror), len(on_mirror)]])
        self._pose_end(sectors, s.order, s.flat_sheet)
        self._pose_gaps(model, sectors, rays)

    def _pose_end(self, sectors: np.ndarray, order: int, flat_sheet: bool) -> None:
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
        self._entries = rows.get((kind, min(order, 2)))  # of q; None: a vector that q carries

    def _pose_gaps(self, model: Posed, sectors: np.ndarray, rays: int) -> None:
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

    def fold(self, x: np.ndarray) -> Folded:
        """Fold states x [K, n] [rad]."""
        half = (0.5 * self._factor[:, None]) * x.T[self._variable]
        cosine, sine = np.cos(half), np.sin(half)
        count = len(self._flat)
        # few states of a long chain: levels of products of neighbours, rather than one crease after the other
        together = len(x) <= FEW and count > LONG
        before = self._products(cosine, sine) if together else self._one_by_one(cosine, sine)
        end = np.array(quat.multiply([*before[self._period]], self._onward))
        rays = np.empty((3, count + 4, len(x)))
        rays[:, :count] = quat.rotate([*before[:-1].swapaxes(0, 1)], [*self._flat.T[..., None]])
        rays[:, count : count + 2] = np.eye(3)[:, (2, 0), None]
        rays[:, count + 2 :] = quat.rotate([*end[:, None]], [*self._mirror.T[..., None]])
        rays = np.ascontiguousarray(rays.T)
        sheet = end[0] if self._cyclic and self._order == 1 else np.ones(len(x))
        return Folded(rays, rays[:, self.ray_of_crease], end.T, sheet)

    def _one_by_one(self, cosine: np.ndarray, sine: np.ndarray) -> np.ndarray:
        """Products of the folds before each ray, [R + 1, 4, K], from half angles of the creases [E, K]."""
        before = np.empty((len(self._flat) + 1, 4, cosine.shape[1]))
        before[0] = np.array(quat.IDENTITY, dtype=float)[:, None]
        e = 0
        for r, b in enumerate(self._right):
            if self._has[r]:
                before[r + 1] = cosine[e] * before[r] + sine[e] * (b @ before[r])
                e += 1
            else:
                before[r + 1] = before[r]
        return before

    def _products(self, cosine: np.ndarray, sine: np.ndarray) -> np.ndarray:
        """Return the same by products of 1, 2, 4, ... neighbours (Hillis and Steele, Comm. ACM 29, 1986)."""
        before = np.zeros((4, len(self._flat) + 1, cosine.shape[1]))
        before[0] = 1.0
        at = 1 + self.ray_of_crease
        before[0, at] = cosine
        before[1:3, at] = self._flat[self.ray_of_crease, :2].T[..., None] * sine
        step = 1
        while step < before.shape[1]:
            before[:, step:] = quat.multiply([*before[:, :-step]], [*before[:, step:]])
            step *= 2
        return before.swapaxes(0, 1)

    def closure(self, at: Folded) -> tuple[np.ndarray, np.ndarray]:
        """Return the equations [K, m] and their Jacobian [K, m, n]."""
        c = at.axes[:, : self._first] * self._factor[: self._first, None]
        if self._entries is None:
            normal = cross(at.rays[:, -1], at.rays[:, -2])
            value = normal[:, 1:2] + self._level
            lever = np.stack([-normal[:, 2], np.zeros(len(c)), normal[:, 0]], axis=-1)  # N x e2
            return value, (c @ lever[:, :, None]).transpose(0, 2, 1)
        value = at.end[:, self._entries]
        if self._cyclic and self._order > 1:
            value = value - self._level
        levers = np.stack([_lever(at.end, row)[1] for row in self._entries], axis=1)
        return value, 0.5 * levers @ c.transpose(0, 2, 1)

    def closure_hessian(self, at: Folded, weights: np.ndarray) -> np.ndarray:
        """Return the Hessian of weights . equations, weights [K, m], shape [K, n, n]."""
        f = self._factor[: self._first]
        c = at.axes[:, : self._first] * f[:, None]
        if self._entries is None:
            normal = cross(at.rays[:, -1], at.rays[:, -2])
            arm = np.zeros_like(c)
            arm[..., 0], arm[..., 2] = c[..., 2], -c[..., 0]  # e2 x c_i
            h = weights[:, :, None] * (arm @ cross(c, normal[:, None]).transpose(0, 2, 1))
        else:
            levers = [_lever(at.end, row) for row in self._entries]
            a = sum(weights[:, k] * scalar for k, (scalar, _) in enumerate(levers))
            b = sum(weights[:, k, None] * vector for k, (_, vector) in enumerate(levers))
            # <weights, c_i c_j q> = (-c_i . c_j, c_i x c_j) . (a, b), and (c_i x c_j) . b = c_j . (b x c_i)
            h = 0.25 * (
                cross(b[:, None], c) @ c.transpose(0, 2, 1)
                - a[:, None, None] * (c @ c.transpose(0, 2, 1))
            )
        upper = np.triu(h)
        return upper + np.triu(h, 1).transpose(0, 2, 1)

    def gaps(self, at: Folded, slots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return gaps [K, S] of the positions in `Structure.gaps` that `slots` [K, S] names, and gradients [K, S, n].

        Facet pairs are without sign; an empty slot (`OPEN`) is zero.
        """
        three, before, over = self._rays_of(at, slots)
        levers = np.stack(_levers(three), axis=2)  # [K, S, 3 rays, 3]
        moves = before[..., None] > np.arange(len(self._variable))  # [K, S, 3 rays, E]
        arm = np.einsum("ksre,ksrx->ksex", moves.astype(float), levers)
        per_crease = np.einsum("ksex,kex->kse", arm, at.axes * self._factor[:, None])
        value = np.einsum("ksx,ksx->ks", three[:, :, 0], cross(three[:, :, 1], three[:, :, 2]))
        return over * value, over[..., None] * self._by_variable(per_crease)

    def gaps_hessian(self, at: Folded, slots: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Return the Hessian [K, n, n] of the sum of weights [K, S] times the gaps in `slots` [K, S]."""
        creases = len(self._variable)
        total = np.zeros((len(slots), creases, creases))
        c = at.axes * self._factor[:, None]
        e = np.arange(creases)
        for s in range(slots.shape[1]):
            used = np.flatnonzero((slots[:, s] != OPEN) & (weights[:, s] != 0))
            if not len(used):
                continue
            three, before, over = self._rays_of(at, slots, used, s)
            ck, scale = c[used], over * weights[used, s]
            # ray `one` turns with the later crease j, ray `two` stays behind the earlier one i, `three` whatever
            for one, two, rest, sign in _PERMUTATIONS:
                mask = (before[:, one, None] > e)[:, None, :] & (before[:, two, None] <= e)[
                    :, :, None
                ]
                if not mask.any():
                    continue
                p, o, t = three[:, one], three[:, two], three[:, rest]
                # ((c_j x p), (c_i x o), t) = (c_j.(p x o)) (c_i.t) - p.(c_i x c_j) (o.t)
                first = (ck @ t[..., None]) * (ck @ cross(p, o)[..., None]).transpose(0, 2, 1)
                second = cross(p[:, None], ck) @ ck.transpose(0, 2, 1)
                term = first - np.einsum("kx,kx->k", o, t)[:, None, None] * second
                total[used] -= sign * scale[:, None, None] * np.where(mask, term, 0.0)
        upper = np.triu(total)
        full = upper + np.triu(total, 1).transpose(0, 2, 1)
        if creases == self.size:
            return full
        images = np.eye(self.size)[self._variable]
        return images.T @ full @ images

    def _rays_of(
        self, at: Folded, slots: np.ndarray, used: np.ndarray | None = None, slot: int = 0
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the three rays of each gap, how many creases come before each, and 1 / sine."""
        index = slots if used is None else slots[used, slot]
        rows = np.arange(len(slots)) if used is None else used
        which = self._three[index]
        rays = at.rays[rows.reshape(-1, *([1] * (which.ndim - 1))), which]
        return rays, self._before[which], self._over[index]

    def _by_variable(self, per_crease: np.ndarray) -> np.ndarray:
        """Sum what belongs to creases [..., E] over the images of each variable, [..., n]."""
        if per_crease.shape[-1] == self.size:
            return per_crease
        return per_crease.reshape(*per_crease.shape[:-1], -1, self.size).sum(axis=-2)


_PERMUTATIONS = (
    (0, 1, 2, 1),
    (1, 2, 0, 1),
    (2, 0, 1, 1),
    (1, 0, 2, -1),
    (2, 1, 0, -1),
    (0, 2, 1, -1),
)


def _lever(q: np.ndarray, entry: int) -> tuple[np.ndarray, np.ndarray]:
    """Return scalar and vector of e conj(q), e the unit quaternion of an entry: <e, p q> = (e conj(q)) . p."""
    w, x, y, z = q.T
    scalar, *vector = {0: (w, -x, -y, -z), 1: (x, w, z, -y), 2: (y, -z, w, x), 3: (z, y, -x, w)}[
        entry
    ]
    return scalar, np.stack(vector, axis=-1)


def _levers(three: np.ndarray) -> list[np.ndarray]:
    """Return p x (r x s) for each ray p of a triple product, r and s the other two in cyclic order."""
    p, q, r = three[..., 0, :], three[..., 1, :], three[..., 2, :]
    return [cross(p, cross(q, r)), cross(q, cross(r, p)), cross(r, cross(p, q))]
