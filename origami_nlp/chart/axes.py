"""Putting a landscape and its minima into matplotlib Axes: areas, curves, markers, labels.

Kinds of minima differ in colour (Okabe and Ito's palette, safe for colour-blind readers) and in
shape.  A square around a marker: the feasible set there is a curve (1-handle); a dot in a white
marker: an isolated point; a ring: a family of states shares this point of the chart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import Normalize, PowerNorm
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from origami_nlp.chart.landscape import Landscape, Place

if TYPE_CHECKING:
    from origami_nlp.minima.find import Minimum

UNIT = "J"
"""Of energies when stiffness is given in N m/rad."""
WARNING = "#B00020"
"""Of a minimum that is not stable when the symmetry may break."""
STYLE: dict[str, tuple[str, Any]] = {
    "interior": ("#F0B000", "*"),
    "contact-pinned": ("#D55E00", (4, 1, 0)),
    "contact-touching": ("#56B4E9", (6, 1, 0)),
    "degenerate": ("#CC79A7", "X"),
}
"""Colour and marker of each kind of minimum."""
SIZE = {"*": 17.0, "X": 11.0}
CURVES = ("#0072B2", "#009E73", "#000000", "#D55E00", "#CC79A7", "#E69F00")
TICKS = {-2: "-π", -1: "-π/2", 0: "0", 1: "π/2", 2: "π"}


@dataclass(frozen=True)
class Marks:
    """Minima with their places on the landscape; branch None marks those of every branch."""

    minima: tuple[Minimum, ...]
    places: list[Place]
    branch: int | None

    def here(self) -> list[tuple[int, Minimum, Place]]:
        """(number from 1, minimum, place) of those to mark on the branch."""
        return [
            (k, m, p)
            for k, (m, p) in enumerate(zip(self.minima, self.places, strict=True), start=1)
            if p.drawn and (self.branch is None or p.branch == self.branch)
        ]


def norm_of(chart: Landscape) -> Normalize:
    """One colour scale for all branches, finer at low energies, where the minima are."""
    values = np.concatenate([b.energy[np.isfinite(b.energy)] for b in chart.branches])
    low, high = (values.min(), values.max()) if values.size else (0.0, 1.0)
    if not high > low:
        high = low + max(abs(low), 1e-300)
    return PowerNorm(0.5, vmin=float(low), vmax=float(high))


def draw_area(
    axes: Any, chart: Landscape, k: int, norm: Normalize, avoid: list[tuple[float, float]]
) -> Any:
    """Draw branch k as colours with sparse contour lines; returns the image for the colour bar.

    avoid: points of markers, beside which contour lines get no label.
    """
    branch = chart.branches[k]
    x, y = branch.axes
    dx, dy = (x[1] - x[0]) / 2, (y[1] - y[0]) / 2
    left, right, low, high = x[0] - dx, x[-1] + dx, y[0] - dy, y[-1] + dy
    energy = np.ma.masked_invalid(branch.energy)
    image = axes.imshow(
        energy,
        extent=(left, right, low, high),
        origin="lower",
        cmap="cividis",
        norm=norm,
        aspect="auto",
        interpolation="nearest",
    )
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
        axes.plot(line[:, 0], line[:, 1], **_HANDLE, clip_on=False)
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


def mark_minima(axes: Any, marks: Marks) -> None:
    """Put markers and numbers of minima; those on one point share a label."""
    here = marks.here()
    for _, minimum, place in here:
        colour, marker = STYLE[minimum.kind]
        x, y = place.point
        top = {"clip_on": False, "zorder": 6, "linestyle": "none"}
        for extra in _surrounds(minimum, place, _freedom(marks)):
            axes.plot([x], [y], **extra, **top)
        face = "white" if minimum.local_dimension == 0 else colour
        edge, width = ("black", 0.9) if face != "white" else (colour, 1.8)
        if minimum.full_space is not None and minimum.full_space.verdict == "unstable":
            edge, width = WARNING, 2.2
        axes.plot(
            [x],
            [y],
            marker=marker,
            markersize=SIZE.get(marker, 15.0) if isinstance(marker, str) else 15.0,
            markerfacecolor=face,
            markeredgecolor=edge,
            markeredgewidth=width,
            path_effects=[withStroke(linewidth=2.6, foreground="white")],
            **top,
        )
        if minimum.local_dimension == 0:
            axes.plot([x], [y], marker=".", markersize=5, color=colour, **top)
    for (x, y), text in _spread_labels(axes, [(p.point, str(k)) for k, _, p in here]):
        axes.annotate(
            text,
            (x, y),
            ha="center",
            va="center",
            fontsize=11,
            weight="bold",
            color="black",
            path_effects=[withStroke(linewidth=2.6, foreground="white")],
            zorder=8,
            annotation_clip=False,
        )


def legend_entries(
    chart: Landscape, minima: tuple[Minimum, ...], places: list[Place]
) -> list[Line2D]:
    """Legend handles for the kinds and surrounds that occur."""
    here = Marks(minima, places, None).here()
    minima, places = tuple(m for _, m, _ in here), [p for _, _, p in here]
    entries = []
    for kind, (colour, marker) in STYLE.items():
        if any(m.kind == kind for m in minima):
            entries.append(_sample(kind, marker=marker, markerfacecolor=colour, markersize=12))
    for dimension, text in ((1, "minimum on a 1-handle"), (0, "isolated point")):
        for m, p in zip(minima, places, strict=True):
            if m.local_dimension == dimension < _freedom(Marks(minima, places, None)):
                style = next(iter(_surrounds(m, Place(p.branch, p.point), 2)), {})
                if dimension == 0:
                    style = {
                        "marker": r"$\odot$",
                        "markerfacecolor": "black",
                        "markeredgewidth": 0.3,
                    }
                entries.append(_sample(text, **{**style, "markersize": 12}))
                break
    if any(p.family for p in places):
        entries.append(_sample("family on one point", **{**_RING, "markersize": 13}))
    if chart.handles:
        entries.append(Line2D([], [], label="1-handle", **_HANDLE))
    return entries


_HANDLE: dict[str, Any] = {
    "color": "#A0206A",
    "linewidth": 2.2,
    "linestyle": (0, (3, 1.5)),
    "zorder": 4,
}
_RING = {"marker": "o", "markersize": 23, "markerfacecolor": "none", "markeredgecolor": "black"}
_SQUARE = {"marker": "s", "markersize": 19, "markerfacecolor": "none", "markeredgecolor": "black"}


def _sample(label: str, **style: Any) -> Line2D:
    style.setdefault("markeredgecolor", "black")
    return Line2D([], [], linestyle="none", label=label, **style)


def _freedom(marks: Marks) -> int:
    """Largest local dimension: that of open regions, against which handles stand out."""
    return max((m.local_dimension for m in marks.minima), default=0)


def _surrounds(minimum: Minimum, place: Place, freedom: int) -> list[dict[str, Any]]:
    halo = {"path_effects": [withStroke(linewidth=3.0, foreground="white")], "markeredgewidth": 1.3}
    extra = []
    if minimum.local_dimension == 1 < freedom:
        extra.append({**_SQUARE, **halo})
    if place.family:
        extra.append({**_RING, **halo})
    return extra


def _spread_labels(
    axes: Any, points: list[tuple[tuple[float, float], str]]
) -> list[tuple[tuple[float, float], str]]:
    """Choose for each label the free side of its marker; labels of one place are joined."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    box = axes.get_position()
    width, height = axes.figure.get_size_inches() * (box.width, box.height)
    scale = np.array([width / (x1 - x0), height / (y1 - y0)])  # to inches
    groups: list[tuple[np.ndarray, list[str]]] = []
    for point, text in points:
        at = np.array(point) * scale
        for place, texts in groups:
            if np.hypot(*(place - at)) < 0.05:
                texts.append(text)
                break
        else:
            groups.append((at, [text]))
    taken = [place for place, _ in groups]
    low, high = np.array([x0, y0]) * scale, np.array([x1, y1]) * scale
    labels = []
    for place, texts in groups:
        text = ", ".join(texts)
        half = 0.05 * len(text)
        options: list[tuple[bool, float, int, np.ndarray]] = []
        for angle in np.radians([45, 135, -45, -135, 0, 180, 90, -90]):
            way = np.array([math.cos(angle), math.sin(angle)])
            at = place + way * (0.25 + half * abs(way[0]))
            room = min((float(np.hypot(*(at - t))) for t in taken if t is not place), default=9.0)
            inside = bool(np.all(at > low + 0.08) and np.all(at < high - 0.08))
            options.append((inside, min(room, 0.5), -len(options), at))
        best = max(options, key=lambda option: option[:3])[3]
        taken.append(best)
        labels.append(((float(best[0] / scale[0]), float(best[1] / scale[1])), text))
    return labels


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


def angle_ticks(axis: Any, low: float, high: float) -> None:
    """Put ticks at multiples of pi/4 between low and high, pi/2 where there are many."""
    quarters = [q for q in range(-8, 9) if low - 1e-9 <= q * math.pi / 4 <= high + 1e-9]
    if high - low > 1.1 * math.pi:
        quarters = [q for q in quarters if q % 2 == 0]
    names = {
        -4: "−π",
        -3: "−3π/4",
        -2: "−π/2",
        -1: "−π/4",
        0: "0",
        1: "π/4",
        2: "π/2",
        3: "3π/4",
        4: "π",
    }
    axis.set_ticks([q * math.pi / 4 for q in quarters], [names.get(q, f"{q}π/4") for q in quarters])
