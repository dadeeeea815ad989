"""A path as states that can be turned: its curves with a slider over the parameter, events and snaps by themselves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from origami_nlp.display import Content, Keyframe, Line, Panel, Poser, Trajectory, join_states
from origami_nlp.paths.records import PathPoint
from origami_nlp.paths.result import Path, Track, degrees_listed

STEPS = "Each step is an equilibrium, polished; on which of them is a minimum, see the title of the path."


def view_path(path: Path) -> Content:
    """Return the states of a path, for a page that can be turned.

    Parameters
    ----------
    path
        Of `follow` or `load_path`.

    Returns
    -------
    Content
        Stations: events, and the states after snaps.  Tracks: each stretch of a curve on which the parameter runs one
        way.  Panels: those of the figure.
    """
    # along springs and loads no vertex moves
    still = getattr(getattr(path, "family", None), "still", True)
    first = path.origami_at(path.parameter.low)
    poser = lru_cache(maxsize=None)(lambda t: Poser(first if still else path.origami_at(t)))
    marks = path.stations
    stations = []
    for m in marks:
        angles = f"fold angles [deg]: {degrees_listed(m.point.fold_angles)}"
        lines = tuple(filter(None, (m.note, angles)))
        folded, view = _folded(poser, m.point), _view(poser, m.point)
        stations.append(Keyframe(m.title, folded, view, lines=lines))
    tracks: list[Trajectory] = []
    along: list[Sequence[PathPoint]] = []
    for title, points in (run for curve in path.curves for run in _one_way(path, curve)):
        states = [_folded(poser, p) for p in points]
        view = _view(poser, points[len(points) // 2])
        t = [path.parameter.drawn(p.t) for p in points]
        tracks.append(join_states(title, states, view, t, path.parameter.axis))
        along.append(points)
    none, panels, shown = np.empty(0), [], list(zip(along, tracks, strict=True))
    for p in path.panels:
        places = p.values([m.point for m in marks]).tolist()
        at = tuple((k, x, y) for k, (x, y) in enumerate(places) if math.isfinite(y))
        drawn = tuple(Line(p.values(points), track.title, "curve") for points, track in shown)
        panels.append(Panel(f"{p.y} over {p.x}", (p.x, p.y), none, none, None, drawn, at))
    note, pieces = "" if tracks else "Nothing was followed.", tuple(path.report_sections())
    content = Content(
        first.title, poser(path.parameter.low).body, tuple(stations), panels=tuple(panels),
        pieces=pieces, note=note, steps=STEPS,
    )  # fmt: skip
    return content.with_tracks(
        tracks, [[p.values(points) for points in along] for p in path.panels]
    )


def _folded(poser: Any, p: PathPoint) -> Any:
    return poser(p.t).folded(p.fold_angles, p.energy)


def _view(poser: Any, p: PathPoint) -> np.ndarray:
    view: np.ndarray = poser(p.t).view(p.fold_angles)
    return view


def _one_way(path: Path, curve: Track) -> list[tuple[str, Sequence[PathPoint]]]:
    """Return the stretches of a curve on which the parameter runs one way, with their titles."""
    t = np.array([p.t for p in curve.points])
    steps = np.sign(np.diff(t))
    turns = [k + 1 for k in range(len(steps) - 1) if steps[k] * steps[k + 1] < 0]
    out = []
    for a, b in zip([0, *turns], [*turns, len(t) - 1], strict=True):
        if b - a < 1 or t[a] == t[b]:
            continue
        ends = " to ".join(path.parameter.shown(v) for v in (t[a], t[b]))
        kinds = ", ".join(dict.fromkeys(curve.kinds[a : b + 1]))
        out.append((f"{curve.word} {curve.id}, {ends}: {kinds}", curve.points[a : b + 1]))
    return out
