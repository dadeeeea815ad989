"""Branches over the parameter: energy, a fold angle and contact moments; minima solid, saddles dashed."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_type
from origami_nlp.atlas.boundary import FLAT, Boundaries
from origami_nlp.atlas.records import PathPoint
from origami_nlp.atlas.result import Atlas
from origami_nlp.atlas.smooth import smooth
from origami_nlp.show import INKS, KINDS, label_text

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
        Energy, the fold angle that tells branches apart best, and contact moments where there are any, over the
        parameter; events are marked and numbered, the number of minima stands above.

    Raises
    ------
    OptionError
        If `atlas` is none.
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
        unit = {"rad": " [deg]", "": ""}.get(atlas.over.unit, f" [{atlas.over.unit}]")
        rows[-1].set_xlabel(label_text(atlas.over.name) + unit)
        if atlas.over.log:
            rows[-1].set_xscale("log")
        rows[-1].set_xlim(*(_shown(atlas, t) for t in (atlas.over.low, atlas.over.high)))
        _legend(atlas, figure)
    return figure


def _shown(atlas: Atlas, t: float) -> float:
    return math.degrees(t) if atlas.over.unit == "rad" else t


def _moment(p: PathPoint) -> float:
    return max((m.value for m in p.multipliers), default=math.nan)


def _telling_crease(atlas: Atlas) -> int:
    """Return the crease whose angle differs most between the states in the middle of the range."""
    angles = [p.fold_angles for b in atlas.branches for p in b.points]
    return int(np.ptp(np.array(angles), axis=0).argmax()) if angles else 0


def _panel(atlas: Atlas, axes: Any, label: str, value: Callable[[PathPoint], float]) -> None:
    drawn, stable = [], []
    for branch in atlas.branches:
        t = np.array([_shown(atlas, p.t) for p in branch.points])
        y = np.array([value(p) for p in branch.points])
        drawn.append(y)
        for r in branch.kind_ranges:
            part = slice(r.points[0], r.points[1] + 1)
            stable += [y[part]] if r.stable else []
            axes.plot(
                t[part],
                y[part],
                color=COLOURS.get(r.kind, OTHER),
                ls="-" if r.stable else (0, (4, 2)),
                lw=1.6 if r.stable else 1.1,
            )
    axes.margins(y=0.1)  # for the numbers of events
    every = np.concatenate(drawn) if drawn else np.zeros(0)
    every = every[np.isfinite(every)]
    if label.startswith("energy") and len(every) and 0 < every.min() * WIDE < every.max():
        axes.set_yscale("log")
    for event in atlas.events:
        at = _event_value(atlas, event.id, value)
        axes.plot(
            _shown(atlas, event.t),
            at,
            MARKS[event.type],
            color="black",
            ms=4.5,
            mfc="white" if event.type == "leaves" else "black",
            zorder=5,
        )
        axes.annotate(
            str(event.id),
            (_shown(atlas, event.t), at),
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
    over = atlas.over
    low, high = over.s_of(over.low), over.s_of(over.high)
    axes.annotate(
        "minima:", (0, 1.02), xycoords="axes fraction", xytext=(-48, 2), textcoords="offset points"
    )
    for interval in atlas.intervals:
        a, b = (over.s_of(t) for t in interval.t)
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
    for cut in {t for i in atlas.intervals for t in i.t} - {over.low, over.high}:
        axes.axvline(_shown(atlas, cut), color="#bbbbbb", lw=0.6, zorder=0)


def _legend(atlas: Atlas, figure: Figure) -> None:
    kinds = dict.fromkeys(r.kind for b in atlas.branches for r in b.kind_ranges)
    lines = [
        Line2D(
            [],
            [],
            color=COLOURS.get(kind, OTHER),
            label=kind,
            ls="-" if kind in COLOURS and kind != "saddle" else (0, (4, 2)),
        )
        for kind in sorted(kinds, key=lambda k: [*COLOURS, k].index(k))
    ]
    marks = [
        Line2D(
            [],
            [],
            color="black",
            marker=MARKS[type],
            ls="none",
            ms=4.5,
            label=type,
            mfc="white" if type == "leaves" else "black",
        )
        for type in dict.fromkeys(e.type for e in atlas.events)
    ]
    if lines or marks:
        figure.legend(
            handles=[*lines, *marks],
            loc="outside upper center",
            ncols=min(6, len(lines) + len(marks)),
            frameon=False,
        )


def draw_boundaries(boundaries: Boundaries) -> Figure:
    """Draw the curves of events over two parameters, with the number of minima between them.

    Parameters
    ----------
    boundaries
        Of `find_boundaries`.

    Returns
    -------
    matplotlib.figure.Figure
        The second parameter to the right, the first one up; solid lines where the number of minima changes, dashed
        ones where only their kind does; numbers are those along the lines that were followed.

    Raises
    ------
    OptionError
        If `boundaries` are none.
    """
    check_type("boundaries", boundaries, Boundaries)
    up, across = boundaries.overs

    def shown(over: Any, t: float) -> float:
        return math.degrees(t) if over.unit == "rad" else t

    with mpl.rc_context({"font.size": 9}):
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        axes = figure.subplots()
        for k, curve in enumerate(boundaries.curves):
            y, x = smooth(curve, boundaries.overs).T
            x = np.array([shown(across, across.t_of(s)) for s in x])
            y = np.array([shown(up, up.t_of(s)) for s in y])
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
        low, high = (up.s_of(t) for t in (up.low, up.high))
        for line in (line for line in boundaries.lines if line.over == up.name):
            for i in line.intervals:
                a, b = (up.s_of(t) for t in i.t)
                if b - a > 0.04 * (high - low):
                    at = shown(across, line.t), shown(up, up.t_of(0.5 * (a + b)))
                    side = {across.low: "left", across.high: "right"}.get(line.t, "center")
                    axes.text(*at, f" {i.minima} ", ha=side, va="center", fontweight="bold")
        axes.set_xlim(*(shown(across, t) for t in (across.low, across.high)))
        axes.set_ylim(*(shown(up, t) for t in (up.low, up.high)))
        for over, label, scale in (
            (across, axes.set_xlabel, axes.set_xscale),
            (up, axes.set_ylabel, axes.set_yscale),
        ):
            unit = {"rad": " [deg]", "": ""}.get(over.unit, f" [{over.unit}]")
            label(label_text(over.name) + unit)
            if over.log:
                scale("log")
        if boundaries.curves:
            figure.legend(loc="outside upper center", ncols=1, frameon=False, fontsize=8)
    return figure
