"""Pictures of paths: branches over a parameter, legs under a load; minima solid, others dashed; and maps of events."""

from __future__ import annotations

import math
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_type
from origami_nlp.display import INKS, KINDS, label_text
from origami_nlp.paths.boundary import FLAT, BifurcationSet, smooth
from origami_nlp.paths.load_result import LoadPath
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.result import Path, Plot

COLOURS = {**{name: kind.colour for name, kind in KINDS.items()}, "saddle": "#56B4E9"}
OTHER = "#CC79A7"
"""Of states whose verdict is neither."""
MARKS = dict(
    zip("fold nonsmooth-fold closes leaves branching singular".split(), "sDooXx", strict=True)
)
OTHER_MARK = "P"
"""Of events that only some paths have."""
WIDE = 60.0
"""Energies whose largest is so many times the smallest are drawn on a logarithmic scale."""
PATH, SNAP = "#222222", "#c1121f"
ARROW = {"arrowstyle": "-|>", "color": SNAP, "lw": 1.4, "shrinkA": 2, "shrinkB": 2}
BAND: Any = {"color": PATH, "lw": 6, "alpha": 0.13, "solid_capstyle": "round", "zorder": 1}
DOTS: Any = {"lw": 1.4, "ls": (0, (1, 1.5)), "zorder": 2.5}
TANGENT: Any = {"color": "#7b2d8b", "lw": 1.1, "ls": (0, (4, 2)), "zorder": 3}
TANGENT_SHARE = 0.2
"""Of the loads that are shown, to either side of the start, along which the stiffness there is drawn."""


def draw_path(path: Path) -> Figure:
    """Draw the states of a path: branches over a parameter, or a load over what it works on, and the energy.

    Parameters
    ----------
    path
        Of `follow` or `load_path`.

    Returns
    -------
    matplotlib.figure.Figure
        Over a parameter energy, the fold angle that separates branches best, and contact moments where there are any,
        the number of minima above.  Of a load the load and the energy over what it works on, and the energy over the
        load: the path in grey, snaps as red arrows.  Events are marked and numbered.

    Raises
    ------
    OptionError
        If `path` is not of its type.
    """
    check_type("path", path, Path)
    panels, load = path.panels, isinstance(path, LoadPath)
    size = (4.2 * len(panels), 4.6) if load else (7.0, 1.0 + 2.1 * len(panels))
    with mpl.rc_context({"font.size": 9, "axes.titlesize": 9}):
        figure = Figure(figsize=size, dpi=110, layout="constrained")
        rows = (1, len(panels)) if load else (len(panels), 1)
        every = figure.subplots(*rows, squeeze=False, sharex=not load).ravel()
        for panel, axes in zip(panels, every, strict=True):
            _panel(path, panel, axes)
        handles = _legend(path)
        if isinstance(path, LoadPath):
            begun = f", from state #{path.state}" if path.state else ""
            figure.suptitle(
                label_text(f"{path.driver.origami.title}: {path.driver.name}{begun}"), fontsize=10
            )
            handles += _legs(path, every)
        else:
            _counts(path, every[0])
        many = min(6, len(handles))
        if handles:
            figure.legend(handles=handles, loc="outside lower center", ncols=many, frameon=False)
    return figure


def _kind_look(kind: str) -> dict[str, Any]:
    """Return how states of a kind are drawn: minima by solid lines, others by dashed ones."""
    ls, lw = ("-", 1.6) if kind in KINDS else ((0, (4, 2)), 1.1)
    return {"color": COLOURS.get(kind, OTHER), "ls": ls, "lw": lw}


def _event_look(type: str) -> dict[str, Any]:
    """Return how an event is marked."""
    look = {"marker": MARKS.get(type, OTHER_MARK), "mfc": "white" if type == "leaves" else "black"}
    return {**look, "ls": "none", "color": "black", "ms": 4.5, "zorder": 5}


def _legend(path: Path) -> list[Line2D]:
    kinds = dict.fromkeys(r.kind for b in path.branches for r in b.kind_ranges)
    order = sorted(kinds, key=lambda k: [*COLOURS, k].index(k))
    handles = [Line2D([], [], **_kind_look(kind), label=kind) for kind in order]
    if any(p.full_space_eigenvalue < 0 for b in path.branches for p in b.points):
        label = "dotted: stable only with its symmetry"
        handles.append(Line2D([], [], color="#888888", lw=1.8, ls=(0, (1, 1.0)), label=label))
    types = dict.fromkeys(e.type for e in path.events)
    return handles + [Line2D([], [], **_event_look(type), label=type) for type in types]


def _panel(path: Path, panel: Plot, axes: Any) -> None:
    stable, every, (low, high) = [np.zeros(0)], [np.zeros(0)], _shown_range(path)
    for branch in path.branches:
        at = panel.values([p if low <= p.t <= high else None for p in branch.points])
        every.append(at[np.isfinite(at[:, 1]), 1])
        for r in branch.kind_ranges:
            part = at[r.points[0] : r.points[1] + 1]
            axes.plot(*part.T, **_kind_look(r.kind))
            stable += [part[:, 1]] if r.stable else []
            if r.stable:  # with the symmetry alone: dots
                own = branch.points[r.points[0] : r.points[1] + 1]
                broken = np.array([[p.full_space_eigenvalue < 0] for p in own])
                axes.plot(*np.where(broken, part, np.nan).T, color="white", **DOTS)
    values, most = np.concatenate(every), float(np.nanmax(np.concatenate(stable), initial=0.0))
    if panel.y == "energy [J]" and len(values) and 0 < values.min() * WIDE < values.max():
        axes.set_yscale("log")
    # the way back meets events where the way there did: their numbers stand beside each other
    named: dict[tuple[float, ...], list[str]] = {}
    for event in (e for e in path.events if low <= e.t <= high):
        place = panel.values([path.point_of(event)])[0]
        axes.plot(*place, **_event_look(event.type))
        named.setdefault(tuple(float(f"{v:.6g}") for v in place), []).append(str(event.id))
    look: Any = {"textcoords": "offset points", "fontsize": 8, "annotation_clip": True}
    for where, ids in named.items():
        axes.annotate(", ".join(ids), where, (3, 4), **look)
    axes.margins(y=0.1)  # for the numbers of events
    if panel.y.startswith("largest moment") and most > 0:  # those of saddles can be huge
        axes.set_ylim(-0.05 * most, 1.1 * most)
    for name, sides in ((panel.x, "x"), (panel.y, "y")):
        axes.set(**{f"{sides}label": label_text(name)})
        if name == path.parameter.axis:
            _over(axes, sides, path.parameter, low, high)
    if not isinstance(path, LoadPath):
        axes.label_outer()
    axes.grid(True, lw=0.3, color="#dddddd")


def _over(axes: Any, side: str, parameter: ParameterRange, low: float, high: float) -> None:
    """Let an axis be that of a parameter."""
    axes.set(**{f"{side}label": label_text(parameter.axis)})
    axes.set(**{f"{side}scale": "log" if parameter.log else "linear"})
    axes.set(**{f"{side}lim": (parameter.drawn(low), parameter.drawn(high))})


def _shown_range(path: Path) -> tuple[float, float]:
    """Values of the parameter that are shown; of a load those of the path, but not far beyond its last event."""
    if not isinstance(path, LoadPath):
        return path.parameter.low, path.parameter.high
    loads = [p.t for leg in path.legs for p in leg.points] + [s.t for s in path.snaps]
    low, high = min(loads), max(loads)
    events = [0.0, *(e.t for e in path.events if low <= e.t <= high)]
    more = 0.3 * (max(events) - min(events)) or high - low
    low, high = max(low, min(events) - more), min(high, max(events) + more)
    room = 0.08 * (high - low) or 1.0
    return low - room, high + room


def _legs(path: LoadPath, every: Any) -> list[Line2D]:
    """Draw what the state does into all axes; return its legend."""
    low, high = _shown_range(path)
    for panel, axes in zip(path.panels, every, strict=True):
        for leg in path.legs:
            at = panel.values([p if low <= p.t <= high else None for p in leg.points])
            axes.plot(*at.T, **BAND)
            if leg.moved:  # of creases that may yield no other states are followed
                axes.plot(*at.T, color=PATH, lw=1.4, zorder=2)
        for snap in path.snaps:
            a, b = panel.values([path.point_at(snap.t, phi) for phi in (snap.before, snap.after)])
            axes.annotate("", b, a, arrowprops=ARROW, zorder=4)
            axes.plot(*a, "o", ms=9, mfc="none", mec=SNAP, zorder=6)  # of angles that stay, too
            axes.plot(*b, ".", ms=5, color=SNAP, zorder=4)  # arrows alone do not widen the axes
    handles = [Line2D([], [], **BAND, label="the path")]
    if path.snaps:
        places = list(dict.fromkeys(f"{s.t:.4g}" for s in path.snaps))[:4]
        label = f"snap at {', '.join(places)} {path.driver.unit}".rstrip()
        handles.append(Line2D([], [], color=SNAP, label=label))
    if math.isfinite(path.start_stiffness):
        start, ends = path.legs[0].points[0], np.array([-1.0, 1.0]) * TANGENT_SHARE * (high - low)
        where = start.angle + ends / path.start_stiffness
        every[0].plot([path.place.drawn(v) for v in where], start.t + ends, **TANGENT)
        label = f"stiffness at the start\n{path.start_stiffness:.4g} {path.stiffness_unit}"
        handles.append(Line2D([], [], **TANGENT, label=label))
    return handles


def _counts(path: Any, axes: Any) -> None:
    """Write the number of minima above, interval by interval."""
    low, high = path.parameter.ends
    above: dict[str, Any] = {"xycoords": "axes fraction", "va": "bottom"}
    axes.annotate("minima:", (0, 1.02), ha="right", **above)
    for interval in path.intervals:
        a, b = (path.parameter.s_of(t) for t in interval.t)
        if (b - a) >= 0.02 * (high - low):
            where = (0.5 * (a + b) - low) / (high - low), 1.02
            axes.annotate(str(interval.minima), where, ha="center", fontweight="bold", **above)
    for cut in {t for i in path.intervals for t in i.t} - {path.parameter.low, path.parameter.high}:
        axes.axvline(path.parameter.drawn(cut), color="#bbbbbb", lw=0.6, zorder=0)


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
            drawn = zip((up, across), smooth(curve, boundaries.parameters).T, strict=True)
            y, x = ([p.drawn(p.t_of(s)) for s in column] for p, column in drawn)
            name = curve.contact and f"{curve.type}: {curve.contact.split(' (')[0]}"
            name = name or ("states pass the flat one" if curve.type == FLAT else "states fold")
            turns = "fold" in curve.type or curve.type == FLAT
            look: Any = {"ls": "-", "lw": 1.6} if turns else {"ls": (0, (4, 2)), "lw": 1.2}
            axes.plot(x, y, color=INKS[k % len(INKS)], **look, label=f"{curve.id}  {name}")
        low, high = up.ends
        for line in (line for line in boundaries.lines if line.parameter == up.name):
            for i in line.intervals:
                a, b = (up.s_of(t) for t in i.t)
                if b - a > 0.04 * (high - low):
                    at = across.drawn(line.t), up.drawn(up.t_of(0.5 * (a + b)))
                    side = {across.low: "left", across.high: "right"}.get(line.t, "center")
                    axes.text(*at, f" {i.minima} ", ha=side, va="center", fontweight="bold")
        for side, p in (("x", across), ("y", up)):
            _over(axes, side, p, p.low, p.high)
        if boundaries.curves:
            figure.legend(loc="outside upper center", ncols=1, frameon=False, fontsize=8)
    return figure
