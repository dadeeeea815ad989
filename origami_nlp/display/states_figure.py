"""States of a vertex or a pattern side by side, each drawn folded below its title, all on one scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.figure import Figure, FigureBase

from origami_nlp.display.painter import crease_legend, draw_state
from origami_nlp.display.text import label_text
from origami_nlp.display.touches import contact_legend
from origami_nlp.kkt import ContactForce
from origami_nlp.pattern import Pattern, Scene

MOST_DRAWN = 24
"""States of one picture."""
WIDTH = 10.0
"""Of rows of states, about [in]."""


def cell_size(origami: Scene | Pattern) -> tuple[float, float]:
    """Return width and height of a state that is drawn with its title [in]."""
    return (3.2, 2.7) if isinstance(origami, Pattern) else (2.2, 2.5)


def lay_out_states(
    figure: FigureBase,
    origami: Scene | Pattern,
    states: Sequence[tuple[str, np.ndarray]],
    across: int,
    contacts: Sequence[Sequence[ContactForce]] = (),
    *,
    named: Sequence[int] = (),
    colours: Sequence[str] = (),
) -> list[Any]:
    """Draw states into a figure, or a part of one, and return entries of its legend.

    Parameters
    ----------
    figure
        An empty one, with a layout that makes room for titles.
    origami
        What is folded.
    states
        Title, its long lines hung, and fold angles [n] [rad] of each.
    across
        How many stand in a row.
    contacts
        Of each state of a pattern, if touches are to be marked.
    named
        Facets whose numbers are written into the last picture, from 0.
    colours
        Of titles; black where there are none.

    Returns
    -------
    list
        Creases, sides of the paper, and contacts that are marked.
    """
    rows, letters = math.ceil(len(states) / across), int(14 * cell_size(origami)[0])
    every = figure.subplots(rows, across, squeeze=False).ravel()
    for k, (axes, (title, phi)) in enumerate(zip(every, states, strict=False)):
        touches = contacts[k] if k < len(contacts) else ()
        draw_state(axes, origami, phi, named if k + 1 == len(states) else (), touches)
        lines = "\n".join(fill(line, letters) for line in title.splitlines())
        axes.set_title(lines, fontsize=9.5, color=colours[k] if colours else "black")
    for axes in every[len(states) :]:
        axes.remove()
    limits = np.array([(a.get_xlim(), a.get_ylim()) for a in every[: len(states)]])
    half = 0.5 * np.ptp(limits, axis=2).max(axis=0)  # one scale for all
    for axes, (x, y) in zip(every, limits.mean(axis=2), strict=False):
        axes.set(xlim=(x - half[0], x + half[0]), ylim=(y - half[1], y + half[1]))
    cell = getattr(origami, "cell", None)  # copies of a cell are drawn without contacts
    return [*crease_legend(), *contact_legend(() if cell else chain(*contacts[: len(states)]))]


def add_heading(
    figure: Figure, title: str, handles: Sequence[Any], notes: Sequence[str] = ()
) -> None:
    """Write a title over a figure, and a legend below it; notes stand over that."""
    width = figure.get_figwidth()
    figure.set_layout_engine("constrained", h_pad=0.1)
    figure.suptitle(fill(title, int(10 * width)), fontsize=12, weight="bold")
    said = "\n".join(fill(note, int(13 * width), break_on_hyphens=False) for note in notes)
    look: dict[str, Any] = {"fontsize": 9, "frameon": False, "title_fontsize": 9, "title": said}
    columns = max(1, int(width / 2.4))
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, **look)


def draw_states(
    origami: Scene | Pattern,
    states: Sequence[tuple[str, np.ndarray]],
    title: str,
    named: Sequence[int] = (),
    contacts: Sequence[Sequence[ContactForce]] = (),
) -> Figure:
    """Draw states of a vertex or a pattern side by side.

    Parameters
    ----------
    origami
        What is folded.
    states
        Title and fold angles [n] [rad] of each; the first `MOST_DRAWN` are drawn.
    title
        Above all.
    named
        Facets whose numbers are written into the last picture, from 0.
    contacts
        Of each state of a pattern, if touches are to be marked.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.display import draw_states
    >>> scene = o.examples.miura("pi/3")
    >>> len(draw_states(scene, [("rest", scene.rest_angles), ("flat", [0, 0, 0, 0])], "Miura").axes)
    2
    """
    shown = [(label_text(name), np.asarray(x)) for name, x in states[:MOST_DRAWN]]
    wide, tall = cell_size(origami)
    across = min(int(WIDTH / wide), len(shown))
    size = max(across * wide, 5.0), math.ceil(len(shown) / across) * tall + 0.8
    figure = Figure(figsize=size, dpi=110, layout="constrained")
    named = named if len(shown) == len(states) else ()
    handles = lay_out_states(figure, origami, shown, across, contacts, named=named)
    more = f" (the first {len(shown)} of {len(states)})" if len(states) > len(shown) else ""
    add_heading(figure, label_text(title + more) if title else "", handles)
    return figure
