"""Drawings of folded cones: all different foldings of a degree, or one branch as it folds."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.cone.branches import ConeBranch
from origami_nlp.cone.classes import direction_name
from origami_nlp.cone.flaps import write_flaps
from origami_nlp.cone.necklaces import foldings
from origami_nlp.errors import OptionError
from origami_nlp.files import save_figure
from origami_nlp.pattern import format_angle
from origami_nlp.show import MOUNTAIN, VALLEY, draw_state

CELL, TITLE, NOTE = 2.1, 0.62, 0.5
"""Side of a drawing, height of its title, and of the note below [in]."""
MOST_DRAWN = 40


def draw_foldings(
    degree: int, elevation: float, path: str | os.PathLike[str] | None = None
) -> Figure:
    """Draw every folding that differs by more than a rotation, at one elevation.

    A branch that ends before the elevation is drawn at its end, and its title says so.

    Parameters
    ----------
    degree
        N, even, at least 6.
    elevation
        v, signed [rad].
    path
        Where to save, or None.

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
            title += f", ends at {format_angle(branch.end)}"
        states.append((branch, direction * size, title))
    note = f"degree {degree}, elevation {format_angle(elevation)} ({direction_name(direction)})"
    return _sheet(states, note, min(4, len(states)), path)


def draw_branch(
    branch: ConeBranch,
    elevations: Sequence[float],
    path: str | os.PathLike[str] | None = None,
) -> Figure:
    """Draw states of one branch.

    Parameters
    ----------
    branch
        Of `branch`.
    elevations
        v of each state, signed [rad].
    path
        Where to save, or None.

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
    return _sheet(states, note, min(4, len(states)), path)


def _short(angle: float) -> str:
    text = format_angle(angle)
    return text if len(text) <= 9 else f"{angle:.4f}"


def _sheet(
    states: Sequence[tuple[ConeBranch, float, str]],
    note: str,
    columns: int,
    path: str | os.PathLike[str] | None,
) -> Figure:
    """Draw states in rows below each other, with what the colours mean."""
    columns = max(columns, 3)
    rows = math.ceil(len(states) / columns)
    width, height = columns * CELL + 0.2, rows * (CELL + TITLE) + NOTE + 0.1
    figure = Figure(figsize=(width, height))
    for k, (branch, elevation, title) in enumerate(states):
        row, column = divmod(k, columns)
        bottom = height - 0.1 - (row + 1) * (CELL + TITLE)
        axes = figure.add_axes(
            ((0.1 + column * CELL) / width, bottom / height, CELL / width, CELL / height)
        )
        phi = np.asarray(branch.fold_angles(elevation))
        draw_state(axes, branch.vertex, phi, size=7.5 if branch.degree <= 12 else 6.0)
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + 0.03 * (high - low))  # thick creases at the very top
        axes.set_title(title, fontsize=8.5, linespacing=1.25, pad=3)
    figure.text(0.1 / width, 0.3 / height, note, fontsize=8)
    figure.text(0.1 / width, 0.1 / height, "valley creases", color=VALLEY, fontsize=8)
    figure.text(1.05 / width, 0.1 / height, "mountain creases", color=MOUNTAIN, fontsize=8)
    if path is not None:
        save_figure(figure, path, 150)
    return figure
