"""What a search for states of a sheet has found."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from origami_nlp.pattern import Pattern
from origami_nlp.sheets.state import SheetState
from origami_nlp.show import Piece, Table, Told

SCHEMA = "origami_nlp.sheet_states/1"


@dataclass(frozen=True)
class SheetSearch:
    """What was enumerated, what was sampled, what ended open.

    Attributes
    ----------
    starts
        In all.
    open
        Starts that could not be closed within the fold limits: never reported.
    flat
        Starts that fell back into the flat state.
    unfinished
        Descents that did not arrive.
    lines, families
        Ways out of the flat state that were enumerated: with one freedom, with more.
    not_enumerated
        Why they were not; empty where they were.
    curves, complete
        Curves of states with one freedom that were traced; how many of them from limit to limit, or round.
    outside
        Of the curves, those that only random starts led to.
    """

    starts: int
    open: int
    flat: int
    unfinished: int
    lines: int
    families: int
    not_enumerated: str
    curves: int
    complete: int
    outside: int

    def words(self) -> Iterator[str]:
        """Say it."""
        if self.not_enumerated:
            yield f"ways out of the flat state: not enumerated, {self.not_enumerated}"
        else:
            more = f" and {self.families} families with more freedoms" if self.families else ""
            yield f"ways out of the flat state: all enumerated, {self.lines} with one freedom{more}"
        if self.curves:
            lost = self.curves - self.complete
            yield (
                f"one freedom: {self.curves} curves traced"
                + (f", {lost} of them lost on the way" if lost else ", each to its ends")
                + (
                    f"; {self.outside} of them known from random starts only"
                    if self.outside
                    else ""
                )
            )
        yield (
            f"{self.starts} starts: {self.open} could not be closed, {self.flat} fell back flat, "
            f"{self.unfinished} descents did not arrive"
        )
        if not self.curves or self.families or self.not_enumerated or self.outside:
            yield "sampled, not exhausted: there may be further states"
        elif self.complete == self.curves:
            yield "every well on these curves is listed; curves that miss the flat state are sampled only"


@dataclass(frozen=True, eq=False, repr=False)
class SheetResult(Told):
    """States of a sheet.

    Attributes
    ----------
    pattern
        The pattern.
    states
        All that was judged, by energy: minima, and what crosses or is undecided.
    search
        How they were looked for.

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.find_states(o.examples.pattern("metasheet", 2, 3), starts=4)
    >>> found.search.starts >= 4
    True
    """

    pattern: Pattern
    states: tuple[SheetState, ...] = field(repr=False)
    search: SheetSearch

    @property
    def minima(self) -> tuple[SheetState, ...]:
        """Certified minima, by energy."""
        return self._with("minimum")

    @property
    def undecided(self) -> tuple[SheetState, ...]:
        """States that are stationary as far as could be told, without a certificate."""
        return self._with("undecided")

    @property
    def crossing(self) -> tuple[SheetState, ...]:
        """States in which facets pass through each other: no states of paper."""
        return self._with("crosses")

    def _with(self, verdict: str) -> tuple[SheetState, ...]:
        return tuple(s for s in self.states if s.verdict == verdict)

    def table(self) -> Table:
        """Return the minima as a table."""
        rows = []
        for k, s in enumerate(self.minima, 1):
            curved = "rigid" if np.isinf(s.eigenvalue) else f"{s.eigenvalue:.4g}"
            limits = [c.where[0] + 1 for c in s.contacts if c.type == "fold-limit"]
            words = [c.words() for c in s.contacts if c.type != "fold-limit"][:1]
            if limits:
                shown = ", ".join(map(str, limits[:3])) + (", ..." if len(limits) > 3 else "")
                words.append(f"fold limit of {shown}")
            touching = "; ".join(words)
            rows.append(
                [str(k), f"{s.energy:.10g}", str(s.kind), str(s.freedoms), curved, touching]
            )
        heads = "state", "energy", "kind", "freedoms", "curvature", "contacts"
        return Table(heads, rows, title=self._title(), columns="lrlrrl")

    def _title(self) -> str:
        many = len(self.minima)
        name = f"{self.pattern.name}: " if self.pattern.name else ""
        return f"{name}{many} stable state{'s' * (many != 1)}"

    def told(self) -> Iterable[Piece]:
        """Say what was found, what was not decided, and how it was looked for."""
        yield self.table() if self.minima else self._title()
        for s in self.crossing:
            yield f"energy {s.energy:.6g}: no state of paper, {s.certificate}"
        for s in self.undecided:
            yield f"energy {s.energy:.6g}: {s.certificate}"
        if any(s.freedoms > 1 or not self.search.curves for s in self.crossing):
            yield (
                "not decided: states that facets in contact hold, where more than one freedom is left or curves are "
                "not traced: crossing is tested there, contact is not solved"
            )
        yield from self.search.words()
        yield "modelled: rigid facets without thickness, springs at creases; the way to a state may cross"

    def to_dict(self) -> dict[str, Any]:
        """Return plain data."""
        return {
            "schema": SCHEMA,
            "minima": [s.to_dict() for s in self.minima],
            "undecided": [s.to_dict() for s in self.undecided],
            "crossing": [s.to_dict() for s in self.crossing],
            "search": asdict(self.search),
        }

    def _rows(self) -> Iterable[Mapping[str, object]]:
        for s in self.minima:
            row = s.to_dict()
            angles = {f"phi_{i + 1}": a for i, a in enumerate(row.pop("fold_angles"))}
            yield {**{k: v for k, v in row.items() if not isinstance(v, list)}, **angles}
