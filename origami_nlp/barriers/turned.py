"""Passes between minima as paths that can be folded along."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.barriers.passes import Pass
from origami_nlp.chart import Landscape
from origami_nlp.minima import points_on
from origami_nlp.pattern import Pattern, Vertex
from origami_nlp.sheets import sheet_poser
from origami_nlp.show import Content, Track, vertex_track

ALONG = "arclength in the fold angles [rad]"


def add_passes(content: Content, chart: Landscape, passes: Sequence[Pass]) -> Content:
    """Add the paths over the passes to the minima of a scene, the lowest pass first.

    Parameters
    ----------
    content
        Of `MinimaResult.turned`.
    chart
        The energy over the scene's coordinates.
    passes
        Of `find_barriers`.

    Returns
    -------
    Content
        With a track for each pair of minima that a path joins.
    """
    joined = [p for p in passes if math.isfinite(p.energy) and len(p.path) > 1]
    tracks = [_track(chart.scene.vertex, p) for p in sorted(joined, key=lambda p: p.energy)]
    note = content.note if content.tracks or tracks else "No admissible path joins two minima."
    return replace(content.with_tracks(tracks, points_on(content, chart, tracks)), note=note)


def add_ways(content: Content, pattern: Pattern, passes: Sequence[Pass]) -> Content:
    """Add the paths over the passes of a pattern to its states, the lowest pass first."""
    _, folded, view = sheet_poser(pattern)
    joined = [p for p in passes if len(p.path) > 1]
    tracks = []
    for p in sorted(joined, key=lambda p: p.energy):
        steps = np.linalg.norm(np.diff(p.path, axis=0), axis=1)
        arc = np.concatenate([[0.0], np.cumsum(steps)])
        states, middle = tuple(folded(phi) for phi in p.path), p.path[len(p.path) // 2]
        ends = {"start": p.from_state - 1, "end": p.to_state - 1}
        tracks.append(Track(_title(p), arc, ALONG, states, view(middle), **ends))
    note = content.note if tracks else "No curve joins two minima."
    return replace(content.with_tracks(tracks, []), note=note)


def _title(p: Pass) -> str:
    return f"{p.from_state} → {p.to_state} over the pass at {p.energy:.6g} J ({p.pass_kind})"


def _track(vertex: Vertex, p: Pass) -> Track:
    start, end = p.from_state - 1, p.to_state - 1
    return vertex_track(vertex, _title(p), p.path, p.path_energy, start=start, end=end)
