"""The record of a search: what it enumerated, sampled, left out and could not decide."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import OMIT
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stopping import unseen_share
from origami_nlp.search import CLOSES_NOT

OPEN_FROM = 0.5
"""Minima that are expected beside those on a list from which on it is open."""
FEW_QUIET = 10
"""Random starts in a row without a new minimum below which nothing is said of those that are missing: 3/N > 0.3."""
NEW_FROM = 1.0
"""New minima for a thousand starts at the end from which on a list is open."""
ESCAPE_PATHS = "branch directions of flat-folded states"
MEETINGS = "branch directions of states where curves meet"
"""Parts of a search that its time may end."""


@dataclass(repr=False)
class SearchReport(ShortRepr):
    """What a search enumerated, what it sampled, what it left open.

    Attributes
    ----------
    starts, feasible_starts
        States from which descents began; those of them that could be closed.
    solves, iterations
        IPOPT's solves, and iterations over all of them.
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
    lines, families
        Branch directions of the flat state: with one degree of freedom, with more.
    flat_folded
        States with every crease open or fully folded, all branch directions of which were followed.
    branch_points
        Other bifurcations found along curves, all branch directions of which were followed.
    not_enumerated
        What of these was not enumerated, and why; empty where all were.
    curves, ended
        Curves of states with one degree of freedom; how many of them are closed, or end at fold limits.
    unclear
        Parts of steps along curves on which contact cannot be excluded.
    seen_twice
        Minima that two starts reached.
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
    feasible_starts: int = 0
    solves: int = 0
    iterations: int = 0
    expected_undiscovered: Unbounded = math.inf
    expected_error: float = 0.0
    stopped_by: str = ""
    seconds: float = 0.0
    seed: int = 0
    effort: str = "normal"
    by_source: dict[str, int] = field(default_factory=dict)
    stalled: int = 0
    failed: dict[str, int] = field(default_factory=dict)
    seen_once: int = 0
    quiet: int = 0
    left_out: tuple[str, ...] = field(default=(), metadata=OMIT)
    interrupted: bool = field(default=False, metadata=OMIT)
    refused: tuple[JudgedState, ...] = field(default=(), repr=False)
    rejected: tuple[JudgedState, ...] = field(default=(), repr=False)
    undecided: tuple[JudgedState, ...] = field(default=(), repr=False)
    open: int = 0
    flat: int = 0
    lines: int = 0
    families: int = 0
    flat_folded: int = 0
    branch_points: int = 0
    not_enumerated: str = ""
    curves: int = 0
    ended: int = 0
    unclear: int = 0
    seen_twice: int = 0
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
        many = math.isfinite(self.expected_undiscovered) and self.expected_undiscovered >= OPEN_FROM
        return cut or many or (not self.curves and self.new_per_thousand >= NEW_FROM)

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
        self.feasible_starts = max(self.starts - self.open - self.stopped.get(CLOSES_NOT, 0), 0)
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
        why = f"{type(failure).__name__}: {failure}"
        self.failed[why] = self.failed.get(why, 0) + 1

    def words(self) -> list[str]:
        """Describe how the search went, and what is known of what it did not find."""
        return [*self._done(), *self.open_words()]

    def _done(self) -> Iterator[str]:
        if self.lines or self.families:
            what = "family" if self.families == 1 else "families"
            more = f" and {self.families} {what} with more degrees of freedom" * bool(self.families)
            yield f"branch directions of the flat state: all enumerated, {self.lines} with one degree of freedom{more}"
        if self.flat_folded > 1:
            ways = "" if ESCAPE_PATHS in self.left_out else ", and the branch directions of each"
            yield f"flat-folded states: {self.flat_folded} enumerated{ways}"
        if self.branch_points:
            ways = "" if MEETINGS in self.left_out else ", and the branch directions of each"
            yield f"branch points: {self.branch_points} found along curves{ways}"
        if self.curves:
            yield from self._of_curves()
        yield (
            f"{self.starts} starts: {self.flat} converged to the flat state, "
            f"{self.open + self.stalled + sum(self.stopped.values())} to no stationary state"
        )
        yield from (f"{n} of them: {why}" for why, n in self.stopped.items())
        for family, starts in self.by_source.items():
            found, own = self.reached.get(family, 0), self.alone.get(family, 0)
            alone = f", {own} of them by no other family" if own else ""
            many = f"{found} minim{'um' if found == 1 else 'a'}"
            yield f"{starts} start{'s' * (starts != 1)}, {family}: {many} reached{alone}"

    def open_words(self) -> list[str]:
        """Say in a few lines what is not proved or not decided."""
        return [*self._refused(), *self._open()]

    def _refused(self) -> Iterator[str]:
        for r in self.refused:
            angles = " ".join(f"{a:.6g}" for a in np.degrees(r.fold_angles))
            yield f"no minimum at the guess {angles} deg: {r.verdict}: {r.certificate}"

    @property
    def completeness_line(self) -> str:
        """What is known of minima that were not found, in a line."""
        quiet = list(self._quiet())
        return quiet[0] if quiet and self.is_open else [*self._open()][-1]

    def unfinished(self) -> list[str]:
        """Say what the time, or an interruption, ended."""
        return [*self._refused(), *list(self._open())[: int(bool(self.left_out))]]

    def _open(self) -> Iterator[str]:
        if self.left_out:
            why = "interrupted" if self.interrupted else OUT_OF_TIME
            yield f"{why}, not through with: {', '.join(self.left_out)}"
        if self.not_enumerated:
            yield self.not_enumerated
        if self.unclear:
            yield "contact cannot be excluded on some sub-intervals of the curves"
        for why, many in self.failed.items():
            yield f"not decided: linear algebra failed {many} time{'s' * (many != 1)}, {why}"
        if self.resolved < self.wells:
            open_ = self.wells - self.resolved
            yield f"not decided: {open_} of {self.wells} wells of the energy along the curves"
        lost = self.curves != self.ended or self.coarse or self.resolved < self.wells
        if self.curves and not (lost or self.left_out or self.failed):
            yield (
                f"every well of the energy along the curves that are known was judged, {self.wells} in all; other "
                "curves are sampled only: completeness is not proved"
            )
        else:
            yield "Each state is certified; completeness is not proved: states were sampled."
        yield from self._quiet()

    def _quiet(self) -> Iterator[str]:
        """State what was seen, and what other seeds would add."""
        if self.drawn and math.isfinite(self.expected_undiscovered):
            yield (
                f"{'open: ' * self.is_open}{self.seen_once} minima reached by one start, {self.seen_twice} by two; "
                f"{self.new_per_thousand:.3g} new ones a thousand starts at the end; other seeds would add at least "
                f"{self.expected_undiscovered:.0f} +- {self.expected_error:.0f} (Chao's estimate, a lower bound)"
            )
        if self.quiet >= FEW_QUIET:
            yield (
                f"No new minimum in the last {self.quiet} of {self.drawn} random starts: a missing one attracts fewer "
                f"than {unseen_share(self.quiet):.2g} of them (95 % confidence)."
            )
        elif self.drawn and not self.quiet:
            yield "the last random start found another minimum or curve: use more starts"

    def _of_curves(self) -> Iterator[str]:
        lost = self.curves - self.ended
        yield (
            f"one degree of freedom: {self.curves} curve{'s' * (self.curves != 1)} traced"
            + (
                f", {lost} of them lost on the way"
                if lost
                else (", each to its ends" if self.curves != 1 else " to its ends")
            )
        )
