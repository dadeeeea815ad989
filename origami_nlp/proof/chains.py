"""What every local minimum satisfies, as affine forms over boxes of fold angles: closure, minors, twins; no symmetry.

Closure.  The loop is cut at the facet between crease N and crease 1 and in its middle: with Q(b, phi) the fold about b,
Q(b_1, phi_1) ... Q(b_h, phi_h) = Q(b_N, -phi_N) ... Q(b_{h+1}, -phi_{h+1}), both sides unit quaternions, states the
lift q = +1 only.  Both depend on half of the angles, so that what is of second order stays small.

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
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

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
    variables,
    with_centre,
)
from origami_nlp.proof.collinear_creases import (
    CollinearPair,
    collinear_creases_of_loop,
    collinear_rows,
    twins_asked,
)

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


class Sprung(Protocol):
    """Springs and twins of a piece."""

    stiffness: np.ndarray
    rest: np.ndarray
    twin_rule: tuple[CollinearPair, ...]


class VertexForms:
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
    ) -> None:
        n = self.size = len(sectors)
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
            (tuple(range(self.half)), _right_products(left), 1.0),
            (tuple(range(n - 1, self.half - 1, -1)), _right_products(right), -1.0),
        )
        # folds and sectors of the loop multiply to -1: q_left Q(e3, whole) = -q_right, whole = 2 pi on a sheet
        self.onward = (
            None if whole == 2 * math.pi else _onward(-math.cos(whole / 2), -math.sin(whole / 2))
        )
        self._pose_triples()
        self._pose_minors()
        self.minor_count = len(self.fours)
        self.minor_creases = tuple(map(tuple, self.fours.tolist()))
        self.twin_rule = collinear_creases_of_loop(self.sectors, doubt)
        self.twins = tuple(t.creases for t in self.twin_rule)

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

    def rows(self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray) -> VanishingRows:
        """Enclose the rows over boxes.

        Parameters
        ----------
        lower, upper
            Shape [n, K] [rad]; pinned angles are +-pi whatever stands there.
        pins
            -1, 0 or +1, shape [n, K].

        Returns
        -------
        VanishingRows
        """
        middle, half = variables(lower, upper)
        closure = self.closure(middle, half, pins)
        fours = ~(pins != 0)[self.fours].any(axis=1)
        minors = self.minors(middle, half, pins)
        return VanishingRows(closure, *with_twins(self, minors, fours, middle, half, pins))

    def closure(self, middle: np.ndarray, half: np.ndarray, pins: np.ndarray) -> Affine:
        """Enclose conj(q_m) (q_left - q_right), q_m = q_left at the middle: four rows."""
        left, right = self.sides_of(middle, half, pins)
        if self.onward is not None:
            left = carried(self.onward, left)
            left = Affine(left.centre, left.slopes, left.error + 4 * self.doubt)
        back = right.slopes[:, ::-1]  # creases h+1 .. N in order
        # two folds by phi about creases that differ by d differ by |sin (phi / 2)| d
        sines = np.where(pins != 0, 1.0, np.minimum(1.0, 0.5 * (np.abs(middle) + half)))
        doubt = 2 * self.doubt_crease * sines.sum(axis=0)
        # two unit quaternions are equal where their difference vanishes; q_left = -q_right, the other lift, is far
        # from 0
        gap = padded(
            left.centre - right.centre,
            np.concatenate([left.slopes, -back], axis=1),
            left.error + right.error + doubt,
            left.magnitude() + right.magnitude(),
            2,
        )
        return times_conjugate(left.centre, gap)

    def sides_of(
        self, middle: np.ndarray, half: np.ndarray, pins: np.ndarray
    ) -> tuple[Affine, Affine]:
        """Enclose q_left, in angles 1 .. h, and q_right, in angles N .. h+1: [4, K] each."""
        ends = []
        turn = half_turns(middle, half, pins)
        for creases, products, sign in self.sides:
            q = constant(np.array([1.0, 0, 0, 0]), 0.0, 0, middle.shape[1])
            for crease, right in zip(creases, products, strict=True):
                by = taken(turn, crease, sign)
                x = mixed(q, by.cosine, carried(right, q), by.sine)
                q = turned(x, carried(right, x), by)
            ends.append(q)
        return ends[0], ends[1]

    def triple_products(self, middle: np.ndarray, half: np.ndarray, pins: np.ndarray) -> Affine:
        """Enclose the triple products of axes, in the order of `triples`: [T, K] in n variables."""
        n, boxes = middle.shape
        turn = angle_turns(middle, half, pins)
        on, back = self._next_axes(turn, boxes), self._next_axes(turn, boxes, -1)
        # a triple product is zero for any sectors where all is flat; its mixed derivatives are at most 2
        share = np.minimum(1.0, 2.0 * (np.abs(middle) + half).sum(axis=0))
        count = len(self.triples)
        centre, error = np.empty((count, boxes)), np.empty((count, boxes))
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

    def minors(self, middle: np.ndarray, half: np.ndarray, pins: np.ndarray) -> Affine:
        """Enclose det [G_S | C_S] for every four creases, stiffness over its largest: [M, K] in n variables."""
        n, boxes = middle.shape
        t = self.triple_products(middle, half, pins)
        k, torque, lean = torques(self, middle, half)
        count = len(self.fours)
        centre = np.zeros((count, boxes))
        slopes = np.zeros((count, n, boxes))
        error = np.zeros((count, boxes))
        total = np.zeros((count, boxes))
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
            size = np.abs(g) + r
            error += size * t.error[w] + r * (
                np.abs(t.slopes[w]).sum(axis=1) - 0.5 * np.abs(own[:, a])
            )
            total += (size + 8 * k[i]) * magnitude[w]
        return padded(centre, slopes, error, total, n + 16)


def torques(
    piece: Sprung, middle: np.ndarray, half: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return stiffness over its largest [n, 1], torque at the middle of boxes and its slope, [n, K]."""
    k = (piece.stiffness / piece.stiffness.max())[:, None]
    return k, k * (middle - piece.rest[:, None]), k * half


def with_twins(
    piece: Sprung,
    minors: Affine,
    asked: np.ndarray,
    middle: np.ndarray,
    half: np.ndarray,
    pins: np.ndarray,
) -> tuple[Affine, np.ndarray]:
    """Add the twin rows to the minors: all rows, and which are asked for."""
    rule = piece.twin_rule
    if not rule:
        return minors, asked
    _, torque, lean = torques(piece, middle, half)
    centre, slopes = collinear_rows(rule, torque, lean)
    size = np.full(centre.shape, 2 * 8.0)  # |torque| <= 2 pi k, k <= 1
    twins = padded(centre, slopes, np.zeros(centre.shape), size, 4)
    return concatenated([minors, twins]), np.concatenate([asked, twins_asked(rule, pins)])


def _last_first(x: Affine) -> Affine:
    return Affine(x.centre, np.roll(x.slopes, 1, axis=-2), x.error)


def angle_turns(middle: np.ndarray, half: np.ndarray, pins: np.ndarray) -> Turn:
    """Turns by angles [n, K], by +-pi exactly where these are pinned."""
    pinned = pins != 0
    c, s = np.where(pinned, -1.0, np.cos(middle)), np.where(pinned, 0.0, np.sin(middle))
    return with_centre(c, s, np.where(pinned, 0.0, half))


def half_turns(middle: np.ndarray, half: np.ndarray, pins: np.ndarray) -> Turn:
    """Turns by half of angles [n, K], by +-pi/2 exactly where these are pinned."""
    pinned = pins != 0
    c = np.where(pinned, 0.0, np.cos(0.5 * middle))
    s = np.where(pinned, pins, np.sin(0.5 * middle))
    return with_centre(c, s, np.where(pinned, 0.0, 0.5 * half))


def taken(turn: Turn, which: Any, sign: float = 1.0) -> Turn:
    """Select turns, or the turns the other way."""
    c, s = turn.cosine[which], sign * turn.sine[which]
    return Turn(
        c, s, turn.mean[which], turn.spread[which], sign * turn.slope[which], turn.miss[which]
    )


def _onward(cosine: float, sine: float) -> np.ndarray:
    """Matrix [4, 4] of q -> q (cosine + sine e3)."""
    c, s = cosine, sine
    return np.array([[c, 0, 0, -s], [0, c, s, 0], [0, -s, c, 0], [s, 0, 0, c]])


def _right_products(azimuths: list[float]) -> list[np.ndarray]:
    """Matrices [4, 4] of q -> q b for the unit vectors b at these azimuths."""
    out = []
    for beta in azimuths:
        x, y = math.cos(beta), math.sin(beta)
        out.append(np.array([[0, -x, -y, 0], [x, 0, 0, -y], [y, 0, 0, x], [0, y, -x, 0.0]]))
    return out


def carried(matrix: np.ndarray, q: Affine) -> Affine:
    """Apply a constant matrix [4, 4] (|entries| <= 1, two a row)."""
    d, boxes = q.slopes.shape[1:]
    slopes = (matrix @ q.slopes.reshape(4, d * boxes)).reshape(4, d, boxes)
    size = np.abs(matrix)
    return padded(matrix @ q.centre, slopes, size @ q.error, size @ q.magnitude(), 8)


def times_conjugate(m: np.ndarray, q: Affine) -> Affine:
    """Multiply by conj(m) from the left, m [4, K] any numbers."""
    w, x, y, z = m
    matrix = np.array([[w, x, y, z], [-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]])
    size = np.abs(matrix)
    slopes = np.einsum("abk,bdk->adk", matrix, q.slopes)
    error = np.einsum("abk,bk->ak", size, q.error)
    total = np.einsum("abk,bk->ak", size, q.magnitude())
    return padded(np.einsum("abk,bk->ak", matrix, q.centre), slopes, error, total, 8)


def complex_product(z: Affine, w: Affine) -> tuple[Affine, Affine]:
    """Multiply y + i z of two axes [2, ..., K]; variables of the first, then of the second."""
    both = z.variables + w.variables
    a, b = z.on(both), w.on(both, slice(z.variables, None))
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]
