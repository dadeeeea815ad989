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
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import Console

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
    from origami_nlp.tell.sheet import draw_sheet, find_panels, sheet_table

    panels = find_panels(request.name, seed=request.seed)
    request.console.print(sheet_table(panels))
    return draw_sheet(request.name, panels)


def _cones(request: Request) -> Figure:
    from origami_nlp.tell.cone_figures import draw_cone_figure

    return draw_cone_figure(request.name)


FIGURES: dict[str, Callable[[Request], Figure]] = {
    "figure3": _sheet,
    "figure4": _sheet,
    "cones": _cones,
    "cone-3": _cones,
    "cone-3-firing": _cones,
    "cone-4": _cones,
    "cone-4-firing": _cones,
    "cone-56": _cones,
}
"""What `reproduce` can draw: name in the paper and the function that draws it."""


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
    from rich.console import Console

    from origami_nlp.judge.minima import check_options
    from origami_nlp.tell.files import check_writable

    if name not in FIGURES:
        raise OptionError(f"FIGURE = {name!r} must be one of {', '.join(FIGURES)}")
    check_options(seed, 1)
    check_figure(figure)
    targets = [figure] if figure else []
    if out is not None or figure is None:
        folder = out or Path(".")
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OptionError(f"--out = {str(out)!r}: {error.strerror}") from None
        targets += [folder / f"{name}.{ending}" for ending in ENDINGS]
    for target in targets:
        check_writable(target, "--figure" if target == figure else "--out")
    console = Console()
    drawn = FIGURES[name](Request(name, seed, console))
    for target in targets:
        save_figure(drawn, target)
    console.print("written: " + ", ".join(map(str, targets)))


def save_figure(figure: Figure, target: Path) -> None:
    """Save a drawn figure, whole or not at all."""
    import io

    from origami_nlp.tell.files import write_whole

    content = io.BytesIO()
    figure.savefig(content, format=target.suffix.lstrip(".").lower(), dpi=200)
    write_whole(target, content.getvalue())
