"""The picture of the README: `python docs/_ext/pictures.py` draws it anew."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

import origami_nlp as o
from origami_nlp.display import draw_state
from origami_nlp.display.drawing import UPPER

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FOLDER = Path(__file__).parents[1] / "figures"
SIDE, FONT = 1.8, 11
"""Width of a state [inches], and of its numbers [points]."""
SAME_ENERGY = 1e-6
"""Energies that differ by less [relative] are those of images of one state."""


def different(result: o.MinimaResult, most: int) -> list[o.JudgedState]:
    """The lowest minima of different energy, at most so many."""
    found: list[o.JudgedState] = []
    for one in result.minima:
        if not found or one.energy > found[-1].energy * (1 + SAME_ENERGY):
            found.append(one)
    return found[:most]


def draw_flat(axes: Axes, vertex: o.Vertex) -> None:
    """Draw the crease pattern of a vertex, creases numbered, a sector with its angle."""
    angles = np.cumsum([0, *vertex.sector_angles])
    axes.add_patch(Circle((0, 0), 1, facecolor=UPPER, edgecolor="black", linewidth=1.2))
    for number, angle in enumerate(angles[:-1], start=1):
        x, y = np.cos(angle), np.sin(angle)
        axes.plot([0, x], [0, y], color="#555555", linewidth=1.3)
        axes.text(1.15 * x, 1.15 * y, str(number), ha="center", va="center", fontsize=FONT)
    middle = angles[1] / 2
    degrees = f"{np.degrees(vertex.sector_angles[0]):.0f}°"
    axes.text(
        0.55 * np.cos(middle),
        0.55 * np.sin(middle),
        degrees,
        ha="center",
        va="center",
        fontsize=FONT,
    )
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), aspect="equal")
    axes.axis("off")


def draw_row(result: o.MinimaResult, path: Path, most: int = 6) -> None:
    """Draw the flat pattern, and beside it the lowest different minima with their energies in two rows."""
    shown = different(result, most)
    across = -(-len(shown) // 2)
    vertex = result.scene.vertex
    figure = Figure(figsize=(SIDE * (across + 1), 1.75 * SIDE), dpi=150)
    grid = figure.add_gridspec(2, across + 1)
    axes = figure.add_subplot(grid[:, 0])
    draw_flat(axes, vertex)
    axes.set_title("flat", fontsize=FONT)
    for place, minimum in enumerate(shown):
        axes = figure.add_subplot(grid[place // across, 1 + place % across])
        draw_state(axes, vertex, minimum.fold_angles, size=FONT, crop=True)
        axes.set_anchor("N")
        axes.set_title(f"{minimum.energy:.4f} J", fontsize=FONT, pad=2)
    figure.subplots_adjust(0.005, 0.005, 0.995, 0.93, wspace=0.04, hspace=0.12)
    figure.savefig(path)
    print(f"{path.name}: {len(shown)} of {len(result.minima)} minima")


if __name__ == "__main__":
    draw_row(
        o.find_minima(o.examples.degree6("pi/3", ratio=1, symmetry="none")), FOLDER / "states.png"
    )
