"""Escape barriers of the stable states of a sheet: along traced curves, and by descents out of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from origami_nlp.errors import OutOfTime
from origami_nlp.kkt import (
    ALONE,
    TRACED,
    Escape,
    EscapePath,
    State,
    barriers,
    bounds,
    energy_scale,
    escape_paths,
    level_of,
)
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import (
    INDEPENDENT,
    NEAR_SINGULAR_TOL,
    OUTSIDE,
    SETTLED,
    SHALLOW,
    coarse,
    nearest,
)
from origami_nlp.pattern_problem import PatternProblem, image
from origami_nlp.pattern_states.curves import TracedCurves
from origami_nlp.pattern_states.terrain import PatternTerrain
from origami_nlp.pattern_states.traced_passes import CurvePasses, curve_passes
from origami_nlp.search import variables_around

MOST_CREASES = 60
"""Creases up to which escape paths are sought by descents."""
MOST_DESCENTS, A_STATE = 60, 15
"""Descents in all, and for each state out of which ways are sought."""
MOST_OPENED = 3
"""Directions that open contacts of a state."""
SECTIONS, MOST_CONFIRMED = 3, 3
"""Of `kkt.escape_paths`: a descent takes some ten milliseconds."""


def with_escapes(
    curves: TracedCurves, states: Sequence[JudgedState], contact: bool, most: int
) -> list[JudgedState]:
    """Add what it takes to leave each stable state.

    Parameters
    ----------
    curves
        Of the sheet, those that were traced.
    states
        Judged; ways lead to minima among them, numbered in their order.
    contact
        Whether facets must not cross.
    most
        Descents in all: as many as the search made.

    Returns
    -------
    list of JudgedState
        With `escape` where they are minima.
    """
    minima = [s for s in states if s.verdict == "minimum"]
    if not minima:
        return list(states)
    found = iter(_escapes(curves, minima, contact, most))
    return [replace(s, escape=next(found)) if s.verdict == "minimum" else s for s in states]


def _escapes(
    curves: TracedCurves, minima: Sequence[JudgedState], contact: bool, most: int
) -> list[Escape]:
    problem = curves.problem
    at = np.array([s.phi for s in minima])
    energies = np.array([s.energy for s in minima])
    scale = energy_scale(problem.pattern.stiffness)
    level = level_of(energies, scale)
    traced = curve_passes(problem, curves.found, at)
    heights, sure = (np.full((len(at),) * 2, math.inf) for _ in range(2))
    if traced is not None:
        heights, sure = (t.heights() * problem.scale for t in (traced.passes, traced.sure))
    exact = _exact(problem, minima, traced, sure, level, scale, contact)
    why = ""
    if problem.size > MOST_CREASES:
        why = f"more than {MOST_CREASES} creases: escape paths are not sought"
    loose = [k for k, s in enumerate(minima) if s.local_dimension and k not in exact]
    symmetries = curves.labels.symmetries(problem.pattern)
    images = _images(at, symmetries)
    alone = [k for k in loose if images[k].of == k]
    most = min(most, MOST_DESCENTS)
    many = -(-most // A_STATE)
    last = energies[alone[:many]].max(initial=-math.inf) + level
    sought = [] if why else [k for k in loose if energies[k] <= last]
    ways = {}
    if sought and len(at) > 1:
        out_of = [k for k in sought if k in alone]
        vertices = variables_around(problem, curves.labels)
        around = {k: _apart(vertices, at[k], symmetries) for k in out_of}
        leaving = {
            k: [*_modes(problem, minima[k]), *_openings(problem, at[k], contact)] for k in out_of
        }
        terrain = PatternTerrain(problem, at, contact, leaving, around, most)
        try:
            found = _of_first(escape_paths(terrain, out_of, SECTIONS, MOST_CONFIRMED), images)
            ways = {k: images[k].way(found[images[k].of]) for k in loose if images[k].of in found}
        except OutOfTime:
            why = "interrupted by the time limit"
    reported = exact | {
        k: Escape(math.inf, ALONE, "no other admissible state is near")
        for k, s in enumerate(minima)
        if not s.local_dimension
    }

    def unknown(k: int) -> str:
        if not why and len(at) == 1:
            return "no other state is known that it could be left for"
        if not why and k not in sought:
            return f"sought for the {len(sought)} states of lowest energy"
        return why or "no way that was tried led to a state of lower energy"

    return bounds(energies, ways, heights, scale, reported, unknown, digits=False)


def _exact(
    problem: PatternProblem,
    minima: Sequence[JudgedState],
    traced: CurvePasses | None,
    sure: np.ndarray,
    level: float,
    scale: float,
    contact: bool,
) -> dict[int, Escape]:
    """Return the barriers that curves give exactly: a way that climbs no higher than every way does."""
    if traced is None:
        return {}
    energies = np.array([s.energy for s in minima])
    found = {}
    for k, (barrier, to) in enumerate(barriers(energies, sure, level, scale)):
        if minima[k].dof != 1 or not traced.sure.on_curves[k]:
            continue
        equal = np.flatnonzero(energies <= energies[k] + level).tolist()
        others = [*equal, *([to] if to >= 0 else [])]
        least = traced.least(k, others, level / problem.scale) * problem.scale
        if math.isinf(least):
            if contact:  # samples at which facets cross are no proof that no way leads past
                continue
            why = "its curve leads to no state of no higher energy: it ends at limits"
            found[k] = Escape(math.inf, TRACED, why)
        elif math.isfinite(barrier) and energies[k] + barrier <= least + level:
            why = "the lowest pass of the curves of closed states, both ways"
            top = tuple(traced.sure.top(k, to).tolist())
            found[k] = Escape(barrier, TRACED, why, to + 1, top, barrier < SHALLOW * scale)
    return found


class _Image(NamedTuple):
    """A state that a symmetry of the sheet makes of state `of`; to: what it makes of each, -1 where not listed."""

    of: int
    symmetry: tuple[np.ndarray, float] | None
    to: Sequence[int]

    def way(self, way: EscapePath) -> EscapePath:
        """Return the image of a way."""
        if self.symmetry is None:
            return way
        return EscapePath(
            way.height, image(self.symmetry, way.top), self.to[way.to] if way.to >= 0 else -1
        )

    def back(self, way: EscapePath) -> EscapePath:
        """Return the way whose image this is."""
        if self.symmetry is None:
            return way
        creases, sign = self.symmetry
        to = list(self.to).index(way.to) if way.to in self.to else -1
        return EscapePath(way.height, sign * way.top[creases], to if way.to >= 0 else -1)


def _of_first(ways: Mapping[int, EscapePath], images: Sequence[_Image]) -> dict[int, EscapePath]:
    """Return the lowest way of each state that is no image, among its own and those of its images."""
    out: dict[int, EscapePath] = {}
    for k, way in ways.items():
        first, back = images[k].of, images[k].back(way)
        if first not in out or back.height < out[first].height:
            out[first] = back
    return out


def _images(at: np.ndarray, symmetries: Sequence[tuple[np.ndarray, float]]) -> list[_Image]:
    """Return for each state [M, n] the first one of which it is an image: escape paths are sought of that alone."""
    found: dict[int, _Image] = {}
    listed = []
    for symmetry in symmetries:
        apart = np.array([np.abs(x - at).max(axis=1) for x in image(symmetry, at)])
        to = np.where(apart.min(axis=1) <= NEAR_SINGULAR_TOL, apart.argmin(axis=1), -1)
        listed.append((symmetry, to.tolist()))
    for k in range(len(at)):
        if k in found:
            continue
        found[k] = _Image(k, None, ())
        for symmetry, to in listed:
            if to[k] >= 0:
                found.setdefault(to[k], _Image(k, symmetry, to))
    return [found[k] for k in range(len(at))]


def _apart(
    vertices: Sequence[list[int]], x: np.ndarray, symmetries: Sequence[tuple[np.ndarray, float]]
) -> list[list[int]]:
    """Return creases round vertices without those that a symmetry of a state [n] makes of others."""
    kept, seen = [], set()
    own = [s for s in symmetries if np.abs(image(s, x) - x).max() <= NEAR_SINGULAR_TOL]
    for creases in vertices:
        if frozenset(creases) not in seen:
            kept.append(creases)
            seen |= {frozenset(to[creases].tolist()) for to, _ in own}
    return kept


def _openings(problem: PatternProblem, phi: np.ndarray, contact: bool) -> list[np.ndarray]:
    """Return directions that open contacts of a state as fast as closure lets them, and close none: all, and each.

    Of single ones those that cost least, where several are alike all of them.
    """
    state = State(problem.with_contact(contact), phi)
    if not (closed := state.contacts.base):
        return []
    z = state.kernel
    slopes = state.on(closed).slopes @ z
    lengths = np.linalg.norm(slopes, axis=1)
    free = lengths > INDEPENDENT
    slopes = slopes[free] / lengths[free, None]
    ways = (nearest(way, slopes, np.zeros(len(slopes))) for way in (slopes.sum(axis=0), *slopes))
    out = [z @ y for y in ways if y is not None and np.abs(y).max(initial=0.0) > SETTLED]
    out = [coarse(d / np.linalg.norm(d)) for d in out]
    costs = np.round([float(problem.torque(phi) @ d) for d in out[1:]], 6)
    return [*out[:1], *(d for d, c in zip(out[1:], costs, strict=True) if c == costs.min())][
        :MOST_OPENED
    ]


def _modes(problem: PatternProblem, state: JudgedState) -> list[np.ndarray]:
    """Return the softest motions of a state that closure allows, fully folded creases held, where they are single."""
    phi = state.phi
    at_limit = np.flatnonzero(problem.fold_limits.room(phi) <= OUTSIDE)
    z = problem.kernel(phi, at_limit)
    lam, _, _ = problem.multipliers(phi, at_limit)
    values, vectors = np.linalg.eigh(z.T @ (problem.hessian(phi, lam) @ z))
    if not len(values) or (len(values) > 1 and values[1] - values[0] <= SETTLED):
        return []
    mode = coarse(z @ vectors[:, 0])
    return [mode, -mode]
