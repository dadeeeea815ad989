"""Passes between minima as paths that can be folded along."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from origami_nlp.chart import Landscape, landscape
from origami_nlp.minima import CELLS, points_on, turn_minima
from origami_nlp.show import Content, Track, vertex_track

if TYPE_CHECKING:
    from origami_nlp.barriers.passes import Pass
    from origami_nlp.barriers.result import Barriers


def turn_barriers(found: Barriers) -> Content:
    """Return the minima of a scene with the path over each pass, for a page that can be turned.

    Parameters
    ----------
    found
        Of `find_barriers`.

    Returns
    -------
    Content
        As `minima.turn_minima` has it, with a track for each pair of minima that a path joins.
    """
    chart = landscape(found.scene, CELLS)
    content = add_passes(turn_minima(found.result, chart), chart, found)
    return replace(content, pieces=(*found.told(), *content.pieces))


def add_passes(content: Content, chart: Landscape, found: Barriers) -> Content:
    """Add the paths over the passes to the minima of a scene, the lowest pass first.

    Parameters
    ----------
    content
        Of `minima.turn_minima`.
    chart
        The energy over the scene's coordinates.
    found
        Of `find_barriers`.

    Returns
    -------
    Content
        With them.
    """
    joined = [p for p in found.passes if math.isfinite(p.energy) and len(p.path) > 1]
    tracks = [_track(found, p) for p in sorted(joined, key=lambda p: p.energy)]
    note = content.note if content.tracks or tracks else "No admissible path joins two minima."
    return replace(content.with_tracks(tracks, points_on(content, chart, tracks)), note=note)


def _track(found: Barriers, p: Pass) -> Track:
    title = f"{p.from_state} → {p.to_state} over the pass at {p.energy:.6g} J ({p.pass_kind})"
    ends = {"start": p.from_state - 1, "end": p.to_state - 1}
    return vertex_track(found.scene.vertex, title, p.path, p.path_energy, **ends)
