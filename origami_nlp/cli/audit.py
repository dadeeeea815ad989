"""`origami-nlp audit`: what published candidate states are, and which artefacts they are."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli.minima import JsonFile, Seed
from origami_nlp.cli.progress import progress
from origami_nlp.paper import read_candidates


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
    from origami_nlp.files import check_outputs, screen, write_json, write_whole
    from origami_nlp.minima import check_options
    from origami_nlp.paper import as_markdown, audit_candidates, audit_to_dict, summary_table

    check_options(seed, 1)
    check_outputs(("--json", json), ("--markdown", markdown))
    candidates = read_candidates(file)
    with progress("audit", len(candidates)) as report:
        panels = audit_candidates(candidates, seed=seed, progress=report)
    screen(json, markdown).print(summary_table(panels))
    if json:
        write_json(audit_to_dict(panels), json)
    if markdown:
        write_whole(markdown, as_markdown(panels).encode())
