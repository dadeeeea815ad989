"""Error against time on whole patterns: this package, projections with gradient steps, bars and hinges, IPOPT.

All start from the same closed state and look for the state of least energy below it, within fold limits; contact is
left out by all.  Methods take turns, a round each, in rotating order; seconds are processor time of one thread, medians
of the rounds, without what is built once a pattern.  What a method answers on its way is judged outside the clock.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.pattern_contacts import PatternContact, measure_contacts
from benchmarks.pattern_methods import PatternMethod, Solve, pattern_methods
from benchmarks.pattern_problems import QUICK, PatternTask, pattern_problems
from benchmarks.pattern_scaling import PatternScale, measure_scales
from benchmarks.run import machine
from origami_nlp.display import Report, Section, Table

ROUNDS, QUICK_ROUNDS = 3, 2
BUDGET, QUICK_BUDGET = 10.0, 2.0
"""Seconds after which a run is cut off."""
ELSEWHERE = 0.1
"""A method that is through, and farther from the state than this, is at another [rad]."""
LEVELS = (1e-4, 1e-8)
"""Errors of fold angles at which times are compared [rad]."""


@dataclass(frozen=True)
class PatternPoint:
    """An answer of a method.

    Attributes
    ----------
    pattern, method, setting
        Which.
    status
        In the method's words.
    seconds
        Processor time until it, median over rounds.
    angle
        Largest error of a fold angle [rad]; nan where the method refused.
    energy
        Relative error of the energy of these fold angles.
    closure
        Largest entry of closure.
    softness
        Of bars and hinges: largest strain, or fold of a facet [rad]; nan of rigid facets.
    """

    pattern: str
    method: str
    setting: str
    status: str
    seconds: float
    angle: float
    energy: float
    closure: float
    softness: float


@dataclass(frozen=True)
class PatternCase:
    """A pattern that was solved.

    Attributes
    ----------
    name, facets, creases, rows
        Its size; rows of closure.
    residual
        Of the reference: closure, and stationarity over the mean stiffness.
    energy
        Of the reference.
    building
        Seconds of each method for what is built once.
    """

    name: str
    facets: int
    creases: int
    rows: int
    residual: float
    energy: float
    building: dict[str, float]


@dataclass(frozen=True, repr=False)
class PatternBench(Report):
    """Error against time on patterns, and the times of each part of the work against the size.

    Attributes
    ----------
    cases
        Patterns.
    points
        Answers, in the order of the methods.
    scales
        Times of the parts of this package's work.
    contacts
        Times of patterns that are pressed together.
    rounds, budget
        How often, and seconds after which a run was cut off.
    machine
        What the numbers depend on.
    """

    PICTURE, SCHEMA = "draw_patterns", "origami-nlp/bench-patterns/1"

    cases: tuple[PatternCase, ...]
    points: tuple[PatternPoint, ...]
    scales: tuple[PatternScale, ...]
    contacts: tuple[PatternContact, ...]
    rounds: int
    budget: float
    machine: dict[str, Any]

    def of(self, pattern: str, method: str) -> tuple[PatternPoint, ...]:
        """Return the answers of a method on a pattern, in the order of its settings and steps."""
        return tuple(p for p in self.points if (p.pattern, p.method) == (pattern, method))

    @property
    def methods(self) -> tuple[str, ...]:
        """Names of the methods."""
        return tuple(dict.fromkeys(p.method for p in self.points))

    def seconds_to(self, pattern: str, method: str, error: float) -> float:
        """Return the seconds until fold angles were right to an error; inf where they never were."""
        good = [p.seconds for p in self.of(pattern, method) if p.angle <= error]
        return min(good, default=math.inf)

    def report_sections(self) -> Iterator[Section]:
        """Return the tables: of methods, of parts of the work, of contact."""
        yield self.methods_table()
        yield self.scales_table()
        yield self.contacts_table()

    def methods_table(self) -> Table:
        """Return a row a pattern and method."""
        heads = ["pattern", "method", "built [s]", *(f"s to {e:.0e}" for e in LEVELS)]
        heads += ["s in all", "error [rad]", "energy", "closure", "ended"]
        rows: list[list[str]] = []
        ends = []
        for case in self.cases:
            for method in self.methods:
                of = self.of(case.name, method)
                if of:
                    rows.append(self._row(case, method, of))
            ends.append(len(rows) - 1)
        title = (
            "Patterns: processor seconds until fold angles are right, and the last answer's errors; medians of "
            f"{self.rounds} rounds"
        )
        return Table(heads, rows, title, "LLrrrrrrrL", framed=False, narrow=True, ends=ends)

    def _row(self, case: PatternCase, method: str, of: Sequence[PatternPoint]) -> list[str]:
        last = of[-1]
        first = f"{case.name}, {case.facets} facets" if method == self.methods[0] else ""
        seconds = (self.seconds_to(case.name, method, e) for e in LEVELS)
        return [
            first,
            method,
            _number(case.building[method], ".2g"),
            *(_number(s, ".2g") for s in seconds),
            _number(last.seconds, ".2g"),
            *(_number(e, ".0e") for e in (last.angle, last.energy, last.closure)),
            self.ended(last),
        ]

    def ended(self, point: PatternPoint) -> str:
        """Describe how the last answer of a run came about."""
        if math.isnan(point.angle):
            return f"refused: {point.status}"
        if point.angle > ELSEWHERE:
            return f"at another state ({point.status})"
        return point.status

    def scales_table(self) -> Table:
        """Return a row a size."""
        heads = ["pattern", "facets", "creases", "rows", "drawn", "built", "first state", "another"]
        heads += ["polish", "stability", "crossings", "pairs", "closure", "torque left"]
        rows = [s.cells() for s in self.scales]
        title = "Parts of this package's work, processor seconds"
        return Table(heads, rows, title, "L" + "r" * 13, framed=False, narrow=True)

    def contacts_table(self) -> Table:
        """Return a row a pattern that was pressed together."""
        heads = ["pattern", "rest", "facets", "creases", "close pairs", "touching", "seconds"]
        heads += ["closure", "torque left", "state"]
        rows = [c.cells() for c in self.contacts]
        title = "Patterns pressed together, processor seconds to the judged state"
        return Table(heads, rows, title, "L" + "r" * 8 + "L", framed=False, narrow=True)

    def to_markdown(self) -> str:
        """Return the tables in Markdown."""
        tables = self.methods_table(), self.scales_table(), self.contacts_table()
        return "\n".join(table.markdown() for table in tables)

    def _rows(self) -> Iterator[dict[str, object]]:
        for point in self.points:
            yield {k: getattr(point, k) for k in PatternPoint.__dataclass_fields__}


def _number(value: float, form: str) -> str:
    return "-" if not math.isfinite(value) else format(value, form)


def run_patterns(
    *,
    quick: bool = False,
    names: Sequence[str] | None = None,
    progress: Callable[[str], object] = lambda text: None,
) -> PatternBench:
    """Solve patterns with every method, side by side, and time the parts of this package's work.

    Parameters
    ----------
    quick
        Two small patterns, fewer rounds, sizes up to 64 facets.
    names
        Of patterns, if not all: keys of `bench.pattern_problems.SPRINGS`.
    progress
        Called with what is being done.

    Returns
    -------
    PatternBench

    Examples
    --------
    >>> from benchmarks import run_patterns
    >>> found = run_patterns(quick=True, names=["miura:4x4"])
    >>> found.of("miura:4x4", "this package")[-1].angle < 1e-12
    True
    """
    rounds, budget = (QUICK_ROUNDS, QUICK_BUDGET) if quick else (ROUNDS, BUDGET)
    cases, points = [], []
    for problem in pattern_problems(names or (QUICK if quick else None)):
        progress(problem.name)
        case, found = _solved(problem, pattern_methods(), rounds, budget)
        cases.append(case)
        points += found
    scales, contacts = (
        tuple(measure_scales(quick, progress)),
        tuple(measure_contacts(quick, progress)),
    )
    return PatternBench(tuple(cases), tuple(points), scales, contacts, rounds, budget, machine())


def _solved(
    problem: PatternTask, methods: Sequence[PatternMethod], rounds: int, budget: float
) -> tuple[PatternCase, list[PatternPoint]]:
    """Run every method on a pattern."""
    building: dict[str, float] = {}
    runs: list[tuple[str, str, Solve]] = []
    for method in methods:
        begin = time.process_time()
        prepared = method.prepare(problem)
        building[method.name] = time.process_time() - begin
        runs += [(method.name, setting, solve) for setting, solve in prepared.items()]
    answers: dict[tuple[str, str, int], PatternPoint] = {}
    seconds: dict[tuple[str, str, int], list[float]] = {}
    for r in range(rounds):
        turn = r * len(runs) // rounds
        for name, setting, solve in [*runs[turn:], *runs[:turn]]:
            for k, (spent, point) in enumerate(
                _timed(problem, name, setting, solve, budget, r == 0)
            ):
                seconds.setdefault((name, setting, k), []).append(spent)
                if point is not None:
                    answers[name, setting, k] = point
    order = {m.name: i for i, m in enumerate(methods)}
    points = [
        PatternPoint(**{**vars(point), "seconds": float(np.median(seconds[key]))})
        for key, point in sorted(answers.items(), key=lambda item: order[item[0][0]])
    ]
    p = problem.pattern
    return (
        PatternCase(
            problem.name,
            p.facets,
            p.creases,
            problem.sheet.closure.count,
            problem.residual,
            problem.energy,
            building,
        ),
        points,
    )


def _timed(
    problem: PatternTask, name: str, setting: str, solve: Solve, budget: float, judge: bool
) -> Iterator[tuple[float, PatternPoint | None]]:
    """Run a method once: seconds until each answer, and the answer, judged outside the clock."""
    spent, run = 0.0, solve()
    while spent < budget:
        begin = time.process_time()
        answer = next(run, None)
        spent += time.process_time() - begin
        if answer is None:
            return
        if not answer.status:
            continue
        if not judge:
            yield spent, None
            continue
        errors = (math.nan,) * 3
        if answer.phi is not None:
            phi = answer.phi
            errors = (
                problem.angle_error(phi),
                problem.energy_error(phi),
                problem.sheet.residual(phi),
            )
        softness = math.nan if answer.softness is None else answer.softness
        yield (
            spent,
            PatternPoint(
                problem.name, name, setting, answer.status, spent, *errors, softness=softness
            ),
        )
