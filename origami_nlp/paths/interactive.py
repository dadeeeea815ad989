"""A path as states that can be turned: its curves with a slider over the parameter, events and snaps by themselves."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from origami_nlp.display import Content, Keyframe, Poser, Trajectory, join_states
from origami_nlp.paths.records import PathPoint
from origami_nlp.paths.result import Atlas, Path

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
        Stations: events.  Tracks: each stretch of a curve on which the parameter runs one
        way.
    """
    over, tracks = path.parameter, list[Trajectory]()
    # along springs and loads no vertex moves
    still = not isinstance(path, Atlas) or path.family.still
    posed = lru_cache(maxsize=None)(lambda t: Poser(path.origami_at(over.low if still else t)))

    def folded(p: PathPoint) -> Any:
        return posed(p.t).folded(p.fold_angles, p.energy)

    def view(p: PathPoint) -> Any:
        return posed(p.t).view(p.fold_angles)

    stations = list[Keyframe]()
    for e in path.events:
        p, title = path.point_of(e), f"event {e.id}: {e.words()} at {over.shown(e.t, 9)}"
        stations.append(Keyframe(title, folded(p), view(p), lines=(e.note,) * bool(e.note)))
    for curve in path.curves:
        t = np.array([p.t for p in curve.points])
        steps = np.sign(np.diff(t))
        turns = (np.flatnonzero(steps[1:] * steps[:-1] < 0) + 1).tolist()
        for a, b in zip([0, *turns], [*turns, len(t) - 1], strict=True):
            if t[a] != t[b]:
                points = curve.points[a : b + 1]
                ends = f"{over.shown(t[a])} to {over.shown(t[b])}"
                title = f"{curve.word} {curve.id}, {ends}: {curve.kind}"
                drawn = [over.drawn(v) for v in t[a : b + 1]]
                states, middle = [folded(p) for p in points], points[len(points) // 2]
                tracks.append(join_states(title, states, view(middle), drawn, over.axis))
    body = posed(over.low).body
    shown = tuple(stations), tuple(tracks), tuple(path.report_sections()), STEPS
    return Content(path.origami_at(over.low).title, body, *shown)
