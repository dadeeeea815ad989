"""The number and kind of stable states over (alpha_1, r_k) for both families of the paper, drawn for `docs/paths.md`.

``python -m tests.atlas.maps`` writes ``docs/figures/states_degree6.png`` and ``states_degree8.png``: some three
minutes of processor time, most of them for the full space of degree 6.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

import origami_nlp as o
from origami_nlp.atlas import Boundaries, Region, find_boundaries, find_regions, region_cells

FIGURES = Path(__file__).parents[2] / "docs" / "figures"
RATIO = "ratio=0.01:100"
FAMILIES = {  # scene, range of alpha, lines in the symmetric space and, where it is drawn, in the full one
    "degree6": (
        (lambda: o.examples.degree6("pi/4"), "alpha=30deg:59.9deg", 4, 4),
        (lambda: o.examples.degree6("5*pi/12"), "alpha=60.1deg:89.5deg", 6, 5),
    ),
    "degree8": ((lambda: o.examples.degree8("pi/6"), "alpha=5deg:85deg", 5),),
}
COLOURS = {1: "#f0f0f0", 2: "#cfe3f3", 3: "#fbe2b8", 4: "#cfe8cf", 5: "#f3cfd8", 6: "#ddd2ee"}
SPACES = {"in the symmetric space": False, "in the full space": True}
UNSURE = "#bdbdbd"
SHORT = {"interior": "i", "contact-pinned": "p", "contact-touching": "t", "degenerate": "d"}
Map = tuple[Boundaries, Sequence[Region]]


def maps(family: str, full: bool) -> list[Map]:
    """Return curves and regions of each part of a family."""
    out = []
    for make, alpha, *lines in FAMILIES[family]:
        scene = make()
        scene = replace(scene, symmetry="none", mirror=None) if full else scene
        found = find_boundaries(scene, RATIO, alpha, lines=lines[full], across=3)
        out.append((found, find_regions(found)))
    return out


def words(kinds: dict[str, int]) -> str:
    """Return kinds of states in short: 2i 1p."""
    return " ".join(f"{n}{SHORT[k]}" for k, n in sorted(kinds.items(), key=lambda k: SHORT[k[0]]))


def draw_map(axes: Axes, found: Boundaries, regions: Sequence[Region]) -> set[int]:
    """Draw one part; return the numbers of states on it."""
    up, across = found.overs
    numbers = region_cells(found)
    sides = [
        np.linspace(over.s_of(over.low), over.s_of(over.high), len(numbers) + 1)
        for over in (up, across)
    ]
    seen = set()
    for region in regions:
        at = [
            int(np.searchsorted(side, over.s_of(t))) - 1
            for side, over, t in zip(sides, (up, across), region.t, strict=True)
        ]
        if region.agrees:
            seen.add(region.minima)
        colour = COLOURS[min(region.minima, 6)] if region.agrees else UNSURE
        axes.contourf(
            *(np.degrees(0.5 * (sides[1][1:] + sides[1][:-1])), np.exp(0.5 * (sides[0][1:] + sides[0][:-1]))),
            numbers == numbers[tuple(at)],
            levels=[0.5, 1.5],
            colors=[colour],
            antialiased=False,
        )  # fmt: skip
        if region.share >= 0.02:
            text = f"{region.minima}\n{words(region.kinds)}" if region.agrees else "?"
            axes.text(
                math.degrees(region.t[1]), region.t[0], text, ha="center", va="center", fontsize=7
            )
    for curve in found.curves:
        x, y = [math.degrees(p.t[1]) for p in curve.points], [p.t[0] for p in curve.points]
        fold = "fold" in curve.type
        axes.plot(x, y, color="#b2182b" if fold else "#222", lw=1.4 if fold else 0.9)
    return seen


def draw(family: str, columns: dict[str, list[Map]]) -> Figure:
    """Draw a family: one column a space."""
    figure = Figure(figsize=(9.6, 4.6), layout="constrained")
    seen: set[int] = set()
    for axes, (title, parts) in zip(
        figure.subplots(1, len(columns), sharey=True, squeeze=False)[0],
        columns.items(),
        strict=True,
    ):
        for found, regions in parts:
            seen |= draw_map(axes, found, regions)
        axes.set_yscale("log")
        axes.set_ylim(parts[0][0].overs[0].low, parts[0][0].overs[0].high)
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("$\\alpha_1$ [deg]")
        axes.set_xlim(
            *(math.degrees(v) for v in (parts[0][0].overs[1].low, parts[-1][0].overs[1].high))
        )
        if len(parts) > 1:
            axes.axvline(60, color="black", ls=":", lw=1)
    figure.axes[0].set_ylabel("$r_k$")
    patches = [Patch(color=COLOURS[k], label=f"{k} states") for k in sorted(seen)]
    patches.append(Patch(color=UNSURE, label="searches in it differ"))
    lines = [
        figure.axes[0].plot([], [], color=c, label=t)[0]
        for c, t in (("#b2182b", "states meet (fold)"), ("#222", "a contact closes or leaves"))
    ]
    figure.legend(
        handles=[*patches, *lines], loc="outside lower center", ncols=8, frameon=False, fontsize=8
    )
    return figure


def main() -> None:
    """Write both figures, and say what is in the regions."""
    for family in FAMILIES:
        spaces = len(FAMILIES[family][0]) - 2
        columns = {title: maps(family, full) for title, full in list(SPACES.items())[:spaces]}
        for title, parts in columns.items():
            for _, regions in parts:
                for r in regions:
                    print(
                        family,
                        title,
                        [round(v, 4) for v in r.t],
                        f"{r.share:.3f}",
                        r.kinds,
                        r.agrees,
                    )
        draw(family, columns).savefig(FIGURES / f"states_{family}.png", dpi=160)


if __name__ == "__main__":
    main()
