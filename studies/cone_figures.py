"""Figures 7 to 10 of the paper (labels cone-3, cone-3-firing, cone-4, cone-4-firing, cone-56) from exact counts.

Each is drawn twice: with the paper's options (interior minima deeper than 1e-3 of the flat state's energy) and
exactly (all minima, contact included, no threshold).  The horizontal axis is the paper's: its intervals of nu_0 are
mirror images of those that its own Q(e2, v) gives (errata, s5.range-6-8), so nu_0 is minus ours.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.display import draw_state
from origami_nlp.paper.cone import (
    Cone,
    PhaseDiagram,
    branch,
    draw_boundaries,
    draw_map,
    legend,
    phase_diagram,
)
from studies.section5 import DEPTH

SIZE, ZOOMED = 160, 120
"""Points of the maps along each coordinate."""
ZOOM = {
    8: (math.pi / 16, (0.05, 25.0)),
    10: (math.pi / 16, (0.05, 25.0)),
    12: (math.pi / 16, (0.05, 25.0)),
}
"""Half width of the zooms in nu_0, and their ratios: printed for N = 8, and used for the others."""
WIDTH, HEIGHT = 3.5, 3.2
"""Of one panel [in]."""
SNAPSHOTS = (("VVV", "up"), ("VVM", "up"), ("VVM", "down"), ("VMM", "down"))
"""Branches of degree 6 that are drawn below their map."""


@lru_cache(maxsize=32)
def _diagram(degree: int, exact: bool, zoom: bool = False) -> PhaseDiagram:
    half, ratios = ZOOM.get(degree, (0.0, (0.0, 0.0)))
    where: dict[str, Any] = {}
    if zoom:
        where = {"ratios": ratios, "rest_elevations": (-half, half)}
    depth = 0.0 if exact else DEPTH
    size = ZOOMED if zoom else SIZE
    return phase_diagram(degree, size=size, depth=depth, contact=exact, **where)


def _map(axes: Any, degree: int, what: str, zoom: bool = False) -> None:
    """One map on the paper's axis: "paper" (its options) or "ends" (exact)."""
    diagram = _diagram(degree, what == "ends", zoom)
    m = diagram.map
    counts = m.at_end if what == "ends" else diagram.minima
    total = m.branches
    if what == "ends":
        span = f"{min(diagram.numbers)}"
        if len(diagram.numbers) > 1:
            span += f" to {max(diagram.numbers)}"
        title = f"at an end (contact or cut), of {span} minima"
    else:
        title = f"$N$ = {degree}: interior, depth > $10^{{-3}}$" + (" (zoom)" if zoom else "")
    borders = diagram.bounding("at end" if what == "ends" else "interior")
    draw_map(
        axes,
        -m.elevations[::-1],
        m.ratios,
        counts[:, ::-1],
        total,
        title=title,
        boundaries=borders,
        mirrored=True,
    )


def _curves(axes: Any, degree: int, exact: bool) -> None:
    """Draw boundaries on the paper's axis."""
    diagram = _diagram(degree, exact)
    low, high = Cone(degree).rest_range
    window = ((-high, -low), (float(diagram.map.ratios[0]), float(diagram.map.ratios[-1])))
    draw_boundaries(axes, diagram.boundaries, *window, mirrored=True)
    name = "exact" if exact else "interior, depth > $10^{-3}$"
    axes.set_title(f"$N$ = {degree}: {name}", fontsize=9)
    legend(axes)


def _snapshots(figure: Any) -> None:
    """Draw folded branches of degree 6 with the number of branches of equal energy."""
    for axes, snapshot in zip(figure.subplots(1, len(SNAPSHOTS)), SNAPSHOTS, strict=True):
        own = branch(*snapshot)
        draw_state(axes, own.vertex, own.fold_angles(own.direction * 0.8 * own.end), crop=True)
        many = own.energy_class.multiplicity
        title = f"{own.energy_class.name}: {many} branch{'es' if many > 1 else ''}"
        axes.set_title(title, fontsize=8)


def _cone3(figure: Any) -> None:
    top, bottom = figure.subfigures(2, 1, height_ratios=(HEIGHT, 1.6))
    left, right = top.subplots(1, 2)
    _map(left, 6, "paper")
    _map(right, 6, "ends")
    _snapshots(bottom)


def _firing(degree: int) -> Callable[[Any], None]:
    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        _curves(left, degree, exact=False)
        _curves(right, degree, exact=True)

    return draw


def _cone4(figure: Any) -> None:
    left, middle, right = figure.subplots(1, 3)
    _map(left, 8, "paper")
    _map(middle, 8, "paper", zoom=True)
    _map(right, 8, "ends")


def _cone56(figure: Any) -> None:
    for row, degree in zip(figure.subplots(2, 3), (10, 12), strict=True):
        _map(row[0], degree, "paper")
        _map(row[1], degree, "paper", zoom=True)
        _map(row[2], degree, "ends")


SHEETS: dict[str, tuple[Callable[[Any], None], tuple[float, float], str]] = {
    "cone-3": (_cone3, (2 * WIDTH + 1, HEIGHT + 1.8), "Multistability of the 6-fold cone"),
    "cone-3-firing": (_firing(6), (2 * WIDTH + 1, HEIGHT + 0.8), "Boundaries of the 6-fold cone"),
    "cone-4": (_cone4, (3 * WIDTH + 0.5, HEIGHT + 0.3), "Multistability of the 8-fold cone"),
    "cone-4-firing": (_firing(8), (2 * WIDTH + 1, HEIGHT + 0.8), "Boundaries of the 8-fold cone"),
    "cone-56": (
        _cone56,
        (3 * WIDTH + 0.5, 2 * HEIGHT + 0.4),
        "Multistability of the 10- and 12-fold cones",
    ),
}
"""Label in the paper: how it is drawn, its size [in], its title."""


def draw_cone_figure(name: str) -> Figure:
    """Draw one of the paper's figures of section 5 by its label, or all of them (``"cones"``)."""
    if name != "cones":
        draw, size, title = SHEETS[name]
        figure = Figure(figsize=size, layout="constrained", dpi=100)
        draw(figure)
        figure.suptitle(title, fontsize=10)
        return figure
    width = max(size[0] for _, size, _ in SHEETS.values())
    heights = [size[1] for _, size, _ in SHEETS.values()]
    figure = Figure(figsize=(width, sum(heights)), layout="constrained", dpi=100)
    parts = figure.subfigures(len(SHEETS), 1, height_ratios=heights)
    for part, (draw, _, title) in zip(np.asarray(parts).tolist(), SHEETS.values(), strict=True):
        draw(part)
        part.suptitle(title, fontsize=11)
    return figure
