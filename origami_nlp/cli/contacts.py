"""`origami-nlp contacts`: what pins each minimum, and how much load it bears."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli.minima import JsonFile, SceneFile, Seed, progress_bar
from origami_nlp.pattern import read_scene


def contacts(
    scene: SceneFile,
    state: Annotated[
        int | None, typer.Option(metavar="K", help="Only the minimum of this number.")
    ] = None,
    seed: Seed = 0,
    json: JsonFile = None,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the report as Markdown.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the report as a static page.")
    ] = None,
    segments: Annotated[
        bool, typer.Option("--segments", help="Also follow the contact boundaries (metastability).")
    ] = False,
    max_starts: Annotated[int, typer.Option(help="Cap on random starts.")] = 1000,
) -> None:
    """Report contact moments, stiffness along the contact and load margin of SCENE's pinned states."""
    stated = read_scene(scene)
    from origami_nlp.contact import report as contact_report, report_contacts
    from origami_nlp.files import check_outputs, screen, write_json, write_whole
    from origami_nlp.minima import check_options, find_minima

    check_options(seed, max_starts)
    check_outputs(("--json", json), ("--markdown", markdown), ("--html", html))
    console = screen(json, markdown, html)
    with progress_bar(stated.label or scene) as progress:
        result = find_minima(stated, seed=seed, max_starts=max_starts, progress=progress)
    report = report_contacts(result, state=state, segments=segments)
    contact_report.print_contacts(report, console)
    if json:
        write_json(contact_report.contacts_to_dict(report), json)
    if markdown:
        write_whole(markdown, contact_report.as_markdown(report).encode())
    if html:
        write_whole(html, contact_report.as_html(report).encode())
