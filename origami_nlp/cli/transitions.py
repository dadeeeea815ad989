"""`origami-nlp transitions`: sector angles at which the admissible space of a family changes."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli.minima import JsonFile, Seed


def transitions(
    family: Annotated[str, typer.Argument(metavar="FAMILY", help="degree6 or degree8.")],
    samples: Annotated[int, typer.Option(help="Sector angles of the sweep.")] = 25,
    size: Annotated[int, typer.Option(help="Rings of each mesh.")] = 16,
    seed: Seed = 0,
    json: JsonFile = None,
) -> None:
    """Sweep alpha_1 over a FAMILY of the paper and locate every transition of its admissible space."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from origami_nlp.judge.space_transitions import find_transitions
    from origami_nlp.tell.files import check_writable
    from origami_nlp.tell.json_file import write_json
    from origami_nlp.tell.space_table import print_transitions

    check_writable(json, "--json")
    console = Console(stderr=json == "-")
    screen = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=screen, transient=True, disable=not screen.is_terminal) as bar:
        task = bar.add_task(family, total=1.0)

        def report(what: str, done: float) -> None:
            bar.update(task, description=f"{family}: {what}", completed=done)

        sweep = find_transitions(family, samples=samples, size=size, seed=seed, report=report)
    print_transitions(sweep, console)
    if json:
        write_json(sweep.to_dict(), json)
