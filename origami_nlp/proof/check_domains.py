"""The pieces of paper that proofs are about, over boxes of fold angles: how they close, and what is critical.

Closure without symmetry: the product q of the quaternions (cos x_i/2, b_i sin x_i/2) is +1, stated as q_1..q_h =
conj(q_N) .. conj(q_h+1), h = ceil(N/2): four polynomials, the first of second order.

Axes: c_i is b_i turned by the creases before it. Triple products of axes are those of a rigid body, so that in a
closed state they may be had from any of the three creases, with the angles on two of the three arcs between them.

A local minimum, with the creases that it pins, is stationary on the others with F. John's multipliers: rank [G | C]
<= m, m the number of closure equations, row i of C its slopes by x_i: all minors of m + 1 free creases vanish.
"""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Any

from flint import arb, arb_mat

from origami_nlp.proof.check_forms import (
    Box,
    Form,
    Terms,
    add,
    carry,
    circle,
    diagonal,
    linear,
    minor,
    parts,
)
from origami_nlp.proof.check_laws import ExactLaw

ULPS = 2
"""Sectors are any reals within so many units in the last place of the scene's doubles."""
Balls = list[Any]


def near(value: float) -> Any:
    """Return the ball of sectors that a double stands for."""
    return arb(value, ULPS * math.ulp(value))


class BallChain(ABC):
    """Creases of a piece, one after the other, in balls.

    Parameters
    ----------
    azimuths
        Of the creases in the flat piece, shape [n], balls.
    stiffness, rest_angles
        Of each crease, shape [n], taken as they are.
    over
        1, or 2 for a crease on a mirror: it turns half of what lies in the piece by half.
    weights
        Creases of the vertex that each stands for, shape [n].

    Attributes
    ----------
    rank
        Number m of closure equations.
    spare
        How many of the rows of `closure`, the first ones, are of second order.
    limits
        Fold limits of each crease; the doubles +-pi stand for +-pi.
    laws
        In place of linear springs; None where there is one.
    """

    rank, spare = 3, 1

    def __init__(
        self,
        azimuths: Sequence[Any],
        stiffness: Sequence[float],
        rest_angles: Sequence[float],
        over: Sequence[int],
        weights: Sequence[int],
    ) -> None:
        self.count = len(azimuths)
        self.stiffness = [arb(k) for k in stiffness]
        self.rest = [arb(a) for a in rest_angles]
        self.over, self.weights = tuple(over), tuple(weights)
        self.limits: list[tuple[float, float]] = [(-math.pi, math.pi)] * self.count
        self.laws: list[ExactLaw | None] = [None] * self.count
        self._half_turns = lru_cache(10_000)(self._half_turns_)
        self._turns = lru_cache(10_000)(self._turns_)
        one = diagonal(3, 1)
        self.flat = []
        self._axes, self._spins, self._planes, self._crosses = [], [], [], []
        for azimuth in azimuths:
            y, x = azimuth.sin_cos()
            self.flat.append((x, y))
            # q -> q (0, b): columns are the images of 1, i, j, k
            self._spins.append(
                arb_mat([[0, -x, -y, 0], [x, 0, 0, -y], [y, 0, 0, x], [0, y, -x, 0]])
            )
            self._axes.append(arb_mat([[x], [y], [0]]))
            # rotation about b: b b' + cos (1 - b b') + sin [b]_x
            along = arb_mat([[x * x, x * y, 0], [x * y, y * y, 0], [0, 0, 0]])
            self._planes.append((along, one - along))
            self._crosses.append(arb_mat([[0, 0, y], [0, 0, -x], [-y, x, 0]]))

    def _half_turns_(self, i: int, low: float, high: float, sign: int) -> tuple[Any, Any]:
        """Right factor Q(b_i, sign x_i) as T0 + T1 xi, 4 x 4."""
        (c0, c1), (s0, s1) = circle(low, high, 2 * self.over[i])
        spin = self._spins[i] * sign
        return diagonal(4, c0) + spin * s0, diagonal(4, c1) + spin * s1

    def _turns_(self, i: int, low: float, high: float, sign: int) -> tuple[Any, Any]:
        """Rotation about b_i by sign x_i as R0 + R1 xi, 3 x 3."""
        (c0, c1), (s0, s1) = circle(low, high, self.over[i])
        (along, across), cross = self._planes[i], self._crosses[i] * sign
        return along + across * c0 + cross * s0, across * c1 + cross * s1

    def stop(self, i: int, side: int) -> float:
        """Fold limit of a crease on a side."""
        return self.limits[i][side > 0]

    def closed(self, i: int, side: int) -> bool:
        """Whether a crease that is pinned on a side (0: free) is folded flat there."""
        return bool(side) and abs(self.stop(i, side)) == math.pi

    def limit(self, i: int, side: int) -> Any:
        """Fold limit of a crease on a side, a ball."""
        return side * arb.pi() if self.closed(i, side) else arb(self.stop(i, side))

    def half_turn(self, i: int, box: Box, pins: Sequence[int], sign: int) -> tuple[Any, Any]:
        """`_half_turns_` of a box; a pinned crease turns by its limit exactly."""
        if not pins[i]:
            return self._half_turns(i, *box[i], sign)
        if not self.closed(i, pins[i]):
            s, c = (arb(self.stop(i, pins[i])) / (2 * self.over[i])).sin_cos()
            return diagonal(4, c) + self._spins[i] * (s * sign), None
        way, half = sign * pins[i], arb(0.5) / self.over[i]
        return diagonal(4, half.cos_pi()) + self._spins[i] * (half.sin_pi() * way), None

    def turn(self, i: int, box: Box, pins: Sequence[int], sign: int) -> tuple[Any, Any]:
        """`_turns_` of a box; a pinned crease turns by its limit exactly."""
        if not pins[i]:
            return self._turns(i, *box[i], sign)
        (along, across), part = self._planes[i], arb(1) / self.over[i]
        if not self.closed(i, pins[i]):
            s, c = (arb(self.stop(i, pins[i])) * part).sin_cos()
            return along + across * c + self._crosses[i] * (s * sign), None
        sine = part.sin_pi() * (sign * pins[i])
        return along + across * part.cos_pi() + self._crosses[i] * sine, None

    def chain(self, angles: Sequence[Any]) -> tuple[Balls, Any, list[Balls]]:
        """Return the whole's quaternion [w, x, y, z] and rotation, and all axes [n][3], at balls of fold angles."""
        q = arb_mat([[1], [0], [0], [0]])
        turn = diagonal(3, 1)
        axes = []
        for i, angle in enumerate(angles):
            (along, across), over = self._planes[i], self.over[i]
            axes.append((turn * self._axes[i]).entries())
            s, c = (angle / (2 * over)).sin_cos()
            q = (diagonal(4, c) + self._spins[i] * s) * q
            s, c = (angle / over).sin_cos()
            turn = turn * (along + across * c + self._crosses[i] * s)
        return q.entries(), turn, axes

    def mixed(self, before: Terms, i: int, after: Terms) -> Form:
        """(u, b_i, v) of two vectors that share no xi."""
        beside = {mask: (-(self._crosses[i] * v)).transpose() for mask, v in before.items()}
        # no angle in both: the product of two polynomials of degree one in each xi is one again
        pairs = itertools.product(beside.items(), after.items())
        return linear({low | high: u * v for (low, u), (high, v) in pairs})[0]

    def torque(self, i: int, box: Box) -> Form:
        """G_i = k_i (x_i - rest_i), or its law's torque, of a free crease over a box."""
        if (law := self.laws[i]) is not None:
            return law.form(i, *box[i])
        middle, radius = parts(*box[i])
        k = self.stiffness[i]
        return k * (middle - self.rest[i]), {i: k * radius}

    def pull(self, i: int, x: Any) -> Any:
        """Torque of one crease at a ball of its fold angle."""
        law = self.laws[i]
        return self.stiffness[i] * (x - self.rest[i]) if law is None else law.at(x)

    def stiff(self, i: int, x: Any) -> Any:
        """How its torque changes with the angle, over the ball."""
        law = self.laws[i]
        return self.stiffness[i] if law is None else law.slope(x)

    def stored(self, i: int, x: Any) -> Any:
        """Energy of one crease."""
        law = self.laws[i]
        return self.stiffness[i] * (x - self.rest[i]) ** 2 / 2 if law is None else law.energy(x)

    def minors(
        self, sets: Iterable[Sequence[int]], box: Box, pins: Sequence[int]
    ) -> Iterator[Form]:
        """det [G | C] of sets of m + 1 free creases, in a closed state of a box."""
        known: dict[tuple[int, ...], Form] = {}
        for rows in sets:
            others = []
            for rest in (tuple(i for i in rows if i != own) for own in rows):
                if rest not in known:
                    known[rest] = self.slopes(rest, box, pins)
                others.append(known[rest])
            yield minor([self.torque(i, box) for i in rows], others)

    def critical_rows(self, box: Box, pins: Sequence[int]) -> list[Form]:
        """All that vanishes in a critical state of a box: minors of its free creases, and twin rows."""
        free = [j for j, s in enumerate(pins) if not s]
        rows = list(self.minors(itertools.combinations(free, self.rank + 1), box, pins))
        for a, b in itertools.combinations_with_replacement(free, 2):
            if (row := self.twin_row(a, b, box, pins)) is not None:
                rows.append(row)
        return rows

    def twin_row(self, a: int, b: int, box: Box, pins: Sequence[int]) -> Form | None:
        """G_a - sg G_b of twins, G_a of one across a mirror (a = b); None where they are not."""
        sign = self.twin(a, b, pins)
        if sign is None:
            return None
        if a == b:
            return self.torque(a, box)
        return add(self.torque(a, box), self.torque(b, box), -sign)

    @abstractmethod
    def closure(self, box: Box, pins: Sequence[int]) -> tuple[Terms, list[list[float]]]:
        """Return polynomials that vanish in every closed state of a box, and a frame in which to combine them."""

    @abstractmethod
    def slopes(self, some: Sequence[int], box: Box, pins: Sequence[int]) -> Form:
        """Determinant of C of m creases in a closed state of a box, up to a factor of all, and one of each crease."""

    @abstractmethod
    def twin(self, a: int, b: int, pins: Sequence[int]) -> int | None:
        """Return whether c_a = sg c_b all over a stratum, and sg; a = b: whether a turns freely with its image."""

    @abstractmethod
    def at(
        self, angles: Sequence[Any]
    ) -> tuple[Balls, list[Balls], list[Balls], list[list[Balls]], Any]:
        """Return what critical points need, at balls of fold angles.

        Returns
        -------
        closure
            Shape [m].
        slopes
            Of closure by each angle, [n][m].
        columns
            C, with K (x - rest) = C m at free creases, [n][m].
        bends
            Derivatives of columns i by angle j, [n][n][m].
        lift
            Positive where the piece closes as a sheet of paper, q = +1.
        """

    @abstractmethod
    def curvature(self, i: int, j: int, bends: list[list[Balls]]) -> Balls:
        """The part of the second derivative by angles j <= i that multiplies -m, [m]."""


class VertexChain(BallChain):
    """A vertex without symmetry.

    Parameters
    ----------
    sectors
        Sector angles, shape [N] [rad]; every vertex within `ULPS` of them that closes flat is meant.
    stiffness, rest_angles
        Shape [N], taken as they are.
    """

    def __init__(
        self, sectors: Sequence[float], stiffness: Sequence[float], rest_angles: Sequence[float]
    ) -> None:
        n = len(sectors)
        self.half = (n + 1) // 2
        self.sectors = [near(a) for a in sectors]
        azimuths = [sum(self.sectors[:i], arb(0)) for i in range(n)]
        super().__init__(azimuths, stiffness, rest_angles, [1] * n, [1] * n)

    def closure(self, box: Box, pins: Sequence[int]) -> tuple[Terms, list[list[float]]]:
        """Return four polynomials; the frame is that at q = q_1 .. q_h: along q, and tangent to the rotations."""
        identity = arb_mat([[1], [0], [0], [0]])
        left = ((i, *self.half_turn(i, box, pins, 1)) for i in range(self.half))
        back = reversed(range(self.half, self.count))
        right = ((i, *self.half_turn(i, box, pins, -1)) for i in back)
        found = carry(identity, left)
        w, x, y, z = (float(v.mid()) for v in found[0].entries())
        for mask, column in carry(identity, right).items():
            found[mask] = found[mask] - column if mask in found else -column
        # two unit quaternions differ along q to second order only, across it to first
        frame = [[w, x, y, z], [-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]]  # q, i q, j q, k q
        return found, frame

    def slopes(self, some: Sequence[int], box: Box, pins: Sequence[int]) -> Form:
        """Triple product of the axes of three creases.

        The three arcs between them are alike: seen from one crease j, fixed, the axis before it is turned back by the
        creases on its arc, the axis after it by j and those on its arc.  No angle is used twice, and those on the
        third arc are not used at all: j is chosen so that they are many.
        """
        i, j, k = min(
            (some[p:] + some[:p] for p in range(3)),  # type: ignore[operator]
            key=lambda t: sum(
                not pins[c] for c in (*self._arc(t[0], t[1]), *self._arc(t[1], t[2]), t[1])
            ),
        )
        back = ((c, *self.turn(c, box, pins, -1)) for c in self._arc(i, j))
        on = reversed([j, *self._arc(j, k)])
        forth = [(c, *self.turn(c, box, pins, 1)) for c in on]
        return self.mixed(carry(self._axes[i], back), j, carry(self._axes[k], forth))

    def _arc(self, first: int, last: int) -> list[int]:
        """Creases strictly between two."""
        return [(first + 1 + c) % self.count for c in range((last - first - 1) % self.count)]

    def twin(self, a: int, b: int, pins: Sequence[int]) -> int | None:
        """Return whether c_a = sg c_b wherever the creases between are fully folded, and return sg.

        The plate between them lies flat, so that its sectors add with a sign that turns at every pinned crease; a
        sum within the rounding of the sectors of a multiple of pi is taken to be that multiple.
        """
        for first, last in ((a, b), (b, a)) if a != b else ():
            total, sign, i = self.sectors[first], 1, (first + 1) % self.count
            while i != last and self.closed(i, pins[i]):
                sign = -sign
                total += sign * self.sectors[i]
                i = (i + 1) % self.count
            if i == last:
                # the one integer in the ball, if there is one
                whole = (total / arb.pi()).unique_fmpz()
                if whole is not None:
                    return -1 if int(whole) % 2 else 1
        return None

    def at(
        self, angles: Sequence[Any]
    ) -> tuple[Balls, list[Balls], list[Balls], list[list[Balls]], Any]:
        """As of `BallChain`: vec q, its slopes (w c + c x v) / 2, the axes, and d c_i/d x_j = c_j x c_i for j < i."""
        (w, *v), _, axes = self.chain(angles)
        slopes = [[(w * a + b) / 2 for a, b in zip(c, cross(c, v), strict=True)] for c in axes]
        none = [arb(0)] * 3
        bends = [
            [cross(axes[j], axes[i]) if j < i else none for j in range(self.count)]
            for i in range(self.count)
        ]
        return v, slopes, axes, bends, w

    def curvature(self, i: int, j: int, bends: list[list[Balls]]) -> Balls:
        """(c_j x c_i) / 2: m is half of closure's multipliers."""
        return [b / 2 for b in bends[i][j]]


def cross(a: Sequence[Any], b: Sequence[Any]) -> Balls:
    """Vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
