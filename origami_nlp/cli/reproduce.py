"""`origami-nlp reproduce`: draw the paper's figures anew, from exact states.

A figure is a function in `FIGURES`: it gets a `Request` and returns the drawn matplotlib Figure.  To add one, write
such a function, import what it needs inside it, and add a line to the dictionary.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from origami_nlp.cli.minima import FigureFile, Seed, check_figure
from origami_nlp.cli.progress import progress
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import Console

    from origami_nlp.minima import MinimaResult
    from origami_nlp.paper import GridCount, GridErrors

ENDINGS = ("png", "pdf")
"""Written to --out."""


@dataclass(frozen=True)
class Request:
    """What the user asked for.

    name: of the figure.  seed: of the random starts.  console: where to say what was found.
    """

    name: str
    seed: int
    console: Console


def _sheet(request: Request) -> Figure:
    from origami_nlp.paper import draw_sheet, find_panels, sheet_table

    with progress(request.name) as report:
        panels = find_panels(request.name, seed=request.seed, progress=report)
    request.console.print(sheet_table(panels))
    return draw_sheet(request.name, panels)


def _grid_convergence(request: Request) -> Figure:
    from origami_nlp.minima import find_minima
    from origami_nlp.paper import (
        count_grid_minima,
        draw_grid_convergence,
        grid_errors,
        print_convergence,
    )
    from origami_nlp.pattern import examples

    scenes = examples.panels()
    results: list[MinimaResult] = []
    errors: list[GridErrors] = []
    counts: dict[str, tuple[GridCount, ...]] = {}
    with progress(request.name) as report:
        for number, scene in enumerate(scenes):
            results.append(find_minima(scene, seed=request.seed))
            errors += grid_errors(results[-1], seed=request.seed)
            report(number + 1, len(scenes) + 2)
        for degree in (6, 8):
            those = [r for r in results if r.scene.degree == degree]
            counts[f"degree {degree}"] = count_grid_minima(those)
            report(len(scenes) + len(counts), len(scenes) + 2)
    print_convergence(errors, counts, request.console)
    return draw_grid_convergence(tuple(errors), counts)


def _cones(request: Request) -> Figure:
    from origami_nlp.paper import draw_cone_figure

    return draw_cone_figure(request.name)


FIGURES: dict[str, Callable[[Request], Figure]] = {
    "figure3": _sheet,
    "figure4": _sheet,
    "grid-convergence": _grid_convergence,
    "cones": _cones,
    "cone-3": _cones,
    "cone-3-firing": _cones,
    "cone-4": _cones,
    "cone-4-firing": _cones,
    "cone-56": _cones,
}
"""What `reproduce` can draw: name in the paper (or of ours) and the function that draws it."""


def reproduce(
    name: Annotated[
        str, typer.Argument(metavar="FIGURE", help="Which figure: " + ", ".join(FIGURES) + ".")
    ],
    figure: FigureFile = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder for FIGURE.png and FIGURE.pdf (without --figure: here)."
        ),
    ] = None,
    seed: Seed = 0,
) -> None:
    """Draw a figure of the paper anew, from exact states and boundaries."""
    from origami_nlp.files import check_outputs, make_folder, save_figure, screen
    from origami_nlp.minima import check_options

    if name not in FIGURES:
        raise OptionError(f"FIGURE = {name!r} must be one of {', '.join(FIGURES)}")
    check_options(seed, 1)
    check_figure(figure)
    targets = [figure] if figure else []
    if out is not None or figure is None:
        folder = make_folder(out or Path("."), "--out")
        targets += [folder / f"{name}.{ending}" for ending in ENDINGS]
    check_outputs(*(("--figure" if target == figure else "--out", target) for target in targets))
    console = screen()
    drawn = FIGURES[name](Request(name, seed, console))
    for target in targets:
        save_figure(drawn, target, 200)
    console.print("written: " + ", ".join(map(str, targets)))
