"""The pictures of README and documentation: `python docs/_ext/pictures.py [NAME ...]` draws them anew, from a checkout.

Without names those that take seconds; ``all`` takes minutes.  Measured times are drawn as they were recorded
(`benchmarks/records`).
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

import origami_nlp as o
from origami_nlp.display import UPPER, draw_state, draw_states

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
        draw_state(axes, vertex, minimum.fold_angles, size=FONT)
        axes.set_anchor("N")
        axes.set_title(f"{minimum.energy:.4f} J", fontsize=FONT, pad=2)
    figure.subplots_adjust(0.005, 0.005, 0.995, 0.93, wspace=0.04, hspace=0.12)
    figure.savefig(path)
    print(f"{path.name}: {len(shown)} of {len(result.minima)} minima")


def own(name: str) -> None:
    """Make a picture by the verb that draws it."""
    path = FOLDER / f"{name}.png"
    if name == "six_states":
        vertex = o.Vertex.from_degrees((62, 100, 119, 79))
        rest = tuple(np.radians((-180, -141, 180, 180)))
        draw_row(o.find_minima(o.Scene(vertex, (0.02, 0.0186, 0.0129, 0.0135), rest)), path)
    elif name == "measured_hinge":
        o.draw(o.fit_hinge(FOLDER.parent / "files" / "tape.csv"), path)


def drawn_periods(name: str) -> None:
    """Draw a state of each energy of a Miura cell of one by three units."""
    units = 3
    found = o.find_minima(
        o.examples.pattern("miura", 1, units, cell=True), effort="quick", escape=False
    )
    of = {round(m.energy, 9): k for k, m in reversed(list(enumerate(found.minima)))}
    shown = [of[energy] for energy in sorted(of)]
    states = [
        (
            f"{found.minima[k].energy / units:.4f} J a unit, Poisson's ratio {found.lattices[k].poisson[1]:.2f}",
            found.minima[k].phi,
        )
        for k in shown
    ]
    head = f"miura:1x{units} --cell: states of period {units}, 2 x 2 copies"
    contacts = [found.minima[k].contacts for k in shown]
    figure = draw_states(found.pattern, states, head, contacts=contacts)
    figure.savefig(FOLDER / f"{name}.png", dpi=100)


def by_command(*words: str) -> None:
    """Make a picture by the command that stands beside it."""
    subprocess.run([sys.executable, "-m", *words], check=True)


def drawn_load(name: str) -> None:
    """Draw the load path of the tutorial: a torque on the straight mountain of a waterbomb."""
    path = o.load_path(o.examples.waterbomb(), 1, to=0.09)
    o.draw(path, FOLDER / f"{name}.png")


def drawn_boundary(name: str) -> None:
    """Draw where states of a vertex of the source paper appear, change and vanish."""
    over = "ratio=0.1:100", "alpha=61deg:85deg"
    found = o.find_bifurcation_set(o.examples.degree6("5*pi/12"), *over, lines=4, across=3)
    o.draw(found, FOLDER / f"{name}.png")


def drawn_hinges(name: str) -> None:
    """Draw the load path of a crease that yields."""
    vertex = o.Vertex.from_degrees((70, 80, 120, 90))
    rest = tuple(np.radians((-50, 20, -60, -15)))
    creased = o.Scene(vertex, (1.0,) * 4, rest, symmetry="none")
    path = o.load_path(creased, 1, to=0.6, yield_torque=0.3, unload=True)
    o.draw(path, FOLDER / name / "creased.png")


def recorded(name: str) -> None:
    """Draw the times of a recorded run."""
    from benchmarks import draw_search
    from benchmarks.search import RECORD

    draw_search(json.loads(RECORD.read_text()), FOLDER / f"{name}.png")


def recorded_engines(name: str) -> None:
    """Draw what both engines of a search found in a recorded run."""
    from benchmarks.engines import draw_engines
    from benchmarks.search import RECORD

    data = json.loads(RECORD.with_name("engines.json").read_text())
    draw_engines(data, FOLDER / f"{name}.png")


PICTURES: dict[str, Callable[[str], None]] = {
    "six_states": own,
    "measured_hinge": own,
    "periodic_miura": drawn_periods,
    "gallery": lambda _: by_command("tests.gallery"),
    "boundary_degree6": drawn_boundary,
    "bistable_waterbomb": drawn_load,
    "hinges": drawn_hinges,
    "speed": recorded,
    "engines": recorded_engines,
}
"""What makes each picture of the documentation; ``gallery`` its folder and page."""
SLOW = ("gallery", "boundary_degree6")
"""Made only by name, or with ``all``: minutes each."""

if __name__ == "__main__":
    asked = sys.argv[1:] or [name for name in PICTURES if name not in SLOW]
    for name in PICTURES if asked == ["all"] else asked:
        PICTURES[name](name)
