"""Long lines broken between words, what follows indented: no number loses its unit, no text a letter."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.text import Text

INDENT = 4
"""Columns by which the rest of a line stands in from its beginning."""
_LABEL = re.compile(r" *\S+ {2,}")
"""A word at the left and room after it: the rest of the line belongs to the right of it."""
_UNIT = re.compile(r"(N m|J|rad|deg|s|%)(?![\w^])")


def hang(text: Text, width: int, inset: int | None = None) -> Text:
    """Return a text whose lines are broken at spaces where they are longer than `width`.

    A word that is longer stands whole on a line of its own.

    Parameters
    ----------
    text
        Of rich, with its styles.
    width
        Columns.
    inset
        Columns before the rest of a broken line; None: as the line begins.

    Returns
    -------
    rich.text.Text
        The same letters, with line ends and the indentation after them in place of spaces.
    """
    from rich.text import Text

    lines = []
    for line in text.split("\n", allow_blank=True):
        room = _inset(line.plain, width) if inset is None else inset
        for number, (start, end) in enumerate(_parts(line.plain, width, room)):
            lines.append(Text(" " * room * (number > 0)) + line[start:end])
    joined = Text("\n", end=text.end).join(lines)
    joined.style = text.style
    return joined


def _inset(line: str, width: int) -> int:
    """Return the columns before the rest of a line: below what follows a label, or a little to the right."""
    label = _LABEL.match(line)
    if label and len(label[0]) <= width // 2:
        return len(label[0])
    return min(len(line) - len(line.lstrip()) + INDENT, width // 2)


def _parts(line: str, width: int, inset: int) -> list[tuple[int, int]]:
    """Return where the parts of a line begin and end."""
    from rich.cells import cell_len

    parts, start, end, room = [], 0, None, width
    for space in re.finditer(r"(?<=\S) +|$", line):
        if end is not None and cell_len(line[start : space.start()]) > room:
            parts.append((start, end[0]))
            start, end, room = end[1], None, width - inset
        if _may_break(line, *space.span()):
            end = space.span()
    return [*parts, (start, len(line.rstrip()) if parts else len(line))]


def _may_break(line: str, start: int, end: int) -> bool:
    """Tell whether a line may end at these spaces: not beside a unit, nor at an equals sign."""
    before, after = line[:start], line[end:]
    unit = before[-1:] in "0123456789)" and _UNIT.match(after)
    half = before.endswith((" N", "[N")) and after.startswith("m")
    head = before.endswith("]") and re.match(r"-?\d", after)  # the unit in the head of a table
    return not (unit or half or head or before.endswith(" =") or after.startswith("= "))
