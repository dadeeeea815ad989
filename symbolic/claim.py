"""A claim of the paper, and what became of it.

A `Claim` is stated once (id, place, machine-readable statement, LaTeX) and carries the function that
decides it.  `decide` runs that function and returns a `Verdict`; nothing here knows how to prove
anything.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

from .statement import Form, StatementError, form_of

VerdictName = Literal["proved", "refuted", "convention", "unproved"]
Origin = Literal["paper", "own derivation", "decimals"]


@dataclass(frozen=True)
class Verdict:
    """Outcome of deciding one claim.

    verdict: ``proved`` (exactly as printed), ``refuted`` (a counterexample to the printed
        statement, and the corrected statement proved), ``convention`` (true only in another reading
        than the one printed: another sense or order than elsewhere in the paper, a picture instead of
        the states, a generic choice, a numerical tolerance), ``unproved`` (the checker could not
        decide: this makes `verify` fail).
    method: how, in a few words (``identity modulo c^2+s^2-1``, ``Groebner``, ``interval``, ...).
    evidence: one or two sentences with the proof sketch or the counterexample, numbers included.
    corrected_latex: the corrected statement, or None when the printed one stands.
    corrected_proved: whether the corrected statement was proved in the same run (None: no
        correction).
    remark: what a reader should know besides, though the statement stands ("" for nothing).
    """

    verdict: VerdictName
    method: str
    evidence: str
    corrected_latex: str | None = None
    corrected_proved: bool | None = None
    remark: str = ""
    seconds: float = 0.0

    @property
    def decided(self) -> bool:
        """Proved as printed, or its corrected statement proved in this run."""
        if self.verdict == "proved":
            return True
        return self.fails and self.corrected_proved is True

    @property
    def fails(self) -> bool:
        """Not true as printed: refuted, or true in another reading only."""
        return self.verdict in ("refuted", "convention")


@dataclass(frozen=True)
class Claim:
    """One displayed equation, or one statement in the text that can be true or false.

    statement: what is printed, in a form that a machine reads.
    check: called as ``check(statement)``; decides what its argument says, whether that is printed,
        corrected or damaged.
    damaged: variants of `statement` that are false; ``decide`` must answer ``refuted`` to each.
    corrected: for a statement that fails, the variant that holds; ``decide`` must answer ``proved``.
    form: what statements of this claim are made of (None: as the printed one is, `form_of`).
    origin: a statement of the paper; a derivation of our own (also a rewriting or a step that the
        paper does not print); or printed decimals against the fractions printed with them.
    root: for statements that fail for the same reason, its name; together they are one finding.
    """

    id: str
    where: str
    title: str
    statement: Any
    statement_latex: str
    check: Callable[[Any], Verdict]
    damaged: tuple[Any, ...] = ()
    corrected: Any = None
    form: Form | None = None
    origin: Origin = "paper"
    root: str = ""

    @property
    def finding(self) -> str:
        """Name of the finding that a failure of this claim belongs to."""
        return self.root or self.id

    def read(self, statement: Any) -> None:
        """Accept a statement that a machine can read, or raise a `StatementError`."""
        form = self.form if self.form is not None else form_of(self.statement)
        try:
            form.read(statement, "statement")
        except StatementError as error:
            raise StatementError(f"{self.id}: {error}") from None

    def decide(self, *variant: Any) -> Verdict:
        """Decide the claim as printed, or one `variant` of its statement; time it.

        Raises `StatementError` for a variant that says nothing.
        """
        (statement,) = variant or (self.statement,)
        self.read(statement)
        start = time.perf_counter()
        verdict = self.check(statement)
        return replace(verdict, seconds=time.perf_counter() - start)
