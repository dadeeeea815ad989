"""Pictures of paths: branches over a parameter, legs under a load; minima solid, others dashed; and maps of events."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_type
from origami_nlp.display import INKS, KINDS, label_text
from origami_nlp.paths.boundary import FLAT, BifurcationSet
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.result import Path, Plot

COLOURS = {**{name: kind.colour for name, kind in KINDS.items()}, "saddle": "#56B4E9"}
OTHER, SNAP = "#CC79A7", "#c1121f"
"""Of states whose verdict is neither; of snaps."""
MARKS = {"fold": "s", "nonsmooth-fold": "D", "closes": "o", "leaves": "o"}
MARKS |= {"branching": "X", "singular": "x"}
BAND: Any = {"color": "#222222", "lw": 6, "alpha": 0.13, "solid_capstyle": "round", "zorder": 1}
DOTS: Any = {"color": "white", "lw": 1.4, "ls": (0, (1, 1.5)), "zorder": 2.5}
"""Over minima that are stable only with their symmetry."""
SOLID: Any = {"ls": "-", "lw": 1.6}
DASHED: Any = {"ls": (0, (4, 2)), "lw": 1.1}


def draw_path(path: Path) -> Figure:
    """Draw the states of a path: branches over a parameter, or a load over what it works on, and the energy.

    Parameters
    ----------
    path
        Of `follow` or `load_path`.

    Returns
    -------
    matplotlib.figure.Figure
        Over a parameter energy, the fold angle that separates branches best, and contact moments where there are any.
        Of a load the load and the energy over what it works on, and the energy over the load: the path in grey, snaps
        as red arrows.  Events are marked and numbered.

    Raises
    ------
    OptionError
        If `path` is not of its type.
    """
    check_type("path", path, Path)
    panels, handles = path.panels, dict[str, Line2D]()
    with mpl.rc_context({"font.size": 9, "axes.titlesize": 9}):
        figure = Figure(figsize=(4.2 * len(panels), 4.6), dpi=110, layout="constrained")
        for panel, axes in zip(
            panels, figure.subplots(1, len(panels), squeeze=False)[0], strict=True
        ):
            _branches(path, panel, axes, handles)
            _legs(path, panel, axes, handles)
            _events(path, panel, axes, handles)
            axes.set(xlabel=label_text(panel.x), ylabel=label_text(panel.y))
            for name, side in ((panel.x, "x"), (panel.y, "y")):
                if name == path.parameter.axis:
                    _over(axes, side, path.parameter, *path.span)
            axes.margins(y=0.1)  # for the numbers of events
            axes.grid(True, lw=0.3, color="#dddddd")
        title = f"{path.origami_at(path.parameter.low).title}: {path.parameter.name}"
        figure.suptitle(label_text(title), fontsize=10)
        look: Any = {"loc": "outside lower center", "ncols": 4, "frameon": False}
        figure.legend(handles.values(), handles.keys(), **look)
    return figure


def _shown(path: Path, panel: Plot, points: Any) -> np.ndarray:
    """Return the places of points on a panel, [m, 2], nan of those outside what is shown."""
    low, high = path.span
    return panel.values(p if low <= p.t <= high else None for p in points)


def _branches(path: Path, panel: Plot, axes: Any, handles: dict[str, Line2D]) -> None:
    """Draw minima by solid lines, other states by dashed ones."""
    for branch in path.branches:
        at, look = _shown(path, panel, branch.points), SOLID if branch.stable else DASHED
        line = axes.plot(*at.T, color=COLOURS.get(branch.kind, OTHER), **look)[0]
        handles.setdefault(branch.kind, line)
        kept = np.array([branch.stable and p.full_space_eigenvalue < 0 for p in branch.points])
        if kept.any():
            axes.plot(*np.where(kept[:, None], at, np.nan).T, **DOTS)


def _events(path: Path, panel: Plot, axes: Any, handles: dict[str, Line2D]) -> None:
    """Mark events with their numbers."""
    beside: Any = {"textcoords": "offset points", "fontsize": 8, "annotation_clip": True}
    for e in (e for e in path.events if path.span[0] <= e.t <= path.span[1]):
        place = panel.values([path.point_of(e)])[0]
        look = {"marker": MARKS.get(e.type, "P"), "mfc": "white" if e.type == "leaves" else "black"}
        mark = axes.plot(*place, **look, ls="none", color="black", ms=4.5, zorder=5)[0]
        handles.setdefault(e.type, mark)
        axes.annotate(str(e.id), place, (3, 4), **beside)


def _legs(path: Any, panel: Plot, axes: Any, handles: dict[str, Line2D]) -> None:
    """Draw what a state does under a load: the path as a band, snaps as arrows."""
    for leg in getattr(path, "legs", ()):
        at = _shown(path, panel, leg.points)
        handles.setdefault("the path", axes.plot(*at.T, **BAND)[0])
        if leg.moved:  # of creases that may yield no other states are followed
            axes.plot(*at.T, color=BAND["color"], lw=1.4, zorder=2)
    arrow = {"arrowstyle": "-|>", "color": SNAP, "lw": 1.4, "shrinkA": 2, "shrinkB": 2}
    for snap in getattr(path, "snaps", ()):
        a, b = panel.values(path.point_at(snap.t, phi) for phi in (snap.before, snap.after))
        axes.annotate("", b, a, arrowprops=arrow, zorder=4)
        axes.plot(*a, "o", ms=9, mfc="none", mec=SNAP, zorder=6)  # of angles that stay, too
        end = axes.plot(*b, ".", ms=5, color=SNAP, zorder=4)[0]  # arrows alone do not widen axes
        handles.setdefault(f"snap at {snap.t:.4g} {path.parameter.unit}".rstrip(), end)


def _over(axes: Any, side: str, parameter: ParameterRange, low: float, high: float) -> None:
    """Let an axis be that of a parameter."""
    axes.set(**{f"{side}label": label_text(parameter.axis)})
    axes.set(**{f"{side}scale": "log" if parameter.log else "linear"})
    axes.set(**{f"{side}lim": (parameter.drawn(low), parameter.drawn(high))})


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
            look = SOLID if "fold" in curve.type or curve.type == FLAT else DASHED
            name = f"{curve.id}  {curve.type}: {curve.contact.partition(' (')[0]}".rstrip(": ")
            axes.plot(x, y, color=INKS[k % len(INKS)], **look, label=name)
        for line in (line for line in boundaries.lines if line.parameter == up.name):
            for i in line.intervals:
                at = across.drawn(line.t), up.drawn(up.t_of(0.5 * sum(map(up.s_of, i.t))))
                side = {across.low: "left", across.high: "right"}.get(line.t, "center")
                axes.text(*at, f" {i.minima} ", ha=side, va="center", fontweight="bold")
        for side, p in (("x", across), ("y", up)):
            _over(axes, side, p, p.low, p.high)
        if boundaries.curves:
            figure.legend(loc="outside upper center", ncols=1, frameon=False, fontsize=8)
    return figure
