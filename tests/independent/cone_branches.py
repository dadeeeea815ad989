"""Minima on every single branch of a cone by brute force: a dense scan of the energy's slope.

No classes: all 2^(N/2 + 1) branches, each with its own N fold angles and their derivatives, on a grid
that is geometric towards both ends.  Zeros that the grid could step over (an extremum of the slope
between two nodes, on the near side of zero) are looked for by golden section.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import product

import numpy as np

from origami_nlp.closed_forms import cone_fold_angles

UNIFORM, GEOMETRIC = 400, 60


@lru_cache(maxsize=8)
def branches(degree: int) -> tuple[tuple[tuple[int, ...], int], ...]:
    """All (flaps, direction)."""
    return tuple((w, d) for d in (1, -1) for w in product((1, -1), repeat=degree // 2))


def branch_end(degree: int, flaps: tuple[int, ...], direction: int, end: str = "contract") -> float:
    """pi/2 - 2 pi/N where a flap takes the larger root (it is of the other sign than v), else pi/2.

    end = "contact": a single such flap goes on, to pi/2 (even number of flaps) or until its even
    crease, then beyond the axis, meets the odd crease opposite.
    """
    if flaps.count(-direction) == 1 and end == "contact":
        return math.pi / 2 if degree % 4 == 0 else math.acos(math.tan(math.pi / degree))
    return math.pi / 2 - 2 * math.pi / degree if -direction in flaps else math.pi / 2


def slope(degree, flaps, direction, s, ratio, rest):
    """dU/ds along one branch at s = |v|, k_odd = 1."""
    angles = cone_fold_angles(degree, direction * np.asarray(s, dtype=float), flaps)
    # derivatives of the closed form are by v and, at v = 0, those of v > 0
    first = direction * angles.first
    if direction < 0 and np.any(np.asarray(s) == 0):
        raise ValueError("start just below the flat state")
    stiffness = np.tile([1.0, ratio], degree // 2)
    return ((angles.value - rest) * first) @ stiffness


def rest_angles(degree: int, elevation: float) -> np.ndarray:
    """Fold angles of the all-valley branch at v_0, every crease on its own."""
    return cone_fold_angles(degree, elevation, [1] * (degree // 2)).value


@lru_cache(maxsize=8)
def tables(degree: int, end: str = "contract"):
    """For all branches on their grids: s, and sums of phi phi' and phi' over odd and even creases."""
    step = np.linspace(0.0, 1.0, UNIFORM + 1)[1:-1]
    small = np.geomspace(1e-15, step[0], GEOMETRIC)[:-1]
    share = np.concatenate([small, step, 1 - small[::-1], [1.0]])
    s, sums = [], []
    for flaps, direction in branches(degree):
        own = share * branch_end(degree, flaps, direction, end)
        angles = cone_fold_angles(degree, direction * own, flaps)
        first = direction * angles.first
        both = angles.value * first
        s.append(own)
        sums.append([x[:, k::2].sum(axis=1) for k in (0, 1) for x in (both, first)])
    return np.array(s), np.array(sums).transpose(1, 0, 2)


def count(
    degree: int, ratio: float, elevation: float, end: str = "contract"
) -> tuple[int, int, int]:
    """(interior minima, branches that fall at an end in contact, branches that fall at a cut)."""
    inside, falls = per_branch(degree, ratio, elevation, end)
    cut = np.array([end == "contract" and w.count(-d) == 1 for w, d in branches(degree)])
    return int(inside.sum()), int((falls & ~cut).sum()), int((falls & cut).sum())


def per_branch(
    degree: int, ratio: float, elevation: float, end: str = "contract"
) -> tuple[np.ndarray, np.ndarray]:
    """For every branch: interior minima, and whether the energy falls at the end."""
    rest = rest_angles(degree, elevation)
    s, (odd2, odd1, even2, even1) = tables(degree, end)
    f = odd2 - rest[0] * odd1 + ratio * (even2 - rest[1] * even1)
    interior = ((f[:, :-1] < 0) & (f[:, 1:] >= 0)).sum(axis=1)
    # an extremum of f between nodes may reach across zero: a pair of zeros the grid steps over
    size = np.sign(f)
    same = (size[:, :-2] == size[:, 1:-1]) & (size[:, 1:-1] == size[:, 2:])
    a = np.abs(f)
    dip = same & (a[:, 1:-1] < a[:, :-2]) & (a[:, 1:-1] <= a[:, 2:])
    # on this grid the extremum is within the change between neighbours of the middle value
    near = np.maximum(a[:, :-2], a[:, 2:]) - a[:, 1:-1]
    dip &= a[:, 1:-1] < 4 * near
    for b, k in np.argwhere(dip):
        flaps, direction = branches(degree)[b]
        sign = size[b, k + 1]

        def towards_zero(x, flaps=flaps, direction=direction, sign=sign):
            return sign * float(slope(degree, flaps, direction, x, ratio, rest))

        if golden(towards_zero, s[b, k], s[b, k + 2]) < 0:
            interior[b] += 1
    return interior, f[:, -1] < 0


def golden(function, low: float, high: float) -> float:
    """Least value of a unimodal function on [low, high]; stops early below zero."""
    ratio = (math.sqrt(5) - 1) / 2
    x, y = high - ratio * (high - low), low + ratio * (high - low)
    fx, fy = function(x), function(y)
    for _ in range(60):
        if min(fx, fy) < 0:
            break
        if fx < fy:
            high, y, fy = y, x, fx
            x = high - ratio * (high - low)
            fx = function(x)
        else:
            low, x, fx = x, y, fy
            y = low + ratio * (high - low)
            fy = function(y)
    return min(fx, fy)


def minimum_on(degree, flaps, direction, ratio, elevation) -> list[float]:
    """Elevations s of the interior minima of one branch, by bisection from a dense scan."""
    rest = rest_angles(degree, elevation)
    row = branches(degree).index((tuple(flaps), direction))
    s = tables(degree)[0][row]
    f = slope(degree, flaps, direction, s, ratio, rest)
    found = []
    for k in np.nonzero((f[:-1] < 0) & (f[1:] >= 0))[0]:
        low, high = s[k], s[k + 1]
        for _ in range(100):
            middle = (low + high) / 2
            below = slope(degree, flaps, direction, middle, ratio, rest) < 0
            low, high = (middle, high) if below else (low, middle)
        found.append((low + high) / 2)
    return found
