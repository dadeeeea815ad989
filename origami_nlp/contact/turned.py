"""States in contact as states that can be turned, and contact boundaries as paths."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from origami_nlp.chart import landscape
from origami_nlp.minima import CELLS, points_on, turn_minima
from origami_nlp.show import Content, Piece, vertex_track

if TYPE_CHECKING:
    from origami_nlp.contact.report import ContactReport


def turn_contacts(report: ContactReport) -> Content:
    """Return a contact report for a page that can be turned.

    Parameters
    ----------
    report
        Of `find_contacts`.

    Returns
    -------
    Content
        As `minima.turn_minima` has it, the loads that contacts bear beside each state, and a track for each contact
        boundary that was followed.
    """
    from origami_nlp.contact.report import margin_lines

    chart = landscape(report.result.scene, CELLS)
    content = turn_minima(report.result, chart)
    stations = list(content.stations)
    for state in report.states:
        old = stations[state.number - 1]
        lines = (
            *old.lines,
            f"tangential stiffness: {state.stiffness_words()}",
            *margin_lines(state.margin),
        )
        stations[state.number - 1] = replace(old, lines=lines)
    content = replace(content, stations=tuple(stations), pieces=tuple(_pieces(report)))
    if report.segments is None:
        return content
    tracks = [
        vertex_track(
            report.result.scene.vertex,
            _title(curve.contacts, numbers),
            curve.fold_angles,
            curve.energy,
            parameter=curve.s,
            label="arclength s [rad]",
        )
        for curve, numbers in zip(report.segments.curves, report.segments.states, strict=True)
    ]
    return content.with_tracks(tracks, points_on(content, chart, tracks))


def _title(contacts: Sequence[str], numbers: Sequence[int]) -> str:
    through = f" through state {', '.join(map(str, numbers))}" if numbers else ""
    return f"contact boundary{through}: {'; '.join(contacts)}"


def _pieces(report: ContactReport) -> Iterator[Piece]:
    """Return the report as it is told, with the margins of single creases as tables."""
    yield report.headline
    yield report.full_table()
    for state in report.states:
        if state.margin.creases:
            yield replace(
                state.creases_table(), title=f"State {state.number}: largest moment on one orbit"
            )
    if report.segments is not None:
        yield from report.segments.told()
