"""Branches over the parameter: energy, a fold angle and contact moments; minima solid, saddles dashed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_type
from origami_nlp.display import INKS, KINDS, label_text
from origami_nlp.paths.atlas import Atlas
from origami_nlp.paths.boundary import FLAT, BifurcationSet
from origami_nlp.paths.records import PathBranch, PathPoint
from origami_nlp.paths.smooth import smooth

SADDLE = "#56B4E9"
COLOURS = {**{name: kind.colour for name, kind in KINDS.items()}, "saddle": SADDLE}
OTHER = "#CC79A7"
"""Of states whose verdict is neither."""
MARKS = {
    "fold": "s",
    "nonsmooth-fold": "D",
    "closes": "o",
    "leaves": "o",
    "branching": "X",
    "breaks-symmetry": "P",
    "singular": "x",
}
OTHER_MARK = "P"
"""Of events that only patterns have."""
WIDE = 60.0
"""Energies whose largest is so many times the smallest are drawn on a logarithmic scale."""


def draw_atlas(atlas: Atlas) -> Figure:
    """Draw the branches of an atlas.

    Parameters
    ----------
    atlas
        Of `follow`.

    Returns
    -------
    matplotlib.figure.Figure
        Energy, the fold angle that separates branches best, and contact moments where there are any, over the
        parameter; events are marked and numbered, the number of minima stands above.

    Raises
    ------
    OptionError
        If `atlas` is not of its type.
    """
    check_type("atlas", atlas, Atlas)
    crease = _telling_crease(atlas)
    panels: list[tuple[str, Callable[[PathPoint], float]]] = [
        ("energy [J]", lambda p: p.energy),
        (f"fold angle {crease + 1} [deg]", lambda p: math.degrees(p.fold_angles[crease])),
    ]
    if any(p.multipliers for b in atlas.branches for p in b.points):
        panels.append(("largest moment [N m]", _moment))
    with mpl.rc_context({"font.size": 9, "axes.titlesize": 9}):
        figure = Figure(figsize=(7.0, 1.0 + 2.1 * len(panels)), layout="constrained")
        rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axes, (label, value) in zip(rows, panels, strict=True):
            _panel(atlas, axes, label, value)
        _counts(atlas, rows[0])
        rows[-1].set_xlabel(label_text(atlas.parameter.axis))
        if atlas.parameter.log:
            rows[-1].set_xscale("log")
        rows[-1].set_xlim(
            *(atlas.parameter.drawn(t) for t in (atlas.parameter.low, atlas.parameter.high))
        )
        _legend(atlas, figure)
    return figure


def _moment(p: PathPoint) -> float:
    return max((m.value for m in p.multipliers), default=math.nan)


def kind_look(kind: str) -> dict[str, Any]:
    """Return how states of a kind are drawn, for ``Axes.plot``: minima by solid lines, others by dashed ones."""
    ls, lw = ("-", 1.6) if kind in KINDS else ((0, (4, 2)), 1.1)
    return {"color": COLOURS.get(kind, OTHER), "ls": ls, "lw": lw}


def event_look(type: str) -> dict[str, Any]:
    """Return how an event is marked, for ``Axes.plot``."""
    face = "white" if type == "leaves" else "black"
    marker = MARKS.get(type, OTHER_MARK)
    return {"marker": marker, "ls": "none", "color": "black", "mfc": face, "ms": 4.5}


def draw_ranges(axes: Any, branch: PathBranch, x: np.ndarray, y: np.ndarray) -> None:
    """Draw the points of a branch, [m] each, range by range as their kinds are drawn."""
    for r in branch.kind_ranges:
        part = slice(r.points[0], r.points[1] + 1)
        axes.plot(x[part], y[part], **kind_look(r.kind))


def kinds_legend(branches: Sequence[PathBranch]) -> list[Line2D]:
    """Return legend entries for the kinds of states on branches."""
    kinds = dict.fromkeys(r.kind for b in branches for r in b.kind_ranges)
    order = sorted(kinds, key=lambda k: [*COLOURS, k].index(k))
    return [Line2D([], [], **kind_look(kind), label=kind) for kind in order]


def _telling_crease(atlas: Atlas) -> int:
    """Return the crease whose angle differs most between the states in the middle of the range."""
    angles = [p.fold_angles for b in atlas.branches for p in b.points]
    return int(np.ptp(np.array(angles), axis=0).argmax()) if angles else 0


def _panel(atlas: Atlas, axes: Any, label: str, value: Callable[[PathPoint], float]) -> None:
    drawn, stable = [], []
    for branch in atlas.branches:
        t = np.array([atlas.parameter.drawn(p.t) for p in branch.points])
        y = np.array([value(p) for p in branch.points])
        drawn.append(y)
        draw_ranges(axes, branch, t, y)
        stable += [y[slice(r.points[0], r.points[1] + 1)] for r in branch.kind_ranges if r.stable]
    axes.margins(y=0.1)  # for the numbers of events
    every = np.concatenate(drawn) if drawn else np.zeros(0)
    every = every[np.isfinite(every)]
    if label.startswith("energy") and len(every) and 0 < every.min() * WIDE < every.max():
        axes.set_yscale("log")
    for event in atlas.events:
        at = _event_value(atlas, event.id, value)
        axes.plot(atlas.parameter.drawn(event.t), at, **event_look(event.type), zorder=5)
        axes.annotate(
            str(event.id),
            (atlas.parameter.drawn(event.t), at),
            (3, 4),
            textcoords="offset points",
            fontsize=8,
            annotation_clip=True,
        )
    if label.startswith("largest moment") and stable:  # those of saddles can be huge
        most = float(np.nanmax(np.concatenate(stable), initial=0.0))
        if most > 0:
            axes.set_ylim(-0.05 * most, 1.1 * most)
    axes.set_ylabel(label)
    axes.grid(True, lw=0.3, color="#dddddd")


def _event_value(atlas: Atlas, event: int, value: Callable[[PathPoint], float]) -> float:
    """Return the ordinate of an event: that of the nearest point of its branches."""
    found = atlas.events[event - 1]
    points = [p for b in atlas.branches if b.id in found.branches for p in b.points]
    if not points:
        return math.nan

    def apart(p: PathPoint) -> float:
        return abs(p.t - found.t) + float(
            np.abs(np.subtract(p.fold_angles, found.fold_angles)).max()
        )

    return value(min(points, key=apart))


def _counts(atlas: Atlas, axes: Any) -> None:
    """Write the number of minima above, interval by interval."""
    parameter = atlas.parameter
    low, high = parameter.ends
    axes.annotate(
        "minima:", (0, 1.02), xycoords="axes fraction", xytext=(-48, 2), textcoords="offset points"
    )
    for interval in atlas.intervals:
        a, b = (parameter.s_of(t) for t in interval.t)
        if (b - a) < 0.02 * (high - low):
            continue
        where = (0.5 * (a + b) - low) / (high - low)
        axes.annotate(
            str(interval.minima),
            (where, 1.02),
            xycoords="axes fraction",
            ha="center",
            va="bottom",
            fontweight="bold",
        )
    for cut in {t for i in atlas.intervals for t in i.t} - {parameter.low, parameter.high}:
        axes.axvline(atlas.parameter.drawn(cut), color="#bbbbbb", lw=0.6, zorder=0)


def _legend(atlas: Atlas, figure: Figure) -> None:
    handles = kinds_legend(atlas.branches)
    types = dict.fromkeys(e.type for e in atlas.events)
    handles += [Line2D([], [], **event_look(type), label=type) for type in types]
    if handles:
        many = min(6, len(handles))
        figure.legend(handles=handles, loc="outside upper center", ncols=many, frameon=False)


def draw_boundaries(boundaries: BifurcationSet) -> Figure:
    """Draw the curves of events over two parameters, with the number of minima between them.

    Parameters
    ----------
    boundaries
        Of `find_bifurcation_set`.

    Returns
    -------
    matplotlib.figure.Figure
        The second parameter to the right, the first one up; solid lines where the number of minima changes, dashed
        ones where only their kind does; numbers are those along the lines that were followed.

    Raises
    ------
    OptionError
        If `boundaries` are not of its type.
    """
    check_type("boundaries", boundaries, BifurcationSet)
    up, across = boundaries.parameters
    with mpl.rc_context({"font.size": 9}):
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        axes = figure.subplots()
        for k, curve in enumerate(boundaries.curves):
            y, x = smooth(curve, boundaries.parameters).T
            x = np.array([across.drawn(across.t_of(s)) for s in x])
            y = np.array([up.drawn(up.t_of(s)) for s in y])
            turns = "fold" in curve.type or curve.type == FLAT
            name = curve.contact.split(" (")[0]
            name = name or ("states pass the flat one" if curve.type == FLAT else "states fold")
            axes.plot(
                x,
                y,
                color=INKS[k % len(INKS)],
                ls="-" if turns else (0, (4, 2)),
                lw=1.6 if turns else 1.2,
                label=f"{curve.id}  {curve.type}: {name}"
                if curve.contact
                else f"{curve.id}  {name}",
            )
        low, high = up.ends
        for line in (line for line in boundaries.lines if line.parameter == up.name):
            for i in line.intervals:
                a, b = (up.s_of(t) for t in i.t)
                if b - a > 0.04 * (high - low):
                    at = across.drawn(line.t), up.drawn(up.t_of(0.5 * (a + b)))
                    side = {across.low: "left", across.high: "right"}.get(line.t, "center")
                    axes.text(*at, f" {i.minima} ", ha=side, va="center", fontweight="bold")
        axes.set_xlim(*(across.drawn(t) for t in (across.low, across.high)))
        axes.set_ylim(*(up.drawn(t) for t in (up.low, up.high)))
        for parameter, label, scale in (
            (across, axes.set_xlabel, axes.set_xscale),
            (up, axes.set_ylabel, axes.set_yscale),
        ):
            label(label_text(parameter.axis))
            if parameter.log:
                scale("log")
        if boundaries.curves:
            figure.legend(loc="outside upper center", ncols=1, frameon=False, fontsize=8)
    return figure
