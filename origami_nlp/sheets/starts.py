"""Where a search for states of a sheet starts: what the pattern gives, random numbers, vertices popped, planes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product

import numpy as np

from origami_nlp.facets import Labels, Sheet, round_vertex
from origami_nlp.minima import find_minima
from origami_nlp.numerics import CLOSES, RESOLVED, SAME, nearest
from origami_nlp.pattern import Contact, Pattern, Scene
from origami_nlp.sheets.curve import SHUT

POPPED = (1.0, -1.0), (1.0, -0.3), (0.3, -1.0), (0.3, -0.3)
"""Where a vertex is popped: what all folds are multiplied by, and those round it besides."""


def close(sheet: Sheet, start: np.ndarray) -> np.ndarray | None:
    """Close a start within the fold limits, creases that are shut left so if they can be; None where it is not."""
    start = np.clip(start, -math.pi, math.pi)
    shut = np.abs(start) == math.pi
    for held in (shut, None) if shut.any() else (None,):
        phi, residual = sheet.project(start, held)
        within = np.abs(phi).max(initial=0.0) <= math.pi + SHUT
        phi = np.clip(phi, -math.pi, math.pi)
        if residual <= CLOSES and within and sheet.closure.on_sheet(phi):
            return phi
    return None


def given(pattern: Pattern) -> Iterator[np.ndarray]:
    """Yield fold angles [n] that the pattern itself gives."""
    if not np.isnan(pattern.file_angles).any():
        yield pattern.file_angles
    if pattern.reference.any():
        yield pattern.reference
    if pattern.signs.any():
        yield from (0.4 * pattern.signs, 1.0 * pattern.signs)
    if pattern.rest.any():
        yield from (0.3 * pattern.rest, pattern.rest)


def scene_of(pattern: Pattern, contact: bool) -> tuple[Scene | None, list[int]]:
    """Return the scene of a pattern's only vertex and its creases in order; None where there are more creases."""
    (loop,) = pattern.vertices
    vertex, creases = round_vertex(pattern, loop), list(loop.creases)
    if vertex is None or len(creases) < pattern.creases:
        return None, creases
    stiffness, rest = (tuple(x[creases].tolist()) for x in (pattern.stiffness, pattern.rest))
    kind: Contact = "full" if contact else "fold-limits"
    return Scene(vertex, stiffness, rest, "none", kind), creases


def of_vertex(
    pattern: Pattern, contact: bool, seed: int, seconds: float
) -> tuple[list[np.ndarray], bool]:
    """Return the minima that the search for single vertices finds, [n] each, and whether it came to its end."""
    scene, creases = scene_of(pattern, contact)
    if scene is None:
        return [], True
    result = find_minima(scene, seed=seed, prove=False, escape=False, seconds=seconds)
    states = np.zeros((len(result.minima), pattern.creases))
    for phi, found in zip(states, result.minima, strict=True):
        phi[creases] = found.fold_angles
    return list(states), result.search.stopped_by != "time"


def drawn(sheet: Sheet, labels: Labels, rng: np.random.Generator, k: int) -> np.ndarray:
    """Draw the k-th random start, [n]: grown out of the flat state, any, or with some creases shut, in turn."""
    n = sheet.size
    if k % 3 == 0 and sheet.pattern.is_flat:
        return _grown(sheet, labels, rng)
    size = rng.uniform(0.3, math.pi)
    start = rng.uniform(-size, size, n)
    if k % 3 == 2:  # which is kept as long as their springs push
        shut = rng.permutation(n)[: int(rng.integers(1, max(2, n // 2)))]
        start[shut] = rng.choice([-math.pi, math.pi], len(shut))
    return labels.drawn(start)


def _grown(sheet: Sheet, labels: Labels, rng: np.random.Generator) -> np.ndarray:
    """Grow a state out of the flat one by steps along what closure leaves free."""
    n = sheet.size
    phi, residual = sheet.project(labels.drawn(rng.uniform(-0.3, 0.3, n)))
    way = phi
    for _ in range(int(rng.integers(0, 8))):
        aside = labels.drawn(rng.normal(size=n))
        way = sheet.along(phi, way + 0.5 * aside * np.abs(way).max())
        size = float(np.abs(way).max())
        if residual > CLOSES or size < RESOLVED:
            break
        new, residual = sheet.project(phi + 0.3 * way / size)
        if residual > CLOSES or np.abs(new).max() > math.pi or not sheet.closure.on_sheet(new):
            break
        phi = new
    return phi


def creases_around(pattern: Pattern, labels: Labels) -> list[list[int]]:
    """Return the creases round each vertex, in an order of vertices that labels do not change."""
    rank = np.argsort(labels.order)
    around = [list(loop.creases) for loop in pattern.vertices]
    return sorted(around, key=lambda creases: sorted(rank[creases].tolist()))


def popped_starts(pattern: Pattern, labels: Labels, phi: np.ndarray) -> Iterator[np.ndarray]:
    """Yield a state [n] with each vertex popped that is not flat, in an order that labels do not change."""
    for creases, (size, share) in product(creases_around(pattern, labels), POPPED):
        if phi[creases].any():
            start = size * phi
            start[creases] *= share
            yield start


def lowest_on(sheet: Sheet, phi: np.ndarray, basis: np.ndarray) -> np.ndarray | None:
    """Return the state of lowest energy on a plane of closed states phi + basis y, within the fold limits."""
    root = np.sqrt(sheet.stiffness)[:, None]
    _, r = np.linalg.qr(root * basis)  # energy = |r y - r y0|^2 / 2 and what stays
    y0 = np.linalg.lstsq(root * basis, root[:, 0] * (sheet.pattern.rest - phi), rcond=None)[0]
    rows = np.linalg.solve(r.T, np.vstack([basis, -basis]).T).T
    y = nearest(r @ y0, rows, np.concatenate([-math.pi - phi, phi - math.pi]))
    if y is None:
        return None
    state = phi + basis @ np.linalg.solve(r, y)
    shut = math.pi - np.abs(state) < 10 * SAME
    state[shut] = np.copysign(math.pi, state[shut])
    state[np.abs(state) < 10 * SAME] = 0.0
    return close(sheet, state)
