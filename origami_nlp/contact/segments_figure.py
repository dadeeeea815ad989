"""The figure of metastable segments: energy, slope, stiffness and contact moment along each boundary."""

from __future__ import annotations

import math
import textwrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.contact.segments import SegmentReport
from origami_nlp.display import BAND, INK, METASTABLE, label_text, patch

MOST_CURVES = 4
"""Boundaries drawn; the figure says how many there are more."""


def draw_segments(report: SegmentReport) -> Figure:
    """Draw U(s), dU/ds, d2U/ds2 and the contact moment along boundaries, those with metastable parts first.

    Parameters
    ----------
    report
        Of `find_segments`.

    Returns
    -------
    matplotlib.figure.Figure
        One column a boundary.
    """
    shown = list(range(len(report.curves)))
    marked = {segment.curve for segment in report.segments}
    shown.sort(key=lambda k: (k not in marked, not report.states[k], k))
    left_out = len(shown) - len(shown[:MOST_CURVES])
    shown = sorted(shown[:MOST_CURVES])
    columns = max(1, len(shown))
    width = 2.0 + 2.3 * columns
    figure = Figure(figsize=(width, 7.4 if shown else 2.0), dpi=110, layout="constrained")
    title = f"{report.scene.title}: {report.verdict.partition(':')[0]}"
    if report.segments:
        title += f", {report.length:.2f} rad"
    if left_out:
        title += f" ({left_out} more boundar{'y' if left_out == 1 else 'ies'} not drawn)"
    lines = textwrap.wrap(label_text(title), int(width * 10))
    figure.suptitle("\n".join(lines), fontsize=12, weight="bold")
    if not shown:
        figure.text(0.5, 0.4, "No minimum has a closed contact.", ha="center")
    else:
        axes = figure.subplots(4, columns, squeeze=False, sharex="col")
        for column, k in enumerate(shown):
            _column(axes[:, column], report, k, first=column == 0)
        handles = _legend(report, shown)
        ncols = max(1, int(width / 2.2))
        figure.legend(
            handles=handles, loc="outside lower center", ncols=ncols, fontsize=9, frameon=False
        )
    return figure


def _legend(report: SegmentReport, shown: list[int]) -> list[Any]:
    """Return handles for what occurs."""
    handles: list[Any] = [Line2D([], [], color=INK, lw=1.4, label="contact pushes")]
    if not all(report.curves[k].pressed.all() for k in shown):
        handles.append(Line2D([], [], color=INK, lw=1, ls=":", label="contact does not push"))
    if any(segment.curve in shown for segment in report.segments):
        handles.append(Line2D([], [], color=METASTABLE, lw=3, alpha=0.75, label="metastable"))
    if any(report.states[k] for k in shown):
        handles.append(Line2D([], [], **_STATE, label="minimum"))
    return [*handles, patch(BAND, "within the threshold")]


_STATE: dict[str, Any] = {"marker": "o", "ls": "", "ms": 5, "mfc": INK, "mec": "white"}


def _column(axes, report: SegmentReport, k: int, *, first: bool) -> None:  # type: ignore[no-untyped-def]
    curve = report.curves[k]
    total = sum(report.scene.stiffness)
    rows = (
        (curve.energy, None, "U  [J]"),
        (curve.slope / (math.pi * total), report.slope, "dU/ds / (π Σk)"),
        (curve.stiffness / total, report.stiffness, "d²U/ds² / Σk"),
        (curve.multipliers, 0.0, "moment  [N m]"),
    )
    for axis, (values, band, label) in zip(axes, rows, strict=True):
        _limit(axis, curve.s, np.atleast_2d(values.T), band or 0.0)
        if band:
            axis.axhspan(-band, band, color=BAND, lw=0)
        elif band is not None:
            axis.axhline(0.0, color="0.6", lw=0.8)
        for line in np.atleast_2d(values.T):
            axis.plot(curve.s, line, color=INK, lw=1, ls=":")
            pushing = np.where(curve.pressed, line, np.nan)
            axis.plot(curve.s, pushing, color=INK, lw=1.4)
            for segment in report.segments:
                if segment.curve == k:
                    s = np.linspace(segment.start, segment.end, 100)
                    axis.plot(s, np.interp(s, curve.s, line), color=METASTABLE, lw=3, alpha=0.75)
        if report.states[k]:
            axis.plot(0.0, np.interp(0.0, curve.s, np.atleast_2d(values.T)[0]), **_STATE)
        if first:
            axis.set_ylabel(label, fontsize=9)
        axis.tick_params(labelsize=8)
    states = ", ".join(f"#{n}" for n in report.states[k])
    head = f"from state {states}" if states else "no minimum"
    contacts = "\n".join(curve.contacts[:2]) + ("\n..." if len(curve.contacts) > 2 else "")
    words = contacts.replace("phi", "φ").replace("pi", "π").replace("= -", "= −")
    axes[0].set_title(f"{head}\n{words}", fontsize=9)
    axes[-1].set_xlabel("arclength s  [rad]", fontsize=9)


def _limit(axis, s: np.ndarray, lines: np.ndarray, band: float) -> None:  # type: ignore[no-untyped-def]
    """Keep the picture to what most of the curve does: near singular ends values grow without bound."""
    even = np.linspace(s[0], s[-1], 400)
    values = np.array([np.interp(even, s, line) for line in lines])
    low, high = np.percentile(values, [1, 99])
    low, high = min(low, -1.5 * band), max(high, 1.5 * band)
    pad = 0.12 * (high - low) + 1e-9
    if lines.max() > high + pad or lines.min() < low - pad:
        axis.set_ylim(low - pad, high + pad)
