"""`origami-nlp barriers`: the lowest pass between every two minima of a scene."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.search import search
from origami_nlp.errors import OptionError
from origami_nlp.pattern import examples, read_scene


def barriers(
    scene: o.SceneUnlessPanels = None,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    full: Annotated[
        bool, typer.Option("--full", help="Also bound the barriers without the symmetry.")
    ] = False,
    panels: Annotated[
        bool, typer.Option("--panels", help="The paper's 18 panels instead of SCENE.")
    ] = False,
    markdown: o.MarkdownFile = None,
    html: o.HtmlFile = None,
    animate: o.AnimateFile = None,
) -> None:
    """Find the lowest pass between every two minima of SCENE, and a path through it."""
    from origami_nlp.barriers import (
        barriers_table,
        barriers_to_dict,
        check_freedoms,
        draw_barriers,
        find_barriers,
        print_barriers,
    )

    if panels == (scene is not None):
        raise OptionError(f"SCENE = {scene!r}: give a scene file or --panels, and not both")
    out = Output(json=json, figure=figure, markdown=markdown, html=html, animate=animate)
    if panels and animate:
        raise OptionError("--animate is for one SCENE, not for --panels")
    stated = examples.panels() if panels else [read_scene(scene or "-")]
    for one in stated:
        check_freedoms(one)
    found = []
    for one in stated:
        result = search(one, scene, seed=seed, full=full)
        with progress(f"{one.label or scene}: passes between the minima"):
            found.append(find_barriers(one, result, full=full, seed=seed))
        print_barriers(found[-1], out.console)
    documents = [barriers_to_dict(b) for b in found]
    out.write("json", lambda: documents if panels else documents[0])
    out.write("markdown", lambda: barriers_table(found).markdown())
    out.write("figure", draw_barriers, *found)
    out.turn(*found)
