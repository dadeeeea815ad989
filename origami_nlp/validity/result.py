"""What a check found: every test with its answer, every fault with its place and size, and one verdict."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from origami_nlp.display import Details, Report, Section, record_table
from origami_nlp.io import printable
from origami_nlp.pattern import Frame
from origami_nlp.validity.faults import Fault, Test

MOST_FAULTS = 12
"""That are printed; the others with ``--verbose``."""
MOST_FRAMES = 3
"""Whose tests are printed where they are ok; the others with ``--verbose``."""


@dataclass(frozen=True, eq=False, repr=False)
class Validity(Report):
    """Whether the states of a file are real.

    Attributes
    ----------
    source
        What was read.
    kinds
        Of each frame that was looked at its number and ``"folded form"`` or ``"crease pattern"``.
    tests
        What was asked, in order.
    faults
        All that is wrong, in order of the tests.
    notes
        What is odd in the file without being wrong.
    frames
        What was looked at; not among plain data.

    Examples
    --------
    >>> import origami_nlp as o
    >>> pattern = o.examples.crease_pattern("miura", 3, 3)
    >>> del pattern["edges_foldAngle"]  # rest angles of springs, at which no vertex closes
    >>> seen = o.check(pattern)
    >>> seen.verdict, len(seen.faults), seen.tests[-1].text
    ('valid', 0, '1 order of 36 pairs of layers')
    """

    PICTURE = "draw_validity"
    SCHEMA = "origami-nlp/validity/1"
    ALSO = ("verdict",)
    ROWS = "faults"
    source: str
    kinds: tuple[tuple[int, str], ...]
    tests: tuple[Test, ...]
    faults: tuple[Fault, ...] = ()
    notes: tuple[str, ...] = ()
    frames: tuple[Frame, ...] = field(default=(), metadata={"plain": False}, repr=False)

    @property
    def verdict(self) -> Literal["valid", "faults", "not decided"]:
        """The answer: valid only where every test that applies was decided."""
        if self.faults:
            return "faults"
        return "not decided" if any(t.status == "not decided" for t in self.tests) else "valid"

    @property
    def sentence(self) -> str:
        """The verdict, in a sentence."""
        name, many = printable(self.source), len(self.faults)
        if many:
            return f"{name}: {many} fault{'s' if many > 1 else ''}"
        for doubt in (t for t in self.tests if t.status == "not decided"):
            return f"{name}: not decided: {doubt.name}: {doubt.text}"
        folded = sum(kind == "folded form" for _, kind in self.kinds)
        what = f"{folded} folded state{'s' if folded > 1 else ''}" if folded else "crease pattern"
        return f"{name}: valid: {what}, {sum(t.status == 'ok' for t in self.tests)} tests"

    def report_sections(self) -> Iterator[Section]:
        """Return the verdict over the tests, of many frames those that do not hold, then the faults."""
        open_ = tuple(t for t in self.tests if t.status not in ("ok", "does not apply"))
        told = self.tests if len(self.kinds) <= MOST_FRAMES else open_
        names = () if len(self.kinds) > 1 else ("name", "status", "text")
        yield record_table(told, self.sentence, names) if told else self.sentence
        yield from map(self._words, self.faults[:MOST_FAULTS])
        yield from (f"note: {note}" for note in self.notes)
        if rest := self.faults[MOST_FAULTS:]:
            yield Details([*map(self._words, rest)], f"{len(rest)} more faults")

    def _words(self, one: Fault) -> str:
        where = f"frame {one.frame}: " if len(self.kinds) > 1 else ""
        at = f", at ({', '.join(f'{v:.4g}' for v in one.place)})" if one.place else ""
        return f"fault: {where}{one.text}{at}"
