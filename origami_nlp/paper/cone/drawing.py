"""Drawings of folded cones: all different foldings of a degree, or one branch as it folds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.display import (
    MARGIN,
    StackedFigure,
    crease_legend,
    draw_state,
    label_text,
)
from origami_nlp.errors import OptionError
from origami_nlp.paper.cone.branches import ConeBranch
from origami_nlp.paper.cone.classes import direction_name
from origami_nlp.paper.cone.flaps import write_flaps
from origami_nlp.paper.cone.necklaces import foldings
from origami_nlp.pattern import format_angle

CELL, TITLE = 2.1, 0.42
"""Width of a drawing, and height of its title [in]."""
MOST_DRAWN = 40


def draw_foldings(degree: int, elevation: float) -> Figure:
    """Draw every folding that differs by more than a rotation, at one elevation.

    A branch that ends before the elevation is drawn at its end, and its title says so.

    Parameters
    ----------
    degree
        N, even, at least 6.
    elevation
        v, signed [rad].

    Returns
    -------
    matplotlib.figure.Figure
        A sheet of folded cones.

    Raises
    ------
    OptionError
        If there are more than MOST_DRAWN of them.
    """
    if degree > 16 or len(foldings(degree)) > MOST_DRAWN:
        raise OptionError(
            f"degree = {degree}: more than {MOST_DRAWN} foldings to draw: give --flaps to draw one"
        )
    direction = 1 if elevation >= 0 else -1
    states = []
    for f in foldings(degree):
        branch = ConeBranch(f.flaps, direction)
        size = min(abs(elevation), branch.end)
        copies = f"{f.copies} cop{'y' if f.copies == 1 else 'ies'}"
        title = f"{write_flaps(f.flaps)}, {f.symmetry}\n{copies}"
        if size < abs(elevation):
            title += f", ends at {_short(branch.end)}"
        states.append((branch, direction * size, title))
    note = f"degree {degree}, elevation {_short(elevation)} ({direction_name(direction)})"
    return _sheet(states, note)


def draw_branch(branch: ConeBranch, elevations: Sequence[float]) -> Figure:
    """Draw states of one branch.

    Parameters
    ----------
    branch
        Of `branch`.
    elevations
        v of each state, signed [rad].

    Returns
    -------
    matplotlib.figure.Figure
        A sheet of folded cones.
    """
    states = [(branch, float(v), f"elevation {_short(v)}") for v in elevations]
    note = (
        f"branch {branch!r}, symmetry {branch.symmetry}; ends at "
        f"{_short(branch.end)}: {branch.end_text}"
    )
    return _sheet(states, note)


def _short(angle: float) -> str:
    text = format_angle(angle)
    return label_text(text) if len(text) <= 9 else f"{angle:.4f}".replace("-", "−")


def _sheet(states: Sequence[tuple[ConeBranch, float, str]], note: str) -> Figure:
    """Draw states in rows below each other, with what the colours mean."""
    # of three or four columns those that fill the last row better
    columns = min(len(states), max((4, 3), key=lambda c: -(-len(states) % c)))
    angles = [np.asarray(branch.fold_angles(elevation)) for branch, elevation, _ in states]
    heights = [CELL + TITLE + 0.1 for _ in range(0, len(states), columns)]
    width = max(columns, 2) * CELL + 2 * MARGIN
    stack = StackedFigure(width, sum(heights), handles=crease_legend(), notes=[note])
    left = (width - columns * CELL) / 2
    for k, (branch, _, title) in enumerate(states):
        row, column = divmod(k, columns)
        x, y = left + column * CELL, sum(heights[:row]) + TITLE
        axes = stack.axes(x, y, CELL, CELL)
        size = 8.0 if branch.degree <= 12 else 6.5
        draw_state(axes, branch.vertex, angles[k], size=size)
        stack.text(x + CELL / 2, y - 0.08, title, fontsize=9, ha="center", linespacing=1.25)
    return stack.figure
