"""The record of a search: what it did, what it found that is no minimum, what is known of what it did not find."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import OMIT
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stopping import unseen_share

OPEN_FROM = 0.5
"""Minima that are expected beside those on a list from which on it is open."""
FEW_QUIET = 10
"""Random starts in a row without a new minimum below which nothing is said of those that are missing: 3/N > 0.3."""


@dataclass(repr=False)
class SearchReport(ShortRepr):
    """What a search did; `PatternSearchReport` says more of a pattern.

    Attributes
    ----------
    starts, feasible_starts
        States from which descents began; those of them that were admissible, of a pattern that could be closed.
    solves, iterations, statuses
        IPOPT's solves, iterations over all of them, and return statuses.
    outcomes
        Converged starts by what their end state is.
    expected_undiscovered
        Chao's estimate of the number of minima that no random start reached: a lower bound in expectation, no
        guarantee; inf where it is not asked for.
    expected_error
        Its standard error.
    stopped_by
        ``"rule"``, ``"cap"``, ``"time"`` (or the user), or ``"complete"``: nothing was left to sample.
    seconds
        Of wall time.
    seed, effort
        As they were asked for.
    by_source
        Starts by the family that they came from.
    stalled
        Descents that did not converge.
    failed
        What was left out, by reason: ends of descents that do not close, parts of the search where linear algebra
        failed.
    seen_once
        Minima that one random start reached.
    quiet
        Random starts since the last new minimum.
    complete
        Why nothing is missing, where that is known; "" elsewhere.
    refused
        Guesses at which no minimum is listed, each with the reason (`hits` is 0).
    rejected
        Distinct answers that are no minimum, with the reason and hits.
    undecided
        Distinct states that were neither certified nor rejected.
    left_out
        Parts of the search that its time, or an interruption, ended: what they had found before is listed.
    interrupted
        Whether the user ended it.
    """

    starts: int = 0
    feasible_starts: int = 0
    solves: int = 0
    iterations: int = 0
    statuses: dict[str, int] = field(default_factory=dict)
    outcomes: dict[str, int] = field(default_factory=dict)
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
    complete: str = ""
    left_out: tuple[str, ...] = field(default=(), metadata=OMIT)
    interrupted: bool = field(default=False, metadata=OMIT)
    refused: tuple[JudgedState, ...] = field(default=(), repr=False)
    rejected: tuple[JudgedState, ...] = field(default=(), repr=False)
    undecided: tuple[JudgedState, ...] = field(default=(), repr=False)

    @property
    def is_open(self) -> bool:
        """Whether it is to be expected that other seeds, or more time, add minima."""
        cut = self.stopped_by in ("time", "cap")
        many = math.isfinite(self.expected_undiscovered) and self.expected_undiscovered >= OPEN_FROM
        return self.stopped_by != "complete" and (cut or many)

    def open_words(self) -> list[str]:
        """Say in a few lines what is not proved: what is known of minima that the search did not find."""
        return [*self._refused(), *self._quiet()]

    @property
    def completeness_line(self) -> str:
        """What is known of minima that were not found, in a line; "" where nothing is to be said."""
        return (*self._quiet(), "")[0]

    def unfinished(self) -> list[str]:
        """Say what was asked and is no minimum, and what the time, or an interruption, ended."""
        ended = self.stopped_by == "time" or self.interrupted
        return [*self._refused(), *list(self._quiet())[: int(ended)]]

    def _refused(self) -> Iterator[str]:
        for r in self.refused:
            angles = " ".join(f"{a:.6g}" for a in np.degrees(r.fold_angles))
            yield f"no minimum at the guess {angles} deg: {r.verdict}: {r.certificate}"

    def _quiet(self) -> Iterator[str]:
        """State the bound on minima that no random start reached."""
        if self.stopped_by == "complete":
            return
        if self.interrupted:
            yield "interrupted: what was found until then is listed"
        elif self.stopped_by == "time":
            yield f"{OUT_OF_TIME}: not all of these starts were followed down, nor all of their ends judged"
        elif self.quiet >= FEW_QUIET:
            yield (
                f"No new minimum in the last {self.quiet} random starts: a missing one attracts fewer than "
                f"{unseen_share(self.quiet):.2g} of them (95 % confidence)."
            )
        elif self.starts:
            yield "New minima were still being found: there may well be more."
        if self.seen_once:
            yield f"{self.seen_once} of the minima {'were' if self.seen_once > 1 else 'was'} reached by one start only"
        if self.stopped_by == "cap":
            yield "stopped at the cap on starts of this effort, before every minimum was reached often enough"

    def words(self) -> list[str]:
        """Say in a few lines how the search went, failures included, and what is known of what it did not find."""
        sources = ", ".join(f"{count} {name}" for name, count in self.by_source.items())
        lines = [
            f"{self.starts} starts ({self.feasible_starts} admissible{'; ' * bool(sources)}{sources}), "
            f"{self.stalled} did not converge, {self.seconds:.2f} s, seed {self.seed}, effort {self.effort}"
            if self.starts
            else f"no start was drawn, {self.seconds:.2f} s",
            *self._coverage(),
            *self.open_words(),
            f"IPOPT: {self.solves} solves: "
            + (
                ", ".join(f"{name} {count}" for name, count in sorted(self.statuses.items()))
                or "none"
            ),
        ]
        if self.failed:
            reasons = ", ".join(f"{why} {count}" for why, count in self.failed.items())
            lines.append(f"left out, as no state or where linear algebra failed: {reasons}")
        ended = [f"{name} {count}" for name, count in sorted(self.outcomes.items()) if count]
        if ended:
            lines.append("starts ended at: " + ", ".join(ended))
        rejected: dict[tuple[str, str], int] = {}
        for r in self.rejected:
            if r.hits:
                key = (r.verdict, r.certificate)
                rejected[key] = rejected.get(key, 0) + 1
        lines += [
            f"  {count} state{'s' * (count > 1)} {verdict}: {reason}"
            for (verdict, reason), count in sorted(rejected.items())
        ]
        return lines

    def _coverage(self) -> Iterator[str]:
        """Say what was listed whole: as much as the numbers carry, and no more."""
        if self.stopped_by == "complete":
            yield f"complete: {self.complete}"
