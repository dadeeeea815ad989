"""The figure of modes: for each minimum its eigenvalues, and the energy along each mode to the first contact."""

from __future__ import annotations

import itertools
import textwrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.display import label_text
from origami_nlp.modes.result import BREAKING, Modes, StateModes

COLOURS = ("#1d3557", "#c1121f", "#2a9d8f", "#b5179e", "#e07a00", "#577590", "#7f5539", "#6a994e")
MOST_STATES = 6
MOST_MEDIANS = 3.0
"""The axis ends at this many medians of the distances to contact; numbers of longer modes are in the legend."""


def draw_modes(found: Modes) -> Figure:
    """Draw eigenvalues and energy along the modes; one row a minimum, symmetry-breaking modes dashed.

    Dots are where something touches; where a mode has the parabola of its eigenvalue, thin lines show it.

    Parameters
    ----------
    found
        Of `find_modes`.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    shown = [s for s in found.states if s.modes]
    left_out = len(found.states) - len(shown[:MOST_STATES])
    shown = shown[:MOST_STATES]
    rows = max(1, len(shown))
    figure = Figure(figsize=(9.4, 0.9 + 3.0 * rows), dpi=110, facecolor="white")
    title = f"{found.label}: energy along the modes of its minima"
    if left_out:
        title += f" ({left_out} without modes, or not drawn)"
    figure.suptitle("\n".join(textwrap.wrap(label_text(title), 90)), fontsize=11)
    if not shown:
        figure.text(0.5, 0.5, "No minimum has a motion that keeps its contacts.", ha="center")
    else:
        axes = figure.subplots(rows, 2, squeeze=False, width_ratios=(1, 2.6))
        for pair, state in zip(axes, shown, strict=True):
            _spectrum(pair[0], state)
            _energies(pair[1], state)
        for axis, label in zip(axes[-1], ("mode", "distance along the mode  [rad]"), strict=True):
            axis.set_xlabel(label, fontsize=9)
        figure.tight_layout(rect=(0, 0, 1, 1 - 0.1 / figure.get_figheight()))
    return figure


def _spectrum(axis: Any, state: StateModes) -> None:
    """Eigenvalues as bars, hollow where the mode breaks the symmetry."""
    for k, (mode, colour) in enumerate(zip(state.modes, itertools.cycle(COLOURS)), start=1):
        hollow = mode.block == BREAKING
        axis.bar(
            k, mode.eigenvalue, 0.6, color="white" if hollow else colour, edgecolor=colour,
            ls="--" if hollow else "-", lw=1.4,
        )  # fmt: skip
    axis.axhline(0.0, color="0.4", lw=0.8)
    axis.set_xticks(range(1, len(state.modes) + 1))
    axis.set_ylabel("eigenvalue  [N m/rad]", fontsize=9)
    axis.set_title(f"state #{state.number}: {state.minimum.kind}", fontsize=9)
    axis.tick_params(labelsize=8)


def _energies(axis: Any, state: StateModes) -> None:
    """Energy along each mode, to where something touches."""
    for k, (mode, colour) in enumerate(zip(state.modes, itertools.cycle(COLOURS)), start=1):
        dashed = mode.block == BREAKING
        low, high = mode.along.ends
        words = f"{k} {mode.block}: {low.s:.2f} to {high.s:.2f}"
        line = "--" if dashed else "-"
        s, rise = mode.along.s, mode.along.rise
        axis.plot(s, rise, color=colour, ls=line, lw=1.6, label=words, zorder=3 if dashed else 2)
        axis.plot(s, 0.5 * mode.eigenvalue * s**2, color=colour, lw=0.6, alpha=0.6)
        for end in mode.along.ends:
            face = colour if end.contacts else "w"
            axis.plot(end.s, end.rise, "o", ms=4.5, color=colour, mfc=face)
    ends = [end.s for mode in state.modes for end in mode.along.ends]
    far = MOST_MEDIANS * float(np.median(np.abs(ends)))  # a long mode would hide the others
    left, right = max(min(ends), -far), min(max(ends), far)
    pad = 0.04 * (right - left)
    axis.set_xlim(left - pad, right + pad)
    seen = [m.along.rise[(m.along.s >= left) & (m.along.s <= right)] for m in state.modes]
    least, most = min(float(r.min()) for r in seen), max(float(r.max()) for r in seen)
    axis.set_ylim(least - 0.05 * (most - least), most + 0.12 * (most - least))
    axis.set_ylabel("U − U₀  [J]", fontsize=9)
    axis.set_title(
        "dots: something touches; thin: eigenvalue alone"
        + (
            "; dashed: breaks the symmetry" if any(m.block == BREAKING for m in state.modes) else ""
        ),
        fontsize=8.5,
    )
    axis.legend(
        fontsize=7.5,
        framealpha=0.8,
        loc="upper center",
        title="to contact [rad]",
        title_fontsize=7.5,
    )
    axis.tick_params(labelsize=8)
