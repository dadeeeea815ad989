"""States of a vertex or a pattern side by side, each drawn folded below its title.

Sizes are in inches and worked out from the contents, so that many states make a larger figure, not a crowded one: they
stand beside what has a place of its own (`beside`) while there is room, the others below it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import chain
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.display.painter import crease_legend, draw_state
from origami_nlp.display.stacked import MARGIN, StackedFigure
from origami_nlp.display.text import label_text
from origami_nlp.display.touches import contact_legend
from origami_nlp.kkt import ContactForce
from origami_nlp.pattern import Pattern, Scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_DRAWN = 24
"""States of one picture."""
CELL, PATTERN_CELL = 2.0, 3.2
"""Width of the drawing of a state, of a vertex and of a pattern [in]."""
SHARE = 0.75
"""Height over width of drawings: all alike, so that their titles are in line."""
HEAD, GAP = 0.18, 0.12
"""Height of a line of a title, and between rows [in]."""
MOST_BESIDE = 3
"""Columns of states beside what has a place of its own."""
ALONE = 10.0
"""Width of rows where there is nothing else, about [in]."""


@dataclass(frozen=True)
class StatesDrawn:
    """States to be drawn side by side.

    Attributes
    ----------
    origami
        What is folded.
    titles
        Of each state; lines that are too long are hung.
    fold_angles
        Of each, [N] [rad], closed.
    contacts
        Of each state of a pattern, if touches are to be marked.
    named
        Facets whose numbers are written into the last picture, from 0, of a pattern.
    colours
        Of titles; black where there are none.
    beside
        Width and height of what stands in the upper left corner [in].
    rows
        States of each row, its left and upper end [in].
    width, height
        Of all [in].
    """

    origami: Scene | Pattern
    titles: Sequence[str]
    fold_angles: Sequence[np.ndarray]
    contacts: Sequence[Sequence[ContactForce]] = ()
    named: Sequence[int] = ()
    colours: Sequence[str] = ()
    beside: tuple[float, float] = (0.0, 0.0)
    rows: list[tuple[range, float, float]] = field(init=False)
    width: float = field(init=False)
    height: float = field(init=False)

    def __post_init__(self) -> None:
        many = len(self.titles)
        if not self.beside[0]:
            across = max(1, min(int(ALONE / self.cell), many))
            found = self._arranged(0, 2 * MARGIN + across * self.cell)
        else:  # as many columns beside what is there as leave least empty
            whole = 2 * MARGIN + self.beside[0]
            columns = range(min(many, 1), min(many, MOST_BESIDE) + 1)
            options = [self._arranged(k, whole + k * self.cell) for k in columns]
            found = min(options, key=lambda option: option[1] * option[2])
        for name, value in zip(("rows", "width", "height"), found, strict=True):
            object.__setattr__(self, name, value)

    @property
    def cell(self) -> float:
        """Width of a drawing [in]."""
        return PATTERN_CELL if isinstance(self.origami, Pattern) else CELL

    def title(self, k: int) -> str:
        """Return the title of a state, lines that are too long hung."""
        lines = self.titles[k].splitlines()
        return "\n".join(fill(line, int(16 * self.cell)) for line in lines)

    def head(self, k: int) -> float:
        """Return the height of the title of a state [in]."""
        return GAP + HEAD * (1 + self.title(k).count("\n"))

    def _arranged(
        self, beside: int, whole: float
    ) -> tuple[list[tuple[range, float, float]], float, float]:
        """Arrange drawings: so many columns beside what is there, the others below."""
        tall = [self.head(k) + self.cell * SHARE for k in range(len(self.titles))]
        width, height = self.beside
        rows: list[tuple[range, float, float]] = []
        k, y = 0, 0.0
        while beside and k < len(tall):
            states = range(k, min(k + beside, len(tall)))
            high = max(tall[i] for i in states)
            if y + high > height + 0.35:
                break
            rows.append((states, MARGIN + width, y))
            k, y = states.stop, y + high + GAP
        if rows and k == len(tall) and (spare := height - y) > 0:
            # little to show: spread over the height
            gap = spare / (len(rows) + 1)
            rows = [(one, left, top + gap * (i + 1)) for i, (one, left, top) in enumerate(rows)]
        y = max(height, y)
        across = int((whole - 2 * MARGIN) / self.cell + 1e-9)
        while k < len(tall):
            states = range(k, min(k + across, len(tall)))
            rows.append((states, MARGIN, y))
            k, y = states.stop, y + max(tall[i] for i in states) + GAP
        return rows, whole, y

    def draw(self, stack: StackedFigure) -> None:
        """Draw the states into the body of a figure.

        Parameters
        ----------
        stack
            With at least `width` and `height`.
        """
        boxes = []
        for states, left, top in self.rows:
            head = max(self.head(k) for k in states)
            for k in states:
                x, wide = left + (k - states.start) * self.cell, self.cell - 0.08
                boxes.append(stack.axes(x + 0.04, top + head, wide, SHARE * wide))
                self._draw(boxes[-1], k)
                look = {"ha": "center", "va": "top", "linespacing": 1.25, "fontsize": 9.5}
                colour = self.colours[k] if self.colours else "black"
                stack.text(x + self.cell / 2, top + 0.04, self.title(k), color=colour, **look)
        limits = np.array([(box.get_xlim(), box.get_ylim()) for box in boxes]).reshape(-1, 2, 2)
        spans = np.ptp(limits, axis=2)
        # one scale for all
        half = 0.5 * max((max(x, y / SHARE) for x, y in spans), default=0.0)
        for box, (x, y) in zip(boxes, limits.mean(axis=2), strict=True):
            box.set(xlim=(x - half, x + half), ylim=(y - SHARE * half, y + SHARE * half))

    def _draw(self, box: Axes, k: int) -> None:
        named = self.named if k + 1 == len(self.titles) else ()
        touches = self.contacts[k] if k < len(self.contacts) else ()
        draw_state(box, self.origami, self.fold_angles[k], named, touches)

    def legend(self) -> list[Any]:
        """Return entries of a legend: creases, sides of the paper, and contacts that are marked."""
        if not self.titles:
            return []
        touches = () if getattr(self.origami, "cell", None) else self.contacts[: len(self.titles)]
        return [*crease_legend(), *contact_legend(chain(*touches))]


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
    shown = states[:MOST_DRAWN]
    named = named if len(shown) == len(states) else ()
    drawn = StatesDrawn(
        origami, [label_text(name) for name, _ in shown], [x for _, x in shown], contacts, named
    )
    more = f" (the first {len(shown)} of {len(states)})" if len(states) > len(shown) else ""
    heading = [label_text(title + more)] if title else []
    stack = StackedFigure(drawn.width, drawn.height, heading, drawn.legend())
    drawn.draw(stack)
    return stack.figure
