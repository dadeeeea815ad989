"""`origami-nlp space`: topology of the admissible space of a scene."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli.minima import FigureFile, JsonFile, SceneFile, check_figure
from origami_nlp.cli.progress import progress
from origami_nlp.pattern import read_scene


def space(
    scene: SceneFile,
    size: Annotated[int, typer.Option(help="Rings of the mesh around the flat state.")] = 64,
    json: JsonFile = None,
    figure: FigureFile = None,
) -> None:
    """Find components, holes, pinch points and handles of SCENE's admissible symmetric states."""
    check_figure(figure)
    stated = read_scene(scene)
    from origami_nlp.files import check_outputs, screen, write_json
    from origami_nlp.space import analyse_space, print_space

    check_outputs(("--json", json), ("--figure", figure))
    console = screen(json)
    with progress(f"{stated.label or scene}: mesh, walls, layers"):
        found = analyse_space(stated, size)
    print_space(found, console)
    if json:
        write_json(found.to_dict(), json)
    if figure:
        from origami_nlp.space import draw_space

        draw_space(found, figure)
        console.print(f"figure written to {figure}")
