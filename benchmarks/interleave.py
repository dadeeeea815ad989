"""All methods on all problems from the same starts, one start at a time, in rotating order.

A slow moment of the machine thus hits all methods alike.  Each round draws new starts, so that rounds are
independent searches.  The first start of a problem is run once untimed by each method (warm-up).

Seconds are processor time of this one-threaded process: wall time on an idle machine, and hardly touched by what else
runs on a busy one.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from benchmarks.attempt import Method, Solver, StartPoint, draw_starts
from benchmarks.judging import Judge
from benchmarks.methods_casadi import silence
from benchmarks.tally import Attempts

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """How much is run.

    rounds, starts: of each problem and round.  sweep: starts a round of settings of the work-precision diagram only.
    budget: seconds a method may use on one problem and round; then its remaining starts are left out, and the tables
    say so.
    """

    rounds: int = 5
    starts: int = 32
    sweep: int = 8
    budget: float = 6.0


def run_problem(
    methods: Sequence[Method], plan: Plan, seed: int, judge: Judge
) -> dict[str, Attempts]:
    """Run every method on the judge's problem; returns their attempts by label."""
    model = judge.model
    out = {m.label: Attempts(plan.rounds, plan.starts) for m in methods}
    for r in range(plan.rounds):
        starts, drawing = draw_starts(model, seed + 1000 * r, plan.starts)
        solvers: dict[str, Solver] = {}
        for method in methods:
            begin = time.process_time()
            with silence():
                solvers[method.label] = method.prepare(model)
            if r == 0:
                out[method.label].building = time.process_time() - begin
                with silence():  # warm-up, with a solver of its own: ours remembers answers
                    method.prepare(model)(starts[0])
        spent = dict.fromkeys(out, 0.0)
        gc.collect()
        gc.disable()
        try:
            for s, start in enumerate(starts):
                turn = (r + s) % len(methods)
                for method in [*methods[turn:], *methods[:turn]]:
                    if method.sweep and s >= plan.sweep:
                        continue
                    if spent[method.label] > plan.budget:
                        continue
                    share = 0.0 if "raw" in method.label else drawing
                    seconds = _attempt(
                        method, solvers[method.label], start, share, out, judge, r, s
                    )
                    spent[method.label] += seconds
        finally:
            gc.enable()
    return out


def _attempt(
    method: Method,
    solver: Solver,
    start: StartPoint,
    drawing: float,
    out: dict[str, Attempts],
    judge: Judge,
    r: int,
    s: int,
) -> float:
    """Time one attempt and judge its answer (judging is not timed); returns the seconds it took."""
    attempts = out[method.label]
    with silence():
        begin = time.process_time()
        answer = solver(start)
        seconds = time.process_time() - begin
    attempts.iterations.append(answer.iterations)
    attempts.building += answer.building
    outcome = None
    if answer.claims:
        outcome = judge.judge(answer)
        if outcome.minimum < 0:
            assert answer.x is not None
            attempts.false[judge.false_state(answer.x)] = outcome.reason
    attempts.record(r, s, seconds - answer.building + drawing, outcome)
    return seconds
