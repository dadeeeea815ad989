"""`origami-nlp modes`: how each minimum gives way, mode by mode."""

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
def modes(
    scene: Source,
    state: Annotated[
        int | None, typer.Option(metavar="K", help="Only the minimum number K of the list.")
    ] = None,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    markdown: o.MarkdownFile = None,
    figure: o.FigureFile = None,
    max_starts: o.MaxStarts = None,
    effort: o.Effort = "normal",
    starts: o.Starts = None,
    workers: o.Workers = None,
) -> None:
    """Report stiffness and energy along each eigenmode of ORIGAMI's minima, until something touches."""
    from origami_nlp.modes import draw_modes, find_modes

    out = Output(json=json, markdown=markdown, figure=figure)
    stated = scene.read_whole(contact=True)
    result = search(
        stated,
        scene.name,
        seed=seed,
        max_starts=max_starts,
        starts=starts,
        effort=effort,
        workers=workers,
        prove=None if scene.is_whole else False,
        contact=scene.whole_contact,
        escape=False,
    )
    found = find_modes(result, state=state)
    found.tell(out.console)
    out.write("json", found.to_dict)
    out.write("markdown", found.to_markdown)
    out.write("figure", draw_modes, found)
