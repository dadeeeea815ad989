"""Pictures of paths: branches over a parameter, legs under a load; minima solid, others dashed; and maps of events."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_type
from origami_nlp.display import INKS, KINDS, label_text
from origami_nlp.paths.atlas import Atlas
from origami_nlp.paths.boundary import FLAT, BifurcationSet
from origami_nlp.paths.load_result import LoadPath
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.result import Path, Plot

COLOURS = {**{name: kind.colour for name, kind in KINDS.items()}, "saddle": "#56B4E9"}
OTHER = "#CC79A7"
"""Of states whose verdict is neither."""
MARKS = {"fold": "s", "nonsmooth-fold": "D", "closes": "o", "leaves": "o"}
MARKS |= {"branching": "X", "singular": "x"}
SNAP = "#c1121f"
BAND: Any = {"color": "#222222", "lw": 6, "alpha": 0.13, "solid_capstyle": "round", "zorder": 1}
DOTS: Any = {"color": "white", "lw": 1.4, "ls": (0, (1, 1.5)), "zorder": 2.5}
"""Over minima that are stable only with their symmetry."""


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
    count, handles = len(panels), dict[str, Line2D]()
    size, rows = (7.0, 1.0 + 2.1 * count), (count, 1)
    if load:
        size, rows = (4.2 * count, 4.6), (1, count)
    with mpl.rc_context({"font.size": 9, "axes.titlesize": 9}):
        figure = Figure(figsize=size, dpi=110, layout="constrained")
        every = figure.subplots(*rows, squeeze=False, sharex=not load).ravel()
        for panel, axes in zip(panels, every, strict=True):
            _branches(path, panel, axes, handles)
            _events(path, panel, axes, handles)
            if isinstance(path, LoadPath):
                _legs(path, panel, axes, handles)
            axes.set(xlabel=label_text(panel.x), ylabel=label_text(panel.y))
            for name, side in ((panel.x, "x"), (panel.y, "y")):
                if name == path.parameter.axis:
                    _over(axes, side, path.parameter, *_shown_range(path))
            axes.margins(y=0.1)  # for the numbers of events
            axes.grid(True, lw=0.3, color="#dddddd")
        if isinstance(path, LoadPath):
            begun = f", from state #{path.state}" if path.state else ""
            title = f"{path.driver.origami.title}: {path.driver.name}{begun}"
            figure.suptitle(label_text(title), fontsize=10)
        elif isinstance(path, Atlas):
            _counts(path, every[0])
        many = max(1, min(6, len(handles)))
        look: Any = {"loc": "outside lower center", "ncols": many, "frameon": False}
        figure.legend(handles.values(), handles.keys(), **look)
    return figure


def _shown(path: Path, panel: Plot, points: Any) -> np.ndarray:
    """Return the places of points on a panel, [m, 2], nan of those outside what is shown."""
    low, high = _shown_range(path)
    return panel.values(p if low <= p.t <= high else None for p in points)


def _branches(path: Path, panel: Plot, axes: Any, handles: dict[str, Line2D]) -> None:
    """Draw minima by solid lines, other states by dashed ones."""
    for branch in path.branches:
        at = _shown(path, panel, branch.points)
        for r in branch.kind_ranges:
            own = slice(r.points[0], r.points[1] + 1)
            look: Any = {"ls": "-", "lw": 1.6} if r.stable else {"ls": (0, (4, 2)), "lw": 1.1}
            line = axes.plot(*at[own].T, color=COLOURS.get(r.kind, OTHER), **look)[0]
            handles.setdefault(r.kind, line)
            if r.stable:
                kept = np.array([p.full_space_eigenvalue < 0 for p in branch.points[own]])
                axes.plot(*np.where(kept[:, None], at[own], np.nan).T, **DOTS)


def _events(path: Path, panel: Plot, axes: Any, handles: dict[str, Line2D]) -> None:
    """Mark events with their numbers."""
    low, high = _shown_range(path)
    beside: Any = {"textcoords": "offset points", "fontsize": 8, "annotation_clip": True}
    for e in (e for e in path.events if low <= e.t <= high):
        place = panel.values([path.point_of(e)])[0]
        look = {"marker": MARKS.get(e.type, "P"), "mfc": "white" if e.type == "leaves" else "black"}
        mark = axes.plot(*place, **look, ls="none", color="black", ms=4.5, zorder=5)[0]
        handles.setdefault(e.type, mark)
        axes.annotate(str(e.id), place, (3, 4), **beside)


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


def _legs(path: LoadPath, panel: Plot, axes: Any, handles: dict[str, Line2D]) -> None:
    """Draw what the state does: the path as a band, snaps as arrows."""
    for leg in path.legs:
        at = _shown(path, panel, leg.points)
        handles.setdefault("the path", axes.plot(*at.T, **BAND)[0])
        if leg.moved:  # of creases that may yield no other states are followed
            axes.plot(*at.T, color=BAND["color"], lw=1.4, zorder=2)
    arrow = {"arrowstyle": "-|>", "color": SNAP, "lw": 1.4, "shrinkA": 2, "shrinkB": 2}
    for snap in path.snaps:
        a, b = panel.values(path.point_at(snap.t, phi) for phi in (snap.before, snap.after))
        axes.annotate("", b, a, arrowprops=arrow, zorder=4)
        axes.plot(*a, "o", ms=9, mfc="none", mec=SNAP, zorder=6)  # of angles that stay, too
        end = axes.plot(*b, ".", ms=5, color=SNAP, zorder=4)[0]  # arrows alone do not widen axes
        handles.setdefault(f"snap at {snap.t:.4g} {path.driver.unit}".rstrip(), end)


def _counts(path: Atlas, axes: Any) -> None:
    """Write the number of minima above, interval by interval."""
    over, (low, high) = path.parameter, path.parameter.ends
    above: dict[str, Any] = {"xycoords": "axes fraction", "va": "bottom"}
    axes.annotate("minima:", (0, 1.02), ha="right", **above)
    for interval in path.intervals:
        a, b = ((over.s_of(t) - low) / (high - low) for t in interval.t)
        if b - a >= 0.02:
            where = 0.5 * (a + b), 1.02
            axes.annotate(str(interval.minima), where, ha="center", fontweight="bold", **above)
        if b < 1.0:
            axes.axvline(over.drawn(interval.t[1]), color="#bbbbbb", lw=0.6, zorder=0)


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
            y, x = ([p.drawn(q.t[k]) for q in curve.points] for k, p in enumerate((up, across)))
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
