"""`origami-nlp bench`: speed against error of every method, on this machine."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli.minima import FigureFile, JsonFile, Seed, check_figure


def bench(
    quick: Annotated[
        bool, typer.Option("--quick", help="A few problems and methods, in about a minute.")
    ] = False,
    hard: Annotated[
        bool, typer.Option("--hard", help="Run the hard cases instead: error and verdict of each.")
    ] = False,
    json: JsonFile = None,
    figure: FigureFile = None,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the report as Markdown.")
    ] = None,
    seed: Seed = 0,
) -> None:
    """Measure speed against error: ours, IPOPT alone, other solvers, grids, the paper's own test."""
    from origami_nlp.judge.minima import check_options
    from origami_nlp.tell.files import check_writable

    check_options(seed, 1)
    check_figure(figure)
    check_writable(json, "--json")
    check_writable(figure, "--figure")
    check_writable(markdown, "--markdown")
    if hard:
        _hard(quick, json, figure, markdown, seed)
        return
    raise NotImplementedError


def _hard(
    quick: bool, json: str | None, figure: Path | None, markdown: Path | None, seed: int
) -> None:
    """Run `origami_nlp.bench.hard`."""
    raise NotImplementedError
