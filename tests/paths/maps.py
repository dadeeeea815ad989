"""The number and kind of stable states over (alpha_1, r_k) for both families of the paper, drawn for `docs/paths.md`.

``python -m tests.paths.maps`` writes ``docs/figures/states_degree6.png`` and ``states_degree8.png``: some fifteen
minutes of processor time, most of them for the full space of degree 8; names of families after it make only those.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke
from scipy.ndimage import distance_transform_edt

import origami_nlp as o
from origami_nlp.paths import BifurcationSet, EventCurve, find_bifurcation_set
from tests.paths.regions import Region, find_regions, region_cells

FIGURES = Path(__file__).parents[2] / "docs" / "figures"
RATIO = "ratio=0.01:100"
BELOW, ABOVE = "alpha=30deg:59.9deg", "alpha=60.1deg:89.5deg"
HALF, WHOLE = "alpha=5deg:44.9deg", "alpha=5deg:85deg"
FAMILIES = {  # in the symmetric space, and in the full one: scene, range of alpha, lines
    "degree6": {
        False: (("degree6", "pi/4", BELOW, 4), ("degree6", "5*pi/12", ABOVE, 6)),
        True: (("degree6", "pi/4", BELOW, 4), ("degree6", "5*pi/12", ABOVE, 5)),
    },
    "degree8": {False: (("degree8", "pi/6", WHOLE, 5),), True: (("degree8", "pi/6", HALF, 4),)},
}
MIRRORED = {("degree8", True)}
"""Where 90 deg - alpha_1 is the same vertex with other labels, and drawn from what is known of alpha_1."""
UNDECIDED = (42.4, 47.6), (0.01, 0.07)
"""Of alpha_1 [deg] and r_k, where curves of degenerate states of degree 8 have loose ends."""
SNAPS = {44.9: 45.0, 59.9: 60.0, 60.1: 60.0}
"""Where ranges end [deg] beside an angle at which something is special, and up to where they are coloured."""
COLOURS = {1: "#f7f7f7", 2: "#dcebf7", 3: "#fbd9a0", 4: "#a9d8ab", 5: "#dd96b0", 6: "#9a86c4"}
"""By the number of states; darker the more there are, in grey as well."""
SPACES = {"in the symmetric space": False, "in the full space": True}
UNSURE = {"facecolor": "white", "edgecolor": "#777777", "hatch": "////", "linewidth": 0.0}
"""What is not decided; all of the plane that is no region of known states."""
LINES = {
    "fold": ({"color": "#b2182b", "lw": 1.4, "zorder": 2.5}, "states meet (fold)"),
    "flat": ({"color": "#2166ac", "lw": 1.4}, "states pass the flat one"),
    "": ({"color": "#222", "lw": 0.9}, "a contact closes or leaves"),
}
"""Curves by what their type ends in."""
SHORT = {"interior": "i", "contact-pinned": "p", "contact-touching": "t", "degenerate": "d"}
NUMBERS = {"ha": "center", "va": "center", "fontsize": 7, "zorder": 5}
NUMBERS |= {"path_effects": [withStroke(linewidth=2.2, foreground="white")]}
"""How numbers are written into regions."""
NAMED = 0.02
"""Share of the plane from which on a region has its numbers written into it."""
Map = tuple[BifurcationSet, Sequence[Region]]


def maps(family: str, full: bool) -> list[Map]:
    """Return curves and regions of each part of a family."""
    out = []
    for name, at, alpha, lines in FAMILIES[family][full]:
        scene = getattr(o.examples, name)(at)
        scene = replace(scene, symmetry="none", mirror=None) if full else scene
        found = find_bifurcation_set(
            scene, RATIO, alpha, lines=lines, across=1 if HALF == alpha else 3
        )
        out.append((found, find_regions(found)))
    return out


def words(kinds: dict[str, int]) -> str:
    """Return kinds of states in short: 2i 1p."""
    return " ".join(f"{n}{SHORT[k]}" for k, n in sorted(kinds.items(), key=lambda k: SHORT[k[0]]))


def draw_map(
    axes: Axes, found: BifurcationSet, regions: Sequence[Region], mirrored: bool = False
) -> None:
    """Draw one part; mirrored: at 90 deg - alpha_1."""

    def place(alpha: float) -> float:
        return 90 - math.degrees(alpha) if mirrored else math.degrees(alpha)

    both, across = found.parameters, found.parameters[1]
    cells = region_cells(found)
    sides = [np.linspace(*parameter.ends, len(cells) + 1) for parameter in both]
    # cells that curves pass belong to what is nearest, so that no seam is left under a line
    nearest = distance_transform_edt(cells == 0, return_distances=False, return_indices=True)
    whole = cells[tuple(nearest)]
    right = [place(v) for v in sides[1]]
    for k, edge in ((0, across.low), (-1, across.high)):
        right[k] = place(math.radians(SNAPS.get(round(math.degrees(edge), 6), math.degrees(edge))))
    for region in (region for region in regions if region.agrees):
        s = [parameter.s_of(t) for parameter, t in zip(both, region.t, strict=True)]
        at = tuple(int(np.searchsorted(side, v)) - 1 for side, v in zip(sides, s, strict=True))
        shown = np.ma.masked_where(whole != whole[at], np.zeros(whole.shape))
        colour = ListedColormap([COLOURS[min(region.minima, 6)]])
        axes.pcolormesh(right, np.exp(sides[0]), shown, cmap=colour, rasterized=True)
        if region.share >= NAMED:
            said = f"{region.minima}\n{words(region.kinds)}"
            axes.text(place(region.t[1]), region.t[0], said, **NUMBERS)
    for curve in found.curves:
        y, x = zip(*(p.t for p in curve.points), strict=True)
        axes.plot([place(v) for v in x], y, **LINES[look_of(curve)][0])


def look_of(curve: EventCurve) -> str:
    """Return the key of `LINES` for a curve."""
    return next(key for key in LINES if curve.type.endswith(key))


def draw(family: str, columns: dict[str, list[Map]]) -> Figure:
    """Draw a family: one column a space."""
    figure = Figure(figsize=(9.6, 4.6), layout="constrained")
    every = figure.subplots(1, len(columns), sharey=True, squeeze=False)[0]
    for axes, (title, parts) in zip(every, columns.items(), strict=True):
        axes.add_patch(Rectangle((0, 0), 1, 1, transform=axes.transAxes, **UNSURE, zorder=0))
        for found, regions in parts:
            draw_map(axes, found, regions)
            if (family, SPACES[title]) in MIRRORED:
                draw_map(axes, found, regions, mirrored=True)
                axes.fill_between(UNDECIDED[0], *UNDECIDED[1], **UNSURE, zorder=3)
        up, first = parts[0][0].parameters
        last = 85 if family == "degree8" else math.degrees(parts[-1][0].parameters[1].high)
        axes.set(yscale="log", ylim=(up.low, up.high), xlim=(math.degrees(first.low), last))
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("sector angle $\\alpha_1$ [deg]")
        if len(parts) > 1:
            axes.axvline(60, color="black", ls=":", lw=1)
    figure.axes[0].set_ylabel("stiffness ratio $r_k$")
    look = {"loc": "outside lower center", "ncols": 5, "frameon": False, "fontsize": 8}
    figure.legend(handles=legend([part for parts in columns.values() for part in parts]), **look)
    return figure


def legend(parts: Sequence[Map]) -> list[Artist]:
    """Return entries for what occurs."""
    regions = [region for _, own in parts for region in own]
    most = max(COLOURS)
    seen = sorted({min(region.minima, most) for region in regions if region.agrees})
    entries: list[Artist] = [
        Patch(color=COLOURS[k], label=f"{k}{' or more' * (k == most)} states") for k in seen
    ]
    entries.append(Patch(**UNSURE, label="not decided"))
    looks = {look_of(curve) for found, _ in parts for curve in found.curves}
    for look, label in (LINES[key] for key in LINES if key in looks):
        entries.append(Line2D([], [], **look, label=label))
    kinds = {
        k for region in regions if region.agrees and region.share >= NAMED for k in region.kinds
    }
    entries += [Line2D([], [], ls="", label=f"{SHORT[k]}: {k}") for k in SHORT if k in kinds]
    return entries


def main() -> None:
    """Write both figures, and say what is in the regions."""
    for family in sys.argv[1:] or FAMILIES:
        columns = {title: maps(family, full) for title, full in SPACES.items()}
        for title, parts in columns.items():
            for r in (r for _, regions in parts for r in regions):
                where = [round(v, 4) for v in r.t]
                print(family, title, where, f"{r.share:.3f}", r.kinds, r.agrees)
        draw(family, columns).savefig(FIGURES / f"states_{family}.png", dpi=160)


if __name__ == "__main__":
    main()
