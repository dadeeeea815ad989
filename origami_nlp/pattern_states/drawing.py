"""Pictures of a pattern: as it is, and along its folding motion."""

from __future__ import annotations

import math
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from origami_nlp.display import (
    BORDER,
    FLAT,
    MOUNTAIN,
    VALLEY,
    crease_legend,
    draw_state,
    draw_states,
    label_text,
)
from origami_nlp.pattern import Pattern, in_plane
from origami_nlp.pattern_states.mobility import Mobility
from origami_nlp.pattern_states.motion import Motion

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_mobility(seen: Mobility, path: Any = None) -> Figure:
    """Draw a pattern: its crease pattern, where it is flat, and beside it the sheet folded.

    Parameters
    ----------
    seen
        Of `analyze_mobility`.
    path
        Where to save it, if anywhere.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    p = seen.pattern
    parts: list[tuple[str, np.ndarray | None]] = [("crease pattern", None)] if p.is_flat else []
    if seen.folded is not None:
        parts.append((f"folded: {seen.start}", seen.folded))
    elif not parts:
        parts.append(("as in the file", p.reference))
    figure = Figure(figsize=(5.2 * len(parts), 5.2), layout="constrained")
    for k, (title, phi) in enumerate(parts):
        axes = figure.add_subplot(1, len(parts), k + 1)
        if phi is None:
            _draw_flat(axes, p)
        else:
            draw_state(axes, p, phi)
        axes.set_title(label_text(title), fontsize=10)
    free = "not known" if seen.dof is None else str(seen.dof)
    title = f"{p.name}: {p.facets} facets, {p.creases} creases, degrees of freedom: {free}"
    figure.suptitle(label_text(title), fontsize=11)
    figure.legend(handles=crease_legend(), loc="outside lower center", ncols=4, frameon=False)
    if path is not None:
        from origami_nlp.io import save_figure

        save_figure(figure, path, 200)
    return figure


def _draw_flat(axes: Axes, p: Pattern) -> None:
    """Draw the flat reference state: letters as in legends, others grey."""
    scale = min(1.0, 12 / math.sqrt(max(len(p.polygons), 1)))
    crease = {tuple(e) for e in p.ends.tolist()}
    count: dict[tuple[int, int], int] = {}
    for q in p.polygons:
        for i, v in enumerate(q):
            s = (min(q[i - 1], v), max(q[i - 1], v))
            count[s] = count.get(s, 0) + 1
    xy = in_plane(p)
    border = [xy[list(s)] for s, n in count.items() if n == 1 and s not in crease]
    axes.add_collection(LineCollection(border, colors=BORDER, linewidths=1.5 * scale))
    for letter, colour, dashes in (
        ("M", MOUNTAIN, "solid"),
        ("V", VALLEY, (0, (3.5, 2.0))),
        ("UF", FLAT, "solid"),
    ):
        lines = [xy[e] for e, a in zip(p.ends, p.assignment, strict=True) if a in letter]
        look: dict[str, Any] = {"colors": colour, "linestyles": [dashes], "linewidths": 1.7 * scale}
        axes.add_collection(LineCollection(lines, **look))
    axes.set_aspect("equal")
    axes.margins(0.05)
    axes.autoscale_view()
    axes.axis("off")


def draw_motion(motion: Motion, path: Any = None) -> Figure:
    """Draw six states along a folding motion.

    Parameters
    ----------
    motion
        Of `find_motion`.
    path
        Where to save the picture, if anywhere.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    states = []
    # where nothing moves beginning and end are one state
    for k in motion.shown(6) if motion.arc[-1] > 0 else [0]:
        phi = motion.fold_angles[k]
        largest = math.degrees(float(np.abs(phi).max()))
        states.append((f"{motion.arc[k]:.2f} rad along, largest fold {largest:.0f} deg", phi))
    title = f"{motion.pattern.name}: {fill(motion.end, 90)}"
    return draw_states(motion.pattern, states, title, path, motion.touching or ())
