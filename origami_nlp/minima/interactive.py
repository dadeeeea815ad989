"""Minima as states that can be turned: contacts marked, descents of unstable states as paths, the energy as a map."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from origami_nlp.chart import Landscape, chart_of, landscape
from origami_nlp.display import Content, Keyframe, Line, Mark, Panel, Poser, Trajectory
from origami_nlp.errors import OptionError
from origami_nlp.kkt import ContactForce
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.report_lines import MOST_ANGLES, letter, state_lines
from origami_nlp.minima.result import MinimaResult
from origami_nlp.numerics import SETTLED
from origami_nlp.pattern import Pattern

CELLS = 161
"""Cells along each coordinate of the map."""
CROSSING = {
    "full": "no facets of it cross",
    "fold-limits": "neighbouring facets do not cross, others may (contact fold-limits)",
    "none": "facets may cross (contact none)",
}
"""What is known of the states on a path, by the contact of the scene."""


def view_minima(result: MinimaResult, chart: Landscape | None = None) -> Content:
    """Return minima, what becomes of the unstable ones, and the map of the energy, for a page that can be turned.

    Parameters
    ----------
    result
        Of `find_minima`.
    chart
        The energy over a scene's coordinates, if it is known already.

    Returns
    -------
    Content
        A station for each minimum, in order; of a vertex a track for each descent, and for each curve of a scene with
        one degree of freedom.

    Raises
    ------
    OptionError
        If a pattern has no minimum.
    """
    origami, minima, poser = result.origami, result.minima, Poser(result.origami)
    stations = tuple(
        Keyframe(
            m.title(k).removeprefix("state "),
            poser.folded(m.fold_angles, m.energy),
            poser.view(m.fold_angles),
            *_contacts_and_lines(result.model, m),
        )
        for k, m in enumerate(minima, start=1)
    )
    pieces = tuple(result.report_sections())
    content = Content(result.title, poser.body, stations, pieces=pieces)
    if isinstance(origami, Pattern):
        if not minima:
            raise OptionError("no stable state was found: there is nothing to turn")
        return content
    chart = chart or landscape(origami, CELLS)
    steps = f"Each step is a stored state that closes; {CROSSING[origami.contact]}."
    content = replace(content, panels=tuple(_panels(chart, minima)), steps=steps)
    tracks = [*_descents(poser, minima), *_curves(poser, chart)]
    if not tracks:
        why = "No path is stored"
        if not origami.group.is_trivial:
            why += ": no descent from any state was found"
            if not any(m.full_space for m in minima):
                why = "No path is stored; --full follows unstable states down when the symmetry breaks"
        return replace(content, note=f"{why}.")
    return content.with_tracks(tracks, points_on(content, chart, tracks))


def points_on(
    content: Content, chart: Landscape, tracks: Sequence[Trajectory]
) -> list[list[np.ndarray]]:
    """Return where the states of paths lie on each panel of a scene's map.

    Parameters
    ----------
    content
        With the panels of `view_minima`.
    chart
        The energy over the coordinates of the scene.
    tracks
        Paths of its states.

    Returns
    -------
    list of list of numpy.ndarray
        For each panel, for each path, points [M, 2]; nan where a state is not symmetric, or not on that panel.
    """
    return [
        [_points(chart, k, np.array([s.fold_angles for s in t.states]), t) for t in tracks]
        for k in range(len(content.panels))
    ]


def images(model: Any, contact: ContactForce) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the creases and facets (1-based) of a contact with all its images under the symmetry of a vertex."""
    facets = set(contact.facets)
    for image in model.orbits.images if model.orbits else ():
        facets |= {int(image.facets[f - 1]) + 1 for f in contact.facets}
    pieces = enumerate(model.crossings.facet.tolist(), start=1)
    return contact.creases, tuple(k for k, f in pieces if f + 1 in facets)


def _contacts_and_lines(model: Any, m: JudgedState) -> tuple[tuple[Mark, ...], tuple[str, ...]]:
    """Return the marks of a state's contacts, and what is known of it."""
    few = len(m.fold_angles) <= MOST_ANGLES
    marks = [_mark(model, letter(k), c) for k, c in enumerate(m.contacts) if few or not c.is_limit]
    angles = ", ".join(f"{a:.3f}" for a in np.round(np.degrees(m.fold_angles), 3) + 0.0)
    lines = (f"fold angles [deg]: {angles}",) * few
    return tuple(marks), (*lines, *state_lines(m))


def _mark(model: Any, letter: str, contact: ContactForce) -> Mark:
    creases, facets = images(model, contact)
    low, high = contact.multiplier_range
    moment = f"{contact.multiplier:.3g} N m"
    if not contact.unique:
        moment = f"{low:.3g} to {high:.3g} N m" if math.isfinite(high) else f"≥ {low:.3g} N m"
    at = (tuple(c - 1 for c in creases), tuple(f - 1 for f in facets))
    return Mark(f"{letter} {moment}", f"contact {letter}: {contact.words()}", high > 0, *at)


def _descents(poser: Poser, minima: Sequence[JudgedState]) -> list[Trajectory]:
    """Return the stored descent of each unstable state."""
    found = []
    for k, m in enumerate(minima):
        if m.full_space is None or m.full_space.descent is None:
            continue
        steps, lands = m.full_space.descent, m.full_space.lands_on
        end = lands.symmetric if lands else None
        where = f"state {end}" if end else "an asymmetric state" if lands else "a lower state"
        title = f"{k + 1} → {where}: descent without the symmetry"
        angles, energies = [s.fold_angles for s in steps], [s.energy for s in steps]
        last = end - 1 if end else None
        found.append(poser.track(title, angles, energies, start=k, end=last))
    return found


def _curves(poser: Poser, chart: Landscape) -> list[Trajectory]:
    """Return each admissible stretch of the curves of a scene with one degree of freedom."""
    if chart.kind != "curve":
        return []
    found = []
    for branch in chart.branches:
        good = np.isfinite(branch.energy)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(int)))
        for a, b in edges.reshape(-1, 2).tolist():
            if b - a > 2:
                title = " ".join(filter(None, ("all states of", branch.name or "the curve")))
                states, energies = branch.fold_angles[a:b], branch.energy[a:b]
                found.append(poser.track(title, states, energies))
    return found


# ---------------------------------------------------------------- the map


def _panels(chart: Landscape, minima: Sequence[JudgedState]) -> list[Panel]:
    if chart.kind == "none":
        return []
    places = [chart.place(m.fold_angles, m.winding) for m in minima]
    if chart.kind == "curve":
        lines = tuple(
            Line(np.stack([b.axes[0], b.energy], axis=1), b.name or "states", "curve")
            for b in chart.branches
        )
        at = tuple((k, *p.point) for k, p in enumerate(places) if p.drawn)
        labels = (axis_words(chart.coordinates[0]), "energy [J]")
        none = np.empty(0)
        return [Panel("Energy of the closed states", labels, none, none, None, lines, at)]
    names = (axis_words(chart.coordinates[0]), axis_words(chart.coordinates[1]))
    return [
        Panel(
            ", ".join(filter(None, ("Energy of the symmetric states", branch.name))),
            names,
            branch.axes[0],
            branch.axes[1],
            branch.energy,
            (),
            tuple((n, *p.point) for n, p in enumerate(places) if p.branch == k and p.drawn),
        )
        for k, branch in enumerate(chart.branches)
    ]


def axis_words(name: str) -> str:
    """Return the name of a chart's coordinate for an axis without formulas."""
    return name.replace("phi_", "φ") + " [rad]"


def _points(chart: Landscape, branch: int, phi: np.ndarray, track: Trajectory) -> np.ndarray:
    out = np.full((len(phi), 2), np.nan)
    orbit = np.asarray(chart.scene.group.orbit)
    first = [int(np.argmax(orbit == k)) for k in orbit]
    symmetric = np.abs(phi[:, first] - phi).max(axis=1) <= SETTLED
    if chart.kind == "curve":
        crease = int(chart.coordinates[0].removeprefix("phi_")) - 1
        energy = np.array([state.energy for state in track.states])
        return np.where(symmetric[:, None], np.stack([phi[:, crease], energy], axis=1), np.nan)
    exact = chart_of(chart.scene)
    if exact is not None:
        own, sure = exact.branch_of(phi)
        on = symmetric & ((own == branch) | (sure <= SETTLED))
        out[on] = exact.points(phi[on])
    return out
