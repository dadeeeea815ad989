"""The figure of metastable segments: energy, slope, stiffness and contact moment along each boundary."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.contact.segments import SLOPE, STIFFNESS, SegmentReport
from origami_nlp.display import BAND, INK, METASTABLE, label_text

MOST_CURVES = 4
"""Boundaries drawn; the figure says how many there are more."""
STATE: dict[str, Any] = {"marker": "o", "ls": "", "ms": 5, "mfc": INK, "mec": "white"}


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
    marked = {segment.curve for segment in report.segments}
    order = sorted(range(len(report.curves)), key=lambda k: (k not in marked, k))
    drawn = sorted(order[:MOST_CURVES])
    width = 2.0 + 2.3 * max(1, len(drawn))
    figure = Figure(figsize=(width, 7.4), dpi=110, layout="constrained")
    title = f"{report.scene.title}\nmetastable: {report.length:.2f} rad"
    if more := len(order) - len(drawn):
        title += f" ({more} more boundaries not drawn)"
    figure.suptitle(label_text(title), fontsize=11, weight="bold")
    if not drawn:
        figure.text(0.5, 0.4, "No minimum has a closed contact.", ha="center")
        return figure
    axes = figure.subplots(4, len(drawn), squeeze=False, sharex="col")
    for column, k in zip(axes.T, drawn, strict=True):
        _column(column, report, k)
    for axis, label in zip(
        axes[:, 0], ("U  [J]", "dU/ds / (π Σk)", "d²U/ds² / Σk", "moment  [N m]"), strict=True
    ):
        axis.set_ylabel(label, fontsize=9)
    entries = {
        name: entry
        for axis in axes.flat
        for entry, name in zip(*axis.get_legend_handles_labels(), strict=True)
    }
    look: Any = {"loc": "outside lower center", "ncols": max(1, int(width / 2.2)), "fontsize": 9}
    figure.legend(entries.values(), entries, **look, frameon=False)
    return figure


def _column(axes: Any, report: SegmentReport, k: int) -> None:
    curve, total = report.curves[k], sum(report.scene.stiffness)
    s, slope, stiffness = curve.s, curve.slope / (math.pi * total), curve.stiffness / total
    rows = (curve.energy, None), (slope, SLOPE), (stiffness, STIFFNESS), (curve.multipliers, 0.0)
    for axis, (values, band) in zip(axes, rows, strict=True):
        if band is not None:
            axis.axhspan(-band, band, color=BAND, lw=0.8, label="within the threshold")
        for line in np.atleast_2d(values.T):
            if not curve.pressed.all():
                axis.plot(s, line, color=INK, lw=1, ls=":", label="contact does not push")
            axis.plot(s, np.where(curve.pressed, line, np.nan), color=INK, label="contact pushes")
            for part in (part for part in report.segments if part.curve == k):
                at = np.linspace(part.start, part.end, 100)
                look = {"color": METASTABLE, "lw": 3, "alpha": 0.75, "label": "metastable"}
                axis.plot(at, np.interp(at, s, line), **look)
        if report.states[k]:
            first = np.interp(0.0, s, np.atleast_2d(values.T)[0])
            axis.plot(0.0, first, **STATE, label="minimum")
        _limit(axis, s, np.atleast_2d(values.T), band or 0.0)
        axis.tick_params(labelsize=8)
    contacts = "\n".join(curve.contacts[:2])
    states = ", ".join(f"#{n}" for n in report.states[k])
    axes[0].set_title(label_text(f"from state {states}\n{contacts}"), fontsize=9)
    axes[-1].set_xlabel("arclength s  [rad]", fontsize=9)


def _limit(axis: Any, s: np.ndarray, lines: np.ndarray, band: float) -> None:
    """Keep the picture to what most of the curve does: near singular ends values grow without bound."""
    even = np.linspace(s[0], s[-1], 400)
    low, high = np.percentile([np.interp(even, s, line) for line in lines], [1, 99])
    low, high = min(low, -1.5 * band), max(high, 1.5 * band)
    pad = 0.12 * (high - low) + 1e-9
    if lines.max() > high + pad or lines.min() < low - pad:
        axis.set_ylim(low - pad, high + pad)
