"""Speed against error, on this machine: `python -m benchmarks COMMAND`, from a checkout."""

from __future__ import annotations

import subprocess
from typing import Any

import typer

from origami_nlp.cli import Ended, Group, Output, main, progress, writes

QUICK: Any = typer.Option(False, "--quick", help="A first look: fewer cases, less time.")
SCENES: Any = typer.Option(5, metavar="COUNT", help="Scenes of each family.")
VERTICES: Any = typer.Option(20, metavar="COUNT", help="Random vertices.")
BUDGET: Any = typer.Option(1.0, metavar="S", help="Seconds of each search.")


def _stamped(data: dict[str, Any]) -> dict[str, Any]:
    """Add the commit that was measured, with "+" where files differ from it."""
    git = ["git", "describe", "--always", "--dirty=+", "--exclude=*", "--abbrev=10"]
    said = subprocess.run(git, capture_output=True, text=True, check=False).stdout.strip()
    return {**data, "stamp": said}


@writes("json", "figure")
def search(
    out: Output,
    quick: bool = QUICK,
    scenes: int = SCENES,
    budget: float = BUDGET,
) -> None:
    """Measure what searches find of all that is known, when and how exactly: ours, SLSQP, NLopt, IPOPT."""
    from benchmarks import draw_search, measure_search, search_tables

    families = ("fold-limits",) if quick else ("fold-limits", "full-contact", "large")
    count = 2 if quick else scenes
    asked = [(family, number) for family in families for number in range(count)]
    with progress.progress("search") as report:
        data = measure_search(asked, budget, lambda text: report(text=text))
    for table in search_tables(data):
        out.say(table)
    out.write("json", _stamped, data)
    out.save("figure", draw_search, data)


@writes("json")
def patterns(out: Output, quick: bool = QUICK) -> None:
    """Solve whole patterns: error against time of this package and of IPOPT."""
    from benchmarks.patterns import QUICK, SPRINGS, measure_patterns, patterns_table

    with progress.progress("patterns") as report:
        data = measure_patterns(QUICK if quick else tuple(SPRINGS), lambda text: report(text=text))
    out.say(patterns_table(data))
    out.write("json", _stamped, data)


@writes("json", "figure")
def engines(
    out: Output,
    vertices: int = VERTICES,
    budget: float = BUDGET,
) -> None:
    """Search by compiled descents and by IPOPT on one problem: what each finds, against seconds."""
    from benchmarks.engines import draw_engines, engines_table, measure_engines

    with progress.progress("engines") as report:
        data = measure_engines(vertices, budget, lambda text: report(text=text))
    out.say(engines_table(data))
    out.write("json", _stamped, data)
    out.save("figure", draw_engines, data)


@writes("json")
def hard(out: Output) -> int:
    """Run the hard cases: error and verdict of each.

    Exit code 1 if any of them fails.
    """
    from benchmarks.hard import hard_table, hard_to_dict, run_hard

    with progress.progress("hard cases") as report:
        found = run_hard(lambda text: report(text=text))
    out.say(hard_table(found))
    out.write("json", hard_to_dict, found)
    good = all(outcome.passed for of in found.values() for outcome in of)
    return Ended.DONE if good else Ended.NO


app = Group("Speed against error of this package and of others, measured on this machine.")
app.add(search, patterns, engines, hard)

if __name__ == "__main__":
    main(app)
