"""The package itself: IPOPT at a loose tolerance, Newton polish, and a verdict on every new answer."""

from __future__ import annotations

from benchmarks.attempt import Attempt, Method, Solver, StartPoint
from origami_nlp.kkt import State, classify
from origami_nlp.minima import FoundState, Record, run_one
from origami_nlp.problem import Model

OURS = "this package"


def ours() -> list[Method]:
    """Return the package's multi-start as one method."""
    return [Method(OURS, "", OURS, 0.0, prepare)]


def prepare(model: Model) -> Solver:
    """Return a solver that solves, polishes and classifies; it remembers earlier answers, as the package does."""
    record = Record()
    minima: set[int] = set()

    def run(start: StartPoint) -> Attempt:
        before = [answer.hits for answer in record.answers]
        new = run_one(model, start.x, record, pairs=start.pairs)
        if new is not None:
            state = new.polished
            what = classify(State(model, state.x), polished=state.converged)
            (minima.add if what.verdict == "minimum" else minima.discard)(id(new))
        answer = new or _hit(record, before)
        if answer is None:
            return Attempt(None, False, "IPOPT did not converge")
        is_minimum = id(answer) in minima
        return Attempt(answer.polished.x, is_minimum, "minimum" if is_minimum else "no minimum")

    return run


def _hit(record: Record, before: list[int]) -> FoundState | None:
    """Return the known answer that the last solve ended at."""
    for answer, hits in zip(record.answers, before, strict=False):
        if answer.hits > hits:
            return answer
    return None
