"""States of a pattern in which one interior vertex is flat, of least energy, and ways down from them to its minima.

Motions of paper from one side of a vertex to the other pass through such a state (`PopSigns`).  With the vertex flat
the facets round it are one: the states are those of a pattern with fewer creases, which is searched as any other.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import NEAR_SINGULAR_TOL
from origami_nlp.pattern import Pattern, make_pattern
from origami_nlp.pattern_problem import (
    PatternProblem,
    PopSigns,
    find_labels,
    flat_with,
    image,
    least_flat_energy,
)
from origami_nlp.pattern_states.find import find_states
from origami_nlp.pattern_states.terrain import FIRST, NEARLY, PatternTerrain

STARTS = 10
"""Random starts in a row that find nothing new, in the search with a vertex flat."""
SECONDS = 60.0
"""For such a search, of wall time."""
MOST_STATES = 3
"""With a vertex flat, from which ways down are sought: those of least energy."""
MOST_TARGETS = 3
"""Minima on either side of a vertex towards which a way down begins, the nearest ones."""
PLACES = 6
"""Decimals of distances between states that are compared: more are rounding."""
SHARES = np.array([0.25, 0.5, 0.75])
"""Of the first step of a way down, at which it is looked at."""


@dataclass(frozen=True, eq=False, repr=False)
class FlatVertex(ShortRepr):
    """What is known of states in which one vertex is flat.

    Attributes
    ----------
    vertex
        As a file numbers it.
    flat
        Creases that are flat then, of bool [n].
    least
        What the energy is not below, in closed form: `least_flat_energy`.
    states, energies
        Stable ones among them that a search has found, by energy, [S, n] [rad], [S].
    """

    vertex: int
    flat: np.ndarray
    least: float
    states: np.ndarray
    energies: np.ndarray

    @property
    def listed(self) -> float:
        """The least energy of the states that were found; `least` where none was, or a state attains that."""
        return max(float(self.energies[0]), self.least) if len(self.energies) else self.least


def list_flat_vertices(
    pattern: Pattern,
    search: bool = True,
    until: float = math.inf,
    progress: Callable[[str], object] | None = None,
) -> tuple[FlatVertex, ...]:
    """Find the states of least energy with each vertex flat that has a sign, once for vertices that are alike.

    Parameters
    ----------
    pattern
        With its springs; states are searched where its reference state is flat.
    search
        Whether to search for them, or give the bounds in closed form alone.
    until
        Time of `time.monotonic` after which no search begins or goes on.
    progress
        Called with what it is at.

    Returns
    -------
    tuple of FlatVertex
        In the order of `PopSigns.vertices`.

    Examples
    --------
    >>> from origami_nlp.pattern import as_pattern
    >>> from origami_nlp.pattern_states import list_flat_vertices
    >>> (known,) = list_flat_vertices(as_pattern("yoshimura:2x2"))
    >>> round(known.least, 6), round(known.listed, 6)
    (0.37011, 0.372454)
    """
    labels, problem = find_labels(pattern), PatternProblem(pattern)
    symmetries = labels.symmetries(pattern)
    terrain = PatternTerrain(problem, np.zeros((0, pattern.creases)), True, {}, {}, 0)
    found: dict[bytes, FlatVertex] = {}
    out, memo = [], dict[tuple[int, ...], list[int]]()
    signs = PopSigns(pattern)
    for vertex, creases in zip(signs.vertices, signs.around, strict=True):
        if time.monotonic() <= until:
            flat = flat_with(pattern, vertex, memo)
        else:  # those round it, and perhaps others
            flat = np.zeros(pattern.creases, bool)
            flat[list(creases)] = True
        known = found.get(flat.tobytes())
        if known is None:
            left = min(SECONDS, until - time.monotonic())
            if progress is not None:
                progress(f"states with vertex {vertex} flat")
            listed = (
                _states(pattern, flat, left) if search and pattern.lies_flat and left > 0 else ()
            )
            some = sorted(filter(terrain.is_admissible, listed), key=pattern.energy)
            least, states = least_flat_energy(pattern, flat), np.array(some).reshape(-1, len(flat))
            known = FlatVertex(vertex, flat, least, states, np.asarray(pattern.energy(states)))
            for symmetry in ((np.arange(len(flat)), 1.0), *symmetries):
                to = image(symmetry, flat.astype(float)) != 0
                there = FlatVertex(vertex, to, least, image(symmetry, known.states), known.energies)
                found.setdefault(to.tobytes(), there)
        out.append(FlatVertex(vertex, known.flat, known.least, known.states, known.energies))
    return tuple(out)


def _states(pattern: Pattern, flat: np.ndarray, seconds: float) -> np.ndarray:
    """Return stable states of a flat sheet with some creases flat, [S, n]."""
    if flat.all():
        return np.zeros((1, len(flat)))
    if pattern.cell:  # what is joined might reach over its outline
        return np.zeros((0, len(flat)))
    found = find_states(
        _joined(pattern, flat), starts=STARTS, escape=False, seconds=seconds, prove=False
    )
    states = np.zeros((len(found.minima), len(flat)))
    for row, m in zip(states, found.minima, strict=True):
        row[~flat] = m.phi
    return states


def _joined(pattern: Pattern, flat: np.ndarray) -> Pattern:
    """Return a pattern whose creases that are flat, of bool [n], do not fold: facets beside them are one."""
    sides = [(a, b) for a, b in pattern.ends.tolist()]
    kept = [k for k, gone in enumerate(flat) if not gone]

    def of(values: np.ndarray) -> dict[tuple[int, int], Any]:
        return {sides[k]: values[k].tolist() for k in kept}

    return make_pattern(
        pattern.corners,
        pattern.polygons,
        assignment={sides[k]: pattern.assignment[k] for k in kept},
        joins=[
            *(side for side, many in pattern.other_sides.items() if many > 1),
            *(sides[k] for k in np.flatnonzero(flat)),
        ],
        numbers=of(pattern.numbers),
        stiffness=of(pattern.stiffness),
        rest=of(pattern.rest),
        limits=of(pattern.limit_angles.T) if pattern.limits else None,
        name=pattern.name,
    ).with_laws([pattern.laws[k] for k in kept] if pattern.laws else [None] * len(kept))


def flat_tops(
    problem: PatternProblem, flat_vertices: Sequence[FlatVertex]
) -> list[tuple[np.ndarray, list[int]]]:
    """Return states of least energy with a vertex flat, each once, and the flat state: what ways may pass.

    Parameters
    ----------
    problem
        Of the pattern.
    flat_vertices
        Of `list_flat_vertices`.

    Returns
    -------
    list of tuple
        A state [n], and the places in `flat_vertices` of vertices that are flat there.
    """
    tops: list[tuple[np.ndarray, list[int]]] = []
    for vertex, known in enumerate(flat_vertices):
        for x in known.states[:MOST_STATES]:
            same = (at for y, at in tops if np.abs(x - y).max() <= NEAR_SINGULAR_TOL)
            if (at := next(same, None)) is not None:
                at.append(vertex)
            else:
                tops.append((x, [vertex]))
    if problem.pattern.lies_flat and not any(not x.any() for x, _ in tops):
        tops.append((np.zeros(problem.size), list(range(len(flat_vertices)))))
    return tops


def ways_down(
    problem: PatternProblem, minima: np.ndarray, flat_vertices: Sequence[FlatVertex]
) -> Iterator[tuple[int, np.ndarray]]:
    """Go down from states with a vertex flat to minima on either side of it, along states that do not cross.

    Parameters
    ----------
    problem
        Of the pattern.
    minima
        Stable states, [M, n].
    flat_vertices
        Of `list_flat_vertices`.

    Yields
    ------
    tuple
        Number of the minimum (from 0), and closed states from the one with a vertex flat down to it, [S, n].
    """
    terrain = PatternTerrain(problem, minima, True, {}, {}, 0)
    signs = PopSigns(problem.pattern)
    sides = np.sign(signs.sums(minima))
    tops = flat_tops(problem, flat_vertices)
    symmetries, gone = find_labels(problem.pattern).symmetries(problem.pattern), list[np.ndarray]()
    for top, vertices in tops:
        if any(np.abs(top - x).max() <= NEAR_SINGULAR_TOL for x in gone):
            continue
        gone += [top, *(image(symmetry, top) for symmetry in symmetries)]
        here = np.sign(signs.sums(top))
        here[vertices] = 0.0
        others = ((sides != here) & (here != 0)).sum(axis=1)
        far = others * 10 * math.pi + np.linalg.norm(minima - top, axis=1)
        order = np.argsort(np.round(far, PLACES), kind="stable")
        near = [order[sides[order, v] == side][:MOST_TARGETS] for v in vertices for side in (1, -1)]
        for k in dict.fromkeys(np.concatenate(near).tolist()):
            for to, path in _down(terrain, top, minima[k]):
                yield to, path
                for symmetry in symmetries:
                    apart = np.abs(minima - image(symmetry, minima[to])).max(axis=1)
                    if apart.min() <= NEAR_SINGULAR_TOL:
                        yield int(apart.argmin()), image(symmetry, path)


def _down(
    terrain: PatternTerrain, top: np.ndarray, towards: np.ndarray
) -> Iterator[tuple[int, np.ndarray]]:
    """Yield the way down that begins towards a minimum, if it ends at one."""
    open_ = top == 0
    starts = (
        terrain.beside(top, np.where(open_, FIRST * towards, share * top)) for share in NEARLY
    )
    beside = next((x for x in starts if x is not None), None)
    if beside is None:
        return
    first = terrain.between(top, beside, SHARES)
    down = terrain.path_down(beside, lambda _: False)
    if first is None or len(down) < 2:
        return
    apart = np.abs(terrain.minima - down[-1]).max(axis=1)
    k = int(apart.argmin())
    if apart[k] <= NEAR_SINGULAR_TOL:
        yield k, np.concatenate([top[None], first, down[:-1], terrain.minima[k][None]])
