"""`origami-nlp contacts`: what pins each minimum, and how much load it bears."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.search import search
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.cli.timed import bounded


@bounded
@takes_scene(o.OrigamiFile, whole=True)
def contacts(
    scene: Source,
    state: Annotated[
        int | None, typer.Option(metavar="K", help="Only the minimum number K of the list.")
    ] = None,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    markdown: o.MarkdownFile = None,
    html: o.HtmlFile = None,
    segments: Annotated[
        bool, typer.Option("--segments", help="Also follow the contact boundaries (metastability).")
    ] = False,
    max_starts: o.MaxStarts = None,
    effort: o.Effort = "normal",
    starts: o.Starts = None,
    workers: o.Workers = None,
) -> None:
    """Report contact moments, stiffness along the contact and load margin of ORIGAMI's pinned states."""
    from origami_nlp.contact import find_contacts

    out = Output(json=json, markdown=markdown, html=html)
    stated = scene.read_whole(contact=True)
    result = search(
        stated,
        scene.name,
        seed=seed,
        max_starts=max_starts,
        starts=starts,
        effort=effort,
        workers=workers,
        contact=scene.whole_contact,
        escape=False,
    )
    found = find_contacts(result, state=state, segments=segments)
    found.tell(out.console)
    out.write("json", found.to_dict)
    out.write("markdown", found.to_markdown)
    out.turn(found)
