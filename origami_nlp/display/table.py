"""Tables of words, and results that print themselves: on screens, in plain text, as Markdown and as HTML.

Nothing here knows a result: rooms make tables of texts, and this writes them down.  A text may carry a style of
rich for the screen (`Words`), which is dropped where it cannot be shown.
"""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from html import escape
from textwrap import shorten
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from origami_nlp.display.records import Shown
from origami_nlp.display.result import Result
from origami_nlp.io import PrettyRepr, printable

if TYPE_CHECKING:
    from rich.console import Console, Group
    from rich.text import Text


class Words(NamedTuple):
    """A text with a look.

    Attributes
    ----------
    text
        The text.
    style
        Of rich, such as ``"bold"``.
    """

    text: str
    style: str = ""


Cell: TypeAlias = str | Words


@dataclass(frozen=True)
class Table:
    """Heads and rows of texts.

    Attributes
    ----------
    heads
        One a column.
    rows
        A text or `Words` a column.
    title
        Above the table.
    columns
        A letter each, ``l`` left or ``r`` right; a capital where words may wrap when the terminal is narrow.
        Without: the first column left, the others right.
    framed
        With lines around.
    narrow
        With less room between columns.

    Examples
    --------
    >>> from origami_nlp.display import Table
    >>> print(Table(("state", "energy"), [("1", "0.5")]).markdown().rstrip())
    | state | energy |
    |---|---|
    | 1 | 0.5 |
    """

    heads: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    title: str = ""
    columns: str = ""
    framed: bool = True
    narrow: bool = False

    def __rich__(self) -> Group:
        """Return the table as a console prints it: heads give way first, then words; numbers stay whole."""
        from rich import box, table
        from rich.console import Group

        look = table.Table(
            box=box.HEAVY_HEAD if self.framed else box.SIMPLE_HEAD,
            pad_edge=self.framed,
            padding=(0, 1, 0, 0) if self.narrow else (0, 1),
        )
        rows = [[*map(_rich, row)] for row in self.rows]
        for k, (head, letter) in enumerate(zip(self.heads, self._letters, strict=True)):
            lines = [line.cell_len for row in rows for line in row[k].split("\n")]
            look.add_column(
                _rich(head),
                justify="left" if letter in "lL" else "right",
                overflow="fold",
                min_width=max(lines, default=0) if letter.islower() else None,
            )
        for row in rows:
            look.add_row(*row)
        title = [_rich(Words(self.title, "italic"))] if self.title else []
        return Group(*title, look)

    def markdown(self) -> str:
        """Return the table in Markdown, without its title; bold cells stay bold."""
        marks = ["---:" if c in "rR" else "---" for c in self.columns] or ["---"] * len(self.heads)
        lines = [f"| {' | '.join(map(_markdown, self.heads))} |", f"|{'|'.join(marks)}|"]
        lines += [f"| {' | '.join(map(_markdown, row))} |" for row in self.rows]
        return "\n".join(lines) + "\n"

    def html(self) -> str:
        """Return the table in HTML, without its title; it brings its own style along."""
        sides = ["left" if c in "lL" else "right" for c in self._letters]
        look = "vertical-align:top;padding:2px 10px 2px 2px"
        styles = [f"style='text-align:{side};{look}'" for side in sides]

        def line(tag: str, cells: Sequence[Cell]) -> str:
            pairs = zip(styles, cells, strict=True)
            return f"<tr>{''.join(f'<{tag} {s}>{_html(c)}</{tag}>' for s, c in pairs)}</tr>"

        body = "\n".join(line("td", row) for row in self.rows)
        return (
            f"<table style='border-collapse:collapse'>\n<thead>{line('th', self.heads)}</thead>"
            f"<tbody>\n{body}\n</tbody></table>"
        )

    @property
    def _letters(self) -> str:
        return self.columns or "l" + "r" * (len(self.heads) - 1)


@dataclass(frozen=True)
class Details:
    """Tables and lines for those who check a result: printed with ``verbose``, folded in HTML.

    Attributes
    ----------
    pieces
        In order.
    title
        What they hold.
    """

    pieces: Sequence[Table | Cell]
    title: str = "Certificates, residuals, search"


Section: TypeAlias = Table | Cell | Details


class Report(PrettyRepr, Result, ABC):
    """A result that prints itself: a class says `report_sections`, and is printed everywhere from that.

    ``print(result)``, IPython and Jupyter show all of it; in lists, and in the plain Python prompt, it is one line.

    Examples
    --------
    >>> from origami_nlp.display import Report
    >>> class Answer(Report):
    ...     def report_sections(self):
    ...         yield "42"
    ...         yield "as was to be expected"
    >>> Answer()
    Answer(42)
    >>> print(Answer())
    42
    as was to be expected
    """

    WIDTH = 110
    """Columns of the plain text."""
    BRIEF = 150
    """Characters of the one line, at most."""

    @abstractmethod
    def report_sections(self) -> Iterable[Section]:
        """Return what there is to say: tables and lines, in order."""

    def print_to(self, console: Console, verbose: bool = False) -> None:
        """Print; lines are as long as they are.

        Parameters
        ----------
        console
            Of rich.
        verbose
            With `Details`; else a line says where they are.
        """

        def write(piece: Section) -> None:
            if isinstance(piece, Table):
                console.print(piece, soft_wrap=True)
            elif not isinstance(piece, Details):
                console.print(_rich(piece), soft_wrap=True)
            elif verbose:
                console.print()
                for inner in piece.pieces:
                    write(inner)
            else:
                where = "--verbose, -o FILE.json; in Python report(verbose=True)"
                write(Words(f"{piece.title}: {where}", "dim"))

        for piece in self.report_sections():
            write(piece)

    def report(self, *, verbose: bool = False) -> str:
        """Return what is printed.

        Parameters
        ----------
        verbose
            With certificates, residuals and the account of the work.

        Returns
        -------
        str
            Plain text.
        """
        from rich.console import Console

        text = io.StringIO()  # in Jupyter a console would display instead of writing to its file
        look: dict[str, Any] = {"color_system": None, "force_jupyter": False}
        self.print_to(Console(file=text, width=self.WIDTH, **look), verbose)
        return text.getvalue().rstrip()

    def __str__(self) -> str:
        return self.report()

    def __repr__(self) -> str:
        first = next(iter(self.report_sections()), "")
        words = first.title if isinstance(first, Table | Details) else first
        text = words if isinstance(words, str) else words.text
        return f"{type(self).__name__}({shorten('; '.join(text.splitlines()), self.BRIEF)})"

    def _repr_html_(self) -> str:
        return pieces_html(self.report_sections())


def pieces_html(pieces: Iterable[Section]) -> str:
    """Return tables and lines as HTML, static and without links.

    Parameters
    ----------
    pieces
        Such as those of `Report.report_sections`.

    Returns
    -------
    str
        One ``div``.
    """

    def parts() -> Iterator[str]:
        for piece in pieces:
            if isinstance(piece, Details):
                summary = f"<summary>{escape(piece.title)}</summary>"
                yield f"<details>{summary}\n{pieces_html(piece.pieces)}\n</details>"
                continue
            if not isinstance(piece, Table):
                yield f"<div style='white-space:pre-wrap'>{_html(piece)}</div>"
                continue
            title = escape(piece.title).replace("\n", "<br>")
            yield f"<p><b>{title}</b></p>\n{piece.html()}" if title else piece.html()

    return "\n".join(["<div>", *parts(), "</div>"])


def record_table(
    records: Sequence[Any], title: str, names: Sequence[str] = (), *, narrow: bool = False
) -> Table:
    """Return records as a table; columns without a value are left out.

    Parameters
    ----------
    records
        Of one class, whose shown fields are the columns.
    title
        Above the table.
    names
        Of the fields that are shown, if not all that have a title.
    narrow
        With less room between columns.

    Returns
    -------
    Table
        Without frame; words to the left, numbers to the right.
    """
    heads, cells, letters = [], [], ""
    for f in fields(records[0]) if records else ():
        how: Shown = f.metadata.get("shown", Shown())
        values = [getattr(record, f.name) for record in records]
        if (
            not how.title
            or (names and f.name not in names)
            or all(v is None or v == () for v in values)
        ):
            continue
        heads.append(how.head)
        cells.append([Words(how.text(v), how.styles.get(v, "")) for v in values])
        letters += how.side or ("L" if any(isinstance(v, str) for v in values) else "r")
    return Table(heads, [*zip(*cells, strict=True)], title, letters, framed=False, narrow=narrow)


def field_table(record: Any, title: str) -> Table:
    """Return what a record holds, a line a field with a number or words; what is zero or empty is left out.

    Parameters
    ----------
    record
        Of a dataclass.
    title
        Above the table.

    Returns
    -------
    Table
        Names, and values; of counts by name a line each.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> from origami_nlp.display import field_table
    >>> @dataclass
    ... class Work:
    ...     starts: int
    ...     lost: int
    ...     by_family: dict
    >>> field_table(Work(7, 0, {"drawn": 5}), "work").rows
    [('starts', '7'), ('by family: drawn', '5')]
    """
    rows = []
    for f in fields(record):
        value, name = getattr(record, f.name), f.name.replace("_", " ")
        how: Shown = f.metadata.get("shown", Shown(name))
        each = value.items() if isinstance(value, dict) else [("", value)]
        for key, one in each if how.title else ():
            if (isinstance(one, str | int | float) and one) or (one and "shown" in f.metadata):
                spec = how.spec or (".4g" if isinstance(one, float) else "")
                head = f"{how.head}: {key}" if key else how.head
                rows.append((head, replace(how, spec=spec).text(one)))
    return Table((title, ""), rows, "", "LL", framed=False, narrow=True)


def _rich(cell: Cell) -> Text:
    from rich.text import Text

    text, style = (cell, "") if isinstance(cell, str) else cell[:2]
    return Text(printable(text, lines=True), style)


def _markdown(cell: Cell) -> str:
    text, style = (cell, "") if isinstance(cell, str) else cell[:2]
    text = text.replace("|", "\\|").replace("\n", "<br>")
    return f"**{text}**" if style == "bold" else text


def _html(cell: Cell) -> str:
    return escape(cell if isinstance(cell, str) else cell.text).replace("\n", "<br>")
