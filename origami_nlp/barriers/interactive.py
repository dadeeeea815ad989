"""Passes between minima as paths that can be folded along."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from origami_nlp.barriers.passes import Pass
from origami_nlp.chart import Landscape
from origami_nlp.display import Content, Poser
from origami_nlp.minima import points_on
from origami_nlp.pattern import Pattern, Scene


def add_passes(
    content: Content, origami: Scene | Pattern, passes: Sequence[Pass], chart: Landscape | None
) -> Content:
    """Add the paths over the passes to the minima, the lowest pass first.

    Parameters
    ----------
    content
        Of `MinimaResult.view_content`.
    origami
        What is folded.
    passes
        Of `find_barriers`.
    chart
        The energy over the coordinates of a scene; None of a pattern.

    Returns
    -------
    Content
        With a track for each pair of minima that a path joins.
    """
    poser, tracks = Poser(origami), []
    joined = [p for p in passes if math.isfinite(p.energy) and len(p.path) > 1]
    for p in sorted(joined, key=lambda p: p.energy):
        title = f"{p.from_state} → {p.to_state} over the pass at {p.energy:.6g} J ({p.pass_kind})"
        start, end = p.from_state - 1, p.to_state - 1
        tracks.append(poser.track(title, p.path, p.path_energy, start=start, end=end))
    none = "No curve joins two minima." if chart is None else "No admissible path joins two minima."
    note = content.note if content.tracks or tracks else none
    places = [] if chart is None else points_on(content, chart, tracks)
    return replace(content.with_tracks(tracks, places), note=note)
