"""Contact boundaries as paths that can be folded along."""

from __future__ import annotations

from collections.abc import Sequence

from origami_nlp.chart import Landscape
from origami_nlp.contact.segments import SegmentReport
from origami_nlp.minima import points_on
from origami_nlp.show import Content, Poser


def add_segments(content: Content, chart: Landscape, segments: SegmentReport) -> Content:
    """Add the contact boundaries that were followed to the minima of a scene.

    Parameters
    ----------
    content
        Of `MinimaResult.turned`.
    chart
        The energy over the scene's coordinates.
    segments
        Of `find_segments`.

    Returns
    -------
    Content
        With a track for each boundary.
    """
    tracks = [
        Poser(segments.scene).track(
            _title(curve.contacts, numbers),
            curve.fold_angles,
            curve.energy,
            parameter=curve.s,
            label="arclength s [rad]",
        )
        for curve, numbers in zip(segments.curves, segments.states, strict=True)
    ]
    return content.with_tracks(tracks, points_on(content, chart, tracks))


def _title(contacts: Sequence[str], numbers: Sequence[int]) -> str:
    through = f" through state {', '.join(map(str, numbers))}" if numbers else ""
    return f"contact boundary{through}: {'; '.join(contacts)}"
