"""Every zero of the slope of the energy on every class of branches, none missed.

F(s) = A'(s) + r B'(s) on [0, end].  A cell of elevations is settled when
  - F has no zero on it: |F(middle)| exceeds half the width times a bound on |F'|, or
  - F is monotone on it (an enclosure of F' leaves out 0): then the signs at its ends tell.
Other cells are halved.  The enclosures are exact but for rounding: of P, S and X and of their first
derivatives the extremes lie at the ends of a cell, and |P''|, |S''|, |X''| have a single maximum
each, at a known place.  So a pair of zeros is not overlooked however close it is, until the
cell is 2^-HALVINGS of the branch; what is left then is a double zero to rounding and is reported as undecided.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.cone.energy import DirectionClasses, crease_angles

CELLS = 12
"""Cells a branch starts with."""
HALVINGS = 26
"""A cell is halved at most this often: a double zero is then known to 1e-9 of the branch."""
TIE = 64 * np.finfo(float).eps
"""|F| below this share of the terms it sums is taken for 0."""
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


def slope_signs(branches: DirectionClasses, ratio: float) -> SlopeSigns:
    """Isolate the minima of all classes of one direction at stiffness ratio r = k_even/k_odd."""
    count = len(branches.classes)
    parts = []
    for end in np.unique(branches.end):
        rows = np.nonzero(branches.end == end)[0]
        for block in np.array_split(rows, math.ceil(len(rows) / BLOCK)):
            parts.append(_isolate(branches, ratio, block, float(end)))
    start, stop = np.zeros(count), np.zeros(count)
    for block, at_start, at_end, *_ in parts:
        start[block], stop[block] = at_start, at_end
    found, low, high, undecided = (np.concatenate([p[k] for p in parts]) for k in (3, 4, 5, 6))
    order = np.lexsort((low, found))
    return SlopeSigns(found[order], low[order], high[order], start, stop, np.unique(undecided))


def _isolate(
    branches: DirectionClasses, ratio: float, block: np.ndarray, end: float
) -> tuple[np.ndarray, ...]:
    """(block, F(0), F(end), bracket rows, low, high, undecided rows) of classes with one end."""
    grid = np.linspace(0.0, end, CELLS + 1)
    weights, vertex = branches.weights[block], branches.even_vertex[block]
    even = 4 * branches.flaps * ratio

    def slope(s: np.ndarray) -> np.ndarray:
        size, first, _ = crease_angles(branches.degree, s)
        kinds = (size + branches.reach * branches.signs) * first
        return weights @ kinds.T + even * (s - vertex[:, None])

    at_nodes = slope(grid)
    for k in (0, -1):
        scale = branches.slope_scale(grid[[k]], ratio, block)
        tied = np.abs(at_nodes[:, k]) <= TIE * scale
        at_nodes[tied, k] = 0.0
    start, stop = at_nodes[:, 0].copy(), at_nodes[:, -1].copy()

    low, high = curvature_bounds(branches, grid[:-1], grid[1:])
    slowest, fastest = weights @ low.T + even, weights @ high.T + even
    middle = slope((grid[:-1] + grid[1:]) / 2)
    half = np.diff(grid) / 2
    monotone = (slowest > 0) | (fastest < 0)
    free = np.abs(middle) > half * np.maximum(np.abs(slowest), np.abs(fastest)) * (1 + 1e-12)
    rising = (at_nodes[:, :-1] < 0) & (at_nodes[:, 1:] >= 0)
    # a zero at the very end is not inside the branch; ends are judged on their own
    rising[:, -1] &= stop > 0
    r, c = np.nonzero(rising & monotone)
    rows, lows, highs = [r], [grid[c]], [grid[c + 1]]

    r, c = np.nonzero(~monotone & ~free)
    a, b, fa, fb = grid[c], grid[c + 1], at_nodes[r, c], at_nodes[r, c + 1]
    for _ in range(HALVINGS):
        if not r.size:
            break
        m = (a + b) / 2
        fm = _own_slope(branches, ratio, block[r], m)
        r, a, b = np.concatenate([r, r]), np.concatenate([a, m]), np.concatenate([m, b])
        fa, fb = np.concatenate([fa, fm]), np.concatenate([fm, fb])
        low, high = curvature_bounds(branches, a, b)
        slow = np.einsum("kc,kc->k", weights[r], low) + even
        fast = np.einsum("kc,kc->k", weights[r], high) + even
        monotone = (slow > 0) | (fast < 0)
        rises = monotone & (fa < 0) & (fb >= 0) & ~((b == end) & (fb == 0))
        rows.append(r[rises])
        lows.append(a[rises])
        highs.append(b[rises])
        at_middle = _own_slope(branches, ratio, block[r], (a + b) / 2)
        width = (b - a) / 2 * np.maximum(np.abs(slow), np.abs(fast)) * (1 + 1e-12)
        left = ~monotone & ~(np.abs(at_middle) > width)
        r, a, b, fa, fb = r[left], a[left], b[left], fa[left], fb[left]
    # what is left is a double zero to rounding; a change of sign across it is still a minimum
    crossing = (fa < 0) & (fb >= 0)
    rows.append(r[crossing])
    lows.append(a[crossing])
    highs.append(b[crossing])
    found = np.concatenate(rows)
    return (
        block,
        start,
        stop,
        block[found],
        np.concatenate(lows),
        np.concatenate(highs),
        block[np.unique(r)],
    )


def _own_slope(
    branches: DirectionClasses, ratio: float, rows: np.ndarray, s: np.ndarray
) -> np.ndarray:
    """F of class rows[k] at s[k]."""
    odd, even = branches.slopes(s, rows)
    return odd + ratio * even


def curvature_bounds(
    branches: DirectionClasses, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Enclose the contribution of one odd crease of each size to A'' on cells [low, high].

    Returns
    -------
    slowest, fastest
        Bounds of (Z + c) Z'' + Z'^2 for Z = P, S, X, shape [k, 3].  A'' is within weights times them.
    """
    size_a, first_a, second_a = crease_angles(branches.degree, low)
    size_b, first_b, second_b = crease_angles(branches.degree, high)
    # Z increases; Z' >= 0 is monotone, so its extremes are at the ends
    x0 = size_a + branches.reach * branches.signs
    x1 = size_b + branches.reach * branches.signs
    g0, g1 = np.minimum(first_a, first_b), np.maximum(first_a, first_b)
    # P'' >= 0 increases; -S'' and -X'' are >= 0, rise to one peak and fall
    bend_a, bend_b = np.abs(second_a), np.abs(second_b)
    y0, y1 = np.minimum(bend_a, bend_b), np.maximum(bend_a, bend_b)
    peak = np.array([math.inf, *_peaks(branches.degree)])
    inside = (low[:, None] < peak) & (peak < high[:, None])
    if inside.any():
        at_peak = np.abs(crease_angles(branches.degree, np.minimum(peak, math.pi / 2))[2])
        tops = np.array([0.0, at_peak[1, 1], at_peak[2, 2]])
        y1 = np.where(inside, np.maximum(y1, tops), y1)
    product0 = np.minimum(x0 * y0, x0 * y1)
    product1 = np.maximum(x1 * y0, x1 * y1)
    down = np.array([False, True, True])
    slowest = np.where(down, -product1, product0) + g0**2
    fastest = np.where(down, -product0, product1) + g1**2
    return slowest - 1e-13 * np.abs(slowest), fastest + 1e-13 * np.abs(fastest)


def _peaks(degree: int) -> tuple[float, float]:
    """Elevations where |S''| and |X''| are largest (pi/2 or more: they rise all the way).

    With t = tan(s/2), |S''| = 2 K (1 - K^2) t (1 + t^2)/(K^2 + t^2)^2, stationary where
    t^4 + 3 (1 - K^2) t^2 = K^2.  With T = tan(alpha), w = T^2 sin^2 s and c = 1 + 2 T^2,
    |X''| = 2 sqrt(w) (c - w)/(1 + w)^2, stationary where w^2 - 3 (c + 1) w + c = 0.
    """
    alpha = 2 * math.pi / degree
    k2 = (math.cos(alpha) / (1 + math.sin(alpha))) ** 2
    b = 3 * (1 - k2)
    t2 = 2 * k2 / (b + math.sqrt(b * b + 4 * k2))
    big = math.tan(alpha) ** 2
    c = 1 + 2 * big
    w = 2 * c / (3 * (c + 1) + math.sqrt(9 * (c + 1) ** 2 - 4 * c))
    unlike = math.asin(math.sqrt(w / big)) if w < big else math.inf
    return 2 * math.atan(math.sqrt(t2)), unlike


def polish(branches: DirectionClasses, ratio: float, signs: SlopeSigns) -> np.ndarray:
    """Close the brackets on the zeros of F to rounding: Newton steps kept inside by bisection."""
    low, high, rows = signs.low.copy(), signs.high.copy(), signs.rows
    s = (low + high) / 2
    active = np.arange(len(s))
    before = high - low
    for _ in range(200):
        if not active.size:
            break
        at, own = s[active], rows[active]
        odd, even = branches.slopes(at, own)
        value = odd + ratio * even
        bend, even2 = branches.curvatures(at, own)
        below = value < 0
        low[active] = np.where(below, at, low[active])
        high[active] = np.where(below, high[active], at)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = value / (bend + ratio * even2)
        new = at - step
        a, b = low[active], high[active]
        # bisect when Newton leaves the bracket or does not halve its last step
        poor = ~((new > a) & (new < b)) | (np.abs(step) > before[active] / 2)
        small = np.abs(step) <= 2e-16 * at
        new = np.where(poor & ~small, (a + b) / 2, np.where(poor, at, new))
        before[active] = np.abs(new - at)
        s[active] = new
        done = small | (value == 0) | (b - a <= 4e-16 * b) | (before[active] <= 2e-16 * at)
        active = active[~done]
    return s
