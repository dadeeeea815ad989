"""The picture of the README: `python docs/_ext/pictures.py` draws it anew."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

from matplotlib.figure import Figure

import origami_nlp as o
from origami_nlp.display import draw_state

FOLDER = Path(__file__).parents[1] / "figures"
SIDE = 2.0
"""Width of a state [inches]."""
SAME_ENERGY = 1e-6
"""Energies that differ by less [relative] are those of images of one state."""


def different(result: o.MinimaResult, most: int) -> list[o.JudgedState]:
    """The lowest minima of different energy, at most so many."""
    found: list[o.JudgedState] = []
    for one in result.minima:
        if not found or one.energy > found[-1].energy * (1 + SAME_ENERGY):
            found.append(one)
    return found[:most]


def draw_row(result: o.MinimaResult, path: Path, most: int = 6) -> None:
    """Draw the lowest different minima side by side, with their energies."""
    shown = different(result, most)
    figure = Figure(figsize=(SIDE * len(shown), SIDE), dpi=150)
    for place, minimum in enumerate(shown, start=1):
        axes = figure.add_subplot(1, len(shown), place)
        draw_state(axes, result.scene.vertex, minimum.fold_angles)
        low, high = axes.get_ylim()
        axes.set_ylim(low + 0.2 * (high - low), high)  # folded states leave the bottom empty
        axes.set_title(f"{minimum.energy:.4f} J", fontsize=10)
    figure.subplots_adjust(0.005, 0.0, 0.995, 0.88, wspace=0.04)
    figure.savefig(path)
    print(f"{path.name}: {len(shown)} of {len(result.minima)} minima")


if __name__ == "__main__":
    draw_row(
        o.find_minima(o.examples.degree6("pi/3", ratio=1, symmetry="none")), FOLDER / "states.png"
    )
