"""Strips of two vertices of degree four by spherical trigonometry: no quaternions, no code of the package."""

import math
from itertools import product

import numpy as np


def sectors(corners: np.ndarray, vertex: int, neighbours: list[int]) -> tuple[float, ...]:
    """Sector angles counter-clockwise from the first neighbour, in the plane."""
    out = corners[neighbours] - corners[vertex]
    azimuth = np.arctan2(out[:, 1], out[:, 0])
    return tuple(((np.roll(azimuth, -1) - azimuth) % (2 * math.pi)).tolist())


def _angle(opposite: float, one: float, other: float) -> float | None:
    """Angle of a spherical triangle from its three sides (law of cosines)."""
    value = (math.cos(opposite) - math.cos(one) * math.cos(other)) / (
        math.sin(one) * math.sin(other)
    )
    return math.acos(value) if -1 <= value <= 1 else None


def quadrilateral(s: tuple[float, ...], fold: float, dart: bool) -> tuple[float, ...] | None:
    """Fold angles of creases 1, 2, 3 of a vertex with sectors s, given that of crease 0; None where there are none.

    Fold angles are the outer angles of a spherical quadrilateral, cut in two triangles by the diagonal from crease 1
    to crease 3; its corner 2 is beyond the diagonal or, a dart, mirrored at it.  A dart of which only one side passes
    the other is a bow tie, no polygon of paper.
    """
    inner = math.pi - abs(fold)
    diagonal = math.acos(
        math.cos(s[3]) * math.cos(s[0]) + math.sin(s[3]) * math.sin(s[0]) * math.cos(inner)
    )
    a1, a3 = _angle(s[3], s[0], diagonal), _angle(s[0], s[3], diagonal)
    b1, b3, b2 = (
        _angle(s[2], s[1], diagonal),
        _angle(s[1], s[2], diagonal),
        _angle(diagonal, s[1], s[2]),
    )
    if None in (a1, a3, b1, b2, b3):
        return None
    if not dart:
        folds = math.pi - a1 - b1, math.pi - b2, math.pi - a3 - b3
    else:
        if (a1 - b1) * (a3 - b3) <= 0:
            return None
        turn = 0.0 if a1 > b1 else 2 * math.pi
        folds = math.pi - a1 + b1 - turn, b2 - math.pi, math.pi - a3 + b3 - turn
    return tuple(math.copysign(1.0, fold) * f for f in folds)


def strip_states(pattern):
    """Return what gives fold angles of a strip of two vertices, over that of the crease they share, by trigonometry.

    It takes the fold angle and, for either vertex, whether its quadrilateral is a dart; None where there is no state.
    """
    ends = [tuple(e) for e in pattern.ends.tolist()]
    count = np.bincount(pattern.ends.ravel(), minlength=len(pattern.corners))
    a, b = np.flatnonzero(count == 4).tolist()
    around = []
    for v, w in ((a, b), (b, a)):
        others = [x for e in ends if v in e for x in e if x != v]
        azimuth = {
            x: math.atan2(*(pattern.corners[x] - pattern.corners[v])[[1, 0]]) for x in others
        }
        ring = sorted(others, key=lambda x, z=azimuth, w=w: (z[x] - z[w]) % (2 * math.pi))
        creases = [ends.index(tuple(sorted((v, x)))) for x in ring]
        around.append((sectors(pattern.corners, v, ring), creases))

    def state(fold: float, darts: tuple[bool, bool]) -> np.ndarray | None:
        phi = np.zeros(len(ends))
        for (s, creases), dart in zip(around, darts, strict=True):
            folds = quadrilateral(s, fold, dart)
            if folds is None:
                return None
            phi[creases] = fold, *folds
        return phi

    return state, around[0][1][0]


def scan(pattern, samples: int = 4001) -> list[tuple[float, np.ndarray]]:
    """Interior minima of the energy of a strip of two vertices that share a crease: energy and fold angles."""
    state, _ = strip_states(pattern)

    def energy(fold: float, darts: tuple[bool, bool]) -> float:
        phi = state(fold, darts)
        return (
            math.inf if phi is None else float(0.5 * pattern.stiffness @ (phi - pattern.rest) ** 2)
        )

    grid = np.linspace(-math.pi, math.pi, 2 * (samples // 2))  # even: not through 0
    # minima may lie next to the flat state; nearer than this cosines do not tell
    beside = np.geomspace(2e-5, 2 * math.pi / samples, 30)
    grid = np.unique(np.concatenate([grid, beside, -beside]))
    found = []
    for darts in product((False, True), repeat=2):
        e = np.array([energy(t, darts) for t in grid])
        for i in range(1, len(grid) - 1):
            near = e[i - 1 : i + 2]
            if not np.isfinite(near).all() or not near[0] > near[1] < near[2]:
                continue
            if grid[i - 1] * grid[i + 1] < 0:
                continue  # across the flat state
            low, high = grid[i - 1], grid[i + 1]
            for _ in range(100):  # thirds
                one, other = low + (high - low) / 3, high - (high - low) / 3
                low, high = (
                    (low, other) if energy(one, darts) < energy(other, darts) else (one, high)
                )
            phi = state(0.5 * (low + high), darts)
            if np.abs(phi).max() < math.pi - 1e-4:
                found.append((energy(0.5 * (low + high), darts), phi))
    return sorted(found, key=lambda f: f[0])
