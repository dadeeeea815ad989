"""The branches of an atlas as paths that can be folded along, with the states at their events."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.atlas.family import Family
from origami_nlp.atlas.records import PathBranch, PathEvent
from origami_nlp.pattern import Vertex
from origami_nlp.show import (
    Body,
    Content,
    Line,
    Panel,
    Piece,
    Station,
    Track,
    vertex_body,
    vertex_folded,
    vertex_track,
    vertex_view,
)


def turn_branches(
    family: Family,
    branches: Sequence[PathBranch],
    events: Sequence[PathEvent],
    told: Iterable[Piece],
) -> Content:
    """Return the states of all branches, for a page that can be turned.

    Parameters
    ----------
    family, branches, events
        Of an `Atlas`.
    told
        Its report.

    Returns
    -------
    Content
        A station for each event; a track for each stretch of a branch on which the parameter runs one way, over that
        parameter in its unit, angles in degrees; one panel, the energy over the parameter.
    """
    over, stations = family.over, []
    at: list[tuple[int, float, float]] = []
    for e in events:
        scene = family.scene_of(e.t)
        energy = float(scene.energy(e.fold_angles))
        where = over.shown(e.t, 9)
        said = [
            e.contact,
            e.note,
            "fold angles [deg]: " + ", ".join(f"{math.degrees(v):.2f}" for v in e.fold_angles),
        ]
        folded = vertex_folded(scene.vertex, e.fold_angles, energy)
        view = vertex_view(scene.vertex, e.fold_angles)
        title = f"event {e.id}: {e.type} at {where}"
        stations.append(Station(title, folded, view, lines=tuple(filter(None, said))))
        at.append((len(at), over.drawn(e.t), energy))
    tracks = [track for b in branches for track in _tracks(family, b)]
    points = [np.stack([t.parameter, [state.energy for state in t.states]], axis=1) for t in tracks]
    none = np.empty(0)
    panel = Panel(
        f"Energy over {over.name}", (over.axis, "energy [J]"), none, none, None, (), tuple(at)
    )
    steps = "Each step is an equilibrium, polished; on which of them is a minimum, see the title of the path."
    first = family.scene_of(over.low)
    name, body = first.label or repr(first.vertex), vertex_body(first.vertex)
    return turn_paths(name, body, stations, tracks, points, panel, told, steps)


def turn_paths(
    title: str,
    body: Body,
    stations: Sequence[Station],
    tracks: Sequence[Track],
    points: Sequence[np.ndarray],
    panel: Panel,
    told: Iterable[Piece],
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
    told
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
        pieces=tuple(told),
        note="" if tracks else "Nothing was followed.",
        steps=steps,
    )
    return content.with_tracks(list(tracks), [list(points)])


def _tracks(family: Family, branch: PathBranch) -> list[Track]:
    """Return the stretches of a branch on which the parameter runs one way."""
    over, t = family.over, np.array([p.t for p in branch.points])
    steps = np.sign(np.diff(t))
    turns = [k + 1 for k in range(len(steps) - 1) if steps[k] * steps[k + 1] < 0]
    out = []
    vertices: dict[float, Vertex] = {}
    for a, b in zip([0, *turns], [*turns, len(t) - 1], strict=True):
        points = branch.points[a : b + 1]
        if b - a < 1 or t[a] == t[b]:
            continue
        for p in points:
            if p.t not in vertices:
                vertices[p.t] = family.scene_of(p.t).vertex
        kinds = [r.kind for r in branch.kind_ranges if r.points[0] < b and r.points[1] > a]
        ends = " to ".join(over.shown(v) for v in (t[a], t[b]))
        title = f"branch {branch.id}, {ends}: {', '.join(dict.fromkeys(kinds))}"
        out.append(
            vertex_track(
                [vertices[p.t] for p in points],
                title,
                [p.fold_angles for p in points],
                [p.energy for p in points],
                parameter=[over.drawn(p.t) for p in points],
                label=over.axis,
            )
        )
    return out
