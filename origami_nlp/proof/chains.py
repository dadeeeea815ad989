"""What every local minimum satisfies, as affine forms over boxes of fold angles: closure, minors, twins; no symmetry.

Closure.  The loop is cut at the facet between crease N and crease 1 and in its middle: with Q(b, phi) the fold about b,
L = Q(b_1, phi_1) ... Q(b_h, phi_h) = R = Q(b_N, -phi_N) ... Q(b_{h+1}, -phi_{h+1}), both sides unit quaternions, states
the lift q = +1 only.  Both depend on half of the angles, so that what is of second order stays small.  With R_0 = R at
the middle of a box the rows are (L - R) R_0^-1.  As Q(b, mid + t) = Q(b, t) Q(b, mid), each side is a product of folds
by t alone, about the axes where the middle of the box has them (the product of exponentials), times a constant: no
angle of the middle turns an error into other rows, as it would if the chain were folded one crease after the other.

Minors.  On the free creases of a stratum a local minimum has rank [G | C] <= 3 (Fritz John; G_i = k_i (phi_i -
rest_i), row i of C the axis c_i): det [G_S | C_S] = 0 for every four free creases S, an alternating sum of G_i times
triple products of axes.  A triple product of three axes of a closed loop depends on the angles along two of the three
arcs between them, and on the middle one: seen from crease j, with Z = y + i z of the next axes on either side, (c_i,
c_j, c_k) = Im(exp(i phi_j) Z' Z).  The two arcs with fewest creases are taken.

Sectors are those of the scene to within `SECTORS` ulp each, with sum 2 pi exactly.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from origami_nlp.numerics import quaternion
from origami_nlp.proof.affine import (
    TRIGONOMETRIC,
    UNIT,
    Affine,
    Turn,
    concatenated,
    constant,
    mixed,
    padded,
    stacked,
    turned,
)
from origami_nlp.proof.angles import Angles, folded_flat
from origami_nlp.proof.collinear_creases import (
    CollinearPair,
    collinear_creases_of_loop,
    collinear_rows,
    twins_asked,
)
from origami_nlp.proof.law_torques import LawTorques

SECTORS = 2
"""Ulp of pi by which a sector angle may differ from the double in the scene."""


@dataclass(frozen=True, eq=False)
class VanishingRows:
    """What vanishes at every critical point in a box, over K boxes.

    Attributes
    ----------
    closure
        Shape [rows, K], in n variables.
    critical
        Minors, then twins, shape [R, K].
    asked
        Which of these hold on the box's stratum, [R, K].
    """

    closure: Affine
    critical: Affine
    asked: np.ndarray


class Enclosed:
    """Rows that are computed of angles by sums and products alone."""

    size: int
    laws: LawTorques | None = None

    @property
    def springs(self) -> np.ndarray:
        """Stiffness over the largest, and rest angles, [2, n, 1]."""
        raise NotImplementedError

    def enclosed(self, angles: Angles) -> tuple[Affine, Affine]:
        """Enclose closure, and minors and twins, over boxes."""
        raise NotImplementedError

    def asked(self, pins: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Return which minors and twins hold on the strata of boxes, [R, K]; pins, and those at +-pi, [n, K]."""
        raise NotImplementedError

    def rows(self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray) -> VanishingRows:
        """Enclose the rows over boxes.

        Parameters
        ----------
        lower, upper
            Shape [n, K] [rad]; angles pinned at what rounds to +-pi are +-pi exactly.
        pins
            -1, 0 or +1, shape [n, K].

        Returns
        -------
        VanishingRows
        """
        angles = Angles.over(lower, upper, pins)
        if self.laws is not None:
            angles = replace(angles, torque=self.laws.over(angles.middle, angles.half))
        closure, critical = self.enclosed(angles)
        return VanishingRows(closure, critical, self.asked(pins, folded_flat(lower, pins)))


class Sprung(Protocol):
    """Springs, laws and twins of a piece."""

    laws: LawTorques | None
    twin_rule: tuple[CollinearPair, ...]

    @property
    def springs(self) -> np.ndarray: ...  # noqa: D102


class VertexForms(Enclosed):
    """The forms of a vertex without symmetry.

    Parameters
    ----------
    sectors
        Shape [N] [rad], sum `whole`.
    stiffness
        Shape [N], in any unit: rows do not depend on it.
    rest
        Shape [N] [rad].
    whole
        What the sectors add up to [rad]: less where every period of a symmetric state closes by itself.
    laws
        Of hinges that are no linear springs, over the largest stiffness.
    """

    linear = slice(1, 4)
    """Rows of closure that are linear to first order; the other one is of second order."""
    pivots = 3

    def __init__(
        self,
        sectors: np.ndarray,
        stiffness: np.ndarray,
        rest: np.ndarray,
        whole: float = 2 * math.pi,
        laws: LawTorques | None = None,
    ) -> None:
        n = self.size = len(sectors)
        self.laws, self.whole = laws, whole
        self.stiffness = np.asarray(stiffness, dtype=float)
        self.rest = np.asarray(rest, dtype=float)
        self.sectors = np.asarray(sectors, dtype=float)
        self.half = (n + 1) // 2
        azimuth = np.array([math.fsum(sectors[:i]) for i in range(n)])
        self.creases = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
        # azimuths of the left creases from crease 1 on, of the right ones back from it
        left = [math.fsum(sectors[:i]) for i in range(self.half)]
        right = [-math.fsum(sectors[i:]) for i in range(n - 1, self.half - 1, -1)]
        doubt = SECTORS * 4 * UNIT
        self.doubt = doubt + 2 * TRIGONOMETRIC  # of a cosine or sine of a sector
        self.doubt_crease = (n * doubt + 8 * UNIT) + 2 * TRIGONOMETRIC
        self.sides = (
            (tuple(range(self.half)), _units(left), 1.0),
            (tuple(range(n - 1, self.half - 1, -1)), _units(right), -1.0),
        )
        # a fold in the middle of boxes is off by 2 TRIGONOMETRIC and what came before it; an axis is turned by two such
        self.doubt_middle = 16 * n * TRIGONOMETRIC
        # folds and sectors of the loop multiply to -1: L Q(e3, whole) = -R, whole = 2 pi on a sheet
        self.onward = (
            None if whole == 2 * math.pi else (-math.cos(whole / 2), 0.0, 0.0, -math.sin(whole / 2))
        )
        self._pose_triples()
        self._pose_minors()
        self.twin_rule = collinear_creases_of_loop(self.sectors, doubt)

    @property
    def springs(self) -> np.ndarray:
        """Stiffness over the largest, and rest angles, [2, n, 1]."""
        return springs_of(self.stiffness, self.rest)

    def _pose_triples(self) -> None:
        """Choose for each triple of creases the middle one and how many creases on each side the others are."""
        n = self.size
        self.triples = list(itertools.combinations(range(n), 3))
        self.triple_number = {t: i for i, t in enumerate(self.triples)}
        self.kinds: dict[tuple[int, int], list[tuple[int, int]]] = {}
        for number, (i, j, k) in enumerate(self.triples):
            # (before, middle, after) around the loop: all three are even permutations of (i, j, k)
            options = [
                ((b - a) % n, (c - b) % n, b) for a, b, c in ((i, j, k), (j, k, i), (k, i, j))
            ]
            # a cyclic shift does not change a triple product: the two shorter of the three arcs are folded
            back, on, middle = min(options, key=lambda o: (o[0] + o[1], abs(o[0] - o[1])))
            self.kinds.setdefault((back, on), []).append((number, middle))
        self.reach = max((max(kind) for kind in self.kinds), default=1)

    def _pose_minors(self) -> None:
        """Number the minors: four creases, the triple without each, and the sign of the expansion along G."""
        n = self.size
        self.fours = np.array(list(itertools.combinations(range(n), 4)), dtype=int).reshape(-1, 4)
        self.without = np.array(
            [
                [self.triple_number[tuple(s[:a]) + tuple(s[a + 1 :])] for a in range(4)]
                for s in self.fours.tolist()
            ],
            dtype=int,
        ).reshape(-1, 4)

    def enclosed(self, angles: Angles) -> tuple[Affine, Affine]:
        """Enclose closure, and minors and twins, over boxes."""
        return self.closure(angles), with_twins(self, self.minors(angles), angles)

    def asked(self, pins: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Return which minors and twins hold on the strata of boxes, [R, K]."""
        return with_twins_asked(self, ~(pins != 0)[self.fours].any(axis=1), pins, flat)

    def closure(self, angles: Angles) -> Affine:
        """Enclose (L - R) R_0^-1, R_0 = R at the middle: four rows."""
        turn = angles.halves
        unit = np.eye(4)[:, :1] + np.zeros((4, turn.mean.shape[1]))
        left, right = (self._middle(turn, side, unit)[0] for side in (0, 1))
        # two folds by phi about creases that differ by d differ by |sin (phi / 2)| d
        # c (1 + e) + s (1 + f) b = (1 + e) (c + s b) + (f - e) s b: a vector misses no more than the sines allow
        sines, most = angles.sines
        doubt = self.doubt_middle * np.stack([np.ones_like(most), most, most, most])
        if self.onward is not None:
            left = quaternion.multiply(left, self.onward)
            doubt = doubt + 4 * self.doubt
        start = np.array(quaternion.multiply(left, (right[0], *(-v for v in right[1:]))))
        left, right = (self._folded(turn, *at) for at in ((0, start, doubt), (1, unit, 0.0 * unit)))
        back = right.slopes[:, ::-1]  # creases h+1 .. N in order
        # two unit quaternions are equal where their difference vanishes; L = -R, the other lift, is far from 0
        return padded(
            left.centre - right.centre,
            np.concatenate([left.slopes, -back], axis=1),
            left.error + right.error + 2 * self.doubt_crease * sines,
            left.magnitude() + right.magnitude(),
            2,
        )

    def _middle(self, turn: Turn, side: int, q: Any) -> tuple[Any, list[np.ndarray]]:
        """Return q times the folds of one side in the middle of boxes, and the axes [3, K] that each is about."""
        creases, units, sign = self.sides[side]
        axes = []
        for crease, (x, y) in zip(creases, units, strict=True):
            axes.append(np.array(quaternion.rotate(q, (x, y, 0.0))))
            c, s = turn.cosine[crease], sign * turn.sine[crease]
            q = quaternion.multiply(q, quaternion.fold(c, s, (x, y, 0.0)))
        return q, axes

    def _folded(self, turn: Turn, side: int, start: np.ndarray, doubt: np.ndarray) -> Affine:
        """Enclose Q(c_1, t_1) Q(c_2, t_2) ... start: c_i the axes of a side in the middle, t_i = phi_i - middle."""
        creases, _, sign = self.sides[side]
        # Q(c, t) start = start Q(c', t): axes as they are seen before start
        axes = self._middle(turn, side, (start[0], *(-v for v in start[1:])))[1]
        q = Affine(start, np.zeros((4, 0, start.shape[1])), doubt)
        for crease, axis in zip(creases, axes, strict=True):
            q = turned(q, times_vector(q, axis, self.doubt_middle), taken(turn, crease, sign))
        return q

    def triple_products(self, angles: Angles) -> Affine:
        """Enclose the triple products of axes, in the order of `triples`: [T, K] in n variables."""
        n, boxes = angles.middle.shape
        turn = angles.whole
        on, back = self._next_axes(turn, boxes), self._next_axes(turn, boxes, -1)
        # a triple product is zero for any sectors where all is flat; its mixed derivatives are at most 2
        share = angles.share
        count = len(self.triples)
        centre, error = np.empty((2, count, boxes))
        slopes = np.zeros((count, n, boxes))
        for (p, q), members in self.kinds.items():
            number, j = (np.array(v) for v in zip(*members, strict=True))
            z, w = back[p - 1][:, j], on[q - 1][:, j]
            # Z' Z, the variables of Z' first
            # (c_i, c_j, c_k) = Im(exp(i phi_j) Z' Z): ax, ay are real and imaginary part at the middle of phi_j
            x, y = complex_product(z, w)
            by = taken(turn, j)
            ax = mixed(x, by.cosine, y, -by.sine)
            ay = mixed(x, by.sine, y, by.cosine)
            t = turned(ay, ax, by)
            centre[number] = t.centre
            error[number] = t.error + 2 * (p + q + 1) * self.doubt * share
            for c in range(p - 1):
                slopes[number, (j - 1 - c) % n] = t.slopes[:, c]
            for c in range(q - 1):
                slopes[number, (j + 1 + c) % n] = t.slopes[:, p - 1 + c]
            slopes[number, j] = t.slopes[:, -1]
        return Affine(centre, slopes, error)

    def _next_axes(self, turn: Turn, boxes: int, way: int = 1) -> list[Affine]:
        """Enclose y and z [2, N, K] of the axis 1, 2, ... creases on, seen from every crease; variables nearest first.

        Backwards (way = -1) the loop is read in a mirror: y counts towards the crease before.
        """
        n = self.size
        j = np.arange(n)
        sector = self.sectors if way > 0 else self.sectors[j - 1]
        c, s = np.cos(sector)[:, None], np.sin(sector)[:, None]
        axis = constant(np.stack([c[:, 0], s[:, 0], 0 * j]), 0.0, 0, boxes)
        found = [axis[1:]]
        near = (j + way) % n
        by = taken(turn, near)
        for _ in range(self.reach - 1):
            # axes seen from the next crease, one further on, turned by its fold and by the sector between
            x, y, z = (axis[i, near] for i in range(3))
            ay, az = mixed(y, by.cosine, z, -by.sine), mixed(y, by.sine, z, by.cosine)
            y, z = turned(ay, -az, by), turned(az, ay, by)
            # the new variable is the nearest
            y, z, x = _last_first(y), _last_first(z), x.on(x.variables + 1, slice(1, None))
            ones = np.ones_like(c)
            x, y = mixed(x, c * ones, y, -s * ones), mixed(x, s * ones, y, c * ones)
            axis = stacked([x, y, z])
            found.append(axis[1:])
        return found

    def minors(self, angles: Angles) -> Affine:
        """Enclose det [G_S | C_S] for every four creases, stiffness over its largest: [M, K] in n variables."""
        n, boxes = angles.middle.shape
        t = self.triple_products(angles)
        torque, lean, error_of, room = torques(self, angles)
        steep = lean if error_of is None else np.abs(lean)
        count = len(self.fours)
        centre, error, total = np.zeros((3, count, boxes))
        slopes = np.zeros((count, n, boxes))
        rows = np.arange(count)
        magnitude = t.magnitude()
        own = t.slopes[self.without, self.fours]  # [M, 4, K]: of T_a in the variable of G_a
        for a in range(4):
            sign = 1.0 - 2.0 * (a % 2)
            i, w = self.fours[:, a], self.without[:, a]
            g, r = torque[i], lean[i]
            # G_i and T_a may both hold xi_i: r own xi_i^2 = r own (1 + eta) / 2
            centre += sign * (g * t.centre[w] + 0.5 * r * own[:, a])
            slopes += sign * (g[:, None] * t.slopes[w])
            slopes[rows, i] += sign * r * t.centre[w]
            # cofactor expansion of det [G | C] along G: signs alternate, T_a is the triple product without row a
            size = np.abs(g) + steep[i]
            error += size * t.error[w] + steep[i] * (
                np.abs(t.slopes[w]).sum(axis=1) - 0.5 * np.abs(own[:, a])
            )
            if error_of is not None:
                error += error_of[i] * magnitude[w]
            total += (size + room[i]) * magnitude[w]
        return padded(centre, slopes, error, total, n + 16)


def torques(
    piece: Sprung, angles: Angles
) -> tuple[np.ndarray, np.ndarray, np.ndarray | None, np.ndarray]:
    """Return torques at the middle of boxes, slopes and errors (None: exact) [n, K], and what rounding counts beside.

    Torques are over the largest stiffness.
    """
    if angles.torque is not None:
        centre, lean, error = angles.torque
        return centre, lean, error, error
    k, rest = piece.springs
    return k * (angles.middle - rest), k * angles.half, None, 8 * k


def springs_of(stiffness: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Return stiffness [n] over its largest, and rest angles [n], as [2, n, 1]."""
    return np.stack([stiffness / stiffness.max(), rest])[:, :, None]


def with_twins_asked(
    piece: Sprung, asked: np.ndarray, pins: np.ndarray, flat: np.ndarray
) -> np.ndarray:
    """Add to which minors are asked for which twin rows are, [R, K]."""
    rule = piece.twin_rule
    return np.concatenate([asked, twins_asked(rule, pins, flat)]) if rule else asked


def with_twins(piece: Sprung, minors: Affine, angles: Angles) -> Affine:
    """Add the twin rows to the minors."""
    rule = piece.twin_rule
    if not rule:
        return minors
    torque, lean, error_of, _ = torques(piece, angles)
    centre, slopes = collinear_rows(rule, torque, lean)
    size = np.full(centre.shape, 2 * 8.0)  # |torque| <= 2 pi k, k <= 1
    error = np.zeros(centre.shape)
    if error_of is not None:
        most = np.abs(torque) + np.abs(lean) + error_of
        error, size = (
            np.stack([sum(v[c] for c in twin.creases) for twin in rule]) for v in (error_of, most)
        )
    twins = padded(centre, slopes, error, size, 4)
    return concatenated([minors, twins])


def _last_first(x: Affine) -> Affine:
    return Affine(x.centre, np.roll(x.slopes, 1, axis=-2), x.error)


def taken(turn: Turn, which: Any, sign: float = 1.0) -> Turn:
    """Select turns, or the turns the other way."""
    c, s = turn.cosine[which], sign * turn.sine[which]
    rest = turn.mean[which], turn.spread[which], sign * turn.slope[which]
    return Turn(c, s, *rest, turn.miss[which], turn.most[which])


def _units(azimuths: list[float]) -> list[tuple[float, float]]:
    """Unit vectors at these azimuths."""
    return [(math.cos(beta), math.sin(beta)) for beta in azimuths]


def times_vector(q: Affine, v: np.ndarray, doubt: float) -> Affine:
    """Multiply quaternions [4, K] from the right by vectors [3, K] of length 1, each entry known to within `doubt`."""
    x, y, z = v
    o = np.zeros_like(x)
    matrix = np.array([[o, -x, -y, -z], [x, o, z, -y], [y, -z, o, x], [z, y, -x, o]])
    size = np.abs(matrix)
    magnitude = q.magnitude()
    slopes = np.einsum("abk,bdk->adk", matrix, q.slopes)
    error = np.einsum("abk,bk->ak", size, q.error) + doubt * magnitude.sum(axis=0)
    total = np.einsum("abk,bk->ak", size, magnitude)
    return padded(np.einsum("abk,bk->ak", matrix, q.centre), slopes, error, total, 8)


def complex_product(z: Affine, w: Affine) -> tuple[Affine, Affine]:
    """Multiply y + i z of two axes [2, ..., K]; variables of the first, then of the second."""
    both = z.variables + w.variables
    a, b = z.on(both), w.on(both, slice(z.variables, None))
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]
