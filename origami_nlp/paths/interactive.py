"""A path as states that can be turned: its curves with a slider over the parameter, events and snaps by themselves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from origami_nlp.display import Content, Keyframe, Poser, Trajectory, join_states
from origami_nlp.paths.atlas import Atlas
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
        way.
    """
    over, marks = path.parameter, path.stations
    # along springs and loads no vertex moves
    still = not isinstance(path, Atlas) or path.family.still
    posed = lru_cache(maxsize=None)(lambda t: Poser(path.origami_at(t)))

    def poser(p: PathPoint) -> Any:
        return posed(over.low if still else p.t)

    def folded(p: PathPoint) -> Any:
        return poser(p).folded(p.fold_angles, p.energy)

    stations, tracks = [], list[Trajectory]()
    for m in marks:
        angles = f"fold angles [deg]: {degrees_listed(m.point.fold_angles)}"
        lines = tuple(filter(None, (m.note, angles)))
        view = poser(m.point).view(m.point.fold_angles)
        stations.append(Keyframe(m.title, folded(m.point), view, lines=lines))
    for title, points in (run for curve in path.curves for run in _one_way(path, curve)):
        middle = points[len(points) // 2]
        view, t = poser(middle).view(middle.fold_angles), [over.drawn(p.t) for p in points]
        tracks.append(join_states(title, [folded(p) for p in points], view, t, over.axis))
    note = "" if tracks else "Nothing was followed."
    shown = tuple(stations), tuple(tracks), tuple(path.report_sections()), note, STEPS
    return Content(path.origami_at(over.low).title, posed(over.low).body, *shown)


def _one_way(path: Path, curve: Track) -> Iterator[tuple[str, Sequence[PathPoint]]]:
    """Yield the stretches of a curve on which the parameter runs one way, with their titles."""
    t = np.array([p.t for p in curve.points])
    steps = np.sign(np.diff(t))
    turns = [k + 1 for k in range(len(steps) - 1) if steps[k] * steps[k + 1] < 0]
    for a, b in zip([0, *turns], [*turns, len(t) - 1], strict=True):
        if a < b and t[a] != t[b]:
            ends = " to ".join(path.parameter.shown(v) for v in (t[a], t[b]))
            kinds = ", ".join(dict.fromkeys(curve.kinds[a : b + 1]))
            yield f"{curve.word} {curve.id}, {ends}: {kinds}", curve.points[a : b + 1]
