"""The console of every command: what it prints is what was found, nothing cut and nothing read as markup."""

from __future__ import annotations

import os
from collections.abc import Container, Iterable, Iterator, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, RenderableType
from rich.measure import Measurement
from rich.protocol import rich_cast
from rich.segment import Segment
from rich.table import Table
from rich.text import Text

from origami_nlp.io.text import hang, printable
from origami_nlp.io.writing import Target, is_stdout

WIDE = 1_000_000
"""Columns of a table in a file or a pipe, which has no edge at which to cut."""
PAGE = 100
"""Columns of lines of words there, where the variable COLUMNS says nothing else."""
MOST_BOXED = 500
"""Rows of a table with lines around its cells."""
NARROWEST = 16
"""Columns that a column of words keeps; where that is too much, rows are listed one after the other."""


class Screen(Console):
    """A rich console that shows text of users as it is.

    Square brackets are no markup, and control characters are shown by their pictures.  Lines of words are broken
    between words.  Tables too wide for the terminal are folded, or their rows are listed one after the other; in a
    file or a pipe they are as wide as they are.
    """

    def __init__(self, **options: Any) -> None:
        """Take the options of `rich.console.Console`."""
        super().__init__(**{"markup": False, "emoji": False, **options})
        self.page = self.width
        if not self.is_terminal and "width" not in options:
            stated = os.environ.get("COLUMNS", "")
            self.width, self.page = WIDE, int(stated) if stated.isdigit() and int(stated) else PAGE

    def print(self, *objects: Any, **options: Any) -> None:
        """Print as rich does, but lines of words broken with an indent, and titles of tables as such lines."""
        things: list[Any] = [rich_cast(one) for one in objects]
        words = things and all(isinstance(one, str | Text) for one in things)
        if words and not options.get("no_wrap"):
            marked = options.pop("highlight", None)
            texts = [
                one if isinstance(one, Text) else self.render_str(one, highlight=marked)
                for one in things
            ]
            text = Text(options.pop("sep", " ")).join(texts)
            things, options = [hang(text, self.page)], {**options, "soft_wrap": True}
        elif len(things) == 1 and isinstance(things[0], Table):
            things, options = [self._titled(things[0])], {"soft_wrap": True, **options}
        super().print(*things, **options)

    def on_broken_pipe(self) -> None:
        """Leave it to who prints, as it is of what is not printed by rich, what a reader that has gone means."""
        raise

    def _titled(self, table: Table) -> Table | Text:
        """Print the title of a table, and return the table without it, or its rows as lines."""
        if table.title:
            self.print(table.title, style="table.title", highlight=False)
            table.title = None
        if self._most(table) > self.width:
            self._fold_heads(table)
        if self._least(table) <= self.width:
            return table
        return hang(Text("\n").join(_rows(table)), self.page)

    def _least(self, table: Table) -> int:
        """Columns that a table needs if no number is folded, and words not below `NARROWEST`."""
        words = [self._most(c.header, *c.cells) for c in table.columns if not c.no_wrap]
        return self._most(table) - sum(max(0, most - NARROWEST) for most in words)

    def _most(self, *things: RenderableType) -> int:
        """Columns of the widest of some things where there is room for all."""
        open_ended = self.options.update(max_width=WIDE)
        return max((Measurement.get(self, open_ended, one).maximum for one in things), default=0)

    def _fold_heads(self, table: Table) -> None:
        """Break heads that are longer than the numbers below them between words."""
        for column in table.columns:
            head = _text(column.header)
            words = head.plain.split()
            width = max(self._most(*column.cells), *map(len, words), 1)
            if column.no_wrap and len(head.plain) > width:
                column.header = hang(head, width, 0)

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Render as rich does, with tables that fit and without control characters."""
        found = super().render(renderable, options)
        if isinstance(renderable, Table):
            self._fit(renderable, (options or self.options).max_width)
        if isinstance(renderable, Table) or type(renderable).__name__ == "Markdown":
            found = _without_ends(found)
        for segment in found:
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
            look = {"box": SIMPLE_HEAD, "pad_edge": False, "padding": (0, 1, 0, 0)}
            table = Table(title=title, title_justify="left", **look)  # type: ignore[arg-type]
            for head in heads:
                table.add_column(head, justify="left" if head in left else "right")
            for row in rows:
                table.add_row(*row)
            self.print(table)
            return
        lines = [[head.replace("\n", " ") for head in heads], *rows]
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
        for column in table.columns:
            column.overflow = "fold"
        if self._least(table) > width:
            for column in table.columns:
                column.no_wrap = False


def _rows(table: Table) -> Iterator[Text]:
    """Return each row of a table as a line: what it is called, then each head with what stands below it."""
    heads = [_text(column.header) for column in table.columns]
    for row in zip(*(column.cells for column in table.columns), strict=True):
        first, *cells = map(_text, row)
        pairs = [(h, c) for h, c in zip(heads[1:], cells, strict=True) if c.plain.strip()]
        reported = [Text.assemble(h, " " if h.plain else "", c) for h, c in pairs]
        name = Text.assemble(heads[0], "" if heads[0].plain in ("", "#") else " ", first)
        yield Text.assemble(name, ": ", Text(", ").join(reported)) if reported else name


def _text(cell: Any) -> Text:
    text = cell if isinstance(cell, Text) else Text(str(cell))
    return Text(" ").join(text.split("\n")) if "\n" in text.plain else text


def _without_ends(segments: Iterable[Segment]) -> Iterator[Segment]:
    """Take away the spaces at the ends of lines."""
    for line in Segment.split_lines(segments):
        while line and not line[-1].text.rstrip(" "):
            line.pop()
        if line:
            line[-1] = Segment(line[-1].text.rstrip(" "), line[-1].style)
        yield from line
        yield Segment.line()


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
