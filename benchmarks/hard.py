"""The hard cases, each with why it is hard, what is known exactly, and what must come out: run, and told."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from benchmarks.hard_case import HardCase, Outcome
from benchmarks.hard_contact import CONTACT_CASES
from benchmarks.hard_flat import FLAT_CASES
from benchmarks.hard_fold_point import FOLD_POINT_CASES
from benchmarks.hard_large import LARGE_CASES
from benchmarks.hard_springs import SPRING_CASES
from origami_nlp.display import Cell, Table, Words, rows_markdown
from origami_nlp.io import pick


@dataclass(frozen=True)
class HardResult:
    """The outcomes of one case."""

    case: HardCase
    outcomes: tuple[Outcome, ...]

    @property
    def failures(self) -> tuple[Outcome, ...]:
        """Outcomes that missed a bound or a verdict."""
        return tuple(o for o in self.outcomes if not o.passed)


@dataclass(frozen=True)
class HardReport:
    """The outcomes of all cases; prints as a table of one row an outcome."""

    results: tuple[HardResult, ...]

    @property
    def failures(self) -> tuple[tuple[str, Outcome], ...]:
        """Failed outcomes with the name of their case."""
        return tuple((r.case.name, o) for r in self.results for o in r.failures)

    def summary(self) -> str:
        """One line: how many settings passed, how many failed."""
        count = sum(len(r.outcomes) for r in self.results)
        failed = len(self.failures)
        seconds = sum(o.seconds for r in self.results for o in r.outcomes)
        return (
            f"{len(self.results)} hard cases, {count} settings: {count - failed} as they must, "
            f"{failed} failures, {seconds:.1f} s"
        )

    def table(self) -> Table:
        """Return the outcomes, one row each, under the name of their case."""
        rows: list[Sequence[Cell]] = []
        ends = []
        for result in self.results:
            rows.append((Words(result.case.name, "bold"), *[""] * 5))
            for o in result.outcomes:
                passed = Words("ok", "green") if o.passed else Words("FAILS", "bold red")
                rows.append((f"  {o.setting}", passed, *_cells(o)))
            ends.append(len(rows) - 1)
        heads = ("setting", "", "error", "iterations", "verdict", "s")
        return Table(heads, rows, self.summary(), "LLLRLR", ends=ends)

    def markdown(self) -> str:
        """Return every case with its statement and a table of its outcomes."""
        lines = [
            "# Hard cases",
            "",
            "Printed by `python -m benchmarks hard`.",
            "",
            self.summary() + ".",
        ]
        lines.append(
            "Errors are largest differences; fold angles in radians, energies and multipliers relative."
        )
        lines += ["", "## Failures", ""]
        lines += [
            f"- {name}, {o.setting}: {_cells(o)[0]}; {_cells(o)[2]}" for name, o in self.failures
        ]
        if not self.failures:
            lines.append("None.")
        for r in self.results:
            c = r.case
            lines += [
                "",
                f"## {c.name}",
                "",
                f"- Hard: {c.hard}",
                f"- Known: {c.known}",
                f"- Must: {c.must}",
                "",
            ]
            passes = ("**fails**", "yes")
            rows = [(o.setting, passes[o.passed], *_cells(o)) for o in r.outcomes]
            heads = ("setting", "passes", "error", "iterations", "verdict", "s")
            lines.append(rows_markdown(heads, rows).rstrip())
        return "\n".join(lines) + "\n"

    def to_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        return {
            "schema": "origami-nlp-hard-1",
            "cases": [
                {
                    **pick(r.case, "name", "hard", "known", "must"),
                    "outcomes": [
                        pick(
                            o,
                            "setting",
                            "passed",
                            "measured",
                            "verdict",
                            "verdict_right=right",
                            "iterations",
                            "seconds",
                            "note",
                        )
                        for o in r.outcomes
                    ],
                }
                for r in self.results
            ],
        }


def _cells(o: Outcome) -> tuple[str, str, str, str]:
    errors = ", ".join(map(str, o.measured))
    verdict = o.verdict + ("" if o.right else " (wrong)") + (f"; {o.note}" if o.note else "")
    iterations = "-" if o.iterations is None else str(o.iterations)
    return errors, iterations, verdict, f"{o.seconds:.2f}"


Progress = Callable[[str, Outcome], None]
"""Called as progress(name of the case, outcome) after each outcome."""


def hard_cases() -> tuple[HardCase, ...]:
    """Return all hard cases."""
    return (*FLAT_CASES, *SPRING_CASES, *FOLD_POINT_CASES, *CONTACT_CASES, *LARGE_CASES)


def run_case(case: HardCase, progress: Progress | None = None) -> HardResult:
    """Run one case; an exception inside it becomes a failed outcome, not the end of the run."""
    outcomes: list[Outcome] = []
    stream = case.run()
    while True:
        begin = time.perf_counter()
        try:
            outcome = next(stream)
        except StopIteration:
            break
        except Exception as error:  # whatever it is: the case failed, and the others still run
            outcome = Outcome("(after the above)", (), f"{type(error).__name__}: {error}", False)
            outcomes.append(replace(outcome, seconds=time.perf_counter() - begin))
            break
        outcomes.append(replace(outcome, seconds=time.perf_counter() - begin))
        if progress:
            progress(case.name, outcomes[-1])
    return HardResult(case, tuple(outcomes))


def run_hard(progress: Progress | None = None) -> HardReport:
    """Run every hard case."""
    return HardReport(tuple(run_case(case, progress) for case in hard_cases()))
