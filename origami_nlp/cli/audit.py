"""`origami-nlp audit`: what published candidate states are, and which artefacts they are."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli.minima import JsonFile, Seed
from origami_nlp.state.published import read_candidates


def audit(
    file: Annotated[
        str,
        typer.Argument(metavar="FILE", help="Candidates: .json or .csv, or - for JSON on stdin."),
    ],
    seed: Seed = 0,
    json: JsonFile = None,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the summary as Markdown.")
    ] = None,
) -> None:
    """Say of each published candidate in FILE which exact minimum it is, or which artefact."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from origami_nlp.judge.audit import audit_candidates
    from origami_nlp.judge.minima import check_options
    from origami_nlp.tell.audit_table import as_markdown, audit_to_dict, summary_table
    from origami_nlp.tell.files import check_writable, write_whole
    from origami_nlp.tell.json_file import write_json

    check_options(seed, 1)
    check_writable(json, "--json")
    check_writable(markdown, "--markdown")
    candidates = read_candidates(file)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("audit", total=len(candidates))
        panels = audit_candidates(
            candidates,
            seed=seed,
            progress=lambda done, _, panel: bar.update(task, completed=done, description=panel),
        )
    console = Console(stderr=json == "-")
    if not console.is_terminal:
        console = Console(stderr=json == "-", width=200)
    console.print(summary_table(panels))
    if json:
        write_json(audit_to_dict(panels), json)
    if markdown:
        write_whole(markdown, as_markdown(panels).encode())
