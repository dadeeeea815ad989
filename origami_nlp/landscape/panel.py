"""One landscape with exact boundaries in matplotlib Axes, in the manner of the paper.

Colours: energy from dark (low) to light, cut exactly at the contact boundaries; minima gold where stable in the full
space, red where not, grey where undecided, their shape says the kind; red lines: metastable stretches; dashed:
1-handles, on which states exist only at phi = +-pi exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import Colormap, ListedColormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import withStroke

from origami_nlp.chart import Branch, chart_limits, chart_of, energy_image, norm_of
from origami_nlp.landscape.exact import ExactLandscape
from origami_nlp.minima import Minimum

VERDICTS = {
    "stable": ("#FFC107", "stable in the full space"),
    "unstable": ("#D81B60", "unstable in the full space"),
    "undecided": ("#9E9E9E", "undecided"),
    None: ("#FFFFFF", "full space not asked"),
}
"""Colour of a minimum by its verdict in the full space, and what the legend says."""
SHAPES: dict[str, tuple[Any, float]] = {
    "interior": ((5, 1, 0), 1.0),
    "contact-pinned": ((4, 1, 0), 1.0),
    "contact-touching": ((6, 1, 0), 1.0),
    "degenerate": ("X", 0.72),
}
"""Marker of a minimum by its kind, and its relative size."""
RED, EDGE, HANDLE, PASS = "#E10000", "#1B1B1B", "#7B1FA2", "#00E5FF"


def energy_colours() -> Colormap:
    """Dark blue (low) to pale green: stars and red lines stand out, and none of it is white."""
    scale = matplotlib.colormaps["YlGnBu_r"](np.linspace(0.03, 0.90, 256))
    return ListedColormap(scale, name="energy")


@dataclass(frozen=True)
class PanelStyle:
    """Sizes in points.

    Attributes
    ----------
    star
        Of a marker.
    line
        Width of a boundary.
    text
        Font size.
    numbers
        Whether minima are numbered.
    """

    star: float = 15.0
    line: float = 1.1
    text: float = 10.0
    numbers: bool = True


def draw_panel(axes: Any, exact: ExactLandscape, branches: list[int], style: PanelStyle) -> Any:
    """Draw branches of a landscape into one Axes.

    Parameters
    ----------
    axes
        Of matplotlib.
    exact
        Of `find_landscape`.
    branches
        Which of the chart's, from 0.
    style
        Sizes of marks and letters.

    Returns
    -------
    matplotlib.collections.QuadMesh or matplotlib.image.AxesImage
        The energies, for a colour bar.
    """
    chart = chart_of(exact.result.scene)
    assert chart is not None
    x0, x1, y0, y1 = chart_limits(chart)
    norm = norm_of(exact.chart, (m.energy for m in exact.result.minima))
    image = None
    for k in branches:
        image = _draw_energy(axes, exact, k, norm, style)
    if exact.boundary is not None:
        for line in exact.boundary.lines:
            if line.branch in branches and not line.hidden:
                look: dict[str, Any] = {"color": EDGE, "linewidth": style.line, "zorder": 3}
                if line.thin:
                    dashes = (0, (3.0, 1.6))
                    look = {"color": HANDLE, "linewidth": 1.9 * style.line, "linestyle": dashes}
                axes.plot(*line.points.T, **look, clip_on=False, snap=False, solid_capstyle="round")
    for part in exact.metastable:
        if part.branch not in branches:
            continue
        top = {"zorder": 4, "clip_on": False, "color": RED}
        if part.hidden:
            ring = {"marker": "o", "markersize": 1.6 * style.star, "markerfacecolor": "none"}
            axes.plot(*part.points[:1].T, **ring, markeredgewidth=2.2 * style.line, **top)
        else:
            axes.plot(*part.points.T, linewidth=3.4 * style.line, solid_capstyle="butt", **top)
    for spine in axes.spines.values():
        spine.set(color="#8A8A8A", linewidth=0.6, zorder=0)
    axes.set(xlim=(x0, x1), ylim=(y0, y1))
    _stars(axes, exact, branches, style)
    return image


def write_counts(axes: Any, exact: ExactLandscape, branches: list[int], style: PanelStyle) -> None:
    """Write N_sym -> N_not-ruled-out -> N_full into the emptiest corner, a lower one if there is a choice.

    Parameters
    ----------
    axes
        Of matplotlib.
    exact
        Of `find_landscape`.
    branches
        Those that are drawn there.
    style
        Sizes of marks and letters.
    """
    shown = ["?" if n is None else str(n) for n in exact.counts]
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    right, up = min(corners, key=lambda c: _taken(exact, branches, *c))
    axes.annotate(
        r"$\,\to\,$".join(shown),
        (right, up),
        xycoords="axes fraction",
        xytext=(-6 if right else 6, -6 if up else 6),
        textcoords="offset points",
        ha="right" if right else "left",
        va="top" if up else "bottom",
        fontsize=style.text,
        zorder=9,
        bbox={
            "boxstyle": "round,pad=0.25",
            "fc": "white",
            "ec": "#777777",
            "lw": 0.5,
            "alpha": 0.93,
        },
    )


def _taken(exact: ExactLandscape, branches: list[int], right: int, up: int) -> float:
    """How much of the box in a corner is taken by the region, or by minima."""
    chart = chart_of(exact.result.scene)
    assert chart is not None
    x0, x1, y0, y1 = chart_limits(chart)

    def inside(x: Any, y: Any) -> Any:
        u, v = (x - x0) / (x1 - x0), (y - y0) / (y1 - y0)
        return (u > 0.62 if right else u < 0.38) & (v > 0.86 if up else v < 0.14)

    taken = 0.0
    for k in branches:
        branch = exact.chart.branches[k]
        corner = inside(*np.meshgrid(*branch.axes))
        taken += float(np.isfinite(branch.energy[corner]).mean()) if corner.any() else 0.0
        taken += sum(
            2.0 * bool(inside(*p.point)) for p in exact.places if p.branch == k and p.drawn
        )
    return taken


def _draw_energy(
    axes: Any, exact: ExactLandscape, k: int, norm: Normalize, style: PanelStyle
) -> Any:
    """Draw the colours and contour lines of one branch, cut at its exact boundary."""
    branch = exact.chart.branches[k]
    energy = np.ma.masked_invalid(fill_outwards(branch) if exact.regions else branch.energy)
    smooth = "bilinear" if exact.regions else "nearest"
    look = {"cmap": energy_colours(), "interpolation": smooth, "zorder": 1}
    image = energy_image(axes, branch, energy, norm, **look)
    levels = [norm.inverse(v) for v in np.linspace(0.0, 1.0, 12)[1:-1]]
    lines = axes.contour(
        *branch.axes,
        energy,
        levels=levels,
        colors="white",
        linewidths=0.4 * style.line,
        alpha=0.7,
        zorder=2,
    )
    if exact.regions:
        patch = PathPatch(
            region_path(exact.regions[k]), transform=axes.transData, fc="none", ec="none"
        )
        axes.add_patch(patch)
        image.set_clip_path(patch)
        lines.set_clip_path(patch)
    return image


def region_path(region: Any) -> Path:
    """Return shapely polygons, holes included, as one compound path."""
    parts = [
        Path(np.asarray(ring.coords), closed=True)
        for polygon in region.geoms
        for ring in (polygon.exterior, *polygon.interiors)
    ]
    return Path.make_compound_path(*parts) if parts else Path(np.zeros((1, 2)))


def fill_outwards(branch: Branch, steps: int = 6) -> np.ndarray:
    """Carry the energy on over the edge by linear extrapolation, for cells that the boundary cuts."""
    energy = branch.energy.copy()
    for _ in range(steps):
        padded = np.pad(energy, 2, constant_values=np.nan)
        rows, columns = energy.shape
        guesses = []
        for dr, dc in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            near = padded[2 + dr : 2 + dr + rows, 2 + dc : 2 + dc + columns]
            far = padded[2 + 2 * dr : 2 + 2 * dr + rows, 2 + 2 * dc : 2 + 2 * dc + columns]
            guesses.append(np.where(np.isfinite(far), 2 * near - far, near))
        every = np.array(guesses)
        known = np.isfinite(every)
        count = known.sum(axis=0)
        mean = np.where(known, every, 0.0).sum(axis=0) / np.maximum(count, 1)
        energy = np.where(np.isnan(energy) & (count > 0), np.maximum(mean, 0.0), energy)
    return energy


def verdict_of(minimum: Minimum) -> str | None:
    """Return the verdict in the full space, None if it was not asked for."""
    return minimum.full_space.verdict if minimum.full_space else None


def _stars(axes: Any, exact: ExactLandscape, branches: list[int], style: PanelStyle) -> None:
    """Put the minima on top, unstable ones last; those that share a point share a number label."""
    order = sorted(
        range(len(exact.places)), key=lambda k: verdict_of(exact.result.minima[k]) == "unstable"
    )
    labels: list[tuple[tuple[float, float], list[int]]] = []
    for k in order:
        minimum, place = exact.result.minima[k], exact.places[k]
        if place.branch not in branches or not place.drawn:
            continue
        marker, scale = SHAPES[minimum.kind]
        axes.plot(
            *place.point,
            marker=marker,
            markersize=style.star * scale,
            markerfacecolor=VERDICTS[verdict_of(minimum)][0],
            markeredgecolor="black",
            markeredgewidth=0.055 * style.star,
            linestyle="none",
            zorder=7,
            clip_on=False,
            path_effects=[withStroke(linewidth=0.19 * style.star, foreground="white")],
        )
        for point, numbers in labels:
            if max(abs(point[0] - place.point[0]), abs(point[1] - place.point[1])) < 0.05:
                numbers.append(k + 1)
                break
        else:
            labels.append((place.point, [k + 1]))
    if style.numbers:
        for point, numbers in labels:
            side = -1 if point[0] > 2.2 else 1
            axes.annotate(
                ", ".join(map(str, sorted(numbers))),
                point,
                xytext=(side * 0.62 * style.star, 0.5 * style.star),
                textcoords="offset points",
                ha="left" if side > 0 else "right",
                fontsize=1.05 * style.text,
                weight="bold",
                zorder=8,
                annotation_clip=False,
                path_effects=[withStroke(linewidth=2.6, foreground="white")],
            )


def legend_of(panels: list[ExactLandscape], style: PanelStyle) -> list[Line2D]:
    """Return legend entries for what occurs on any of the panels.

    Parameters
    ----------
    panels
        Of `find_landscape`.
    style
        Sizes of marks and letters.

    Returns
    -------
    list of matplotlib.lines.Line2D
        Handles with labels.
    """
    minima = [m for panel in panels for m in panel.result.minima]
    entries = []

    def sample(label: str, **look: Any) -> None:
        entries.append(Line2D([], [], label=label, **{"linestyle": "none", **look}))

    size = 0.8 * style.star
    for verdict, (colour, text) in VERDICTS.items():
        if any(verdict_of(m) == verdict for m in minima):
            look = {"markerfacecolor": colour, "markeredgecolor": "black", "markeredgewidth": 0.6}
            sample(text, marker=SHAPES["interior"][0], markersize=size, **look)
    for kind, (marker, scale) in SHAPES.items():
        if any(m.kind == kind for m in minima):
            look = {
                "markerfacecolor": "#DDDDDD",
                "markeredgecolor": "black",
                "markeredgewidth": 0.6,
            }
            sample(kind.replace("-", " "), marker=marker, markersize=size * scale, **look)
    stretches = [s for panel in panels for s in panel.metastable]
    solid = {"linestyle": "-"}
    if any(not s.hidden for s in stretches):
        sample("metastable stretch", color=RED, linewidth=3.0 * style.line, **solid)
    if any(s.hidden for s in stretches):
        ring = {"marker": "o", "markersize": 1.2 * size, "markerfacecolor": "none"}
        sample("metastable, on one point", markeredgecolor=RED, markeredgewidth=1.6, **ring)
    lines = [ln for panel in panels if panel.boundary for ln in panel.boundary.lines]
    if lines:
        sample("contact", color=EDGE, linewidth=style.line, **solid)
    if any(ln.thin for ln in lines):
        sample("1-handle", color=HANDLE, linewidth=1.9 * style.line, linestyle=(0, (3.0, 1.6)))
    return entries
