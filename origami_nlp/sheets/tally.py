"""What a search for states of a sheet has met so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.minima import JudgedState
from origami_nlp.numerics import SETTLED
from origami_nlp.sheets.curves import Traced
from origami_nlp.sheets.result import SheetSearch


@dataclass(eq=False)
class Tally:
    """Counts of what was met; `left_out` are parts of the search that time or an interruption ended, in order."""

    starts: int = 0
    open: int = 0
    flat: int = 0
    unfinished: int = 0
    flat_folded: int = 0
    lines: int = 0
    planes: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    families: int = 0
    reasons: list[str] = field(default_factory=list)
    traced: int = 0
    not_traced: int = 0
    crossroads: int = 0
    outside: int = 0
    drawn: int = 0
    since: int = 0
    judged: list[JudgedState] = field(default_factory=list)
    pressed: int = 0
    refused: list[str] = field(default_factory=list)
    of_vertex: int = 0
    popped: int = 0
    by_pops: int = 0
    wells: int = 0
    resolved: int = 0
    failed: list[str] = field(default_factory=list)
    left_out: dict[str, None] = field(default_factory=dict)
    interrupted: bool = False

    def has_plane(self, basis: np.ndarray, off: np.ndarray) -> bool:
        """Tell whether a plane of closed states, spanned by a basis [n, t] from a state [n], is known."""
        return any(
            other.shape == basis.shape
            and np.abs(off - there).max() < SETTLED
            and np.abs(basis - other @ (other.T @ basis)).max() < SETTLED
            for other, there in self.planes
        )

    def summary(self, found: Sequence[Traced]) -> SheetSearch:
        """Sum up what was done, with the curves that are known."""
        return SheetSearch(
            starts=self.starts,
            open=self.open,
            flat=self.flat,
            unfinished=self.unfinished,
            lines=self.lines,
            families=self.families,
            flat_folded=self.flat_folded,
            crossroads=self.crossroads,
            not_enumerated="; ".join(dict.fromkeys(self.reasons)),
            curves=len(found),
            complete=sum(c.complete for c in found),
            not_traced=self.not_traced,
            outside=self.outside,
            unclear=sum(c.stretches.unclear for c in found if c.stretches is not None),
            drawn=self.drawn,
            since=self.since,
            pressed=self.pressed,
            refused=tuple(self.refused),
            of_vertex=self.of_vertex,
            popped=self.popped,
            by_pops=self.by_pops,
            wells=self.wells,
            resolved=self.resolved,
            coarse=sum(not c.curve.fits for c in found),
            failed=tuple(self.failed),
            left_out=tuple(self.left_out),
            interrupted=self.interrupted,
        )
