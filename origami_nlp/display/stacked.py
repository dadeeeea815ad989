"""Figures whose sizes are inches, worked out from their contents: title, body, legend and notes below each other.

So more to show makes a larger figure, not a crowded one.  Uses matplotlib's object interface only: no global state, any
backend.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

MARGIN = 0.2
LINE, SMALL = 0.17, 9.0
"""Height of a line of small text [in], and its font size [points]."""
ENTRY = 1.95
"""Width of an entry of the legend at most [in]."""


class StackedFigure:
    """A figure with its title, legend and notes written; the body is empty.

    Parameters
    ----------
    width, body
        Width of the figure, and height of what it shows [in].
    title
        Its parts: in one line if they fit, else each begins another.
    handles
        Entries of the legend.
    notes
        Sentences below it.

    Attributes
    ----------
    figure
        Of matplotlib.
    """

    def __init__(
        self,
        width: float,
        body: float,
        title: Sequence[str] = (),
        handles: Sequence[Any] = (),
        notes: Sequence[str] = (),
    ):
        if sum(map(len, title)) < 9.3 * width:
            title = ["; ".join(title)]
        head = [line for part in title for line in textwrap.wrap(part, int(9.3 * width))]
        words = [
            line
            for note in notes
            for line in textwrap.wrap(note, int(13.5 * width), break_on_hyphens=False)
        ]
        longest = max((len(h.get_label()) for h in handles), default=0)
        columns = max(1, int((width - 2 * MARGIN) / min(ENTRY, 0.55 + 0.06 * longest)))
        legend = 0.23 * math.ceil(len(handles) / columns)
        self._top = 0.25 + 0.25 * len(head) if head else 0.1
        height = self._top + body + 0.1 + legend + 0.08 + LINE * len(words) + 0.12
        self._size = width, height
        self.figure = Figure(figsize=self._size, dpi=110, facecolor="white")
        for k, line in enumerate(head):
            y = 0.12 + 0.25 * k - self._top
            self.text(MARGIN, y, line, fontsize=12, va="top", weight="bold")
        if handles:
            self.figure.legend(
                handles=handles,
                loc="upper left",
                bbox_to_anchor=self._at(MARGIN, body + 0.1),
                ncols=min(columns, len(handles)),
                fontsize=SMALL,
                frameon=False,
                borderaxespad=0.0,
                columnspacing=1.4,
                handletextpad=0.6,
            )
        for k, line in enumerate(words):
            self.text(MARGIN, body + 0.18 + legend + LINE * k, line, fontsize=SMALL, va="top")

    def _at(self, x: float, y: float) -> tuple[float, float]:
        """Return a place [in, from the upper left corner of the body] as fractions of the figure."""
        width, height = self._size
        return x / width, 1 - (self._top + y) / height

    def axes(self, x: float, y: float, width: float, height: float) -> Any:
        """Return Axes whose upper left corner is at a place.

        Parameters
        ----------
        x, y
            The place [in], from the upper left corner of the body.
        width, height
            Their size [in].

        Returns
        -------
        matplotlib.axes.Axes
            New ones.
        """
        corner = self._at(x, y + height)
        return self.figure.add_axes((*corner, width / self._size[0], height / self._size[1]))

    def text(self, x: float, y: float, words: str, **look: Any) -> None:
        """Write words at a place.

        Parameters
        ----------
        x, y
            The place [in], from the upper left corner of the body.
        words
            The words.
        **look
            Of ``Figure.text``.
        """
        self.figure.text(*self._at(x, y), words, **look)
