"""What is done in parts, until its time or the user ends it: what was left out is noted, what failed is counted."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from origami_nlp.errors import OutOfTime
from origami_nlp.minima import PatternSearchReport
from origami_nlp.pattern_problem import PatternProblem

FAILURES = np.linalg.LinAlgError, ArithmeticError
"""What linear algebra may end in at some start: it is counted and named."""


class Parts:
    """Work on a problem, with the record of what it did."""

    problem: PatternProblem
    tally: PatternSearchReport

    def part(self, what: str, work: Callable[..., None], *given: Any) -> bool:
        """Do a part of the search; False, and noted as left out, where time or the user ends it before."""
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
