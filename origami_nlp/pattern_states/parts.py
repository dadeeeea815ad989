"""What is done in parts, until its time or the user ends it: what was left out is noted, what failed is counted."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from origami_nlp.errors import OutOfTime
from origami_nlp.minima import JudgedState, PatternSearchReport
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, rank
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem
from origami_nlp.pattern_states.curves import TracedCurves
from origami_nlp.pattern_states.judgement import singular_beside

FAILURES = np.linalg.LinAlgError, ArithmeticError
"""What linear algebra may end in at some start: it is counted and named."""


class Parts:
    """Work on a problem, with the record of what it did and the states that it judged."""

    problem: PatternProblem
    labels: CanonicalLabelling
    curves: TracedCurves
    tally: PatternSearchReport
    judged: list[JudgedState]
    progress: Callable[[int, int, str], object] | None = None
    found: Callable[[float, np.ndarray], object] | None = None
    at = ""

    def say(self) -> None:
        """Say how far the work is: starts, minima and the part that it is at."""
        if self.progress is not None:
            self.progress(self.tally.starts, self.count()[0], self.at)

    def begin(self) -> None:
        """Count a start."""
        self.tally.starts += 1
        self.say()

    def part(self, what: str, work: Callable[..., None], *given: Any) -> bool:
        """Do a part of the search; False, and noted as left out, where time or the user ends it before."""
        self.at = what
        self.say()
        try:
            self.problem.check_time()
            work(*given)
        except (OutOfTime, KeyboardInterrupt) as stop:
            if isinstance(stop, KeyboardInterrupt):
                self.problem.until, self.tally.interrupted = -math.inf, True
            self.tally.leave_out(what)
            return False
        except FAILURES as failure:
            self.tally.fail(failure)
        return True

    def attempt(self, work: Callable[..., None], *given: Any) -> None:
        """Do what concerns one start, or one well; where linear algebra fails there, count and name it."""
        try:
            work(*given)
        except FAILURES as failure:
            self.tally.fail(failure)

    def known(self, phi: np.ndarray, verdict: str = "minimum") -> bool:
        """Return whether a state was judged: one that is not stationary says nothing of a minimum beside it."""
        least = {"not stationary": CLOSURE_TOL} if verdict == "minimum" else {}
        apart = ((np.abs(phi - s.phi).max(), s.verdict) for s in self.judged)
        return any(far <= least.get(what, 10 * DUPLICATE_TOL) for far, what in apart)

    def add(self, state: JudgedState) -> None:
        """Keep a state, once."""
        near = singular_beside(self.problem, state.phi) if state.verdict == "undecided" else None
        if state.dof < 0:  # it does not close, or is beyond a limit
            self.tally.open += 1
        elif near is not None and self.known(near):  # not distinguished from what was judged
            self.tally.stalled += 1
        elif not self.known(state.phi, state.verdict):
            self.judged.append(state)
            if state.verdict == "minimum" and self.found is not None:
                self.found(state.energy, state.phi.copy())
            self.say()

    def by_energy(self) -> list[JudgedState]:
        """Return what was judged, by energy; states of one energy in an order that labels do not change."""
        by_key = sorted(self.judged, key=lambda s: self.labels.key(s.phi))
        return sorted(by_key, key=lambda s: rank(s.energy / self.problem.scale, ()))

    def count(self) -> tuple[int, int]:
        """Return how many minima and curves are known."""
        return sum(s.verdict == "minimum" for s in self.judged), len(self.curves.found)
