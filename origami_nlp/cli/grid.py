"""`origami-nlp paper grid`: what a grid reports as minima, and where each of them goes."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.search import search
from origami_nlp.errors import OptionError
from origami_nlp.pattern import read_scene


def grid(
    scene: o.SceneFile,
    size: Annotated[int, typer.Option(help="Grid points along each coordinate.")] = 65,
    seed: o.Seed = 0,
) -> None:
    """List the grid-local minima of SCENE's landscape and follow each downhill to an exact minimum."""
    from origami_nlp.chart import landscape
    from origami_nlp.minima import minima_table
    from origami_nlp.paper import follow_grid_minima, grid_minima_table

    stated = read_scene(scene)
    if not 9 <= size <= 4097:
        raise OptionError(f"--size = {size} must lie between 9 and 4097")
    chart = landscape(stated, 9)
    if chart.kind != "area":
        why = chart.reason or "it has one symmetric freedom only"
        raise OptionError(f"scene has no two-dimensional chart: {why}")
    out = Output()
    result = search(stated, scene, seed=seed)
    out.say(minima_table(result))
    out.say(grid_minima_table(follow_grid_minima(result, size), size, chart.coordinates))
