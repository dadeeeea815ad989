"""Speed against error, on this machine: `python -m benchmarks COMMAND`, from a checkout."""

from __future__ import annotations

import os
import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.arguments import check_whole
from origami_nlp.cli import Group, Output, main, options as o, progress, writes

Unions = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR",
        help="Where all known minima of each scene are kept: a run that is stopped goes on there.",
    ),
]
DEGREES = (6, 8, 10, 12, 14, 16, 18, 30, 50, 100, 200, 500, 1000, 2000)
QUICK = (6, 8, 10, 12, 100, 1000)
"""Degrees of the cones that are counted, and those of a quick run."""


def _families() -> list[str]:
    from benchmarks import FAMILIES

    return list(FAMILIES)


@writes("json", "figure", "markdown")
def speed(
    out: Output,
    quick: o.Quick = False,
    seed: o.Seed = 0,
    unions: Unions = None,
) -> None:
    """Measure speed against error: ours, IPOPT alone, other solvers, grids, the paper's own test.

    Set OMP_NUM_THREADS=1 for steady numbers: seconds are processor time of one thread.
    """
    from benchmarks import draw_bench, in_short, markdown as as_markdown, run_bench, write_bench

    with progress.progress("speed") as report:
        data = run_bench(
            quick=quick, seed=seed, progress=lambda text: report(text=text), unions=unions
        )
    out.page(in_short(data))
    out.save("json", write_bench, data)
    out.save("figure", draw_bench, data)
    out.write("markdown", as_markdown, data, _link(out.files("figure"), out.files("markdown")))


def _origin() -> dict[str, str]:
    """Return of which commit a record is, and what made it."""
    from benchmarks.checkout import stamp

    return {"stamp": stamp(), "command": f"python -m benchmarks {shlex.join(sys.argv[1:])}"}


def _link(figures: list[str], pages: list[str]) -> str | None:
    """Return how the Markdown file may show the figure."""
    shown = [f for f in figures if Path(f).suffix.lower() in (".png", ".svg")]
    if not shown or not pages:
        return None
    return Path(
        os.path.relpath(Path(shown[0]).resolve(), Path(pages[0]).resolve().parent)
    ).as_posix()


@writes("json", "markdown")
def hard(
    out: Output,
) -> None:
    """Run the hard cases: error, iterations and verdict of each.

    Exit code 1 if any of them fails.
    """
    from benchmarks import run_hard

    with progress.progress("hard cases") as report:
        found = run_hard(lambda name, outcome: report(text=f"{name}: {outcome.setting}"))
    out.say(found.table())
    out.write("json", found.to_dict)
    out.write("markdown", found.markdown)
    if found.failures:
        raise typer.Exit(1)


@writes("json", "figure", "markdown")
def profile(
    out: Output,
    seed: o.Seed = 0,
) -> None:
    """Search every panel of the paper once, with stopwatches: where the time goes."""
    from dataclasses import asdict

    from benchmarks import time_budget
    from origami_nlp.pattern import panels

    budgets = []
    with progress.progress("profile") as report:
        for scene in panels():
            report(text=scene.label)
            budgets.append(time_budget.measure(scene, seed))
    out.say(time_budget.table(budgets))
    found = [{**asdict(b), "total": b.total} for b in budgets]
    said = {"schema": "origami-nlp/time-budget/1", "panels": found, **_origin()}
    out.write("json", lambda: said)
    out.save("figure", time_budget.draw, budgets)
    out.write("markdown", time_budget.markdown, budgets)


@writes("json", "figure", "markdown")
def search(
    out: Output,
    family: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FAMILY",
            autocompletion=_families,
            help="A family of scenes (repeatable); default all.",
        ),
    ] = None,
    quick: o.Quick = False,
    scenes: Annotated[
        int | None, typer.Option(metavar="COUNT", help="Scenes of each family (default all).")
    ] = None,
    before: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Another checkout to compare with.")
    ] = None,
    effort: Annotated[
        str | None,
        typer.Option(metavar="quick|normal|thorough", help="Of the main job (default normal)."),
    ] = None,
    unions: Unions = None,
) -> None:
    """Measure what searches find of all that is known, and when.

    Known minima are kept in a temporary folder, or in that of --unions.
    """
    import tempfile

    from benchmarks import coverage_markdown, draw_coverage, measure_coverage, scenes_for
    from benchmarks.fixed_costs import measure_costs

    with progress.progress("search") as report:
        data = measure_coverage(
            scenes_for(family or [], quick, scenes),
            unions or Path(tempfile.gettempdir()) / "origami_nlp-unions",
            before=before,
            seeds=2,
            budget=1.0,
            effort=effort,
            progress=lambda text: report(text=text),
        )
        if out.files("json"):
            data |= _origin()
            data["costs"] = measure_costs(lambda text: report(text=text))
    out.page(coverage_markdown(data))
    out.write("json", lambda: data)
    out.save("figure", draw_coverage, data)
    out.write("markdown", coverage_markdown, data)


def costs(
    before: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Another checkout to compare with.")
    ] = None,
) -> None:
    """Measure anew what a call costs beside its search, into the record that the page is written from."""
    import json

    from benchmarks import speed_page
    from benchmarks.checkout import stamp
    from benchmarks.fixed_costs import measure_costs

    data = json.loads(speed_page.DATA.read_text())
    with progress.progress("costs") as report:
        found = measure_costs(lambda text: report(text=text), before)
    data["costs"] = {"stamp": stamp(), **found}
    speed_page.DATA.write_text(json.dumps(data, separators=(",", ":")) + "\n")


def page() -> None:
    """Write the pages of speed and of where time goes, figures and the README's sentence from what was recorded."""
    import json

    from benchmarks import budget_page, patterns_page, read_bench, speed_page

    budget_page.write_page()
    patterns_page.write_page()

    data = json.loads(speed_page.DATA.read_text())
    speed_page.write_page(data, read_bench(speed_page.PAPER))


@writes("json", "figure", "markdown")
def patterns(
    out: Output,
    quick: o.Quick = False,
) -> None:
    """Solve whole patterns with every method: error against time, and sizes."""
    from benchmarks import draw_patterns, run_patterns

    with progress.progress("patterns") as report:
        found = run_patterns(quick=quick, progress=lambda text: report(text=text))
    out.say(found)
    out.write("json", lambda: {**found.to_dict(), **_origin()})
    out.save("figure", draw_patterns, found)
    out.write("markdown", found.to_markdown)


@writes("json", "markdown")
def proved(
    out: Output,
    scenes: Annotated[int, typer.Argument(metavar="SCENES", help="Vertices of each family.")],
) -> None:
    """Prove how many minima vertices of degree 4, 5 and the cross have, with random springs."""
    from benchmarks import count_proved

    with progress.progress("proofs") as report:
        found = count_proved(
            check_whole("SCENES", scenes, 1), progress=lambda text: report(text=text)
        )
    out.say(found)
    out.write("json", found.to_dict)
    out.write("markdown", found.to_markdown)


@writes("json", "markdown")
def design(
    out: Output,
    vertices: Annotated[int, typer.Argument(metavar="VERTICES", help="Vertices of each degree.")],
) -> None:
    """Count how many states springs hold, degree 4 to 8, against CVXPY (where installed) and penalty methods."""
    from benchmarks import measure_design

    with progress.progress("design") as report:
        found = measure_design(
            check_whole("VERTICES", vertices, 1), progress=lambda text: report(text=text)
        )
    out.say(found)
    out.write("json", found.to_dict)
    out.write("markdown", found.to_markdown)


@writes("markdown")
def cones(
    out: Output,
    quick: o.Quick = False,
    samples: o.Samples = 10,
    seed: o.Seed = 0,
) -> None:
    """Measure the time of an exact count of a cone's minima against N, beside brute force, each with its error.

    Of each degree so many --samples are drawn: random points (nu_0, r_k).
    """
    from benchmarks import MAP_DEGREES, as_markdown, measure

    with progress.progress("cones") as report:
        rows = measure(
            QUICK if quick else DEGREES,
            check_whole("--samples", samples, 1),
            seed,
            maps=(12,) if quick else MAP_DEGREES,
            progress=lambda degree: report(text=f"degree {degree} done"),
        )
    out.page(as_markdown(rows))
    out.write("markdown", as_markdown, rows)


app = Group("Speed against error of this package and of others, measured on this machine.")
app.add(speed, search, costs, page, profile, hard, patterns, proved, design, cones)

if __name__ == "__main__":
    main(app)
