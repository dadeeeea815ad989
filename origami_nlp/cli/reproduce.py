"""`origami-nlp paper reproduce`: draw the paper's figures anew, from exact states."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.errors import OptionError
from origami_nlp.paper import FIGURES


def reproduce(
    name: Annotated[
        str, typer.Argument(metavar="FIGURE", help="Which figure: " + ", ".join(FIGURES) + ".")
    ],
    figure: o.FigureFile = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder for FIGURE.png and FIGURE.pdf (without --figure: here)."
        ),
    ] = None,
    seed: o.Seed = 0,
) -> None:
    """Draw a figure of the paper anew, from exact states and boundaries."""
    from origami_nlp.files import make_folder, save_figure

    if name not in FIGURES:
        raise OptionError(f"FIGURE = {name!r} must be one of {', '.join(FIGURES)}")
    targets = [] if figure is None else [figure]
    if out is not None or figure is None:
        folder = make_folder(out or Path("."), "--out")
        targets += [folder / f"{name}.{ending}" for ending in ("png", "pdf")]
    output = Output(*(("--figure" if t is figure else "--out", t) for t in targets))
    with progress(name) as report:
        drawn = FIGURES[name](name, seed, report)
    drawn.tell(output.console)
    for target in targets:
        save_figure(drawn.figure, target, 200)
    output.written(*targets)
