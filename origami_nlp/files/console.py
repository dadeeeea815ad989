"""The console of every command: what it prints is what was found, nothing cut and nothing read as markup."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.measure import Measurement
from rich.segment import Segment
from rich.table import Table

from origami_nlp.files.text import printable
from origami_nlp.files.writing import Target, is_stdout

WIDE = 1_000_000
"""Columns of a file or a pipe, which has no edge at which to cut."""
PAGE = 120
"""Columns of running text, where what is printed is as wide as it may be."""
MOST_BOXED = 500
"""Rows of a table with lines around its cells."""


class Screen(Console):
    """A rich console that shows text of users as it is.

    Square brackets are no markup, control characters are shown by their pictures, tables too wide for the
    terminal are folded, and where the output is no terminal nothing is wrapped.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rich.console.Console`."""
        super().__init__(**{"markup": False, "emoji": False, **options})
        if not self.is_terminal and "width" not in options:
            self.width = WIDE

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Render as rich does, with tables that fit and without control characters."""
        if isinstance(renderable, Table):
            self._fit(renderable, (options or self.options).max_width)
        for segment in super().render(renderable, options):
            text, style, control = segment
            shown = text if control else printable(text, lines=True)
            yield segment if shown == text else Segment(shown, style)

    def print_rows(
        self,
        title: str,
        heads: Sequence[str],
        rows: Sequence[Sequence[str]],
        left: Container[str] = (),
        tables: int = 1,
    ) -> None:
        """Print one of so many `tables`; `left`: heads of the columns of words.

        Many rows or tables are plain lines, which is 20 times as fast.
        """
        if max(len(rows), 10 * tables) <= MOST_BOXED:
            table = Table(title=title, title_justify="left")
            for head in heads:
                table.add_column(head, justify="left" if head in left else "right")
            for row in rows:
                table.add_row(*row)
            self.print(table)
            return
        lines = [heads, *rows]
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        print(printable(title), file=self.file)
        for line in lines:
            cells = (
                cell.ljust(width) if head in left else cell.rjust(width)
                for head, cell, width in zip(heads, line, widths, strict=True)
            )
            print(printable("  ".join(cells).rstrip()), file=self.file)

    def _fit(self, table: Table, width: int) -> None:
        """Let cells of `table` fold: words longer than their column, and numbers only if nothing else gives."""
        open_ended = self.options.update(max_width=WIDE)
        needed = len(table.columns) * 3 + 1  # borders and padding, at most
        for column in table.columns:
            column.overflow = "fold"
            sizes = [
                Measurement.get(self, open_ended, cell) for cell in (column.header, *column.cells)
            ]
            fixed = column.no_wrap
            needed += max((s.maximum if fixed else s.minimum for s in sizes), default=0)
        if needed > width:
            for column in table.columns:
                column.no_wrap = False


def screen(*targets: Target | None, **options: Any) -> Screen:
    """Return the console for people: standard error where one of the files to write is standard output.

    Parameters
    ----------
    targets
        Files that will be written, None for those that will not.
    options
        Of `rich.console.Console`.

    Returns
    -------
    Screen
        The console.
    """
    return Screen(stderr=any(map(is_stdout, targets)), **options)
