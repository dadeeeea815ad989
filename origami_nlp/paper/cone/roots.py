"""Every minimum of the energy on every class of branches, none missed.

F(s) = A'(s) + r B'(s) on [0, end].  A cell of elevations is settled when
  - F has no zero on it: |F(middle)| exceeds half the width times a bound on |F'|, or
  - F is monotone on it (an enclosure of F' leaves out 0): then the signs at its ends decide.
Other cells are halved.  The enclosures are exact but for rounding: of P, S and X and of their first
derivatives the extremes lie at the ends of a cell, and |P''|, |S''|, |X''| have a single maximum
each, at a known place.  So a pair of zeros is not overlooked however close it is, until the
cell is 2^-HALVINGS of the branch; what is left then is a double zero to rounding and is reported as a tie.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from origami_nlp.numerics import EPS
from origami_nlp.paper.cone.classes import Branches
from origami_nlp.paper.cone.energy import BranchEnergy
from origami_nlp.paper.cone.rules import Rest

HALVINGS = 30
"""A branch is halved at most this often: 2^-30 = 9e-10 of it is less than sqrt(eps), where the two zeros of a fold are
one to rounding (F is eps of its terms at sqrt(eps) from a double zero)."""
TIE = 64 * EPS
"""|F| below this share of the terms it sums is taken for 0: three sizes and the even creases, each product of a few
factors right to 4 eps, add up to less."""
FREE = 1 + 1e-12
"""Bounds of |F'| are widened by this factor before F is said to have no zero on a cell: F and its bound are right
to TIE = 1.4e-14 of their terms, and wider bounds cost a halving only."""
WIDER = 1e-13
"""Enclosures of F' are widened by this share for the rounding of the sizes and derivatives at the ends of a cell
(closed forms right to some 20 eps), products and sums included."""
STEPS = 200
"""Most steps for one zero: bisection alone needs 52 from a bracket as wide as its middle, more near the flat state."""
BLOCK = 40_000
"""Classes treated at a time (memory)."""


class Found(NamedTuple):
    """Minima on branches: classes `rows`, elevations s, which are at an end, and -F there; rows of those with ties."""

    rows: np.ndarray
    s: np.ndarray
    at_end: np.ndarray
    multiplier: np.ndarray
    ties: np.ndarray


def minima_of(branches: Branches, rest: Rest, ratio: np.ndarray) -> Found:
    """Find the minima of all classes, each at its ratio [m], sorted by class and elevation."""
    rows = np.arange(len(branches))
    if rest.odd == 0 and rest.even == 0:  # flat at rest: all branches climb
        rows = rows[:0]
    blocks = np.array_split(rows, 1 + len(rows) // BLOCK)
    parts = [_minima(BranchEnergy(branches[b], rest, ratio[b]), b) for b in blocks]
    return Found(*map(np.concatenate, zip(*parts, strict=True)))


def _minima(energy: BranchEnergy, number: np.ndarray) -> Found:
    """Find the minima of classes with the numbers [m]."""
    end = energy.branches.end
    start, stop = (_slope_or_zero(energy.at(s)) for s in (0 * end, end))
    rows, low, high, double = _isolate(energy, start, stop)
    inside = _polished(energy, rows, low, high)
    # F(end) = 0 but for rounding: what F does before it decides
    tied = np.flatnonzero(stop == 0)
    bend = energy.at(end[tied], tied).curvature
    # the energy falls to the end, or is level there and curves up: the end is a minimum of the closed branch
    pinned = np.union1d(np.flatnonzero(stop < 0), tied[bend > 0])
    rows, s = np.append(rows, pinned), np.append(inside, end[pinned])
    at_end = np.arange(len(rows)) >= len(inside)
    multiplier = np.where(at_end, np.maximum(-stop[rows], 0.0), 0.0)
    order = np.lexsort((s, rows))
    ties = np.unique(np.concatenate([np.flatnonzero(start == 0), tied, double]))
    return Found(number[rows[order]], s[order], at_end[order], multiplier[order], number[ties])


def _slope_or_zero(energy: BranchEnergy) -> np.ndarray:
    """F, exactly 0 where it is 0 to rounding."""
    slope = energy.slope
    return np.where(np.abs(slope) <= TIE * energy.slope_scale, 0.0, slope)


def _isolate(
    energy: BranchEnergy, start: np.ndarray, stop: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Bracket the zeros at which F rises: rows, low, high; and rows of double zeros.

    start, stop: F at both ends of each branch.
    """
    r, end = np.arange(len(start)), energy.branches.end
    a, b, fa, fb = 0 * end, end, start, stop
    brackets = []
    for _ in range(HALVINGS + 1):
        m = (a + b) / 2
        here = energy.at(m, r)
        fm = here.slope
        bounds = curvature_bounds(energy.at(a, r), energy.at(b, r))
        slowest, fastest = (here.total((odd, 4 * here.branches.cone.flaps)) for odd in bounds)
        monotone = (slowest > 0) | (fastest < 0)
        # a zero at the very end is not inside the branch; ends are judged on their own
        rises = (fa < 0) & (fb >= 0) & ~((b == end[r]) & (fb == 0))
        brackets.append((r[rises & monotone], a[rises & monotone], b[rises & monotone]))
        steepest = np.maximum(np.abs(slowest), np.abs(fastest))
        left = ~monotone & ~(np.abs(fm) > (b - a) / 2 * steepest * FREE)
        rises, r, a, m, b, fa, fm, fb = (v[left] for v in (rises, r, a, m, b, fa, fm, fb))
        double, across = np.unique(r), (r[rises], a[rises], b[rises])
        r, a, b = np.append(r, r), np.append(a, m), np.append(m, b)
        fa, fb = np.append(fa, fm), np.append(fm, fb)
        if not r.size:
            break
    # what is left is a double zero to rounding; a change of sign across it is still a minimum
    rows, low, high = (np.concatenate(v) for v in zip(*brackets, across, strict=True))
    return rows, low, high, double


def curvature_bounds(low: BranchEnergy, high: BranchEnergy) -> tuple[np.ndarray, np.ndarray]:
    """Enclose A'' on the cells between two elevations of the same branches.

    It sums Z'^2 + (Z + c) Z'' over the odd creases, of sizes Z = P, S, X.
    """
    (_, first_a, second_a), (_, first_b, second_b) = low.sizes, high.sizes
    # Z increases; Z' >= 0 is monotone, so its extremes are at the ends
    x0, x1 = low.stretch, high.stretch
    g0, g1 = np.minimum(first_a, first_b), np.maximum(first_a, first_b)
    # P'' >= 0 increases; -S'' and -X'' are >= 0, rise to one peak and fall
    bend_a, bend_b = np.abs(second_a), np.abs(second_b)
    y0, y1 = np.minimum(bend_a, bend_b), np.maximum(bend_a, bend_b)
    peak, top = _peaks(low.branches, low.rest)
    inside = (np.asarray(low.s)[..., None] < peak) & (peak < np.asarray(high.s)[..., None])
    y1 = np.where(inside, np.maximum(y1, top), y1)
    product0, product1 = np.minimum(x0 * y0, x0 * y1), np.maximum(x1 * y0, x1 * y1)
    down = np.array([False, True, True])
    slowest = np.where(down, -product1, product0) + g0**2
    fastest = np.where(down, -product0, product1) + g1**2
    counts = low.branches.odd_creases
    return (
        (counts * (slowest - WIDER * np.abs(slowest))).sum(axis=-1),
        (counts * (fastest + WIDER * np.abs(fastest))).sum(axis=-1),
    )


def _peaks(branches: Branches, rest: Rest) -> tuple[np.ndarray, np.ndarray]:
    """Elevations where |P''|, |S''| and |X''| are largest (pi/2 and more: they rise all the way), and what is there.

    With t = tan(s/2), |S''| = 2 K (1 - K^2) t (1 + t^2)/(K^2 + t^2)^2, stationary where
    t^4 + 3 (1 - K^2) t^2 = K^2.  With T = tan(alpha), w = T^2 sin^2 s and c = 1 + 2 T^2,
    |X''| = 2 sqrt(w) (c - w)/(1 + w)^2, stationary where w^2 - 3 (c + 1) w + c = 0.
    """
    alpha = 2 * math.pi / branches.cone.degree
    k2 = (math.cos(alpha) / (1 + math.sin(alpha))) ** 2
    b = 3 * (1 - k2)
    # the positive root of t^4 + b t^2 - K^2 = 0, without cancellation
    t2 = 2 * k2 / (b + math.sqrt(b * b + 4 * k2))
    big = math.tan(alpha) ** 2
    c = 1 + 2 * big
    w = 2 * c / (3 * (c + 1) + math.sqrt(9 * (c + 1) ** 2 - 4 * c))
    unlike = math.asin(math.sqrt(w / big)) if w < big else math.inf
    peak = np.array([math.inf, 2 * math.atan(math.sqrt(t2)), unlike])
    there = BranchEnergy(branches, rest, 1.0, np.minimum(peak, math.pi / 2)).sizes[2]
    return peak, np.abs(np.diagonal(there))


def _polished(
    energy: BranchEnergy, rows: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Close brackets [low, high] on the zeros of F to rounding: Newton steps kept inside by bisection."""
    low, high, s = low.copy(), high.copy(), (low + high) / 2
    before, active = high - low, np.arange(len(s))
    for _ in range(STEPS):
        if not active.size:
            break
        at = s[active]
        here = energy.at(at, rows[active])
        value = here.slope
        low[active] = np.where(value < 0, at, low[active])
        high[active] = np.where(value < 0, high[active], at)
        a, b = low[active], high[active]
        with np.errstate(divide="ignore", invalid="ignore"):
            step = value / here.curvature
        # bisect when Newton leaves the bracket or does not halve its last step
        poor = ~((at - step > a) & (at - step < b)) | (np.abs(step) > before[active] / 2)
        small = (np.abs(step) <= EPS * at) | (value == 0)
        new = np.where(small, at, np.where(poor, (a + b) / 2, at - step))
        before[active], s[active] = np.abs(new - at), new
        active = active[~(small | (b - a <= 2 * EPS * b) | (np.abs(new - at) <= EPS * at))]
    return s
