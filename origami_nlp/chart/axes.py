"""Putting a landscape into matplotlib Axes: areas within exact boundaries, or curves.

Colours and lines are those of `display.style`; minima and passes are marked by who knows them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import Normalize, PowerNorm
from matplotlib.lines import Line2D

from origami_nlp.chart.boundary import Boundary
from origami_nlp.chart.chart import chart_limits, chart_of
from origami_nlp.chart.energy_map import Landscape
from origami_nlp.display import HANDLE, INK, INKS, angle_ticks, energy_colours, patch, subscript
from origami_nlp.numerics import NONZERO

UNIT = "J"
"""Of energies when stiffness is given in N m/rad."""
DASHES = ("-", (0, (6, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
"""Of the curves of one degree of freedom, so that they differ in grey too."""
WHITE = {
    "full": "excluded: facets cross or |φ| > 180°",
    "fold-limits": "excluded: |φ| > 180°",
    "none": "no closed state with all |φ| ≤ π",
}
"""What is white in a picture, by the contact of the scene."""


def norm_of(chart: Landscape, energies: Iterable[float] = ()) -> Normalize:
    """One colour scale for all branches and `energies`, finer at low energies, where the minima are."""
    values = np.concatenate([b.energy[np.isfinite(b.energy)] for b in chart.branches])
    low, high = min([*values, *energies], default=0.0), float(values.max(initial=-math.inf))
    if not high > low:
        high = low + max(abs(low), NONZERO)
    return PowerNorm(0.5, vmin=float(low), vmax=high)


def draw_area(
    axes: Any,
    chart: Landscape,
    branches: Sequence[int],
    norm: Normalize,
    boundary: Boundary | None,
    line: float = 1.1,
) -> Any:
    """Draw branches of a landscape, and their exact boundary.

    Parameters
    ----------
    axes
        Of matplotlib.
    chart
        Of two coordinates.
    branches
        Which of the chart's, from 0.
    norm
        Of `norm_of`.
    boundary
        Of `outline_of`.
    line
        Width of a boundary [points].

    Returns
    -------
    matplotlib.image.AxesImage
        The energies, for a colour bar.
    """
    image, whole = None, chart_of(chart.scene)
    assert whole is not None
    for branch in (chart.branches[k] for k in branches):
        image = _draw_energy(axes, branch.axes, branch.energy, norm, line)
    for one in boundary or ():
        if one.branch in branches and not one.hidden:
            look: dict[str, Any] = {"color": INK, "linewidth": line}
            look = HANDLE | {"lw": 1.9 * line} if one.thin else look
            axes.plot(*one.points.T, **{"zorder": 3} | look, clip_on=False, snap=False)
    for spine in axes.spines.values():
        spine.set(color="#8A8A8A", linewidth=0.6, zorder=0)
    x0, x1, y0, y1 = chart_limits(whole)
    axes.set(xlim=(x0, x1), ylim=(y0, y1))
    axes.set_xlabel(coordinate_label(chart.coordinates[0]))
    axes.set_ylabel(coordinate_label(chart.coordinates[1]), labelpad=0)
    angle_ticks(axes.xaxis, x0, x1)
    angle_ticks(axes.yaxis, y0, y1)
    return image


def area_legend(chart: Landscape, boundary: Boundary | None, line: float = 1.1) -> list[Any]:
    """Return legend entries for the lines and the white of `draw_area`.

    Parameters
    ----------
    chart, boundary, line
        Of `draw_area`.

    Returns
    -------
    list of matplotlib.artist.Artist
        Handles with labels.
    """
    entries: list[Any] = []
    if boundary:
        entries.append(Line2D([], [], color=INK, linewidth=line, label="contact"))
        if any(each.thin for each in boundary):
            entries.append(Line2D([], [], **HANDLE | {"lw": 1.9 * line}, label="1-handle"))
    white = WHITE[chart.scene.contact]
    return [*entries, patch("white", f"{white}, or stops" if chart.scene.limits else white)]


def _draw_energy(axes: Any, at: Any, energy: np.ndarray, norm: Normalize, line: float) -> Any:
    """Draw the colours and contour lines of one branch, up to the cells of the grid that have no state."""
    energy = np.ma.masked_invalid(energy)
    # pixels around the middles of cells
    half = [(v[1] - v[0]) / 2 for v in at]
    extent = [e for v, h in zip(at, half, strict=True) for e in (v[0] - h, v[-1] + h)]
    look: dict[str, Any] = {"cmap": energy_colours(), "interpolation": "bilinear", "zorder": 1}
    image = axes.imshow(energy, extent=extent, origin="lower", norm=norm, aspect="auto", **look)
    levels = norm.inverse(np.linspace(0.0, 1.0, 12)[1:-1])
    look = {"levels": levels, "colors": "white", "linewidths": 0.4 * line, "alpha": 0.7}
    axes.contour(*at, energy, **look, zorder=2)
    return image


def draw_curves(axes: Any, chart: Landscape) -> list[Any]:
    """Draw energy against a fold angle, one line for each curve of states.

    Parameters
    ----------
    axes
        Of matplotlib.
    chart
        Of one coordinate.

    Returns
    -------
    list of matplotlib.lines.Line2D
        Handles for a legend, which name the curves.
    """
    handles = []
    for k, branch in enumerate(chart.branches):
        look = {"color": INKS[k % len(INKS)], "linestyle": DASHES[k % len(DASHES)]}
        name = curve_name(chart, k)
        handles += axes.plot(branch.axes[0], branch.energy, **look, linewidth=1.8, label=name)
    axes.set(xlim=(-1.06 * math.pi, 1.06 * math.pi))
    axes.margins(y=0.09)
    angle_ticks(axes.xaxis, -math.pi, math.pi)
    axes.set_xlabel(coordinate_label(chart.coordinates[0]))
    axes.set_ylabel(f"energy U [{UNIT}]")
    axes.grid(color="#dddddd", linewidth=0.6)
    return handles


def curve_name(chart: Landscape, k: int) -> str:
    """Name a curve of states by the folds of its creases where the coordinate is largest.

    Parameters
    ----------
    chart
        Of one coordinate.
    k
        Which curve, from 0.

    Returns
    -------
    str
        Such as ``VMV− for φ₁ > 0``: crease 1 a valley, 2 a mountain, 3 a valley, 4 not folded.

    Examples
    --------
    >>> from origami_nlp import Scene, Vertex
    >>> from origami_nlp.chart import landscape
    >>> from origami_nlp.chart.axes import curve_name
    >>> scene = Scene(Vertex(("pi/3", "2*pi/3", "2*pi/3", "pi/3")), (1,) * 4, (0,) * 4, "D1")
    >>> chart = landscape(scene, 64)
    >>> [curve_name(chart, k) for k in range(len(chart.branches))]
    ['VMMM for φ₁ > 0', 'V−V− for φ₁ > 0']
    """
    crease = int(chart.coordinates[0].removeprefix("phi_"))
    states = chart.branches[k].fold_angles
    at = states[:, crease - 1]
    towards = 1.0 if np.nanmax(at) > -np.nanmin(at) - 1e-6 else -1.0
    # halfway: where creases are at their limits or flat again, the rest says nothing
    middle = states[int(np.nanargmin(np.abs(at - towards * np.nanmax(towards * at) / 2)))]
    letters = "".join("−VM"[int(np.sign(np.round(phi, 6)))] for phi in middle)
    return f"{letters} for φ{subscript(crease)} {'>' if towards > 0 else '<'} 0"


def coordinate_label(name: str) -> str:
    """Return the name of a chart's coordinate for an axis."""
    if name.startswith("phi_"):
        return rf"fold angle $\varphi_{{{name[4:]}}}$"
    crease = name.rsplit(" ", 1)[-1].rstrip(")")
    return rf"elevation $\upsilon$ of crease {crease}"
