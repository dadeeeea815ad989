"""The picture of an actuation: the sheet with its torques, states that are reached, and where loads lead."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.actuation.result import Actuation
from origami_nlp.arguments import check_type
from origami_nlp.display import (
    BORDER,
    FLAT,
    MOUNTAIN,
    VALLEY,
    crease_legend,
    draw_pattern_state,
    label_text,
)
from origami_nlp.pattern import in_plane

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_DRAWN = 8
"""States."""
COLUMNS, CELL = 4, 3.0
"""Of the picture, and the width of each [in]."""
ARROW, BEND = "#444444", 0.2
"""Of transitions: colour, and how far they leave the straight line, over its length."""
PAPER: Any = {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.85}


def draw_actuation(seen: Actuation) -> Figure:
    """Draw the torques of the first load on the flat sheet, the states, and transitions between them.

    Parameters
    ----------
    seen
        Of `actuate`.

    Returns
    -------
    matplotlib.figure.Figure
        First the sheet: driven creases in the colour of their torque, the fewest that start a branch alone dotted where
        no load is stated.  Then the graph of transitions, where there are any: nodes are stable states, the numbers at
        arrows those of loads.  Then states.

    Raises
    ------
    OptionError
        If `seen` is not of its type.
    """
    check_type("seen", seen, Actuation)
    states = [(f"state {k} under the torques", s.phi) for k, s in enumerate(seen.reached, start=1)]
    states += [(f"#{k}: {s.energy:.4g} J", s.phi) for k, s in enumerate(seen.states, start=1)]
    states, more = states[:MOST_DRAWN], len(states) - MOST_DRAWN
    drawings = int(seen.pattern.is_flat) + bool(seen.transitions) + len(states)
    columns = min(COLUMNS, max(drawings, 1))
    rows = math.ceil(max(drawings, 1) / columns)
    figure = Figure(figsize=(CELL * columns, CELL * rows + 0.9), layout="constrained")
    axes = iter([figure.add_subplot(rows, columns, k + 1) for k in range(rows * columns)])
    if seen.pattern.is_flat:
        _draw_torques(next(axes), seen)
    if seen.transitions:
        _draw_graph(next(axes), seen)
    for title, phi in states:
        box = next(axes)
        draw_pattern_state(box, seen.pattern, phi)
        box.set_title(label_text(title), fontsize=9)
    for box in axes:
        box.axis("off")
    words = seen.verdict + (f" ({more} more states)" if more > 0 else "")
    figure.suptitle(label_text(words), fontsize=10, wrap=True)
    figure.legend(
        handles=crease_legend(), loc="outside lower center", ncols=4, frameon=False, fontsize=8
    )
    return figure


def _draw_torques(axes: Axes, seen: Actuation) -> None:
    """Draw the sheet with the creases that bear torques."""
    p, x = seen.pattern, in_plane(seen.pattern)
    for polygon in p.polygons:
        ring = x[[*polygon, polygon[0]]]
        axes.plot(*ring.T, color=BORDER, lw=0.8, zorder=1)
    load = seen.loads[0] if seen.loads else np.zeros(p.creases)
    few: dict[int, float] = {}
    if seen.driven and not seen.loads:
        few = dict(zip(seen.driven[0].creases, seen.driven[0].torques, strict=True))
    for k, (a, b) in enumerate(p.ends.tolist()):
        torque = float(load[k]) or few.get(k + 1, 0.0)
        colour = FLAT if not torque else VALLEY if torque > 0 else MOUNTAIN
        look: Any = {
            "color": colour,
            "lw": 3.0 if torque else 1.2,
            "ls": ":" if few and torque else "-",
        }
        axes.plot(*x[[a, b]].T, solid_capstyle="round", zorder=2 + bool(torque), **look)
        place: Any = {"ha": "center", "va": "center", "fontsize": 7, "zorder": 4}
        words = f"{k + 1}" + (f": {torque:.3g}" if torque else "")
        middle = x[[a, b]].mean(axis=0)
        colour = colour if torque else "black"
        axes.text(middle[0], middle[1], words, bbox=PAPER, color=colour, **place)
    axes.set_aspect("equal")
    axes.axis("off")
    fewest = "torques of these signs" if seen.signs else "fewest driven creases"
    axes.set_title("torques [N m]" if seen.loads else fewest, fontsize=9)


def _draw_graph(axes: Axes, seen: Actuation) -> None:
    """Draw stable states on a circle, and an arrow a transition."""
    nodes = sorted(
        {t.start for t in seen.transitions} | {t.end for t in seen.transitions if t.end >= 0}
    )
    turn = {n: math.pi / 2 - 2 * math.pi * k / len(nodes) for k, n in enumerate(nodes)}
    at = {n: np.array([math.cos(a), math.sin(a)]) for n, a in turn.items()}
    led: dict[tuple[int, int], list[int]] = {}
    for t in seen.transitions:
        if t.end >= 0 and t.load not in led.setdefault((t.start, t.end), []):
            led[t.start, t.end].append(t.load)
    text: Any = {"fontsize": 7, "ha": "center", "va": "center", "color": ARROW}
    arrow: Any = {"arrowstyle": "-|>", "color": ARROW, "shrinkA": 11, "shrinkB": 11, "lw": 1.0}
    for (start, end), loads in led.items():
        words, a, b = ", ".join(map(str, loads)), at[start], at[end]
        if start == end:
            axes.text(1.3 * a[0], 1.3 * a[1], f"{words}: stays", **text)
            continue
        axes.annotate(
            "",
            (b[0], b[1]),
            (a[0], a[1]),
            arrowprops={**arrow, "connectionstyle": f"arc3,rad={BEND}"},
        )
        across = np.array([b[1] - a[1], a[0] - b[0]])
        middle = (a + b) / 2 + 0.5 * BEND * across
        axes.text(middle[0], middle[1], words, bbox=PAPER, **text)
    for n, place in at.items():
        axes.plot(*place, "o", ms=17, mfc="white", mec="black")
        axes.text(
            place[0], place[1], "flat" if n == 0 else f"#{n}", ha="center", va="center", fontsize=7
        )
    axes.set(xlim=(-1.6, 1.6), ylim=(-1.6, 1.6), aspect="equal")
    axes.axis("off")
    axes.set_title("loads, put on and taken off", fontsize=9)
