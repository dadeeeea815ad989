"""A case that is hard by construction, and what comes out of it.

A case yields outcomes, one for each setting.  An outcome holds what was measured beside the bound that it must
keep; one that misses a bound, ends in another verdict, or raises, is a failure and is shown as one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Measured:
    """One number of an outcome: what it is, its value, and the largest value that passes."""

    what: str
    value: float
    bound: float

    @property
    def passed(self) -> bool:
        """Whether the value keeps its bound (nan does not)."""
        return self.value <= self.bound

    def __str__(self) -> str:
        return f"{self.what} {self.value:.1e}" + ("" if self.passed else f" > {self.bound:.0e}")


@dataclass(frozen=True)
class Outcome:
    """What came out of one setting of a case.

    setting: which one, in words.  measured: numbers with their bounds.  verdict: what the package says of the
    state.  right: whether that is what must come out.  iterations: of IPOPT, over all solves; None where
    nothing was solved.  seconds: wall time, set by the runner.  note: what else a reader must know.
    """

    setting: str
    measured: tuple[Measured, ...]
    verdict: str
    right: bool
    iterations: int | None = None
    seconds: float = 0.0
    note: str = ""

    @property
    def passed(self) -> bool:
        """Whether the verdict is right and every number keeps its bound."""
        return self.right and all(m.passed for m in self.measured)


@dataclass(frozen=True)
class HardCase:
    """A hard case.

    hard, known, must: what is hard, what is known exactly, what must come out.  run: yields the outcomes.
    """

    name: str
    hard: str
    known: str
    must: str
    run: Callable[[], Iterator[Outcome]]
