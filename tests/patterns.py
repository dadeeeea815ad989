"""Patterns of many vertices that the tests of this room fold, made from points alone."""

import math
from typing import NamedTuple

import numpy as np

from origami_nlp.pattern import Pattern, Scene, make_pattern
from origami_nlp.search import TRUST, descent_path


class Downhill(NamedTuple):
    """Where a descent of the kernel ends, whether at a minimum, and after how many steps."""

    phi: np.ndarray
    arrived: bool
    steps: int


def downhill(problem, phi: np.ndarray) -> Downhill:
    """Follow the energy downhill from a closed state in which no facets cross."""
    found = descent_path(problem, phi, longest=TRUST)
    return Downhill(found.end, found.arrives, len(found.states) - 1)


def grid(points: np.ndarray, without: tuple[tuple[int, int], ...] = (), **options) -> Pattern:
    """Quadrilaterals between points [m + 1, n + 1, 2], less some."""
    m, n = points.shape[0] - 1, points.shape[1] - 1
    at = np.arange((m + 1) * (n + 1)).reshape(m + 1, n + 1)
    quads = [
        (int(at[i, j]), int(at[i + 1, j]), int(at[i + 1, j + 1]), int(at[i, j + 1]))
        for i in range(m)
        for j in range(n)
        if (i, j) not in without
    ]
    return make_pattern(points.reshape(-1, 2), quads, **options)


def miura(m: int, n: int, gamma: float = math.pi / 3, without=()) -> Pattern:
    i, j = np.meshgrid(np.arange(m + 1.0), np.arange(n + 1.0), indexing="ij")
    return grid(np.stack([i + (j % 2) * np.cos(gamma), j * np.sin(gamma)], axis=2), without)


def miura_angles(pattern: Pattern, n: int, zigzag: float, gamma: float = math.pi / 3) -> np.ndarray:
    """Fold angles by tan(h/2) = cos gamma tan(z/2), straight rows h and zigzags z; spherical trigonometry."""
    straight = np.abs(pattern.directions[:, 1]) < 1e-9
    start = pattern.ends.min(axis=1)
    i, j = start // (n + 1), start % (n + 1)
    row = 2 * math.atan(math.cos(gamma) * math.tan(zigzag / 2))
    # along a row mountains and valleys alternate; a zigzag is one or the other, in turn
    return np.where(straight, -((-1.0) ** (i + j)) * row, (-1.0) ** i * zigzag)


def strip(seed: int, m: int = 3, n: int = 2) -> Pattern:
    rng = np.random.default_rng(seed)
    i, j = np.meshgrid(np.arange(m + 1.0), np.arange(n + 1.0), indexing="ij")
    points = np.stack([i, j], axis=2) + rng.uniform(-0.18, 0.18, (m + 1, n + 1, 2))
    pattern = grid(points)
    k, rest = rng.uniform(0.2, 2, pattern.creases), rng.uniform(-3, 3, pattern.creases)
    return pattern.with_springs(list(k), list(rest))


def wheel(sectors) -> Pattern:
    """Return one vertex with a round of triangles."""
    azimuth = np.concatenate([[0.0], np.cumsum(sectors)[:-1]])
    rim = np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    n = len(sectors)
    triangles = [(0, 1 + i, 1 + (i + 1) % n) for i in range(n)]
    return make_pattern(np.vstack([[0.0, 0.0], rim]), triangles)


QUAD = ((0.0, 0.0), (1.0, 0.0), (1.25, 0.9), (-0.1, 0.75))


def metasheet(m: int, quad=QUAD) -> tuple[Pattern, np.ndarray]:
    """Return a tiling of m x m copies of a quadrilateral and its half-turns, with the class of each crease.

    The copy at (i, j) is turned by a half-turn if i + j is odd; classes are the sides of the quadrilateral.
    """
    q = np.array(quad)
    corners: list[np.ndarray] = []

    def number(x: np.ndarray) -> int:
        for k, y in enumerate(corners):
            if np.abs(x - y).max() < 1e-9:
                return k
        corners.append(x)
        return len(corners) - 1

    quads, sides = [], {}
    for i in range(m):
        for j in range(m):
            x = _copy(q, i, j)
            ring = [number(p) for p in x]
            quads.append(tuple(ring))
            for c in range(4):
                sides[tuple(sorted((ring[c], ring[(c + 1) % 4])))] = c
    pattern = make_pattern(np.array(corners), quads)
    classes = np.array([sides[tuple(sorted(e))] for e in pattern.ends.tolist()])
    return pattern, classes


def _copy(q: np.ndarray, i: int, j: int) -> np.ndarray:
    """Return the corners of the copy at (i, j): half-turns about middles of sides, one after the other."""
    x = q
    for k in range(i):  # about the middle of side 1 of the first, side 3 of the turned one
        side = 1 if k % 2 == 0 else 3
        x = x[side] + x[(side + 1) % 4] - x
    for k in range(j):
        side = 2 if (i + k) % 2 == 0 else 0  # a turned copy has its side 0 above
        x = x[side] + x[(side + 1) % 4] - x
    return x


def scene_pattern(scene: Scene) -> Pattern:
    """Return the sheet with one interior vertex of a scene that lies flat: corner i is the end of crease i."""
    n, a = scene.degree, scene.vertex.azimuths
    corners = np.vstack([[0.0, 0.0], np.column_stack([np.cos(a), np.sin(a)])])
    letters = ["M" if r < 0 else "V" if r > 0 else "U" for r in scene.rest_angles]
    made = make_pattern(
        corners,
        [(0, i, i % n + 1) for i in range(1, n + 1)],
        assignment={(0, i + 1): letter for i, letter in enumerate(letters)},
        numbers={(0, i + 1): i for i in range(n)},
        name=scene.name or "",
    ).with_springs(list(scene.stiffness), list(scene.rest_angles))
    made = made.with_limits(scene.limits) if scene.limits else made
    return made.with_laws(scene.laws) if scene.laws else made
