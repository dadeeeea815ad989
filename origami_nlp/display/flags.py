"""Flags: one boolean a way in which a result can be bad, each with its cause and its cure.

A class of flags is a frozen dataclass of booleans; what it says of each stands in its docstring, under *Attributes*, in
two parts: the cause, and after ``Cure:`` what to do.  What is printed, and the page of the documentation, are made from
there, so that they cannot drift apart.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import fields
from typing import Any, NamedTuple

from origami_nlp.display.table import Report, Section, Table
from origami_nlp.io import to_plain

_ENTRY = re.compile(r"^(\w+)\n((?:    .*\n?)+)", re.MULTILINE)


class FlagText(NamedTuple):
    """What a flag means.

    Attributes
    ----------
    cause
        Why it is up.
    cure
        What to do.
    """

    cause: str
    cure: str


class Flags(Report):
    """Booleans that are all False where nothing is wrong; printed are those that are up.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> from origami_nlp.display import Flags
    >>> @dataclass(frozen=True, repr=False)
    ... class Weather(Flags):
    ...     '''Of a day.
    ...
    ...     Attributes
    ...     ----------
    ...     rain
    ...         Drops fall. Cure: an umbrella.
    ...     '''
    ...
    ...     rain: bool
    >>> Weather(rain=True), bool(Weather(rain=False))
    (Weather(rain), False)
    >>> Weather.reasons()["rain"].cure
    'an umbrella.'
    """

    @property
    def up(self) -> tuple[str, ...]:
        """Names of the flags that are up."""
        return tuple(f.name for f in fields(self) if getattr(self, f.name))  # type: ignore[arg-type]

    @classmethod
    def reasons(cls) -> dict[str, FlagText]:
        """Return cause and cure of each flag, from the docstring.

        Returns
        -------
        dict
            A `FlagText` by name, in order.
        """
        listed = (inspect.getdoc(cls) or "").partition("Attributes\n----------\n")[2]
        out = {}
        for name, text in _ENTRY.findall(listed):
            cause, _, cure = " ".join(text.split()).partition(" Cure: ")
            out[name] = FlagText(cause, cure)
        return out

    def table(self) -> Table:
        """Return the flags that are up with cause and cure."""
        rows = [(name, *self.reasons()[name]) for name in self.up]
        title = f"{len(rows) or 'none'} of {len(fields(self))} flags up"  # type: ignore[arg-type]
        return Table(("flag", "cause", "cure"), rows, title, "lLL", framed=False)

    def report_sections(self) -> Iterator[Section]:
        """Return the flags that are up with cause and cure, or that there are none."""
        table = self.table()
        yield table if table.rows else table.title

    def to_dict(self) -> dict[str, Any]:
        """Return the flags by name, as plain JSON data."""
        data: dict[str, Any] = to_plain(self)
        return data

    def __bool__(self) -> bool:
        return bool(self.up)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self.up)})"

    def _rows(self) -> Iterator[dict[str, object]]:
        for name, reason in self.reasons().items():
            yield {"flag": name, "up": getattr(self, name), **reason._asdict()}
