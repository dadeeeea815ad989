"""The figure of a load path: load over what it works on; minima solid, saddles dashed, snaps as arrows."""

from __future__ import annotations

import math
import textwrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from origami_nlp.arguments import check_type
from origami_nlp.display import draw_pattern_state, label_text
from origami_nlp.kkt import ContactForce, State, contact_forces
from origami_nlp.paths.figure import draw_ranges, event_look, kinds_legend
from origami_nlp.paths.load_result import LoadPath
from origami_nlp.paths.records import PathBranch
from origami_nlp.pattern import Pattern

PICTURE_WIDTH = 9.6
"""Of a picture [inches]."""
TALL, MOST_DRAWN = 2.9, 4
"""Of the row of folded states [inches], and how many there are."""
PATH, SNAP = "#222222", "#c1121f"
ARROW = {"arrowstyle": "-|>", "color": SNAP, "lw": 1.4, "shrinkA": 2, "shrinkB": 2}
TANGENT: Any = {"color": "#7b2d8b", "lw": 1.1, "ls": (0, (4, 2))}
TANGENT_SHARE = 0.2
"""Of the loads that are shown, to either side of the start, along which the stiffness there is drawn."""


def draw_load(path: LoadPath) -> Figure:
    """Draw load against angle, and the energy of the states that are passed; of a pattern also its states round snaps.

    Parameters
    ----------
    path
        Of `load_path`.

    Returns
    -------
    matplotlib.figure.Figure
        Left the load over what it works on: the path in grey, snaps as red arrows, events with their numbers, which the
        lines below name.  Right the energy without the load.  Of a pattern, below, the first states of the path, with
        rings where facets touch, full where they push.

    Raises
    ------
    OptionError
        If `path` is not of its type.
    """
    check_type("path", path, LoadPath)
    low, high = _range(path)
    shown = [e for e in path.events if low <= e.t <= high]
    lines = ["\n    ".join(textwrap.wrap(f"{e.id}  {e.words()}, {e.t:.9g}", 58)) for e in shown]
    rows = [max(line.count("\n") + 1 for line in lines[k : k + 2]) for k in range(0, len(lines), 2)]
    below = 0.17 * sum(rows)
    height, tall = 4.6 + below, 0.0 if path.pattern is None else TALL
    figure = Figure(figsize=(PICTURE_WIDTH, height + tall), dpi=110, facecolor="white")
    upper: Any = figure
    if path.pattern is not None:
        upper, lower = figure.subfigures(2, 1, height_ratios=(height, tall))  # type: ignore[misc]
        _place_states(lower, path, path.pattern)
    left, right = (
        upper.add_axes((x, (below + 0.67) / height, w, 3.55 / height))
        for x, w in ((0.085, 0.52), (0.70, 0.28))
    )
    begun = f", from state #{path.state}" if path.state else ""
    title = textwrap.wrap(label_text(f"{path.label}: {path.driver.name}{begun}"), 95)
    upper.suptitle("\n".join(title), fontsize=11, y=1 - 0.12 / height)
    _curve(left, path, [e.id for e in shown])
    _energy(right, path)
    for axes in (left, right):
        axes.grid(True, lw=0.3, color="#dddddd")
        axes.tick_params(labelsize=8)
    for k in range(2):
        text = "\n".join(label_text(line) for line in lines[k::2])
        upper.text(0.085 + 0.47 * k, (below + 0.06) / height, text, fontsize=7.5, va="top")
    return figure


def _place_states(figure: Any, path: LoadPath, pattern: Pattern) -> None:
    """Draw the pattern at the start, on both sides of snaps, and at the ends of legs that do not snap."""
    unit, first = path.driver.unit, path.legs[0].points[0]
    shown = [(f"at {first.t:.4g} {unit}", first.fold_angles, first.t)]
    for number, leg in enumerate(path.legs, start=1):
        if leg.snap is None:
            last = leg.points[-1]
            shown.append((f"end of leg {number}, {last.t:.4g} {unit}", last.fold_angles, last.t))
            continue
        snap = path.snaps[leg.snap - 1]
        shown.append((f"before snap {leg.snap}, {snap.t:.4g} {unit}", snap.before, snap.t))
        shown.append((f"after snap {leg.snap}", snap.after, snap.t))
    line, share = path.driver.line(), 1 / min(len(shown), MOST_DRAWN)
    for k, (title, phi, t) in enumerate(shown[:MOST_DRAWN]):
        axes = figure.add_axes(((k + 0.02) * share, 0.02, 0.96 * share, 0.82))
        state = np.array(phi)
        draw_pattern_state(axes, pattern, state, contacts=_carried(line.at(t), state))
        axes.set_title(title, fontsize=9)


def _carried(problem: Any, phi: np.ndarray) -> tuple[ContactForce, ...]:
    """Return the closed contacts of an equilibrium [n] and what they carry; none of patterns too large for a kernel."""
    if problem.sparse:
        return ()
    found = problem.closed(phi)
    closed = (*found.base, *(c for b in found.branches for o in b for c in o))
    return contact_forces(State(problem, phi), tuple(dict.fromkeys(closed)))


def _range(path: LoadPath) -> tuple[float, float]:
    """Loads that are shown: those of the path, but not far beyond its last event."""
    loads = [p.t for leg in path.legs for p in leg.points] + [s.t for s in path.snaps]
    low, high = min(loads), max(loads)
    events = [0.0, *(e.t for e in path.events if low <= e.t <= high)]
    more = 0.3 * (max(events) - min(events)) or high - low
    low, high = max(low, min(events) - more), min(high, max(events) + more)
    room = 0.08 * (high - low) or 1.0
    return low - room, high + room


def _angles(path: LoadPath, fold_angles: Any) -> np.ndarray:
    return path.shown(path.driver.conjugate(np.array(fold_angles)))


def _curve(axes: Any, path: LoadPath, shown: list[int]) -> None:
    for branch in path.branches:
        t = np.array([p.t for p in branch.points])
        x = _angles(path, [p.fold_angles for p in branch.points])
        draw_ranges(axes, branch, x, t)
        _dot_unstable(axes, branch, x, t)
    for leg in path.legs:
        t = np.array([p.t for p in leg.points])
        x = path.shown(np.array([p.angle for p in leg.points]))
        axes.plot(x, t, color=PATH, lw=6, alpha=0.13, solid_capstyle="round", zorder=1)
        if leg.moved:  # of creases that may yield no other states are followed
            axes.plot(x, t, color=PATH, lw=1.4, zorder=2)
    for snap in path.snaps:
        a, b = _angles(path, [snap.before, snap.after])
        axes.annotate("", (b, snap.t), (a, snap.t), arrowprops=ARROW, zorder=4)
        axes.plot(a, snap.t, "o", ms=9, mfc="none", mec=SNAP, zorder=6)  # of angles that stay, too
        axes.plot(b, snap.t, ".", ms=5, color=SNAP, zorder=4)  # arrows alone do not widen the axes
    named: dict[tuple[float, float], list[str]] = {}
    for event in path.events:
        if event.id not in shown:
            continue
        at = float(_angles(path, event.fold_angles))
        # the way back meets events where the way there did: their numbers stand beside each other
        named.setdefault((float(f"{at:.6g}"), float(f"{event.t:.6g}")), []).append(str(event.id))
        axes.plot(at, event.t, **event_look(event.type), zorder=5)
    for place, numbers in named.items():
        axes.annotate(", ".join(numbers), place, (4, 4), textcoords="offset points", fontsize=8)
    axes.set_ylim(*_range(path))
    axes.set_ylabel(f"{path.driver.name}{path.in_unit}")
    axes.set_xlabel(path.where)
    handles = kinds_legend(path.branches)
    if any(p.full_space_eigenvalue < 0 for b in path.branches for p in b.points):
        label = "dotted: stable only with its symmetry"
        handles.append(Line2D([], [], color="#888888", lw=1.8, ls=(0, (1, 1.0)), label=label))
    handles.append(Line2D([], [], color=PATH, lw=6, alpha=0.13, label="the path"))
    if path.snaps:
        places = list(dict.fromkeys(f"{s.t:.4g}" for s in path.snaps))[:MOST_DRAWN]
        label = f"snap at {', '.join(places)} {path.driver.unit}".rstrip()
        handles.append(Line2D([], [], color=SNAP, label=label))
    if math.isfinite(path.start_stiffness):
        start, (low, high) = path.legs[0].points[0], _range(path)
        ends = np.array([-1.0, 1.0]) * TANGENT_SHARE * (high - low)
        where = start.angle + ends / path.start_stiffness
        axes.plot(path.shown(where), start.t + ends, **TANGENT, zorder=3)
        label = f"stiffness at the start\n{path.start_stiffness:.4g} {path.stiffness_unit}"
        handles.append(Line2D([], [], **TANGENT, label=label))
    axes.legend(handles=handles, fontsize=7.5, framealpha=0.85)


def _dot_unstable(axes: Any, branch: PathBranch, x: np.ndarray, t: np.ndarray) -> None:
    """Cut the lines of states that are stable but for their symmetry into dots."""
    broken = np.zeros(len(x), dtype=bool)
    for r in branch.kind_ranges:
        broken[r.points[0] : r.points[1] + 1] |= r.stable
    broken &= np.array([p.full_space_eigenvalue < 0 for p in branch.points])
    if broken.any():
        rest = np.where(broken, x, np.nan)
        axes.plot(rest, t, color="white", lw=1.4, ls=(0, (1, 1.5)), zorder=2.5)


def _energy(axes: Any, path: LoadPath) -> None:
    for leg in path.legs:
        axes.plot([p.t for p in leg.points], [p.energy for p in leg.points], color=PATH, lw=1.4)
    for snap in path.snaps:
        a, b = path.driver.unloaded.energy(np.array([snap.before, snap.after]))
        axes.annotate("", (snap.t, b), (snap.t, a), arrowprops=ARROW)
        axes.plot(snap.t, b, alpha=0.0)  # arrows alone do not widen the axes
    axes.set_xlabel(f"load{path.in_unit}")
    axes.set_ylabel("energy without the load  [J]")
    axes.locator_params(axis="x", nbins=4)  # its labels are wide
    axes.set_xlim(*_range(path))
