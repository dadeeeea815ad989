"""Putting a landscape and its minima into matplotlib Axes: areas, curves, markers, labels.

Kinds of minima differ in colour (Okabe and Ito's palette, safe for colour-blind readers) and in
shape.  A square around a marker: the feasible set there is a curve (1-handle); a dot in a white
marker: an isolated point; a ring: a family of states shares this point of the chart.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.colors import Normalize, PowerNorm
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from origami_nlp.chart.energy_map import Branch, Landscape
from origami_nlp.show import angle_ticks

UNIT = "J"
"""Of energies when stiffness is given in N m/rad."""
CURVES = ("#0072B2", "#009E73", "#000000", "#D55E00", "#CC79A7", "#E69F00")


def norm_of(chart: Landscape, energies: Iterable[float] = ()) -> Normalize:
    """One colour scale for all branches and `energies`, finer at low energies, where the minima are."""
    values = np.concatenate([b.energy[np.isfinite(b.energy)] for b in chart.branches])
    low, high = (values.min(), values.max()) if values.size else (0.0, 1.0)
    low = min([low, *energies])
    if not high > low:
        high = low + max(abs(low), 1e-300)
    return PowerNorm(0.5, vmin=float(low), vmax=float(high))


def energy_image(axes: Any, branch: Branch, energy: Any, norm: Normalize, **look: Any) -> Any:
    """Paint the cells of a branch by their energies [ny, nx], none where it is masked; returns the image."""
    (left, right), (low, high) = map(cell_edges, branch.axes)
    extent = (left, right, low, high)
    return axes.imshow(energy, extent=extent, origin="lower", norm=norm, aspect="auto", **look)


def cell_edges(values: np.ndarray) -> tuple[float, float]:
    """Return where the first of evenly spaced cells starts, and the last one ends, given their middles."""
    half = (values[1] - values[0]) / 2
    return float(values[0] - half), float(values[-1] + half)


def draw_area(
    axes: Any, chart: Landscape, k: int, norm: Normalize, avoid: list[tuple[float, float]]
) -> Any:
    """Draw branch k as colours with sparse contour lines; returns the image for the colour bar.

    avoid: points of markers, beside which contour lines get no label.
    """
    branch = chart.branches[k]
    x, y = branch.axes
    (left, right), (low, high) = cell_edges(x), cell_edges(y)
    energy = np.ma.masked_invalid(branch.energy)
    image = energy_image(axes, branch, energy, norm, cmap="cividis", interpolation="nearest")
    levels = _levels(norm, energy)
    if levels:
        lines = axes.contour(
            x, y, energy, levels=levels, colors="white", linewidths=0.6, alpha=0.75
        )
        labels = axes.clabel(lines, fontsize=7, fmt="%g", inline_spacing=2)
        reach = 0.05 * np.array([right - left, high - low])
        for label in labels:
            away = [np.abs(np.subtract(label.get_position(), p)) > reach for p in avoid]
            label.set_visible(all(a.any() for a in away))
            label.set_alpha(1.0)
            label.set_path_effects([withStroke(linewidth=1.4, foreground="#30343a")])
    for line in chart.handles:
        axes.plot(line[:, 0], line[:, 1], **HANDLE, clip_on=False)
    axes.add_patch(
        Rectangle((left, low), right - left, high - low, fill=False, color="#555555", linewidth=0.8)
    )
    for spine in axes.spines.values():
        spine.set_visible(False)
    # margins: a marker at phi = +-pi is seen whole
    pad_x, pad_y = 0.045 * (right - left), 0.045 * (high - low)
    axes.set(xlim=(left - pad_x, right + pad_x), ylim=(low - pad_y, high + pad_y))
    axes.set_xlabel(coordinate_label(chart.coordinates[0]))
    axes.set_ylabel(coordinate_label(chart.coordinates[1]))
    angle_ticks(axes.xaxis, left, right)
    angle_ticks(axes.yaxis, low, high)
    if branch.name:
        axes.set_title(branch.name.replace("-", "−"), fontsize=10, pad=4)
    return image


def draw_curves(axes: Any, chart: Landscape) -> None:
    """Draw energy against a fold angle, one line for each curve of states."""
    for k, branch in enumerate(chart.branches):
        axes.plot(
            branch.axes[0],
            branch.energy,
            color=CURVES[k % len(CURVES)],
            linestyle=("-", "--", "-.")[k // len(CURVES) % 3],
            linewidth=1.8,
            label=branch.name or None,
        )
    axes.set(xlim=(-1.06 * math.pi, 1.06 * math.pi))
    axes.margins(y=0.09)
    angle_ticks(axes.xaxis, -math.pi, math.pi)
    axes.set_xlabel(coordinate_label(chart.coordinates[0]))
    axes.set_ylabel(f"energy U [{UNIT}]")
    axes.grid(color="#dddddd", linewidth=0.6)
    if len(chart.branches) > 1:
        axes.legend(fontsize=8, framealpha=0.9)


def colour_bar(image: Any, axes: Any) -> None:
    """Draw the energy scale of an image into its own Axes."""
    bar = axes.figure.colorbar(image, cax=axes)
    bar.set_label(f"energy U [{UNIT}]")
    bar.ax.yaxis.set_major_locator(MaxNLocator(7))


def _levels(norm: Normalize, energy: Any) -> list[float]:
    """At most seven contour levels, 1-2-5 apart where the energies span decades."""
    low, high = float(norm.vmin or 0.0), float(norm.vmax or 1.0)
    values = energy.compressed()
    if not values.size:
        return []
    decades = range(math.floor(math.log10(max(high, 1e-300))) - 3, math.ceil(math.log10(high)) + 1)
    nice = [m * 10.0**e for e in decades for m in (1, 2, 5) if low < m * 10.0**e < high]
    if len(nice) < 4:
        nice = [v for v in MaxNLocator(6).tick_values(low, high) if low < v < high]
    return [v for v in nice[-7:] if values.min() < v < values.max()]


def coordinate_label(name: str) -> str:
    """Return the name of a chart's coordinate for an axis."""
    if name.startswith("phi_"):
        return rf"$\varphi_{{{name[4:]}}}$ [rad]"
    crease = name.rsplit(" ", 1)[-1].rstrip(")")
    return rf"elevation $\upsilon$ of crease {crease} [rad]"


HANDLE: dict[str, Any] = {
    "color": "#A0206A",
    "linewidth": 2.2,
    "linestyle": (0, (3, 1.5)),
    "zorder": 4,
}
