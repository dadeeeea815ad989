"""Minima as states that can be turned: contacts marked, descents of unstable states and traced curves as paths."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from origami_nlp.display import Content, Keyframe, Mark, Poser, Trajectory
from origami_nlp.errors import OptionError
from origami_nlp.kkt import ContactForce
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.report_lines import MOST_ANGLES, letter, state_lines
from origami_nlp.minima.result import MinimaResult

CROSSING = {
    "full": "no facets of it cross",
    "fold-limits": "neighbouring facets do not cross, others may (contact fold-limits)",
    "none": "facets may cross (contact none)",
}
"""What is known of the states on a path, by the contact that was asked for."""


def view_minima(result: MinimaResult) -> Content:
    """Return minima, and what becomes of the unstable ones, for a page that can be turned.

    Parameters
    ----------
    result
        Of `find_minima`.

    Returns
    -------
    Content
        A station for each minimum, in order; a track for each descent, and for the stretches of traced curves on which
        facets do not cross.

    Raises
    ------
    OptionError
        If there is no minimum.
    """
    minima, poser = result.minima, Poser(result.origami)
    if not minima:
        raise OptionError("no stable state was found: there is nothing to turn")
    stations = tuple(
        Keyframe(
            m.title(k).removeprefix("state "),
            poser.folded(m.fold_angles, m.energy),
            poser.view(m.fold_angles),
            *_contacts_and_lines(result.model, m),
        )
        for k, m in enumerate(minima, start=1)
    )
    tracks = (*_descents(result, poser), *_curves(result, poser))
    steps = f"Each step is a stored state that closes; {CROSSING[result.search.contact]}."
    pieces = tuple(result.report_sections())
    return Content(result.title, poser.body, stations, tracks, pieces, steps=steps)


def _contacts_and_lines(model: Any, m: JudgedState) -> tuple[tuple[Mark, ...], tuple[str, ...]]:
    """Return the marks of a state's contacts, and what is known of it."""
    few = len(m.fold_angles) <= MOST_ANGLES
    marks = [_mark(model, letter(k), c) for k, c in enumerate(m.contacts) if few or not c.is_limit]
    angles = ", ".join(f"{a:.3f}" for a in np.round(np.degrees(m.fold_angles), 3) + 0.0)
    lines = (f"fold angles [deg]: {angles}",) * few
    return tuple(marks), (*lines, *state_lines(m))


def _mark(model: Any, letter: str, contact: ContactForce) -> Mark:
    low, high = contact.multiplier_range
    moment = f"{contact.multiplier:.3g} N m"
    if not contact.unique:
        moment = f"{low:.3g} to {high:.3g} N m" if math.isfinite(high) else f"≥ {low:.3g} N m"
    facets = {f - 1 for f in contact.facets}
    for image in model.orbits.images if model.orbits else ():  # under the symmetry of a vertex
        facets |= {int(image.facets[f - 1]) for f in contact.facets}
    pieces = tuple(k for k, f in enumerate(model.crossings.facet.tolist()) if f in facets)
    at = tuple(c - 1 for c in contact.creases), pieces
    return Mark(f"{letter} {moment}", high > 0, *at)


def _descents(result: MinimaResult, poser: Poser) -> Iterator[Trajectory]:
    """Yield the stored descent of each unstable state."""
    for k, m in enumerate(result.minima):
        if m.full_space is not None and m.full_space.descent is not None:
            steps, lands = m.full_space.descent, m.full_space.lands_on
            end = lands.symmetric if lands else None
            where = f"state {end}" if end else "an asymmetric state" if lands else "a lower state"
            title = f"{k + 1} → {where}: descent without the symmetry"
            angles, energies = [s.fold_angles for s in steps], [s.energy for s in steps]
            yield poser.track(title, angles, energies, start=k)


def _curves(result: MinimaResult, poser: Poser) -> Iterator[Trajectory]:
    """Yield the stretches of traced curves on which facets do not cross."""
    for number, traced in enumerate(result.curves[:8], start=1):
        seen = traced.stretches
        states = traced.curve.states if seen is None else seen.states
        good = np.ones(len(states), bool) if seen is None else ~seen.crosses
        edges = np.flatnonzero(np.diff([False, *good, False]))
        for a, b in edges.reshape(-1, 2).tolist():
            if b - a > 2:
                x = states[a:b]
                phi, energies = result.model.expand(x), result.model.energies(x)
                yield poser.track(f"curve {number} of closed states", phi, energies)
