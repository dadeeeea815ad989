"""The figure of a design: its states folded, its springs as bars, energies and barriers as levels."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from origami_nlp.arguments import check_type
from origami_nlp.display import MOUNTAIN, VALLEY, draw_state, label_text
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.result import Design
from origami_nlp.pattern import Pattern

ACROSS = 5
"""States in one row."""
GREY, TOP = "#8a8a8a", "#c1121f"


def draw_design(design: Design) -> Figure:
    """Draw the states of a design, its springs and its energies.

    Parameters
    ----------
    design
        With springs.

    Returns
    -------
    matplotlib.figure.Figure
        Above the states, wanted ones first, then those that nobody asked for; below the stiffness of each crease, its
        rest angle (wound angle where there is a preload), and the energies of states and passes.

    Raises
    ------
    OptionError
        If `design` is not of its type or has no springs.
    """
    check_type("design", design, Design)
    if design.scene is None:
        why = design.reason.text if design.reason else ""
        raise OptionError(f"the design has no springs to draw: {why}")
    made = design.scene
    states = [(s.name, s.energy, s.fold_angles, "black") for s in design.states]
    states += [
        (f"not asked for ({m.kind})", m.energy, m.fold_angles, GREY) for m in design.extra_minima
    ]
    rows, across = math.ceil(len(states) / ACROSS), min(ACROSS, max(len(states), 3))
    size = (10.5, 2.5 * rows + 3.4)
    figure = Figure(figsize=size, dpi=110, facecolor="white", layout="constrained")
    parts: Any = figure.subfigures(2, 1, height_ratios=(2.5 * rows, 3.4))
    grid = parts[0].subplots(rows, across, squeeze=False)
    for axes in grid.flat[len(states) :]:
        axes.axis("off")
    for axes, (name, energy, phi, colour) in zip(grid.flat, states, strict=False):
        draw_state(axes, made, phi, size=7.0)
        axes.set_title(label_text(f"{name}\n{energy:.4g} J"), fontsize=9, color=colour)
    what = "verified" if design.verified else "NOT verified"
    parts[0].suptitle(label_text(f"{made.title}: margin {design.margin:.3g}, {what}"), fontsize=11)
    left, right, levels = parts[1].subplots(1, 3, width_ratios=(1, 1, 1.15))
    number = np.arange(1, len(made.stiffness) + 1)
    left.bar(number, made.stiffness, color=GREY, width=0.6)
    left.set(yscale="log", ylabel="stiffness [N m/rad]")
    for bound in design.targets.stiffness:
        left.axhline(bound, color="black", lw=0.7, ls=":")
    angles = np.degrees(made.rest if isinstance(made, Pattern) else made.wound_angles)
    right.bar(number, angles, color=[VALLEY if a > 0 else MOUNTAIN for a in angles], width=0.6)
    right.set_ylabel("wound to [deg]" if getattr(made, "preload", ()) else "rest angle [deg]")
    for limit in (-180.0, 0.0, 180.0):
        right.axhline(limit, color="black", lw=0.7, ls=":" if limit else "-")
    for axes in (left, right):
        axes.set(xticks=number, xlabel="crease")
    _levels(levels, design)
    for axes in (left, right, levels):
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _levels(axes: Axes, design: Design) -> None:
    """Draw energies as levels, and barriers between them as dashed lines to the pass."""
    levels = [(s.name, s.energy, "black") for s in design.states]
    if not design.barriers:  # (they may be far below)
        levels += [("extra", m.energy, GREY) for m in design.extra_minima]
    at = {name: (k, energy) for k, (name, energy, _) in enumerate(levels)}
    for k, (_, energy, colour) in enumerate(levels):
        axes.plot([k - 0.3, k + 0.3], [energy] * 2, color=colour, lw=2.2)
    for b in design.barriers:
        (x, low), (other, _) = at[b.start], at[b.end]
        top = 0.5 * (x + other), low + b.rise
        axes.plot([x, top[0]], [low, top[1]], color=TOP, lw=0.9, ls="--")
        axes.annotate(f"+{b.rise:.3g}", top, (0, 3), textcoords="offset points", color=TOP)
    names = [label_text(name) for name, *_ in levels]
    turned = 30 if max(map(len, names)) > 8 else 0
    axes.set_xticks(range(len(names)), names, fontsize=8, rotation=turned)
    axes.set_ylabel("energy [J]")
    axes.margins(y=0.15)
