"""Springs for given states: the convex program against CVXPY and against penalties, on the same random questions."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from benchmarks.by_cvxpy import SOLVERS, by_cvxpy, is_there
from benchmarks.penalty import NEAR, by_penalties, distance
from benchmarks.prescribed import (
    DEGREES,
    Prescribed,
    count_prescribed,
    prescribed_rows,
    random_question,
)
from origami_nlp.display import Report, Section, Table
from origami_nlp.inverse_design import ConvexDesign, scene_of, solve, springs_of
from origami_nlp.io import to_plain
from origami_nlp.numerics import DEFINITE, smatrix

SCHEMA = "origami-nlp/design-bench/1"
STATES = 2
OURS, METHODS = "ours", ("L-BFGS", "Gauss-Newton")
REPEATS = 3


@dataclass(frozen=True)
class Compared:
    """Questions of two random states of vertices of one degree, springs wound up to two turns.

    Attributes
    ----------
    degree
        Creases.
    questions, held, refuted
        How many there were, how many have springs by the problem, how many it refutes.
    seconds
        Median processor time of a question by method; of the problem targets included.
    found
        By method, of the questions that have springs: in how many it found some.
    claimed
        By penalty method, of those refuted: in how many it found springs with minima within 0.01 rad of the states.
    differs
        Largest difference of the optimum from that of CVXPY with either solver, over all questions; None without CVXPY.
    """

    degree: int
    questions: int
    held: int
    refuted: int
    seconds: dict[str, float]
    found: dict[str, int]
    claimed: dict[str, int]
    differs: float | None


@dataclass(frozen=True, repr=False)
class DesignBench(Report):
    """What was measured.

    Attributes
    ----------
    prescribed
        How many random states have springs.
    compared
        Times and successes by degree.
    """

    prescribed: tuple[Prescribed, ...]
    compared: tuple[Compared, ...]

    def report_sections(self) -> Iterator[Section]:
        """Return both tables."""
        heads, rows = prescribed_rows(self.prescribed)
        title = "Random interior states that springs hold, by degree; all others refuted unless said to be open"
        yield Table(heads, rows, title, framed=False)
        title = "Two random states, wound springs: medians of processor time [ms], largest difference of optima"
        yield Table(*self.speed_rows(), title, framed=False)
        title = (
            "The same questions: in how many of those with springs each method found some (minima within 0.01 rad of "
            "both states), median processor time [ms] of a question"
        )
        yield Table(*self.success_rows(), title, framed=False)

    def speed_rows(self) -> tuple[list[str], list[list[str]]]:
        """Return heads and rows of the table of times, one row a degree."""
        heads = ["N", "questions", "springs", "refuted", "ours"]
        with_cvxpy = all(c.differs is not None for c in self.compared)
        heads += [f"CVXPY + {s}" for s in SOLVERS] * with_cvxpy + ["differ by"] * with_cvxpy
        rows = []
        for c in self.compared:
            row = [str(n) for n in (c.degree, c.questions, c.held, c.refuted)]
            row += [f"{1e3 * c.seconds[s]:.1f}" for s in (OURS, *SOLVERS * with_cvxpy)]
            rows.append(row + [f"{c.differs:.0e}"] * with_cvxpy)
        return heads, rows

    def success_rows(self) -> tuple[list[str], list[list[str]]]:
        """Return heads and rows of the table of successes, one row a degree."""
        heads = ["N", *(h for m in (OURS, *METHODS) for h in (m, "ms"))]
        return heads, [
            [
                str(c.degree),
                *(
                    h
                    for m in (OURS, *METHODS)
                    for h in (f"{c.found[m]} of {c.held}", f"{1e3 * c.seconds[m]:.0f}")
                ),
            ]
            for c in self.compared
        ]

    def to_markdown(self) -> str:
        """Return both tables as Markdown."""
        return "\n".join(p.markdown() for p in self.report_sections() if isinstance(p, Table))

    def to_dict(self) -> dict[str, Any]:
        """Return plain data."""
        return {
            "schema": SCHEMA,
            "prescribed": [asdict(c) for c in self.prescribed],
            "compared": [to_plain(c) for c in self.compared],
        }


def measure_design(
    vertices: int,
    degrees: Sequence[int] = DEGREES,
    progress: Callable[[str], object] = lambda text: None,
) -> DesignBench:
    """Count prescribable states, and compare times and successes.

    Parameters
    ----------
    vertices
        Random vertices of each degree.
    degrees
        Numbers of creases.
    progress
        Called with words on the progress.

    Returns
    -------
    DesignBench
    """
    counts = count_prescribed(vertices, degrees, progress)
    return DesignBench(counts, tuple(_compared(n, vertices, progress) for n in degrees))


def _compared(n: int, vertices: int, progress: Callable[[str], object]) -> Compared:
    posed: list[ConvexDesign] = []
    times: dict[str, list[float]] = {OURS: []}
    found, claimed = dict.fromkeys((OURS, *METHODS), 0), dict.fromkeys(METHODS, 0)
    for number in range(vertices):
        progress(f"degree {n}, {number + 1} of {vertices}")
        own = []
        for _ in range(REPEATS):
            targets = random_question(n, number, STATES, True)
            _ = [
                p.state.jacobian for p in targets.placed
            ]  # drawn and closed, which all methods are given
            start = time.process_time()
            one = solve(targets)
            scene: Any = scene_of(targets, springs_of(one)) if one.feasible else None
            own.append(time.process_time() - start)
        times[OURS].append(float(np.median(own)))
        found[OURS] += scene is not None and distance(targets, scene) <= NEAR
        posed.append(one)
        for method in METHODS:
            tried = by_penalties(targets, method, number)
            times.setdefault(method, []).append(tried.seconds)
            found[method] += tried.found and one.feasible
            claimed[method] += tried.found and one.every_refuted
    differs = None
    if is_there():
        progress(f"degree {n}, CVXPY")
        differs = 0.0
        for one, other in zip(posed, by_cvxpy([plain(p) for p in posed]), strict=True):
            for solver, (value, seconds) in other.items():
                times.setdefault(solver, []).append(seconds)
                same = value == one.margin == -math.inf
                differs = max(differs, 0.0 if same else abs(value - one.margin))
    return Compared(
        n,
        vertices,
        sum(p.feasible for p in posed),
        sum(p.every_refuted for p in posed),
        {name: float(np.median(t)) for name, t in times.items()},
        found,
        claimed,
        differs,
    )


def plain(posed: ConvexDesign) -> dict[str, Any]:
    """Return a problem as plain data, matrices with all their entries."""
    p = posed.problem
    rows = []
    for r in p.rows:
        a, b = p.matrix(r), r.b
        if r.cone == DEFINITE:
            a, b = np.array([smatrix(c).ravel() for c in a.T]).T, smatrix(b).ravel()
        rows.append([r.cone, a.tolist(), b.tolist()])
    return {"size": p.size, "aim": posed.places.margin, "rows": rows}
