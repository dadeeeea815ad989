"""`origami-nlp bench`: speed against error of every method, on this machine."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.arguments import check_whole
from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.errors import OptionError


def _families() -> list[str]:
    from origami_nlp.bench import FAMILIES

    return list(FAMILIES)


def bench(
    quick: o.Quick = False,
    hard: Annotated[
        bool, typer.Option("--hard", help="Run the hard cases instead: error and verdict of each.")
    ] = False,
    profile: Annotated[
        bool, typer.Option("--profile", help="Instead: where the time of the main job goes.")
    ] = False,
    search: Annotated[
        bool,
        typer.Option(
            "--search", help="Instead: what searches find of all that is known, and when."
        ),
    ] = False,
    patterns: Annotated[
        bool,
        typer.Option("--patterns", help="Instead: whole patterns, error against time, and sizes."),
    ] = False,
    proved: Annotated[
        int | None,
        typer.Option(
            metavar="SCENES",
            help="Instead: proved numbers of minima of so many vertices of degree 4, 5 and of the cross.",
        ),
    ] = None,
    design: Annotated[
        int | None,
        typer.Option(
            metavar="VERTICES",
            help="Instead: how many states springs hold, on so many vertices of degree 4 to 8 each; times and "
            "successes against CVXPY (where it is installed) and penalty methods.",
        ),
    ] = None,
    before: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="--search: another checkout to compare with."),
    ] = None,
    family: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FAMILY",
            autocompletion=_families,
            help="--search: a family of scenes (repeatable); default all.",
        ),
    ] = None,
    effort: Annotated[
        str | None,
        typer.Option(
            metavar="quick|normal|thorough", help="--search: of the main job (default normal)."
        ),
    ] = None,
    unions: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Where all known minima of each scene are kept: a run that is stopped goes on there "
            "(default: a temporary folder for --search, none otherwise).",
        ),
    ] = None,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    markdown: o.MarkdownFile = None,
    seed: o.Seed = 0,
) -> None:
    """Measure speed against error: ours, IPOPT alone, other solvers, grids, the paper's own test.

    Set OMP_NUM_THREADS=1 for steady numbers: seconds are processor time of one thread.
    """
    if profile and (quick or hard):
        raise OptionError(f"--profile does not go with {'--hard' if hard else '--quick'}: give one")
    if hard and (figure is not None or quick):
        option = "--figure" if figure is not None else "--quick"
        raise OptionError(
            f"{option} does not go with --hard: the hard cases are one table, all of it"
        )
    if search and (profile or hard):
        raise OptionError(
            f"--search does not go with {'--hard' if hard else '--profile'}: give one"
        )
    only = {"--before": before, "--family": family, "--effort": effort}
    given = [name for name, value in only.items() if value]
    if given and not search:
        raise OptionError(f"{given[0]} goes with --search only")
    others = {"--profile": profile, "--hard": hard, "--search": search}
    others |= {"--proved": proved is not None, "--design": design is not None}
    clash = [name for name, value in others.items() if value]
    if patterns and clash:
        raise OptionError(f"--patterns does not go with {clash[0]}: give one")
    if proved is not None and (search or profile or hard or quick or figure is not None):
        raise OptionError("--proved goes with --json and --markdown only")
    if design is not None and (proved or search or profile or hard or quick or figure is not None):
        raise OptionError("--design goes with --json and --markdown only")
    out = Output(json=json, figure=figure, markdown=markdown)
    if design is not None:
        _design(out, check_whole("--design", design, 1))
    elif proved is not None:
        _proved(out, check_whole("--proved", proved, 1))
    elif patterns:
        _patterns(out, quick)
    elif search:
        _search(out, family or [], quick, before, unions, effort)
    elif profile:
        _profile(out, seed)
    elif hard:
        _hard(out)
    else:
        _speed(out, quick, seed, unions, _link(figure, markdown))


def _link(figure: Path | None, markdown: str | None) -> str | None:
    """Return how the Markdown file may show the figure."""
    if figure is None or markdown is None or figure.suffix.lower() not in (".png", ".svg"):
        return None
    return Path(os.path.relpath(figure.resolve(), Path(markdown).resolve().parent)).as_posix()


def _speed(out: Output, quick: bool, seed: int, unions: Path | None, link: str | None) -> None:
    """Run all methods, show the headline and the targets, and write what was asked for."""
    from origami_nlp.bench import (
        draw_bench,
        in_short,
        markdown as as_markdown,
        run_bench,
        write_bench,
    )

    with progress("bench") as report:
        tell = lambda text: report(text=text)  # noqa: E731
        data = run_bench(quick=quick, seed=seed, tell=tell, unions=unions)
    out.page(in_short(data))
    out.save("json", write_bench, data)
    out.save("figure", draw_bench, data)
    out.write("markdown", as_markdown, data, link)


def _search(
    out: Output,
    families: list[str],
    quick: bool,
    before: Path | None,
    unions: Path | None,
    effort: str | None,
) -> None:
    """Measure searches on families of scenes (`origami_nlp.bench.coverage`)."""
    import tempfile

    from origami_nlp.bench import coverage_markdown, draw_coverage, measure_coverage, scenes_for

    folder = unions or Path(tempfile.gettempdir()) / "origami_nlp-unions"
    with progress("bench") as report:
        data = measure_coverage(
            scenes_for(families, quick),
            folder,
            before=before,
            seeds=2 if quick else 5,
            budget=1.0 if quick else 5.0,
            effort=effort,
            tell=lambda text: report(text=text),
        )
    out.page(coverage_markdown(data))
    out.write("json", lambda: data)
    out.save("figure", draw_coverage, data)
    out.write("markdown", coverage_markdown, data)


def _proved(out: Output, scenes: int) -> None:
    """Prove how many minima vertices with random springs have (`origami_nlp.bench.proved`)."""
    from origami_nlp.bench import count_proved

    with progress("bench") as report:
        found = count_proved(scenes, tell=lambda text: report(text=text))
    out.say(found)
    out.write("json", found.to_dict)
    out.write("markdown", found.to_markdown)


def _patterns(out: Output, quick: bool) -> None:
    """Solve whole patterns with every method (`origami_nlp.bench.patterns`)."""
    from origami_nlp.bench import draw_patterns, run_patterns

    with progress("bench") as report:
        found = run_patterns(quick=quick, tell=lambda text: report(text=text))
    out.say(found)
    out.write("json", found.to_dict)
    out.save("figure", draw_patterns, found)
    out.write("markdown", found.to_markdown)


def _design(out: Output, vertices: int) -> None:
    """Count states that springs hold, and measure designs (`origami_nlp.bench.design_speed`)."""
    from origami_nlp.bench import measure_design

    with progress("bench") as report:
        found = measure_design(vertices, tell=lambda text: report(text=text))
    out.say(found)
    out.write("json", found.to_dict)
    out.write("markdown", found.to_markdown)


def _profile(out: Output, seed: int) -> None:
    """Search every panel of the paper once, with stopwatches (`origami_nlp.bench.time_budget`)."""
    from dataclasses import asdict

    from origami_nlp.bench import time_budget
    from origami_nlp.pattern import panels

    budgets = []
    with progress("bench") as report:
        for scene in panels():
            report(text=scene.label)
            budgets.append(time_budget.measure(scene, seed))
    out.say(time_budget.table(budgets))
    found = [{**asdict(b), "total": b.total} for b in budgets]
    out.write("json", lambda: {"schema": "origami-nlp/time-budget/1", "panels": found})
    out.save("figure", time_budget.draw, budgets)
    out.write("markdown", time_budget.markdown, budgets)


def _hard(out: Output) -> None:
    """Run the hard cases (`origami_nlp.bench.hard`): error, iterations and verdict of each.

    Exit code 1 if any of them fails.
    """
    from origami_nlp.bench import run_hard

    with progress("bench") as report:
        found = run_hard(lambda name, outcome: report(text=f"{name}: {outcome.setting}"))
    out.say(found.table())
    out.write("json", found.to_dict)
    out.write("markdown", found.markdown)
    if found.failures:
        raise typer.Exit(1)
