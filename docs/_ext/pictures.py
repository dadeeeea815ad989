"""The pictures of README and documentation: `python docs/_ext/pictures.py [NAME ...]` draws them anew, from a checkout.

Without names those that take seconds; ``all`` takes about half an hour.  Measured times are drawn as they were recorded
(`docs/bench_search.json`, `docs/bench_patterns.json`), but for those of `time_budget`.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

import origami_nlp as o
from origami_nlp.display import draw_state, draw_states
from origami_nlp.display.drawing import UPPER
from origami_nlp.hinges import HINGE_EXAMPLES

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


def panel(name: str) -> o.Scene:
    """A vertex of degree 6 by its sector angle and stiffness ratio, such as ``pi/3 1``."""
    alpha, ratio = name.split()
    return o.examples.degree6(alpha, ratio=float(ratio))


def own(name: str) -> None:
    """Make a picture by the verb that draws it."""
    path = FOLDER / f"{name}.png"
    if name == "states":
        draw_row(o.find_minima(o.examples.degree6("pi/3", ratio=1, symmetry="none")), path)
    elif name == "six_states":
        vertex = o.Vertex.from_degrees((62, 100, 119, 79))
        rest = tuple(np.radians((-180, -141, 180, 180)))
        draw_row(o.find_minima(o.Scene(vertex, (0.02, 0.0186, 0.0129, 0.0135), rest)), path)
    elif name == "birds_foot":
        a, k, p = np.pi / 3, 0.025, np.pi / 2
        psi, error = 2 * np.arctan(np.cos(a) * np.tan(p / 2)), np.radians(10)
        vertex = o.Vertex((a, np.pi - a, np.pi - a, a))
        scene = o.Scene(vertex, (k,) * 4, (-psi + error, p, psi + error, p), symmetry="none")
        draw_row(o.find_minima(scene), path)
    elif name == "measured_hinge":
        o.draw(o.fit_hinge(FOLDER.parent / "files" / "tape.csv"), path)
    elif name == "degree6_pi3":
        o.draw(o.find_minima(panel("pi/3 1"), full=True), path)
    elif name == "metastable_degree8":
        scene = o.examples.degree8("pi/12", ratio=0.01)
        o.draw(o.find_segments(o.find_minima(scene)), path)
    elif name == "space_stops":
        o.draw(o.find_space(replace(o.examples.degree6("pi/3"), limits=(-1.2, 2.0))), path)
    else:
        family, alpha = re.fullmatch(r"space_(degree\d)_(\w+)", name).groups()
        vertex = getattr(o.examples, family)(alpha.replace("5pi", "5*pi").replace("_", "/"))
        o.draw(o.find_space(vertex), path)


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


def drawn_tubes(name: str) -> None:
    """Draw both states of a cylinder of Yoshimura's pattern, six copies round."""
    cell = o.examples.pattern("yoshimura", 1, 1, cell=True, rolled=6)
    found = o.find_minima(cell, effort="quick", escape=False)
    states = [
        (
            f"{m.energy:.4f} J a cell, radius {tube.radius:.3g}, rings {abs(tube.advances[1]) / 2:.4f} apart",
            m.phi,
        )
        for m, tube in zip(found.minima, found.lattices, strict=True)
    ]
    figure = draw_states(
        found.pattern, states, "yoshimura:1x1 --cell --rolled 6: two rows of cells"
    )
    figure.savefig(FOLDER / f"{name}.png", dpi=100)


def drawn_waterbombs(name: str) -> None:
    """Draw the energy of waterbomb bases along both curves of their symmetric states."""
    figure = Figure(figsize=(6, 3.4), layout="constrained")
    axes = figure.subplots()
    for n, colour in ((3, "C0"), (4, "C1"), (6, "C2")):
        a = np.pi / n
        for sign, line in ((1, "-"), (-1, "--")):
            ratio = -(1 + sign * np.sin(a)) / np.cos(a)
            end = min(np.pi, abs(4 * np.arctan(1 / ratio)))
            m = np.linspace(-end, end, 601)
            v = 4 * np.arctan(ratio * np.tan(m / 4))
            u = n * 0.025 / 2 * ((m + np.pi / 3) ** 2 + (v - np.pi / 2) ** 2)
            label = f"{2 * n} creases" if sign > 0 else None
            axes.plot(np.degrees(m), u, line, color=colour, label=label)
    axes.set(xlabel="fold of mountains [deg]", ylabel="energy [J]", xlim=(-185, 100), ylim=(0, 0.6))
    axes.legend(frameon=False, title="dashed: the second curve", loc="upper left")
    figure.savefig(FOLDER / f"{name}.png", dpi=150)


def by_command(*words: str) -> None:
    """Make a picture by the command that stands beside it."""
    subprocess.run([sys.executable, "-m", *words], check=True)


def drawn_load(name: str) -> None:
    """Draw the load path of the tutorial: a torque on the straight mountain of a waterbomb."""
    path = o.load_path(o.examples.waterbomb(), 1, to=0.09, confirm=False)
    o.draw(path, FOLDER / f"{name}.png")


def drawn_hinges(name: str) -> None:
    """Draw the examples of hinges, and a crease that yields."""
    folder = FOLDER / name
    with tempfile.TemporaryDirectory() as there:
        for word, text in HINGE_EXAMPLES.items():
            file = Path(there) / (word + (".fold" if word == "bistable-strip" else ".toml"))
            file.write_text(text())
            read = o.read_pattern if file.suffix == ".fold" else o.read_scene
            o.draw(o.find_minima(read(file)), folder / f"{word}.png")
    vertex = o.Vertex.from_degrees((70, 80, 120, 90))
    rest = tuple(np.radians((-50, 20, -60, -15)))
    creased = o.Scene(vertex, (1.0,) * 4, rest, symmetry="none")
    path = o.load_path(creased, 1, to=0.6, yield_torque=0.3, unload=True)
    o.draw(path, folder / "creased.png")


def reproduce(figure: str, name: str) -> None:
    """Make one of the paper's figures anew; its landscapes as PDF too."""
    from studies import FIGURES

    drawn = FIGURES[figure](figure, 0, lambda *_: None).figure
    for ending in (".png", ".pdf")[: 1 + name.startswith("figure")]:
        drawn.savefig(FOLDER / f"{name}{ending}", dpi=150)


def counted(name: str) -> None:
    """Draw the counts of a recorded run."""
    from studies import SheetCount, draw_counts

    data = json.loads((FOLDER.parent / "counts.json").read_text())
    draw_counts([SheetCount(**one) for one in data["counts"]]).savefig(
        FOLDER / f"{name}.png", dpi=150
    )


def boxed(name: str) -> None:
    """Draw the boxes of vertices that are proved to have four states at most."""
    from studies import draw_boxes

    data = json.loads((FOLDER.parent / "at_most_four.json").read_text())
    boxes = [(one, two, four) for one, two, four in data["boxes"]]
    draw_boxes(boxes, Fraction(data["width"])).savefig(FOLDER / f"{name}.png", dpi=150)


def grown(name: str) -> None:
    """Draw the boxes of vertices that are proved to have six states at most."""
    from studies import draw_two_maxima

    data = json.loads((FOLDER.parent / "at_most_six.json").read_text())
    draw_two_maxima("".join(data["tree"])).savefig(FOLDER / f"{name}.png", dpi=150)


def recorded(name: str) -> None:
    """Draw the times of a recorded run."""
    from benchmarks import PatternBench, draw_coverage, draw_patterns

    which = "bench_search" if name == "speed" else "bench_patterns"
    data = json.loads((FOLDER.parent / f"{which}.json").read_text())
    if name == "speed":
        draw_coverage(data, FOLDER / "speed.png")
    else:
        draw_patterns(PatternBench.from_dict(data), FOLDER / "speed_patterns.png")


PICTURES: dict[str, Callable[[str], None]] = {
    "states": own,
    "degree6_pi3": own,
    "six_states": own,
    "birds_foot": own,
    "sheet_counts": counted,
    "at_most_four": boxed,
    "at_most_six": grown,
    "measured_hinge": own,
    "periodic_miura": drawn_periods,
    "rolled_yoshimura": drawn_tubes,
    "waterbomb_curves": drawn_waterbombs,
    **{
        f"space_{end}": own
        for end in (
            "degree6_pi_4",
            "degree6_pi_3",
            "degree6_5pi_12",
            "degree8_pi_12",
            "degree8_pi_4",
            "stops",
        )
    },
    **{name: lambda name: reproduce(name, name) for name in ("figure3", "figure4")},
    "grid_convergence": lambda name: reproduce("grid-convergence", name),
    **{
        f"cones_{figure}": lambda name: reproduce(name.removeprefix("cones_"), name)
        for figure in ("cone-3", "cone-3-firing", "cone-4", "cone-4-firing", "cone-56")
    },
    "cone_foldings_8": lambda name: by_command(
        "origami_nlp",
        "paper",
        "cone",
        "draw",
        "--degree",
        "8",
        "--elevation",
        "pi/8",
        "-o",
        str(FOLDER / f"{name}.png"),
    ),
    "examples": lambda _: by_command("tests.gallery"),
    "sheets": lambda _: by_command("tests.gallery_of_patterns"),
    **{
        f"states_{family}": lambda name: by_command(
            "tests.bifurcation.maps", name.removeprefix("states_")
        )
        for family in ("degree6", "degree8")
    },
    "bistable_waterbomb": drawn_load,
    "hinges": drawn_hinges,
    "soft_facets": lambda _: by_command("studies.soft_facets"),
    "metastable_degree8": own,
    "barriers_merge_trees": lambda name: by_command(
        "origami_nlp", "barriers", "panels", "-o", str(FOLDER / f"{name}.png")
    ),
    "speed": recorded,
    "speed_patterns": recorded,
    "time_budget": lambda name: by_command(
        "benchmarks", "profile", "-o", str(FOLDER / f"{name}.png"), "-o", "-.md"
    ),
}
"""What makes each picture of the documentation; ``examples`` and ``sheets`` their folder and page."""
SLOW = (
    "examples",
    "sheets",
    "soft_facets",
    "states_degree6",
    "states_degree8",
    "grid_convergence",
    "barriers_merge_trees",
    "time_budget",
)
"""Made only by name, or with ``all``: minutes each."""

if __name__ == "__main__":
    asked = sys.argv[1:] or [name for name in PICTURES if name not in SLOW]
    for name in PICTURES if asked == ["all"] else asked:
        PICTURES[name](name)
