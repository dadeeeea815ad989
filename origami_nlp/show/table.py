"""Tables of words: on screens, in plain text and as Markdown."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text


def plain_text(width: int, tell: Callable[[Console], None]) -> str:
    """Return what `tell` prints as plain text, `width` columns wide.

    In Jupyter a console would display instead of writing to its file.
    """
    text = io.StringIO()
    tell(Console(file=text, width=width, color_system=None, force_jupyter=False))
    return text.getvalue()


def rows_table(heads: Sequence[str], rows: Sequence[Sequence[str]], title: str) -> Table:
    """Return rows as a table; the first column and long texts to the left, numbers to the right."""
    table = Table(title=Text(title), title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for k, head in enumerate(heads):
        text = head.startswith(("kinds", "how"))
        table.add_column(head, justify="left" if k == 0 or text else "right", no_wrap=not text)
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    return table


def rows_markdown(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return rows as a Markdown table."""
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)]) + "\n"


def folding_table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], title: str, wrap: Sequence[int] = (0,)
) -> Table:
    """Return a table whose columns `wrap` hold words, which wrap where the terminal is narrow."""
    table = Table(title=Text(title), title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for k, head in enumerate(heads):
        words = k in wrap
        table.add_column(head, justify="left" if words else "right", no_wrap=not words)
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    return table
