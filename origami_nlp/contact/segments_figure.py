"""The figure of metastable segments: energy, slope, stiffness and contact moment along each boundary."""

from __future__ import annotations

import math
import os
import textwrap

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.contact.segments import SegmentReport
from origami_nlp.files import save_figure

RED, LINE, BAND = "#c1121f", "#26323f", "#f0d9b5"
MOST_CURVES = 8


def draw_segments(report: SegmentReport, path: str | os.PathLike[str] | None = None) -> Figure:
    """Draw U(s), dU/ds, d2U/ds2 and the contact moment along every boundary; metastable parts in red.

    The bands are the thresholds of the report; dotted parts of a curve are those where a contact does not
    push; circles are minima.

    Parameters
    ----------
    report
        Of `find_segments`.
    path
        Where to save, or None.

    Returns
    -------
    matplotlib.figure.Figure
        One column a boundary.

    Raises
    ------
    OptionError
        If the ending of `path` names no known picture format.
    """
    shown = list(range(len(report.curves)))
    marked = {segment.curve for segment in report.segments}
    shown.sort(key=lambda k: (k not in marked, not report.states[k], k))
    left_out = len(shown) - len(shown[:MOST_CURVES])
    shown = sorted(shown[:MOST_CURVES])
    columns = max(1, len(shown))
    width = 1.4 + 3.1 * columns
    figure = Figure(figsize=(width, 8.6), dpi=110, facecolor="white")
    name = report.scene.label or f"degree {report.scene.degree}"
    count = len(report.segments)
    title = f"{name}: {count or 'no'} metastable segment{'s' * (count != 1)}"
    if count:
        title += f", {report.length:.2f} rad in all"
    if left_out:
        title += f" ({left_out} more boundaries not drawn)"
    title = title.replace("alpha_1", "α₁").replace("r_k", "rₖ").replace("$", r"\$")
    figure.suptitle("\n".join(textwrap.wrap(title, int(width * 11))), fontsize=11)
    if not shown:
        figure.text(0.5, 0.5, "No minimum has a closed contact.", ha="center")
    else:
        axes = figure.subplots(4, columns, squeeze=False, sharex="col")
        for column, k in enumerate(shown):
            _column(axes[:, column], report, k, first=column == 0)
        figure.tight_layout(rect=(0, 0, 1, 0.96))
    if path is not None:
        save_figure(figure, path)
    return figure


def _column(axes, report: SegmentReport, k: int, *, first: bool) -> None:  # type: ignore[no-untyped-def]
    curve = report.curves[k]
    total = sum(report.scene.stiffness)
    rows = (
        (curve.energy, None, "U  [J]"),
        (curve.slope / (math.pi * total), report.slope, "dU/ds / (π Σk)"),
        (curve.stiffness / total, report.stiffness, "d²U/ds² / Σk"),
        (curve.multipliers, 0.0, "contact moment  [N m]"),
    )
    for axis, (values, band, label) in zip(axes, rows, strict=True):
        _limit(axis, curve.s, np.atleast_2d(values.T), band or 0.0)
        if band:
            axis.axhspan(-band, band, color=BAND, lw=0)
        elif band is not None:
            axis.axhline(0.0, color="0.6", lw=0.8)
        for line in np.atleast_2d(values.T):
            axis.plot(curve.s, line, color=LINE, lw=1, ls=":")
            pushing = np.where(curve.pressed, line, np.nan)
            axis.plot(curve.s, pushing, color=LINE, lw=1.4)
            for segment in report.segments:
                if segment.curve == k:
                    s = np.linspace(segment.start, segment.end, 100)
                    axis.plot(s, np.interp(s, curve.s, line), color=RED, lw=3, alpha=0.75)
        if report.states[k]:
            axis.plot(
                0.0,
                np.interp(0.0, curve.s, np.atleast_2d(values.T)[0]),
                "o",
                ms=6,
                mfc="w",
                mec=LINE,
            )
        if first:
            axis.set_ylabel(label, fontsize=9)
        axis.tick_params(labelsize=8)
    states = ", ".join(f"#{n}" for n in report.states[k])
    head = f"from state {states}" if states else "no minimum"
    contacts = "\n".join(curve.contacts[:2]) + ("\n..." if len(curve.contacts) > 2 else "")
    axes[0].set_title(f"{head}\n{contacts}", fontsize=8.5)
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
