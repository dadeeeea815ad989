"""The branches of an atlas as paths that can be folded along, with the states at their events."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from origami_nlp.display import (
    Body,
    Content,
    FoldedBody,
    Keyframe,
    Line,
    Panel,
    Poser,
    Section,
    Trajectory,
    join_states,
)
from origami_nlp.paths.family import Family
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.records import PathBranch, PathEvent, PathPoint


def view_branches(
    family: Family,
    branches: Sequence[PathBranch],
    events: Sequence[PathEvent],
    reported: Iterable[Section],
) -> Content:
    """Return the states of all branches, for a page that can be turned.

    Parameters
    ----------
    family, branches, events
        Of an `Atlas`.
    reported
        Its report.

    Returns
    -------
    Content
        A station for each event; a track for each stretch of a branch on which the parameter runs one way, over that
        parameter in its unit, angles in degrees; one panel, the energy over the parameter.
    """
    parameter, stations, poser = family.parameter, [], _Posers(family)
    at: list[tuple[int, float, float]] = []
    for e in events:
        scene = family.scene_of(e.t)
        energy = float(scene.energy(np.array(e.fold_angles)))
        where = parameter.shown(e.t, 9)
        said = [
            e.contact,
            e.note,
            "fold angles [deg]: " + ", ".join(f"{math.degrees(v):.2f}" for v in e.fold_angles),
        ]
        title = f"event {e.id}: {e.type} at {where}"
        shown = poser.folded(e.t, e.fold_angles, energy), poser.view(e.t, e.fold_angles)
        stations.append(Keyframe(title, *shown, lines=tuple(filter(None, said))))
        at.append((len(at), parameter.drawn(e.t), energy))
    tracks = [track for b in branches for track in _tracks(parameter, poser, b)]
    points = [np.stack([t.parameter, [state.energy for state in t.states]], axis=1) for t in tracks]
    none, axes = np.empty(0), (parameter.axis, "energy [J]")
    panel = Panel(f"Energy over {parameter.name}", axes, none, none, None, (), tuple(at))
    steps = "Each step is an equilibrium, polished; on which of them is a minimum, see the title of the path."
    return view_paths(poser.name, poser.body, stations, tracks, points, panel, reported, steps)


def view_paths(
    title: str,
    body: Body,
    stations: Sequence[Keyframe],
    tracks: Sequence[Trajectory],
    points: Sequence[np.ndarray],
    panel: Panel,
    reported: Iterable[Section],
    steps: str,
) -> Content:
    """Return followed states for a page that can be turned.

    Parameters
    ----------
    title, body
        What is folded.
    stations, tracks
        Single states, and paths.
    points
        Of each path on the panel, [m, 2].
    panel
        Without the paths.
    reported
        The report.
    steps
        What each step of a path is.

    Returns
    -------
    Content
        The page.
    """
    lines = tuple(Line(p, t.title, "curve") for p, t in zip(points, tracks, strict=True))
    content = Content(
        title,
        body,
        tuple(stations),
        panels=(replace(panel, lines=lines),),
        pieces=tuple(reported),
        note="" if tracks else "Nothing was followed.",
        steps=steps,
    )
    return content.with_tracks(list(tracks), [list(points)])


class _Posers:
    """What puts the states of a family into space."""

    def __init__(self, family: Family) -> None:
        made, low = family.scene_of, family.parameter.low
        # along springs and loads no vertex moves
        self._at = lru_cache(maxsize=None)(lambda t: Poser(made(low if family.still else t)))
        first: Any = made(low)
        self.body = self._at(low).body
        self.name = first.title

    def folded(self, t: float, phi: Sequence[float], energy: float) -> FoldedBody:
        return self._at(t).folded(phi, energy)

    def view(self, t: float, phi: Sequence[float]) -> np.ndarray:
        return self._at(t).view(phi)

    def track(
        self, title: str, points: Sequence[PathPoint], values: list[float], label: str
    ) -> Trajectory:
        states = [self.folded(p.t, p.fold_angles, p.energy) for p in points]
        middle = points[len(points) // 2]
        return join_states(title, states, self.view(middle.t, middle.fold_angles), values, label)


def _tracks(parameter: ParameterRange, poser: _Posers, branch: PathBranch) -> list[Trajectory]:
    """Return the stretches of a branch on which the parameter runs one way."""
    t = np.array([p.t for p in branch.points])
    steps = np.sign(np.diff(t))
    turns = [k + 1 for k in range(len(steps) - 1) if steps[k] * steps[k + 1] < 0]
    out = []
    for a, b in zip([0, *turns], [*turns, len(t) - 1], strict=True):
        points = branch.points[a : b + 1]
        if b - a < 1 or t[a] == t[b]:
            continue
        kinds = [r.kind for r in branch.kind_ranges if r.points[0] < b and r.points[1] > a]
        ends = " to ".join(parameter.shown(v) for v in (t[a], t[b]))
        title = f"branch {branch.id}, {ends}: {', '.join(dict.fromkeys(kinds))}"
        values = [parameter.drawn(p.t) for p in points]
        out.append(poser.track(title, points, values, parameter.axis))
    return out
