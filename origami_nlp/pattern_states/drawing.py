"""Pictures of a pattern: as it is, and along its folding motion."""

from __future__ import annotations

from collections import Counter
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.display import (
    crease_legend,
    draw_creases,
    draw_state,
    draw_states,
    label_text,
    line_scale,
)
from origami_nlp.pattern import in_plane
from origami_nlp.pattern_states.mobility import Mobility
from origami_nlp.pattern_states.motion import Motion


def draw_mobility(seen: Mobility) -> Figure:
    """Draw a pattern: its crease pattern, where it is flat, and beside it the sheet folded.

    Parameters
    ----------
    seen
        Of `analyze_mobility`.

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
    figure, handles = Figure(figsize=(5.2 * len(parts), 5.2), layout="constrained"), crease_legend()
    for k, (title, phi) in enumerate(parts):
        axes = figure.add_subplot(1, len(parts), k + 1)
        if phi is None:
            count = Counter(
                (min(q[i - 1], v), max(q[i - 1], v)) for q in p.polygons for i, v in enumerate(q)
            )
            creases = {tuple(e) for e in p.ends.tolist()}
            border = [s for s, n in count.items() if n == 1 and s not in creases]
            edges = np.array([*border, *p.ends.tolist()])
            letters = "B" * len(border) + "".join(p.assignment)
            handles[:2] = draw_creases(axes, in_plane(p), edges, letters, line_scale(p))
        else:
            draw_state(axes, p, phi)
        axes.set_title(label_text(title), fontsize=10)
    figure.suptitle(label_text(seen.verdict), fontsize=11)
    figure.legend(handles=handles, loc="outside lower center", ncols=5, frameon=False)
    return figure


def draw_motion(motion: Motion) -> Figure:
    """Draw six states along a folding motion.

    Parameters
    ----------
    motion
        Of `find_motion`.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    # where nothing moves beginning and end are one state
    rows = motion.rows(6 if motion.arc[-1] > 0 else 1)
    states = [(row.caption(), motion.fold_angles[row.state - 1]) for row in rows]
    return draw_states(motion.pattern, states, fill(motion.verdict, 90), motion.touching or ())
