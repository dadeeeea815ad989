"""`origami-nlp bench`: speed against error of every method, on this machine."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from origami_nlp.cli.minima import FigureFile, JsonFile, Seed, check_figure
from origami_nlp.cli.progress import progress
from origami_nlp.errors import OptionError

Markdown = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Write the report as Markdown.")
]


def bench(
    quick: Annotated[
        bool, typer.Option("--quick", help="A few problems and methods, in about a minute.")
    ] = False,
    hard: Annotated[
        bool, typer.Option("--hard", help="Run the hard cases instead: error and verdict of each.")
    ] = False,
    profile: Annotated[
        bool, typer.Option("--profile", help="Instead: where the time of the main job goes.")
    ] = False,
    json: JsonFile = None,
    figure: FigureFile = None,
    markdown: Markdown = None,
    seed: Seed = 0,
) -> None:
    """Measure speed against error: ours, IPOPT alone, other solvers, grids, the paper's own test.

    Set OMP_NUM_THREADS=1 for steady numbers: seconds are processor time of one thread.
    """
    from origami_nlp.files import check_outputs
    from origami_nlp.minima import check_options

    check_options(seed, 1)
    check_figure(figure)
    check_outputs(("--json", json), ("--figure", figure), ("--markdown", markdown))
    if profile and (quick or hard):
        raise OptionError(f"--profile does not go with {'--hard' if hard else '--quick'}: give one")
    job = _profile if profile else _hard if hard else _speed
    job(quick, json, figure, markdown, seed)


def _speed(
    quick: bool, json: str | None, figure: Path | None, markdown: Path | None, seed: int
) -> None:
    """Run all methods, show the headline and the targets, and write what was asked for."""
    from rich.markdown import Markdown as Rendered

    from origami_nlp.bench import in_short, markdown as as_markdown, run_bench, write_bench
    from origami_nlp.files import PAGE, screen, write_whole

    with _status() as tell:
        data = run_bench(quick=quick, seed=seed, tell=tell)
    screen(json, markdown).print(Rendered(in_short(data)), width=PAGE)
    if json:
        write_bench(data, json)
    if figure:
        from origami_nlp.bench import draw_bench

        draw_bench(data, figure)
    if markdown:
        link = None
        if figure and figure.suffix.lower() in (".png", ".svg"):
            link = Path(os.path.relpath(figure.resolve(), markdown.resolve().parent)).as_posix()
        write_whole(markdown, as_markdown(data, link).encode())


def _profile(
    quick: bool, json: str | None, figure: Path | None, markdown: Path | None, seed: int
) -> None:
    """Search every panel of the paper once, with stopwatches (`origami_nlp.bench.time_budget`)."""
    from dataclasses import asdict

    from origami_nlp.bench import time_budget
    from origami_nlp.files import screen, write_json, write_whole
    from origami_nlp.pattern import panels

    budgets = []
    with _status() as tell:
        for scene in panels():
            tell(scene.label)
            budgets.append(time_budget.measure(scene, seed))
    screen(json, markdown).print(time_budget.table(budgets))
    if json:
        panels_data = [{**asdict(b), "total": b.total} for b in budgets]
        write_json({"schema": "origami-nlp/time-budget/1", "panels": panels_data}, json)
    if figure:
        time_budget.draw(budgets, figure)
    if markdown:
        write_whole(markdown, time_budget.markdown(budgets).encode())


@contextmanager
def _status() -> Iterator[Callable[[str], Any]]:
    """Show what is being measured."""
    with progress("bench") as report:
        yield lambda text: report(text=text)


def _hard(
    quick: bool, json: str | None, figure: Path | None, markdown: Path | None, seed: int
) -> None:
    """Run the hard cases (`origami_nlp.bench.hard`): error, iterations and verdict of each.

    Exit code 1 if any of them fails.
    """
    if figure is not None or quick:
        option = "--figure" if figure is not None else "--quick"
        raise OptionError(
            f"{option} does not go with --hard: the hard cases are one table, all of it"
        )
    from origami_nlp.bench import run_hard
    from origami_nlp.files import screen, write_json, write_whole

    with _status() as tell:
        report = run_hard(lambda name, outcome: tell(f"{name}: {outcome.setting}"))
    screen(json, markdown).print(report.table())
    if json:
        write_json(report.to_dict(), json)
    if markdown:
        write_whole(markdown, report.markdown().encode())
    if report.failures:
        raise typer.Exit(1)
