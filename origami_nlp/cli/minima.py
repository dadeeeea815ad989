"""`origami-nlp minima`: find, classify and show every stable state of a scene."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.errors import OptionError
from origami_nlp.state.scene_file import read_scene

SceneFile = Annotated[
    str, typer.Argument(metavar="SCENE", help="Scene file (TOML), or - for stdin.")
]
Seed = Annotated[int, typer.Option(help="Seed of the random starts.")]
JsonFile = Annotated[
    str | None, typer.Option("--json", metavar="FILE", help="Write JSON to FILE, or - for stdout.")
]
FigureFile = Annotated[
    Path | None,
    typer.Option("--figure", metavar="FILE", help="Write a figure (.png, .pdf or .svg)."),
]
FIGURE_SUFFIXES = (".png", ".pdf", ".svg")


def minima(
    scene: SceneFile,
    seed: Seed = 0,
    json: JsonFile = None,
    figure: FigureFile = None,
    max_starts: Annotated[int, typer.Option(help="Cap on random starts.")] = 1000,
    full: Annotated[
        bool, typer.Option("--full", help="Also decide each state in the full space.")
    ] = False,
) -> None:
    """Find every stable state of SCENE, classify it, and show it."""
    from rich.console import Console

    check_figure(figure)
    stated = read_scene(scene)
    from origami_nlp.judge.minima import check_options, find_minima
    from origami_nlp.tell.files import check_writable
    from origami_nlp.tell.json_file import result_to_dict, write_json
    from origami_nlp.tell.table import print_result

    check_options(seed, max_starts)
    check_writable(json, "--json")
    check_writable(figure, "--figure")
    console = Console(stderr=json == "-")
    with progress_bar(stated.name or scene) as report:
        result = find_minima(stated, seed=seed, max_starts=max_starts, full=full, progress=report)
    print_result(result, console)
    if json:
        write_json(result_to_dict(result), json)
    if figure:
        from origami_nlp.tell.figure import draw_minima

        draw_minima(result, figure)
        console.print(f"figure written to {figure}")


def check_figure(figure: Path | None) -> None:
    """Complain about a figure format that we do not write."""
    if figure is not None and figure.suffix.lower() not in FIGURE_SUFFIXES:
        raise OptionError(
            f"--figure = {str(figure)!r}: the name must end in {', '.join(FIGURE_SUFFIXES)}"
        )


@contextmanager
def progress_bar(title: str):  # type: ignore[no-untyped-def]
    """Show starts, minima and expected undiscovered answers while a search runs (on stderr)."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed} starts, {task.fields[found]} minima"),
        TextColumn("expected undiscovered {task.fields[missing]}"),
        TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task(title, total=None, found=0, missing="-")

        def report(starts: int, found: int, missing: float) -> None:
            shown = "-" if missing == float("inf") else f"{missing:.2f}"
            bar.update(task, completed=starts, found=found, missing=shown)

        yield report
