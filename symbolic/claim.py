"""A claim of the paper, and what became of it.

A `Claim` is stated once (id, place, SymPy statement, LaTeX) and carries the function that decides
it.  `decide` runs that function and returns a `Verdict`; nothing here knows how to prove anything.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

VerdictName = Literal["proved", "refuted", "convention", "unproved"]


@dataclass(frozen=True)
class Verdict:
    """Outcome of deciding one claim.

    verdict: ``proved`` (exactly as printed), ``refuted`` (a counterexample to the printed
        statement, and the corrected statement proved), ``convention`` (true only under a reading
        that contradicts another place), ``unproved`` (the checker could not decide: this makes
        `verify` fail).
    method: how, in a few words (``identity modulo c^2+s^2-1``, ``Groebner``, ``interval``, ...).
    evidence: one or two sentences with the proof sketch or the counterexample, numbers included.
    corrected_latex: the corrected statement, or None when the printed one stands.
    corrected_proved: whether the corrected statement was proved in the same run (None: no
        correction).
    """

    verdict: VerdictName
    method: str
    evidence: str
    corrected_latex: str | None = None
    corrected_proved: bool | None = None
    seconds: float = 0.0

    @property
    def decided(self) -> bool:
        """Proved as printed, or its corrected statement proved in this run."""
        if self.verdict == "proved":
            return True
        return self.verdict in ("refuted", "convention") and self.corrected_proved is True


@dataclass(frozen=True)
class Claim:
    """One displayed equation, or one statement in the text that can be true or false.

    check: called as ``check(statement)``; must be able to refute a damaged `statement` (mutation
        tests pass one in), so it may not ignore its argument.
    damaged: variants of `statement` that are false; ``decide`` must answer ``refuted`` to each.
    """

    id: str
    where: str
    title: str
    statement: Any
    statement_latex: str
    check: Callable[[Any], Verdict]
    damaged: tuple[Any, ...] = ()

    def decide(self, statement: Any = None) -> Verdict:
        """Decide the claim as printed, or a variant `statement` of it; time it."""
        start = time.perf_counter()
        verdict = self.check(self.statement if statement is None else statement)
        return replace(verdict, seconds=time.perf_counter() - start)
