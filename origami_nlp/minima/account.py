"""The record of a search: what it enumerated, sampled, left out and could not decide."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from origami_nlp.display import shown
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import OMIT
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stopping import unseen_share

ESCAPE_PATHS = "branch directions of flat-folded states"
MEETINGS = "branch directions of states where curves meet"
"""Parts of a search that its time may end."""


@dataclass(repr=False)
class SearchReport(ShortRepr):
    """What a search enumerated, what it sampled, what it left open.

    Attributes
    ----------
    starts
        States from which descents began.
    expected_undiscovered
        Chao's estimate of the number of minima that no random start reached: a lower bound in expectation, no
        guarantee; inf where it is not asked for.
    expected_error
        Its standard error.
    stopped_by
        ``"rule"``, ``"cap"`` or ``"time"`` (or the user).
    seconds
        Of wall time.
    seed, effort
        As they were asked for.
    by_source
        Starts by the family that they came from.
    stalled
        Ends that are not told from a state that was judged.
    failed
        Where linear algebra failed, by reason.
    seen_once
        Minima that one random start reached.
    quiet
        Random starts since the last new minimum.
    refused
        Guesses at which no minimum is listed, each with the reason.
    rejected
        Distinct answers that are no minimum, with the reason.
    undecided
        Distinct states that were neither certified nor rejected.
    left_out
        Parts of the search that its time, or an interruption, ended: what they had found before is listed.
    interrupted
        Whether the user ended it.
    open
        Starts that could not be closed within the fold limits: never reported.
    flat
        Starts that converged to the flat state.
    not_enumerated
        What was not enumerated, and why; empty where all were.
    curves, ended
        Curves of states with one degree of freedom; how many of them are closed, or end at fold limits.
    unclear
        Parts of steps along curves on which contact cannot be excluded.
    new_per_thousand
        Minima that were new among the last third of the starts, for a thousand of them.
    drawn
        Random starts; `quiet` of them closed and were made since one led to a new minimum or curve.
    stopped
        Descents that ended at no stationary state, by reason.
    reached, alone
        Minima that the starts of each family of `by_source` led to, and those of them that no other family did.
    wells, resolved
        Wells of the energy along curves; how many of them were judged.
    coarse
        Of the curves, those whose polynomials are further from closed states than they are meant to be.
    contact
        ``"full"``; ``"fold-limits"`` or ``"none"`` where facets may cross.
    """

    starts: int = 0
    expected_undiscovered: Unbounded = math.inf
    expected_error: float = 0.0
    stopped_by: str = ""
    seconds: float = field(default=0.0, metadata=shown())
    seed: int = 0
    effort: str = "normal"
    by_source: dict[str, int] = field(default_factory=dict)
    stalled: int = 0
    failed: dict[str, int] = field(default_factory=Counter)
    seen_once: int = 0
    quiet: int = 0
    left_out: tuple[str, ...] = field(default=(), metadata=OMIT)
    interrupted: bool = field(default=False, metadata=OMIT)
    refused: tuple[JudgedState, ...] = field(default=(), repr=False)
    rejected: tuple[JudgedState, ...] = field(default=(), repr=False)
    undecided: tuple[JudgedState, ...] = field(default=(), repr=False)
    open: int = 0
    flat: int = 0
    not_enumerated: str = ""
    curves: int = 0
    ended: int = 0
    unclear: int = 0
    new_per_thousand: float = 0.0
    drawn: int = 0
    stopped: dict[str, int] = field(default_factory=Counter)
    reached: dict[str, int] = field(default_factory=dict)
    alone: dict[str, int] = field(default_factory=dict)
    wells: int = 0
    resolved: int = 0
    coarse: int = 0
    contact: str = "full"

    @property
    def is_open(self) -> bool:
        """Whether it is to be expected that other seeds, or more time, add minima."""
        cut = self.stopped_by in ("time", "cap")
        # half a minimum is expected beside those on the list
        many = math.isfinite(self.expected_undiscovered) and self.expected_undiscovered >= 0.5
        # or one more for a thousand starts
        return cut or many or (not self.curves and self.new_per_thousand >= 1.0)

    def leave_out(self, what: str) -> None:
        """Note a part of the search that its time, or an interruption, ended.

        Parameters
        ----------
        what
            The part.
        """
        self.left_out = (*dict.fromkeys((*self.left_out, what)),)

    def skip(self, why: str) -> None:
        """Note what was not enumerated, once.

        Parameters
        ----------
        why
            In words.
        """
        self.not_enumerated = "; ".join(dict.fromkeys(filter(None, (self.not_enumerated, why))))

    def sum_up(
        self, judged: Sequence[JudgedState], found: Sequence[Any], starts: int
    ) -> tuple[JudgedState, ...]:
        """Keep what was judged to be no minimum, and what the curves that are known say; return the minima.

        Parameters
        ----------
        judged
            States by energy.
        found
            The curves.
        starts
            Random starts in a row that were to find nothing new.

        Returns
        -------
        tuple of JudgedState
            By energy.
        """
        self.undecided = tuple(s for s in judged if s.verdict == "undecided")
        self.rejected = tuple(s for s in judged if s.verdict not in ("minimum", "undecided"))
        ended = "rule" if self.quiet >= starts else "cap"
        self.stopped_by = "time" if self.left_out else ended
        self.curves, self.ended = len(found), sum(c.complete for c in found)
        self.unclear = sum(int(c.stretches.unclear.sum()) for c in found if c.stretches is not None)
        self.coarse = sum(not c.curve.fits for c in found)
        return tuple(s for s in judged if s.verdict == "minimum")

    def fail(self, failure: Exception) -> None:
        """Count where linear algebra did not get through.

        Parameters
        ----------
        failure
            What it raised.
        """
        self.failed[f"{type(failure).__name__}: {failure}"] += 1

    @property
    def every_well(self) -> bool:
        """Whether every well of the energy along the curves that are known was judged; others are sampled only."""
        lost = self.curves != self.ended or self.coarse or self.resolved < self.wells
        return bool(self.curves) and not (lost or self.left_out or self.failed)

    @property
    def open_words(self) -> str:
        """What is known of minima that were not found, in a few words."""
        if not self.is_open:
            return "completeness not proved"
        new = self.new_per_thousand
        return f"open: {new:.3g} new ones a thousand starts at the end" if new else "open"

    def open_lines(self) -> Iterator[str]:
        """Say what is not decided, and what other seeds would add, at most a line each."""
        if self.undecided:
            energies = [r.energy for r in self.undecided]
            span = " to ".join(f"{e:.6g}" for e in sorted({min(energies), max(energies)}))
            yield f"states not decided: {len(energies)}, energy {span} J: --verbose says why"
        if self.refused:
            yield f"guesses at which there is no minimum: {len(self.refused)}: --verbose says why"
        if self.left_out:
            why = "interrupted" if self.interrupted else OUT_OF_TIME
            yield f"{why}, not through with: {', '.join(self.left_out)}"
        elif self.is_open and self.drawn and math.isfinite(self.expected_undiscovered):
            yield (
                f"open: other seeds would add at least {self.expected_undiscovered:.0f} +- "
                f"{self.expected_error:.0f} minima (Chao's estimate, a lower bound)"
            )
        elif self.every_well:
            yield f"wells of the energy along known curves: all {self.wells} judged"
        # fewer say nothing of those that are missing: 3/N > 0.3
        elif self.quiet >= 10:
            yield (
                f"no new minimum in the last {self.quiet} of {self.drawn} random starts: a missing one attracts fewer "
                f"than {unseen_share(self.quiet):.2g} of them (95 % confidence)"
            )
