"""What every local minimum satisfies where mirrors are imposed, over boxes of the fold angles of a wedge.

Torques per crease, G_i = k_i (phi_i - rest_i), stand beside the axes as without symmetry: a crease on a mirror counts
half in the energy of a piece, and moves it half.

D_1: the first mirror's normal n_1 is the last one's, N = H n_k (the paper's H e2 = e2).  On closed states the slopes
of closure are a rotation of n_1 x c_i, in the mirror's plane: det [G, x, z]_S = 0 for every three free creases, an
alternating sum of G_i (n_1, c_j, c_k); the triple product is the same with N.

D_n, n > 1: n_1 . N = -cos(pi / n) (cos(w pi / n) where states wind w times, w < n; w = n: as D_1), with slopes t_i =
(n_1, c_i, N): G_a t_b = G_b t_a for every two free creases.

All of it is triple products seen from the crease in the middle, as without symmetry.  Backwards, the wedge is read in a
mirror (y to -y).
"""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np

from origami_nlp.proof.affine import (
    TRIGONOMETRIC,
    UNIT,
    Affine,
    Turn,
    concatenated,
    constant,
    dot,
    mixed,
    padded,
    stacked,
    turned,
)
from origami_nlp.proof.angles import Angles
from origami_nlp.proof.chains import (
    SECTORS,
    Enclosed,
    Sprung,
    springs_of,
    taken,
    torques,
    with_twins,
    with_twins_asked,
)
from origami_nlp.proof.collinear_creases import collinear_creases_of_wedge
from origami_nlp.proof.law_torques import LawTorques

SHORTEST = 1e-3
"""Vectors that are taken for frames are longer; a shorter one gives a frame that bounds nothing well."""


class WedgeForms(Enclosed):
    """The forms of a wedge of D_n between two mirrors.

    Parameters
    ----------
    order
        n of D_n, over the winding w of its states: mirrors make the angle w pi/n.
    sectors
        Between successive rays, [R - 1] [rad].
    crease
        Number of the crease on each ray, None for a mirror through a facet, [R].
    stiffness, rest
        Of each crease of the wedge, one of its images, [n].
    laws
        Of hinges that are no linear springs, over the largest stiffness.
    """

    def __init__(
        self,
        order: int | Fraction,
        sectors: np.ndarray,
        crease: list[int | None],
        stiffness: np.ndarray,
        rest: np.ndarray,
        laws: LawTorques | None = None,
    ) -> None:
        n = self.size = len(stiffness)
        self.order, self.crease, self.laws = order, crease, laws
        self.sectors = np.asarray(sectors, dtype=float)
        self.stiffness, self.rest = np.asarray(stiffness, float), np.asarray(rest, float)
        self.rays = len(crease)
        self.middle_ray = self.rays // 2
        doubt = SECTORS * 4 * UNIT
        self.doubt = self.rays * (doubt + 2 * TRIGONOMETRIC)
        self.pivots = 2 if order == 1 else 1
        self.linear = slice(1, 3) if order == 1 else slice(0, 1)
        many = 3 if order == 1 else 2
        self.minor_creases = tuple(itertools.combinations(range(n), many))
        self.twin_rule = collinear_creases_of_wedge(self.sectors, crease, doubt)
        self.ray_of = [r for r, c in enumerate(crease) if c is not None]

    @property
    def springs(self) -> np.ndarray:
        """Stiffness over the largest, and rest angles, [2, n, 1]."""
        return springs_of(self.stiffness, self.rest)

    def turns(self, angles: Angles) -> Turn:
        """Turns of the creases, half as far on a mirror, [n, K]."""
        on_mirror = np.isin(self.ray_of, (0, self.rays - 1))[:, None]
        both = angles.halves, angles.whole
        names = Turn.__dataclass_fields__
        return Turn(*(np.where(on_mirror, *(getattr(t, v) for t in both)) for v in names))

    def enclosed(self, angles: Angles) -> tuple[Affine, Affine]:
        """Enclose closure, and minors and twins, over boxes."""
        turn = self.turns(angles)
        on = _Views(self, turn, 1)
        back = _Views(self, turn, -1)
        if self.order == 1:
            minors = self._three(on, back, turn, angles)
        else:
            minors = self._two(on, back, turn, angles)
        return self._closure(on, back), with_twins(self, minors, angles)

    def asked(self, pins: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Return which minors and twins hold on the strata of boxes, [R, K]."""
        return with_twins_asked(self, all_free(self.minor_creases, pins), pins, flat)

    def seen_first(self, angles: Angles) -> np.ndarray:
        """Return the first mirror's normal as the middle ray sees it before its fold, in the middle of boxes [3, K]."""
        back = _Views(self, self.turns(angles), -1)
        return _mirrored(back.after[self.middle_ray][:, 0]).centre

    def _closure(self, on: _Views, back: _Views) -> Affine:
        """Compare the mirrors' normals, seen from the middle ray before its fold."""
        last = on.before[self.middle_ray][:, 0]
        first = back.after[self.middle_ray][:, 0]
        first = _mirrored(first)
        if self.order > 1:
            level = math.cos(math.pi / self.order)
            # n_1 . N, both seen from the middle ray: each depends on half of the folds
            row = dot(first, last)
            return padded(
                row.centre[None] + level,
                row.slopes[None],
                row.error[None] + 4 * self.doubt,
                2.0 + 0 * row.centre[None],
                4,
            )
        # unit vectors: of the three rows one, along `first`, is of second order
        gap = first - last
        gap = Affine(gap.centre, gap.slopes, gap.error + 4 * self.doubt)
        return _in_frame(first.centre, gap)

    def _triple(self, ray: int, before: Affine, after: Affine, turn: Turn) -> Affine:
        """Enclose (u, c, v): u seen backwards, v forwards from a crease; shape [K]."""
        variable = self.crease[ray]
        assert variable is not None
        by = taken(turn, variable)
        z = dot(before[1:], after[2:0:-1])
        # (y' + i z')(y + i z) of both vectors seen from the crease, the one before it in the mirror; then turned by its
        # fold
        y0, y1 = before[1] * after[1], before[2] * after[2]
        y = y0 - y1
        ax = mixed(y, by.cosine, z, -by.sine)
        ay = mixed(y, by.sine, z, by.cosine)
        t = _placed(turned(ay, ax, by), variable)
        return Affine(t.centre, t.slopes, t.error + 4 * self.doubt)

    def _three(self, on: _Views, back: _Views, turn: Turn, angles: Angles) -> Affine:
        """Minors of three creases, D_1."""
        pairs = {}
        n = self.size
        for i, j in itertools.combinations(range(n), 2):
            r, s = self.ray_of[i], self.ray_of[j]
            if j <= n - 1 - i:  # creases before j, or those after i
                pairs[i, j] = self._triple(
                    r, back.after[r][:, 0], on.after[r][:, on.place(r, s)], turn
                )
            else:
                pairs[i, j] = self._triple(
                    s, back.after[s][:, back.place(s, r)], on.after[s][:, 0], turn
                )
        terms = [
            [(i, pairs[j, k], 1.0), (j, pairs[i, k], -1.0), (k, pairs[i, j], 1.0)]
            for i, j, k in self.minor_creases
        ]
        return sums_of_torques(self, terms, angles)

    def _two(self, on: _Views, back: _Views, turn: Turn, angles: Angles) -> Affine:
        """Minors of two creases, D_n."""
        slopes = [
            self._triple(r, back.after[r][:, 0], on.after[r][:, 0], turn) for r in self.ray_of
        ]
        terms = [[(a, slopes[b], 1.0), (b, slopes[a], -1.0)] for a, b in self.minor_creases]
        return sums_of_torques(self, terms, angles)


class _Views:
    """The far mirror's normal, and the axes between, seen from every ray: before its fold, and after it.

    Stacks of vectors [3, V, K], the normal first, then axes from the far mirror on; forwards (way = 1) or backwards.
    """

    def __init__(self, wedge: WedgeForms, turn: Turn, way: int) -> None:
        n, boxes = wedge.size, turn.cosine.shape[-1]
        rays = list(range(wedge.rays))[::way]
        self.after: dict[int, Affine] = {}
        self.before: dict[int, Affine] = {}
        self.seen: dict[int, list[int]] = {}
        stack = constant(np.array([[0.0], [-1.0], [0.0]]), 0.0, n, boxes)
        axis = constant(np.array([[1.0], [0.0], [0.0]]), 0.0, n, boxes)
        axes: list[int] = []
        for r in reversed(rays):
            self.after[r], self.seen[r] = stack, list(axes)
            variable = wedge.crease[r]
            if variable is not None:
                stack = _about_x(stack, taken(turn, variable), variable)
                stack = concatenated([stack, axis], axis=1)
                axes.append(r)
            self.before[r] = stack
            if r != rays[0]:
                sector = wedge.sectors[r - 1 if way > 0 else r]
                stack = _about_z(stack, math.cos(sector), math.sin(sector))

    def place(self, r: int, s: int) -> int:
        """Where the axis of the crease on ray s stands among what is seen from ray r after its fold."""
        return 1 + self.seen[r].index(s)


def _about_x(v: Affine, by: Turn, variable: int) -> Affine:
    """Turn vectors [3, V, K] about e1 by an angle that they do not depend on yet."""
    x, y, z = v[0], v[1], v[2]
    ay, az = mixed(y, by.cosine, z, -by.sine), mixed(y, by.sine, z, by.cosine)
    y, z = (_placed(turned(a, b, by), variable) for a, b in ((ay, -az), (az, ay)))
    return stacked([x, y, z])


def _about_z(v: Affine, c: float, s: float) -> Affine:
    """Turn vectors [3, V, K] about e3."""
    x, y, z = v[0], v[1], v[2]
    a, b = np.full((1, 1), c), np.full((1, 1), s)
    x, y = mixed(x, a, y, -b), mixed(x, b, y, a)
    return stacked([x, y, z])


def _mirrored(v: Affine) -> Affine:
    """y to -y of a vector [3, K]."""
    flip = np.array([1.0, -1.0, 1.0])[:, None]
    return Affine(flip * v.centre, flip[..., None] * v.slopes, v.error)


def _placed(form: Affine, variable: int) -> Affine:
    """Move the slope of the last variable to where it belongs; the form did not depend on that one."""
    slopes = form.slopes[..., :-1, :].copy()
    slopes[..., variable, :] += form.slopes[..., -1, :]
    return Affine(form.centre, slopes, form.error)


def frame_of(normal: np.ndarray) -> np.ndarray:
    """Return frames [3, 3, K] whose first axis is along vectors [3, K] that are not small."""
    normal = normal / np.maximum(np.linalg.norm(normal, axis=0), SHORTEST)
    # the axis of the smallest entry, of equal ones the first
    second = np.cross(normal, np.eye(3)[:, np.abs(normal).argmin(axis=0)], axis=0)
    second = second / np.maximum(np.linalg.norm(second, axis=0), SHORTEST)
    return np.stack([normal, second, np.cross(normal, second, axis=0)])


def _in_frame(normal: np.ndarray, gap: Affine) -> Affine:
    """Turn a vector [3, K] into a frame whose first axis is along `normal`; any matrix would do."""
    frame = frame_of(normal)
    size = np.abs(frame)
    total = np.einsum("abk,bk->ak", size, gap.magnitude())
    return padded(
        np.einsum("abk,bk->ak", frame, gap.centre),
        np.einsum("abk,bdk->adk", frame, gap.slopes),
        np.einsum("abk,bk->ak", size, gap.error),
        total,
        6,
    )


def all_free(creases: tuple[tuple[int, ...], ...], pins: np.ndarray) -> np.ndarray:
    """Return which choices of creases are free, [M, K]."""
    if not creases:
        return np.zeros((0, pins.shape[1]), dtype=bool)
    which = np.array(creases, dtype=int)
    return (pins == 0)[which].all(axis=1)


def sums_of_torques(
    piece: Sprung, terms: list[list[tuple[int, Affine, float]]], angles: Angles
) -> Affine:
    """Enclose sums of sign G_i t, [M, K], the stiffness over its largest."""
    n, boxes = angles.middle.shape
    torque, lean, error, room = torques(piece, angles)
    unit = lean[:, None] * np.eye(n)[:, :, None]
    if error is None:
        # (phi - rest) k is rounded twice
        g = padded(torque, unit, np.zeros((n, boxes)), np.full((n, boxes), 1.0) * room, 4)
    else:
        g = Affine(torque, unit, error)
    sums = []
    for row in terms:
        i, t, sign = zip(*row, strict=True)
        s = np.array(sign)[:, None]
        left = Affine(s * g.centre[list(i)], s[..., None] * g.slopes[list(i)], g.error[list(i)])
        sums.append(dot(left, stacked(t)))
    return stacked(sums, boxes, n)
