"""Text that users and files give, made safe to show: a name must not steer the terminal that prints it.

Long lines are broken between words, what follows indented: no number loses its unit, no text a letter.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.text import Text


_SHOWN: dict[int, str] = {
    **{code: chr(0x2400 + code) for code in range(32)},  # pictures of the control characters
    127: "\u2421",
    # C1 controls, line separators, marks that turn the direction of writing, halves of surrogate pairs
    **dict.fromkeys(
        (*range(0x80, 0xA0), 0x200E, 0x200F, *range(0x2028, 0x202F), *range(0x2066, 0x206A)),
        "\ufffd",
    ),
    **dict.fromkeys(range(0xD800, 0xE000), "\ufffd"),
}
_BUT_LINES = {code: shown for code, shown in _SHOWN.items() if code not in (9, 10)}


def printable(text: str, *, lines: bool = False) -> str:
    r"""Return a text with each control character replaced by a visible one, such as U+241B for escape.

    Parameters
    ----------
    text
        Of a user or a file.
    lines
        Keep line ends and tabs.

    Returns
    -------
    str
        As many characters.

    Examples
    --------
    >>> from origami_nlp.io import printable
    >>> printable("\x1b[2J")
    '␛[2J'
    """
    return text.translate(_BUT_LINES if lines else _SHOWN)


def is_unicode(text: str) -> bool:
    """Return whether a text can be written as UTF-8: half of a surrogate pair is no character.

    Parameters
    ----------
    text
        The text.

    Returns
    -------
    bool
        Whether it can.
    """
    return not any(0xD800 <= ord(c) < 0xE000 for c in text)


def is_number(text: str) -> bool:
    """Return whether a text is a number, as Python reads it.

    Parameters
    ----------
    text
        The text.

    Returns
    -------
    bool
        Whether it is.
    """
    try:
        float(text)
    except ValueError:
        return False
    return True


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
    """Return whether a line may end at these spaces: not beside a unit, nor at an equals sign."""
    before, after = line[:start], line[end:]
    unit = before[-1:] in "0123456789)" and _UNIT.match(after)
    half = before.endswith((" N", "[N")) and after.startswith("m")
    head = before.endswith("]") and re.match(r"-?\d", after)  # the unit in the head of a table
    return not (unit or half or head or before.endswith(" =") or after.startswith("= "))
