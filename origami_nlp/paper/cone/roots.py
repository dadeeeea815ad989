"""Every zero of the slope of the energy on every class of branches, none missed.

F(s) = A'(s) + r B'(s) on [0, end].  A cell of elevations is settled when
  - F has no zero on it: |F(middle)| exceeds half the width times a bound on |F'|, or
  - F is monotone on it (an enclosure of F' leaves out 0): then the signs at its ends decide.
Other cells are halved.  The enclosures are exact but for rounding: of P, S and X and of their first
derivatives the extremes lie at the ends of a cell, and |P''|, |S''|, |X''| have a single maximum
each, at a known place.  So a pair of zeros is not overlooked however close it is, until the
cell is 2^-HALVINGS of the branch; what is left then is a double zero to rounding and is reported as undecided.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import EPS
from origami_nlp.paper.cone.energy import OddCreases, SideEnergy

CELLS = 12
"""Cells a branch starts with; counts do not depend on it."""
HALVINGS = 26
"""A cell is halved at most this often: 2^-26 = 1.5e-8 = sqrt(eps) of the branch's twelfth, where the two zeros of a
fold are one to rounding (F is eps of its terms at sqrt(eps) from a double zero)."""
TIE = 64 * EPS
"""|F| below this share of the terms it sums is taken for 0: three sizes and the even creases, each product of a few
factors right to 4 eps, add up to less."""
FREE = 1 + 1e-12
"""Bounds of |F'| are widened by this factor before F is said to have no zero on a cell: F and its bound are right
to TIE = 1.4e-14 of their terms, and wider bounds cost a halving only."""
WIDER = 1e-13
"""Enclosures of F' are widened by this share for the rounding of the sizes and derivatives at the ends of a cell
(closed forms right to some 20 eps), products and sums included."""
CLOSE = EPS
"""A zero is found when Newton's step is below this share of it (the last bit), or its bracket below twice that."""
STEPS = 200
"""Most steps for one zero: bisection alone needs 52 from a bracket as wide as its middle, more near the flat state."""
BLOCK = 40_000
"""Classes treated at a time (memory)."""


@dataclass(frozen=True)
class SlopeSigns:
    """Where the slope of the energy changes sign from - to + (minima), and its signs at the ends.

    Attributes
    ----------
    rows, low, high
        Brackets: class, and elevations with F(low) < 0 <= F(high), F increasing between; [k] each.
        Sorted by class and elevation.
    start, end
        F at s = 0 and at the end of each class, [m]; exactly 0 where it is 0 to rounding.
    undecided
        Rows of classes with a double zero to rounding (a fold of the curve r = -A'/B').
    """

    rows: np.ndarray
    low: np.ndarray
    high: np.ndarray
    start: np.ndarray
    end: np.ndarray
    undecided: np.ndarray


def slope_signs(side: SideEnergy, ratio: np.ndarray) -> SlopeSigns:
    """Isolate the minima of all classes of one direction, each at its stiffness ratio r = k_even/k_odd [m]."""
    parts = []
    for end, rows in side.by_end():
        for block in np.array_split(rows, math.ceil(len(rows) / BLOCK)):
            parts.append((block, _isolate(side.only(block), ratio[block], end)))
    start, stop = np.zeros(len(side.end)), np.zeros(len(side.end))
    for block, part in parts:
        start[block], stop[block] = part.start, part.end
    found = np.concatenate([block[p.rows] for block, p in parts])
    low, high = (np.concatenate([getattr(p, k) for _, p in parts]) for k in ("low", "high"))
    undecided = np.concatenate([block[p.undecided] for block, p in parts])
    order = np.lexsort((low, found))
    return SlopeSigns(found[order], low[order], high[order], start, stop, np.unique(undecided))


def _isolate(side: SideEnergy, ratio: np.ndarray, end: float) -> SlopeSigns:
    """Isolate the minima of classes with one end; brackets in any order."""
    grid = np.linspace(0.0, end, CELLS + 1)
    each = ratio[:, None]
    even = 4 * side.flaps * each
    at_nodes = side.at(grid).slope(each)
    for k in (0, -1):
        scale = side.at(grid[[k]]).slope_scale(each)[:, 0]
        at_nodes[np.abs(at_nodes[:, k]) <= TIE * scale, k] = 0.0
    start, stop = at_nodes[:, 0].copy(), at_nodes[:, -1].copy()

    # where F' has one sign on a cell F has one zero at most; where |F(middle)| > width max |F'| it has none
    low, high = curvature_bounds(side, grid[:-1], grid[1:])
    slowest, fastest = side.weights @ low.T + even, side.weights @ high.T + even
    middle = side.at((grid[:-1] + grid[1:]) / 2).slope(each)
    monotone = (slowest > 0) | (fastest < 0)
    steepest = np.maximum(np.abs(slowest), np.abs(fastest))
    free = np.abs(middle) > np.diff(grid) / 2 * steepest * FREE
    rising = (at_nodes[:, :-1] < 0) & (at_nodes[:, 1:] >= 0)
    # a zero at the very end is not inside the branch; ends are judged on their own
    rising[:, -1] &= stop > 0
    r, c = np.nonzero(rising & monotone)
    brackets = [(r, grid[c], grid[c + 1])]

    r, c = np.nonzero(~monotone & ~free)
    a, b, fa, fb = grid[c], grid[c + 1], at_nodes[r, c], at_nodes[r, c + 1]
    for _ in range(HALVINGS):
        if not r.size:
            break
        # cells that neither test decides are halved
        m = (a + b) / 2
        fm = side.at(m, r).slope(ratio[r])
        r, a, b = np.concatenate([r, r]), np.concatenate([a, m]), np.concatenate([m, b])
        fa, fb = np.concatenate([fa, fm]), np.concatenate([fm, fb])
        low, high = curvature_bounds(side, a, b)
        slow = np.einsum("kc,kc->k", side.weights[r], low) + even[r, 0]
        fast = np.einsum("kc,kc->k", side.weights[r], high) + even[r, 0]
        monotone = (slow > 0) | (fast < 0)
        rises = monotone & (fa < 0) & (fb >= 0) & ~((b == end) & (fb == 0))
        brackets.append((r[rises], a[rises], b[rises]))
        at_middle = side.at((a + b) / 2, r).slope(ratio[r])
        width = (b - a) / 2 * np.maximum(np.abs(slow), np.abs(fast)) * FREE
        left = ~monotone & ~(np.abs(at_middle) > width)
        r, a, b, fa, fb = r[left], a[left], b[left], fa[left], fb[left]
    # what is left is a double zero to rounding; a change of sign across it is still a minimum
    crossing = (fa < 0) & (fb >= 0)
    brackets.append((r[crossing], a[crossing], b[crossing]))
    rows, lows, highs = (np.concatenate(part) for part in zip(*brackets, strict=True))
    return SlopeSigns(rows, lows, highs, start, stop, np.unique(r))


def curvature_bounds(
    side: SideEnergy, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Enclose the contribution of one odd crease of each size to A'' on cells [low, high].

    Returns
    -------
    slowest, fastest
        Bounds of (Z + c) Z'' + Z'^2 for Z = P, S, X, shape [k, 3].  A'' is within weights times them.
    """
    degree = side.cone.degree
    a, b = (OddCreases.at(degree, s, side.reach) for s in (low, high))
    # Z increases; Z' >= 0 is monotone, so its extremes are at the ends
    x0, x1 = a.stretch, b.stretch
    g0, g1 = np.minimum(a.first, b.first), np.maximum(a.first, b.first)
    # P'' >= 0 increases; -S'' and -X'' are >= 0, rise to one peak and fall
    bend_a, bend_b = np.abs(a.second), np.abs(b.second)
    y0, y1 = np.minimum(bend_a, bend_b), np.maximum(bend_a, bend_b)
    peak = np.array([math.inf, *_peaks(degree)])
    inside = (low[:, None] < peak) & (peak < high[:, None])
    if inside.any():
        at_peak = np.abs(OddCreases.at(degree, np.minimum(peak, math.pi / 2), 0.0).second)
        tops = np.array([0.0, at_peak[1, 1], at_peak[2, 2]])
        y1 = np.where(inside, np.maximum(y1, tops), y1)
    product0 = np.minimum(x0 * y0, x0 * y1)
    product1 = np.maximum(x1 * y0, x1 * y1)
    down = np.array([False, True, True])
    slowest = np.where(down, -product1, product0) + g0**2
    fastest = np.where(down, -product0, product1) + g1**2
    return slowest - WIDER * np.abs(slowest), fastest + WIDER * np.abs(fastest)


def _peaks(degree: int) -> tuple[float, float]:
    """Elevations where |S''| and |X''| are largest (pi/2 or more: they rise all the way).

    With t = tan(s/2), |S''| = 2 K (1 - K^2) t (1 + t^2)/(K^2 + t^2)^2, stationary where
    t^4 + 3 (1 - K^2) t^2 = K^2.  With T = tan(alpha), w = T^2 sin^2 s and c = 1 + 2 T^2,
    |X''| = 2 sqrt(w) (c - w)/(1 + w)^2, stationary where w^2 - 3 (c + 1) w + c = 0.
    """
    alpha = 2 * math.pi / degree
    k2 = (math.cos(alpha) / (1 + math.sin(alpha))) ** 2
    b = 3 * (1 - k2)
    # the positive root of t^4 + b t^2 - K^2 = 0, without cancellation
    t2 = 2 * k2 / (b + math.sqrt(b * b + 4 * k2))
    big = math.tan(alpha) ** 2
    c = 1 + 2 * big
    w = 2 * c / (3 * (c + 1) + math.sqrt(9 * (c + 1) ** 2 - 4 * c))
    unlike = math.asin(math.sqrt(w / big)) if w < big else math.inf
    return 2 * math.atan(math.sqrt(t2)), unlike


def polish(side: SideEnergy, ratio: np.ndarray, signs: SlopeSigns) -> np.ndarray:
    """Close the brackets on the zeros of F to rounding: Newton steps kept inside by bisection."""
    low, high, rows = signs.low.copy(), signs.high.copy(), signs.rows
    s = (low + high) / 2
    active = np.arange(len(s))
    before = high - low
    for _ in range(STEPS):
        if not active.size:
            break
        at, r = s[active], ratio[rows[active]]
        here = side.at(at, rows[active])
        value = here.slope(r)
        below = value < 0
        low[active] = np.where(below, at, low[active])
        high[active] = np.where(below, high[active], at)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = value / here.curvature(r)
        new = at - step
        a, b = low[active], high[active]
        # bisect when Newton leaves the bracket or does not halve its last step
        poor = ~((new > a) & (new < b)) | (np.abs(step) > before[active] / 2)
        small = np.abs(step) <= CLOSE * at
        new = np.where(poor & ~small, (a + b) / 2, np.where(poor, at, new))
        before[active] = np.abs(new - at)
        s[active] = new
        done = small | (value == 0) | (b - a <= 2 * CLOSE * b) | (before[active] <= CLOSE * at)
        active = active[~done]
    return s
