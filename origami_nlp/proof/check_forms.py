"""A folded vertex over a box of fold angles, in ball arithmetic: what the check of a proof computes with.

Written from the mathematics alone, in python-flint's `arb` (midpoint and radius, every operation rounded
outwards); nothing here comes from the search that made the proof.

Each free angle is x_j = m_j + r_j xi_j with |xi_j| <= 1.  With t = r xi: cos t lies in [cos r, 1], and
|sin t - xi sin r| <= d for d = sin t* - s t*, s = sin(r)/r, cos t* = s (the chord lies below the concave
sine, farthest where slopes agree).  So cosine and sine of x are c0 + c1 xi with c0 a ball, and a product of
rotations about fixed axes, each angle used once, is a polynomial in the xi of degree one in each: its
coefficients are computed as they are, products of balls.

Closure: the product q of the quaternions (cos x_i/2, b_i sin x_i/2) is +1, stated as q_1..q_h =
conj(q_N) .. conj(q_h+1), h = ceil(N/2): four polynomials.

Axes: c_i is b_i turned by the creases before it.  Triple products of axes are those of a rigid body, so that in a
closed state they may be had from any of the three creases, with the angles on two of the three arcs between them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Any

from flint import arb, arb_mat

Box = tuple[tuple[float, float], ...]
"""Lower and upper end of each fold angle [rad]; of a pinned one unused."""
Form = tuple[Any, dict[int, Any]]
"""Centre (a ball) and coefficients of the xi: the centre's radius holds all that is not linear."""
Terms = dict[int, Any]
"""Coefficients (column matrices) of products of xi, by the set of their indices as bits."""

AROUND = arb(0, 1)
"""[-1, 1]."""
SQUARE = arb(0.5, 0.5)
"""[0, 1], where xi^2 lies."""
THIN = 1e-3
"""Half widths [rad] below which the chord's error is bounded by a power: nothing cancels."""
ULPS = 2
"""Sectors are any reals within so many units in the last place of the scene's doubles."""


class Sheet:
    """Geometry and springs of a vertex without symmetry, in balls.

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
        self.count = n = len(sectors)
        self.half = (n + 1) // 2
        self.sectors = [arb(a, ULPS * math.ulp(a)) for a in sectors]
        self.stiffness = [arb(k) for k in stiffness]
        self.rest = [arb(a) for a in rest_angles]
        self.flat = []
        azimuth = arb(0)
        for a in self.sectors:
            sine, cosine = azimuth.sin_cos()
            self.flat.append((cosine, sine))
            azimuth += a
        self._half_turns = lru_cache(10_000)(self._half_turns_)
        self._turns = lru_cache(10_000)(self._turns_)
        one = _scalar(3, 1)
        self._axes, self._spins, self._planes, self._crosses = [], [], [], []
        for x, y in self.flat:
            # q -> q (0, b): columns are the images of 1, i, j, k
            self._spins.append(
                arb_mat([[0, -x, -y, 0], [x, 0, 0, -y], [y, 0, 0, x], [0, y, -x, 0]])
            )
            self._axes.append(arb_mat([[x], [y], [0]]))
            along = arb_mat([[x * x, x * y, 0], [x * y, y * y, 0], [0, 0, 0]])
            self._planes.append((along, one - along))
            self._crosses.append(arb_mat([[0, 0, y], [0, 0, -x], [-y, x, 0]]))

    def _half_turns_(self, i: int, low: float, high: float, sign: int) -> tuple[Any, Any]:
        """Right factor Q(b_i, sign x_i) as T0 + T1 xi, 4 x 4."""
        (c0, c1), (s0, s1) = circle(low, high, 2)
        spin = self._spins[i] * sign
        return _scalar(4, c0) + spin * s0, _scalar(4, c1) + spin * s1

    def _turns_(self, i: int, low: float, high: float, sign: int) -> tuple[Any, Any]:
        """Rotation about b_i by sign x_i as R0 + R1 xi, 3 x 3."""
        (c0, c1), (s0, s1) = circle(low, high, 1)
        (along, across), cross = self._planes[i], self._crosses[i] * sign
        return along + across * c0 + cross * s0, across * c1 + cross * s1

    def half_turn(self, i: int, box: Box, pins: Sequence[int], sign: int) -> tuple[Any, Any]:
        """`_half_turns_` of a box; a pinned crease turns by +-pi exactly."""
        if pins[i]:
            return self._spins[i] * (sign * pins[i]), None
        return self._half_turns(i, *box[i], sign)

    def turn(self, i: int, box: Box, pins: Sequence[int], sign: int) -> tuple[Any, Any]:
        """`_turns_` of a box; a pinned crease turns by +-pi exactly."""
        if pins[i]:
            along, across = self._planes[i]
            return along - across, None
        return self._turns(i, *box[i], sign)

    def folded(self, angles: Sequence[Any]) -> tuple[list[Any], list[list[Any]]]:
        """Return the quaternion [w, x, y, z] of the whole chain, and its axes [N][3], at balls of fold angles."""
        q = arb_mat([[1], [0], [0], [0]])
        turn = _scalar(3, 1)
        axes = []
        for i, angle in enumerate(angles):
            along, across = self._planes[i]
            axes.append((turn * self._axes[i]).entries())
            s, c = (angle / 2).sin_cos()
            q = (_scalar(4, c) + self._spins[i] * s) * q
            s, c = angle.sin_cos()
            turn = turn * (along + across * c + self._crosses[i] * s)
        return q.entries(), axes

    def closure(self, box: Box, pins: Sequence[int]) -> tuple[Terms, list[float]]:
        """Return four polynomials that vanish in every closed state of a box, and about where q_1 .. q_h is."""
        identity = arb_mat([[1], [0], [0], [0]])
        left = ((i, *self.half_turn(i, box, pins, 1)) for i in range(self.half))
        back = reversed(range(self.half, self.count))
        right = ((i, *self.half_turn(i, box, pins, -1)) for i in back)
        found = carry(identity, left)
        middle = [float(v.mid()) for v in found[0].entries()]
        for mask, column in carry(identity, right).items():
            found[mask] = found[mask] - column if mask in found else -column
        return found, middle

    def triple(self, three: Sequence[int], box: Box, pins: Sequence[int]) -> Form:
        """Triple product of the axes of three creases in a closed state of a box.

        The three arcs between them are alike: seen from one crease j, fixed, the axis before it is turned back by the
        creases on its arc, the axis after it by j and those on its arc.  No angle is used twice, and those on the
        third arc are not used at all: j is chosen so that they are many.
        """
        i, j, k = min(
            (three[p:] + three[:p] for p in range(3)),  # type: ignore[operator]
            key=lambda t: sum(
                not pins[c] for c in (*self._arc(t[0], t[1]), *self._arc(t[1], t[2]), t[1])
            ),
        )
        back = ((c, *self.turn(c, box, pins, -1)) for c in self._arc(i, j))
        on = reversed([j, *self._arc(j, k)])
        forth = [(c, *self.turn(c, box, pins, 1)) for c in on]
        before = carry(self._axes[i], back)
        # (c_i x b_j) . c_k
        after = carry(self._axes[k], forth)
        beside = {mask: (-(self._crosses[j] * v)).transpose() for mask, v in before.items()}
        product = {
            low | high: u * v
            for (low, u), (high, v) in itertools.product(beside.items(), after.items())
        }
        return linear(product)[0]

    def _arc(self, first: int, last: int) -> list[int]:
        """Creases strictly between two."""
        return [(first + 1 + c) % self.count for c in range((last - first - 1) % self.count)]

    def torque(self, i: int, box: Box) -> Form:
        """G_i = k_i (x_i - rest_i) of a free crease over a box."""
        middle, radius = parts(*box[i])
        k = self.stiffness[i]
        return k * (middle - self.rest[i]), {i: k * radius}

    def twin(self, a: int, b: int, pins: Sequence[int]) -> int | None:
        """Tell whether c_a = sg c_b wherever the creases between are shut, and return sg (None: it is not).

        The plate between them lies flat, so that its sectors add with a sign that turns at every pinned crease; a
        sum within the rounding of the sectors of a multiple of pi is taken to be that multiple.
        """
        for first, last in ((a, b), (b, a)):
            total, sign, i = self.sectors[first], 1, (first + 1) % self.count
            while i != last and pins[i]:
                sign = -sign
                total += sign * self.sectors[i]
                i = (i + 1) % self.count
            if i == last:
                whole = (total / arb.pi()).unique_fmpz()
                if whole is not None:
                    return -1 if int(whole) % 2 else 1
        return None


def _scalar(size: int, value: Any) -> Any:
    return arb_mat(size, size, [value if i % (size + 1) == 0 else 0 for i in range(size * size)])


def parts(low: float, high: float) -> tuple[Any, Any]:
    """Return m, r (exact) such that [low, high] is in m + r [-1, 1]."""
    m = arb(0.5 * (low + high))
    up, down = (arb(high) - m).upper(), (m - arb(low)).upper()
    return m, up if up >= down else down


def circle(low: float, high: float, over: int) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """Return (c0, c1), (s0, s1): cosine and sine of x/over for x in [low, high] as c0 + c1 xi.

    Parameters
    ----------
    low, high
        Ends of x, at most 2 pi apart.
    over
        1, or 2 for half angles.
    """
    middle, radius = parts(low, high)
    sine, cosine = (middle / over).sin_cos()
    r = radius / over
    if r == 0:
        return (cosine, arb(0)), (sine, arb(0))
    chord, end = r.sin_cos()
    even = (1 + end) / 2 + AROUND * ((1 - end) / 2)
    if (
        r < THIN
    ):  # sin t - s t is concave in t >= 0, zero at 0 and r, its second derivative within r
        bulge = r**3 / 8
    else:
        s = chord / r
        bulge = (1 - s * s).sqrt() - s * s.acos()
    odd = AROUND * abs(bulge)
    return (cosine * even - sine * odd, -sine * chord), (sine * even + cosine * odd, cosine * chord)


def carry(start: Any, maps: Iterable[tuple[int, Any, Any]]) -> Terms:
    """Apply maps T0 + T1 xi_j, one after the other, to a column; T1 None: a constant map."""
    terms = {0: start}
    for j, constant, slope in maps:
        more = {} if slope is None else {mask | 1 << j: slope * v for mask, v in terms.items()}
        terms = {mask: constant * v for mask, v in terms.items()} | more
    return terms


def linear(terms: Terms) -> list[Form]:
    """Return the rows of a polynomial as forms: products of several xi go to the centre's radius."""
    rows = terms[0].nrows()
    centres, slopes = terms[0].entries(), [dict[int, Any]() for _ in range(rows)]
    for mask, column in terms.items():
        if mask and mask & (mask - 1):
            for r, value in enumerate(column.entries()):
                centres[r] += AROUND * value
        elif mask:
            for r, value in enumerate(column.entries()):
                slopes[r][mask.bit_length() - 1] = value
    return list(zip(centres, slopes, strict=True))


def add(x: Form, y: Form, sign: int = 1) -> Form:
    """Return x + sign y."""
    slopes = dict(x[1])
    for j, value in y[1].items():
        value = value if sign > 0 else -value
        slopes[j] = slopes[j] + value if j in slopes else value
    return (x[0] + y[0] if sign > 0 else x[0] - y[0]), slopes


def times(x: Form, y: Form) -> Form:
    """Return x y: xi_j^2 lies in [0, 1], each product of two different xi in [-1, 1]."""
    (a, g), (b, h) = x, y
    if not h:
        return a * b, {j: value * b for j, value in g.items()}
    if not g:
        return a * b, {j: value * a for j, value in h.items()}
    centre = a * b
    keys = sorted({*g, *h})
    spread = arb(0)
    for j, k in itertools.combinations(keys, 2):
        mixed = arb(0)
        if j in g and k in h:
            mixed += g[j] * h[k]
        if k in g and j in h:
            mixed += g[k] * h[j]
        spread += abs(mixed)
    slopes = {}
    for j in keys:
        if j not in g:
            slopes[j] = a * h[j]
        elif j not in h:
            slopes[j] = b * g[j]
        else:
            slopes[j] = a * h[j] + b * g[j]
            centre += g[j] * h[j] * SQUARE
    return centre + AROUND * spread, slopes


def cross(x: Sequence[Form], y: Sequence[Form]) -> list[Form]:
    """Vector product of two vectors of forms."""
    return [
        add(times(x[1], y[2]), times(x[2], y[1]), -1),
        add(times(x[2], y[0]), times(x[0], y[2]), -1),
        add(times(x[0], y[1]), times(x[1], y[0]), -1),
    ]


def dot(x: Sequence[Form], y: Sequence[Form]) -> Form:
    """Scalar product of two vectors of forms."""
    return add(add(times(x[0], y[0]), times(x[1], y[1])), times(x[2], y[2]))


def nonzero(form: Form) -> bool:
    """Tell whether a form certainly differs from 0 everywhere."""
    return bool(abs(form[0]) > sum((abs(v) for v in form[1].values()), arb(0)))


def determinant(torques: Sequence[Form], triples: Sequence[Form]) -> Form:
    """det [G_S | C_S] of four creases, expanded along G: `triples` are those of the other three, in order."""
    total = times(torques[0], triples[0])
    for p in range(1, 4):
        total = add(total, times(torques[p], triples[p]), -1 if p % 2 else 1)
    return total


def scaled(form: Form, factor: Any) -> Form:
    """Return a form times a ball."""
    return form[0] * factor, {j: v * factor for j, v in form[1].items()}


def minors(
    sheet: Sheet, fours: Iterable[Sequence[int]], box: Box, pins: Sequence[int]
) -> Iterator[Form]:
    """`determinant` of sets of four free creases in a closed state of a box."""
    known: dict[tuple[int, ...], Form] = {}
    for four in fours:
        triples = []
        for three in (tuple(i for i in four if i != own) for own in four):
            if three not in known:
                known[three] = sheet.triple(three, box, pins)
            triples.append(known[three])
        yield determinant([sheet.torque(i, box) for i in four], triples)


def critical_rows(sheet: Sheet, box: Box, pins: Sequence[int]) -> list[Form]:
    """All that vanishes in a critical state of a box: minors of its free creases, and twin rows."""
    free = [j for j, s in enumerate(pins) if not s]
    rows = list(minors(sheet, itertools.combinations(free, 4), box, pins))
    for a, b in itertools.combinations(free, 2):
        if sign := sheet.twin(a, b, pins):
            rows.append(twin_row(sheet, a, b, sign, box))
    return rows


def twin_row(sheet: Sheet, a: int, b: int, sign: int, box: Box) -> Form:
    """G_a - sign G_b."""
    return add(sheet.torque(a, box), sheet.torque(b, box), -sign)
