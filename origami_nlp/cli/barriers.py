"""`origami-nlp barriers`: the lowest pass between every two minima of a scene."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli.minima import FigureFile, JsonFile, Seed, check_figure, progress_bar
from origami_nlp.cli.progress import progress
from origami_nlp.errors import OptionError
from origami_nlp.pattern import read_scene


def barriers(
    scene: Annotated[
        str | None,
        typer.Argument(
            metavar="SCENE", help="Scene file (TOML), or - for stdin; leave out with --panels."
        ),
    ] = None,
    seed: Seed = 0,
    json: JsonFile = None,
    figure: FigureFile = None,
    full: Annotated[
        bool, typer.Option("--full", help="Also bound the barriers without the symmetry.")
    ] = False,
    panels: Annotated[
        bool, typer.Option("--panels", help="The paper's 18 panels instead of SCENE.")
    ] = False,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a Markdown table to FILE.")
    ] = None,
) -> None:
    """Find the lowest pass between every two minima of SCENE, and a path through it."""
    check_figure(figure)
    if panels == (scene is not None):
        raise OptionError(f"SCENE = {scene!r}: give a scene file or --panels, and not both")
    from origami_nlp.barriers import (
        barriers_table,
        barriers_to_dict,
        check_freedoms,
        draw_merge_trees,
        find_barriers,
        print_barriers,
    )
    from origami_nlp.files import check_outputs, screen, write_json, write_whole
    from origami_nlp.minima import check_options, find_minima
    from origami_nlp.pattern import examples

    check_options(seed, 1)
    check_outputs(("--json", json), ("--figure", figure), ("--markdown", markdown))
    stated = examples.panels() if panels else [read_scene(scene or "-")]
    for one in stated:
        check_freedoms(one)
    console = screen(json, markdown)
    found = []
    for one in stated:
        with progress_bar(one.label or str(scene)) as report:
            result = find_minima(one, seed=seed, full=full, progress=report)
        with progress(f"{one.label or scene}: passes between the minima"):
            found.append(find_barriers(one, result, full=full, seed=seed))
        print_barriers(found[-1], console)
    documents = [barriers_to_dict(b) for b in found]
    if json:
        write_json(documents if panels else documents[0], json)
    if markdown:
        write_whole(markdown, barriers_table(found).markdown().encode())
    if figure:
        draw_merge_trees(found, figure)
        console.print(f"figure written to {figure}")
