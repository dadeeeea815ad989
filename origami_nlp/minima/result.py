"""What a search for minima returns, and how it tells itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from origami_nlp.minima.minimum import Minimum, SearchReport
from origami_nlp.minima.telling import (
    geometry_lines,
    search_lines,
    state_lines,
    states_table,
    undecided_lines,
)
from origami_nlp.pattern import Scene
from origami_nlp.programme import Model
from origami_nlp.show import Piece, Table, Told, Words


@dataclass(frozen=True, repr=False)
class MinimaResult(Told):
    """Scene, model, minima in order of energy, and the record of the search."""

    scene: Scene
    model: Model
    minima: tuple[Minimum, ...]
    search: SearchReport

    def table(self) -> Table:
        """Return one row a minimum."""
        return states_table(self.scene, self.minima, self.model.freedom)

    def told(self) -> Iterator[Piece]:
        """Return the table, the states and the record of the search."""
        yield self.table()
        yield from state_lines(self.scene, self.minima)
        yield from undecided_lines(self.search)
        yield from geometry_lines(self.scene)
        yield from (Words(line, "dim") for line in search_lines(self.search))

    def to_html(self, *, picture: bool = True) -> str:
        """Return a piece of HTML, static and without links; `picture`: with that of `draw_minima`."""
        from origami_nlp.minima.html import as_html  # pictures are slow to import

        return as_html(self.scene, self.minima, self.model.freedom, self.search, picture=picture)

    def _repr_html_(self) -> str:
        return self.to_html()


minima_table, print_result = MinimaResult.table, MinimaResult.tell
