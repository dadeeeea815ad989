"""The figure of a design: its states folded, its springs as bars, energies and barriers as levels."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from origami_nlp.arguments import check_type
from origami_nlp.display import MOUNTAIN, VALLEY, draw_pattern_state, draw_state, label_text
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.result import Design
from origami_nlp.pattern import Pattern

ACROSS = 5
"""States in one row."""
GREY = "#8a8a8a"


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
        raise OptionError(
            "the design has no springs to draw: " + (design.reason.text if design.reason else "")
        )
    states = [(s.name, s.energy, s.fold_angles, True) for s in design.states]
    states += [
        (f"not asked for ({kind})", energy, phi, False) for energy, kind, phi in design.extra_minima
    ]
    rows = math.ceil(len(states) / ACROSS)
    figure = Figure(
        figsize=(10.5, 2.5 * rows + 3.4), dpi=110, facecolor="white", layout="constrained"
    )
    parts: Any = figure.subfigures(2, 1, height_ratios=(2.5 * rows, 3.4))
    above, below = parts
    across = min(ACROSS, max(len(states), 3))
    for k in range(rows * across):
        axes = above.add_subplot(rows, across, k + 1)
        if k >= len(states):
            axes.axis("off")
            continue
        name, energy, phi, wanted = states[k]
        if isinstance(design.scene, Pattern):
            draw_pattern_state(axes, design.scene, np.array(phi))
        else:
            draw_state(axes, design.scene.vertex, phi, size=7.0)
        axes.set_title(
            label_text(f"{name}\n{energy:.4g} J"), fontsize=9, color="black" if wanted else GREY
        )
    what = "verified" if design.verified else "NOT verified"
    made = design.scene
    label = (
        made.name or "pattern"
        if isinstance(made, Pattern)
        else made.label or f"degree {made.degree}"
    )
    above.suptitle(label_text(f"{label}: margin {design.margin:.3g}, {what}"), fontsize=11)
    axes = below.subplots(1, 3, width_ratios=(1, 1, 1.15))
    _springs(axes[0], axes[1], design)
    _levels(axes[2], design)
    return figure


def _springs(left: Axes, right: Axes, design: Design) -> None:
    """Draw a bar for each crease: stiffness, and the angle at which it has no torque."""
    assert design.scene is not None
    scene = design.scene
    number = np.arange(1, len(scene.stiffness) + 1)
    left.bar(number, scene.stiffness, color=GREY, width=0.6)
    left.set_yscale("log")
    left.set_ylabel("stiffness [N m/rad]")
    low, high = design.targets.stiffness
    for bound in (low, high):
        left.axhline(bound, color="black", lw=0.7, ls=":")
    left.set_ylim(0.7 * low, 1.4 * high)
    angles = np.degrees(scene.rest if isinstance(scene, Pattern) else scene.wound_angles)
    right.bar(number, angles, color=[VALLEY if a > 0 else MOUNTAIN for a in angles], width=0.6)
    right.axhline(0.0, color="black", lw=0.8)
    most = max(180.0, 1.08 * float(np.abs(angles).max()))
    for limit in (-180.0, 180.0):
        right.axhline(limit, color="black", lw=0.7, ls=":")
    right.set_ylim(-1.1 * most, 1.1 * most)
    right.set_ylabel("wound to [deg]" if getattr(scene, "preload", ()) else "rest angle [deg]")
    for axes in (left, right):
        axes.set_xticks(number)
        axes.set_xlabel("crease")
        axes.spines[["top", "right"]].set_visible(False)


def _levels(axes: Axes, design: Design) -> None:
    """Draw energies as levels, and barriers between them as dashed lines to the pass."""
    place = {s.name: 2.0 * k for k, s in enumerate(design.states)}
    for s in design.states:
        x = place[s.name]
        axes.plot([x - 0.55, x + 0.55], [s.energy] * 2, color="black", lw=2.2)
    others = () if design.barriers else design.extra_minima  # (they may be far below)
    for k, (energy, _, _) in enumerate(others):
        x = 2.0 * (len(place) + k)
        axes.plot([x - 0.55, x + 0.55], [energy] * 2, color=GREY, lw=2.2)
    energies = {s.name: s.energy for s in design.states}
    drawn: set[frozenset[str]] = set()
    for b in design.barriers:
        pair = frozenset((b.start, b.end))
        if math.isnan(b.rise):
            continue
        top = energies[b.start] + b.rise
        middle = 0.5 * (place[b.start] + place[b.end])
        sign = 1.0 if place[b.end] > place[b.start] else -1.0
        if pair not in drawn:
            axes.plot([middle - 0.3, middle + 0.3], [top] * 2, color="#c1121f", lw=2.2)
        drawn.add(pair)
        axes.plot(
            [place[b.start] + 0.55 * sign, middle - 0.3 * sign],
            [energies[b.start], top],
            color="#c1121f",
            lw=0.9,
            ls="--",
        )
        axes.annotate(
            f"+{b.rise:.3g}",
            (0.5 * (place[b.start] + middle), 0.5 * (energies[b.start] + top)),
            fontsize=8,
            ha="right" if sign > 0 else "left",
            xytext=(-5 * sign, 0),
            textcoords="offset points",
            color="#c1121f",
        )
    names = [*place, *("extra" for _ in others)]
    axes.set_xticks([2.0 * k for k in range(len(names))])
    turned = 30 if max(map(len, names)) > 8 else 0
    axes.set_xticklabels(list(map(label_text, names)), fontsize=8, rotation=turned)
    axes.set_ylabel("energy [J]")
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(y=0.15)
    axes.set_xlim(-1.1, 2.0 * len(names) - 0.9)
