"""No branch of a given vertex of degree 4 has three maxima of the energy: branch and bound over their places.

Two branches, each with one stable state more than maxima between its ends: at most two maxima each means at most six
stable states within the fold limits, whatever the springs, rest angles within 180 degrees.

Along a branch the slope of the energy is f = sum of l_m w_m with l_m >= 0 and the eight functions w = phi_i' (phi_i -+
pi): a spring with its rest angle between the limits is a mixture of two at the limits.  n maxima at places in
[c - r, c + r] give f, f', ..., f^(2n-2) a zero there each, and f^(2n-1) <= 0 at one point (divided differences), so
that with D_j = r^j f^(j)(c) and M >= r^2n |f^(2n)| there

    +-D_j + 2^(2n-2-j) (D_{2n-1} - 3 M) <= 0  for j < 2n - 1,      D_{2n-1} - M <= 0                      (*)

Each is linear in l, so it is one number for each w (M: the sum of those of all w).  Multipliers x >= 0 with a sum of
x (*) > 0 for all eight w exclude maxima at these places.  A linear program finds them, over boxes of two places and
then of three where no two exclude each other.  They are stated as integers; `tests/independent/at_most_six` checks.

Places: y in [-1, 1], t = sinh(b y)/sinh(b), tan(phi/2) = 2 t/(sqrt(1 - q) (1 - t^2)) of the crease that reaches 180
degrees, sin(phi/2)^2 of the crease opposite being q < 1 times its own.  The states for -y are those for y with all
folds turned, so that half of the boxes are enough.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from functools import cache
from itertools import pairwise, product
from math import comb, factorial
from time import process_time
from typing import Any

import numpy as np
import sympy as sp
from origami_nlp.symbolic.degree4 import half_tangent
from scipy.optimize import linprog

Cell = tuple[Fraction, Fraction]
Box = tuple[Cell, ...]
Tree = Any
"""A list: an integer vector of multipliers at a leaf; else "split" and its parts, or why there is nothing to show."""

STRETCH = 4
"""b of the places."""
ORDER, EXTRA = 6, 5
NEAR = 40
"""Gap between two places, over the width of their cells, up to which they are also taken as a pair."""
SCALE = 1 << 20
ROOM = 1.02
"""Bounds are taken so much larger, for a checker whose own are not as close."""
MARGIN = 1e-6
"""Least sum over all w, over the largest multiplier, that is taken as positive in double precision."""


WIDER = 2
"""Boxes of sectors are taken so much larger, for a checker whose slopes are not as close."""
HELD = 2e-4
"""The same at single places: pairs with less are left to boxes of three places, as halving them costs too much."""


@cache
def _tangents() -> Callable[..., Any]:
    q, e, t = sp.symbols("q e t", positive=True)
    functions = {
        (crease, mode): sp.lambdify(
            (q, e, t),
            sp.fraction(half_tangent(crease, q, e, t, mode)),
            modules=[{"sqrt": lambda x: x.sqrt()}],
        )
        for crease in (1, 2, 3, 4)
        for mode in (1, 2)
    }
    return lambda crease, mode, *values: functions[crease, mode](*values)


@dataclass
class Branch:
    """A branch of a generic vertex.

    sectors [deg]; mode: 1 or 2, as in the closed form; leader: the crease (1 to 4) that reaches 180 degrees.
    """

    sectors: Sequence[float | str]
    mode: int
    leader: int = 0
    _known: dict[Cell, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict, repr=False)
    _bounds: dict[Cell, np.ndarray] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        from flint import arb

        angles = [arb(str(a)) * arb.pi() / 180 for a in self.sectors]
        for shift in range(4):
            s = [angles[(i + shift) % 4].sin() for i in range(4)]
            self._q = (s[0] * s[3] / (s[1] * s[2]), s[0] * s[1] / (s[2] * s[3]))
            if all(q < 1 for q in self._q):
                break
        else:
            raise ValueError(f"sectors = {self.sectors}: two ratios of opposite sines are not 1")
        tanh = (s[0] * s[2] / (s[1] * s[3])).sqrt()
        self._e = ((1 + tanh) / (1 - tanh)).sqrt()
        self.leader = (shift + self.mode - 1) % 4 + 1

    def taylor(self, middle: Fraction, radius: Fraction) -> list[list[Any]]:
        """Enclose Taylor coefficients 0 to ORDER + EXTRA of the eight functions, at all places of a cell."""
        from flint import arb, arb_series, ctx

        ctx.cap = ORDER + EXTRA + 2
        y = arb_series(
            [
                arb(
                    arb(middle.numerator) / middle.denominator,
                    arb(radius.numerator) / radius.denominator,
                ),
                1,
            ]
        )
        grown = (y * STRETCH).exp()
        end = arb(STRETCH).exp()
        t = (grown - 1 / grown) / (end - 1 / end)
        rows = []
        for crease in (1, 2, 3, 4):
            top, bottom = _tangents()(crease, self.mode, self._q[(crease + 1) % 2], self._e, t)
            slope = 2 * (top.derivative() * bottom - top * bottom.derivative())
            slope = slope / (top * top + bottom * bottom)
            fold = slope.integral() + 2 * arb.atan2(top[0], bottom[0])
            for limit in (arb.pi(), -arb.pi()):
                w = slope * (fold - limit)
                rows.append([w[k] for k in range(ORDER + EXTRA + 1)])
        return rows

    def cell(self, low: Fraction, high: Fraction) -> tuple[np.ndarray, np.ndarray]:
        """Return least and most of r^j w^(j) at the middle [2, 8, ORDER + 1], and bounds of it over the cell."""
        key = (low, high)
        if key not in self._known:
            radius = (high - low) / 2
            powers = np.array([float(radius) ** k * factorial(k) for k in range(ORDER + 1)])
            middle = self.taylor((low + high) / 2, Fraction(0))
            at = np.array(
                [
                    [[float(end(x)) for x in row[: ORDER + 1]] for row in middle]
                    for end in (lambda x: x.lower(), lambda x: x.upper())
                ]
            )
            self._known[key] = at * powers, self._bound(low, high) * powers
        return self._known[key]

    def _bound(self, low: Fraction, high: Fraction) -> np.ndarray:
        key = (low, high)
        if key not in self._bounds:
            half = (high - low) / 2
            if half <= Fraction(1, 1 << 9):
                bound = self._over(low + half, half)
            else:
                middle = Fraction(round((low + half) * (1 << 9)), 1 << 9)
                bound = np.maximum(self._bound(low, middle), self._bound(middle, high))
            self._bounds[key] = bound
        return self._bounds[key]

    def _over(self, middle: Fraction, half: Fraction) -> np.ndarray:
        """Bound Taylor coefficients over a small cell: by those at its middle, the highest by intervals."""
        at, over = (
            np.array([[float(abs(x).upper()) for x in row] for row in self.taylor(middle, r)])
            for r in (Fraction(0), half)
        )
        found, r = np.zeros((8, ORDER + 1)), float(half)
        for k in range(ORDER + 1):
            for j in range(EXTRA):
                found[:, k] += comb(k + j, k) * at[:, k + j] * r**j
            found[:, k] += comb(k + EXTRA, k) * over[:, k + EXTRA] * r**EXTRA
        return found

    def columns(self, low: Fraction, high: Fraction, maxima: int) -> np.ndarray:
        """Return what (*) is for each w, [8, 4 maxima - 1]: +D_j for all j, -D_j for all j, the last."""
        (least, most), bound = self.cell(low, high)
        last, rest = 2 * maxima - 1, ROOM * bound[:, 2 * maxima]
        weights = 2.0 ** (last - 1 - np.arange(last))
        cost = np.outer(least[:, last] - 3 * rest, weights)
        return np.c_[least[:, :last] + cost, cost - most[:, :last], least[:, last] - rest]


@dataclass
class Corners:
    """The branches of the vertices at the corners of a box, the first three sectors +-tolerance [deg].

    What is multiplied is all but linear in the sectors over such a box: where it is positive at the corners a check of
    the whole box is likely to succeed, which is not decided here.
    """

    sectors: Sequence[float | str]
    mode: int
    tolerance: float | str
    branches: list[Branch] = field(default_factory=list)

    def __post_init__(self) -> None:
        middle = [Decimal(str(a)) for a in self.sectors]
        off = Decimal(str(self.tolerance)) * WIDER
        signs: Any = product((-1, 1), repeat=3) if off else [(0, 0, 0)]
        for some in signs:
            moved = [a + s * off for a, s in zip(middle, (*some, -sum(some)), strict=True)]
            self.branches.append(Branch([str(a) for a in moved], self.mode))
            # bounds have room for so little
            self.branches[-1]._bounds = self.branches[0]._bounds
        self.leader = self.branches[0].leader

    def columns(self, low: Fraction, high: Fraction, maxima: int) -> np.ndarray:
        """Return those of all branches, [8 branches, 4 maxima - 1]."""
        return np.concatenate([b.columns(low, high, maxima) for b in self.branches])


def clusters(box: Box) -> list[tuple[int, int]]:
    """Return which places (first, last) are taken together: each alone, and neighbours that are near."""
    widest = max(high - low for low, high in box)
    near = [b[0] - a[1] <= NEAR * widest for a, b in pairwise(box)]
    found = [(i, i) for i in range(len(box))] + [(i, i + 1) for i, yes in enumerate(near) if yes]
    return [*found, (0, 2)] if near == [True, True] else found


def parts(box: Box) -> list[Box]:
    """Halve the first of the widest cells, in the order of places; equal cells together."""
    widths = [high - low for low, high in box]
    low, high = widest = box[widths.index(max(widths))]
    halves = (low, (low + high) / 2), ((low + high) / 2, high)
    same = [i for i, cell in enumerate(box) if cell == widest]
    found = []
    for lower in range(len(same), -1, -1):
        cells = list(box)
        for rank, i in enumerate(same):
            cells[i] = halves[rank >= lower]
        found.append(tuple(cells))
    return found


def mirrored(box: Box) -> bool:
    """Whether all of a box is the mirror image of other boxes."""
    return box[0][0] + box[-1][0] >= 0


def _multipliers(
    branch: Corners, box: Box, least: float, together: list[tuple[int, int]]
) -> list[int] | None:
    """Return integers x >= 0 with sum x (*) > 0 for all w, or None where the margin is below `least`."""
    columns = np.concatenate(
        [branch.columns(box[i][0], box[j][1], j - i + 1) for i, j in together], axis=1
    )
    sizes = np.abs(columns).max(axis=0)
    scaled = columns / sizes
    scaled /= np.abs(scaled).max(axis=1)[:, None]
    count = scaled.shape[1]
    found = linprog(
        np.r_[np.zeros(count), -1],
        np.c_[-scaled, np.ones(len(scaled))],
        np.zeros(len(scaled)),
        bounds=[(0, 1)] * count + [(None, 1)],
    ).x
    if found is None or found[-1] < least:
        return None
    exact = found[:-1] / sizes
    whole = np.round(exact / exact.max() * SCALE)
    if ((columns @ whole) <= MARGIN * np.abs(columns * whole).sum(axis=1)).any():
        return None
    return [int(x) for x in whole]


@dataclass
class _Search:
    branch: Corners
    depth: int
    until: float
    least: int = 3
    pairs: Tree = None
    open: list[Box] = field(default_factory=list)
    leaves: int = 0

    def grow(self, box: Box) -> Tree:
        """Return the tree below a box."""
        if mirrored(box):
            return ["mirror"]
        if self.pairs is not None and any(
            excluded(self.pairs, box[i], box[j]) for i, j in ((0, 1), (0, 2), (1, 2))
        ):
            return ["pair"]
        width = max(high - low for low, high in box)
        level = (Fraction(2) / width).numerator.bit_length() - 1
        if level >= self.least:
            found = _multipliers(self.branch, box, MARGIN, clusters(box))
            if found is not None:
                self.leaves += 1
                return found
        if level >= self.depth or process_time() > self.until or self._held(box, level):
            self.open.append(box)
            return ["open"]
        return ["split", *(self.grow(part) for part in parts(box))]

    def _held(self, box: Box, level: int) -> bool:
        """Whether springs hold, or nearly hold, maxima at the middle of a box of two places: halving it is no use."""
        if self.pairs is not None or level < 6 or box[1][0] < box[0][1]:
            return False
        tiny = Fraction(1, 1 << 16)
        point = tuple(((a + b) / 2 - tiny, (a + b) / 2 + tiny) for a, b in box)
        return _multipliers(self.branch, point, HELD, clusters(box)) is None


WHOLE: Cell = (Fraction(-1), Fraction(1))


def excluded(pairs: Tree, first: Cell, second: Cell) -> bool:
    """Whether a tree of pairs excludes maxima in both of these cells; places beyond the mirror by their images."""
    image = (-second[1], -second[0]), (-first[1], -first[0])
    return all(_below(pairs, (WHOLE, WHOLE), box) for box in ((first, second), image))


def _below(tree: Tree, node: Box, box: Box) -> bool:
    if any(a[0] >= b[1] or a[1] <= b[0] for a, b in zip(node, box, strict=True)):
        return True
    if tree[0] == "split":
        return all(
            _below(part, below, box) for part, below in zip(tree[1:], parts(node), strict=True)
        )
    return tree[0] != "open"


def prove_branch(
    sectors: Sequence[float | str],
    mode: int,
    *,
    tolerance: float | str = 0.0,
    pair_depth: int = 12,
    depth: int = 12,
    seconds: float = 600.0,
) -> dict[str, Any]:
    """Look for a proof that this branch has no three maxima; seconds of processor time for pairs, and for triples.

    For all vertices whose first three sectors are within tolerance [deg] of those given.

    Returns a certificate: sectors, tolerance, mode, leader, stretch, near, trees of pairs and triples; for the reader
    the numbers of leaves and of open boxes, and the share of the triples of places that is excluded.
    """
    branch = Corners(sectors, mode, tolerance)
    began = process_time()
    two = _Search(branch, pair_depth, began + seconds)
    pairs = two.grow((WHOLE, WHOLE))
    halfway = process_time()
    three = _Search(branch, depth, halfway + seconds, 4, pairs)
    triples = three.grow((WHOLE, WHOLE, WHOLE))
    left = sum(float(_volume(box)) for box in three.open)
    return {
        "sectors": [str(a) for a in sectors],
        "tolerance": str(tolerance),
        "mode": mode,
        "leader": branch.leader,
        "stretch": STRETCH,
        "near": NEAR,
        "pairs": pairs,
        "triples": triples,
        "leaves": [two.leaves, three.leaves],
        "open": [len(two.open), len(three.open)],
        "excluded": max(0.0, 1 - 1.5 * left),
        "seconds": [halfway - began, process_time() - halfway],
    }


def _volume(box: Box) -> Fraction:
    """Volume of the places of a box that are in order."""
    volume, run = Fraction(1), 0
    for i, (low, high) in enumerate(box):
        run = run + 1 if i and box[i - 1] == (low, high) else 1
        volume *= (high - low) / run
    return volume
