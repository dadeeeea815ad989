"""`origami-nlp grid`: what a grid reports as minima, and where each of them goes."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli.minima import SceneFile, Seed, progress_bar
from origami_nlp.errors import OptionError
from origami_nlp.pattern import read_scene


def grid(
    scene: SceneFile,
    size: Annotated[int, typer.Option(help="Grid points along each coordinate.")] = 65,
    seed: Seed = 0,
) -> None:
    """List the grid-local minima of SCENE's landscape and follow each downhill to an exact minimum."""
    from rich.table import Table
    from rich.text import Text

    from origami_nlp.chart import landscape
    from origami_nlp.files import screen
    from origami_nlp.minima import check_options, find_minima, minima_table
    from origami_nlp.paper import follow_grid_minima

    stated = read_scene(scene)
    check_options(seed, 1)
    if not 9 <= size <= 4097:
        raise OptionError(f"--size = {size} must lie between 9 and 4097")
    chart = landscape(stated, 9)
    if chart.kind != "area":
        why = chart.reason or "it has one symmetric freedom only"
        raise OptionError(f"scene has no two-dimensional chart: {why}")
    console = screen()
    with progress_bar(stated.label or scene) as report:
        result = find_minima(stated, seed=seed, progress=report)
    console.print(minima_table(result))
    points = follow_grid_minima(result, size)
    table = Table(
        title=f"{len(points)} grid minima on {size} x {size} points", title_justify="left"
    )
    x, y = chart.coordinates
    y = y.split(" (")[0]
    for head in ("branch", x, y, "energy [J]", "excl.", "to", "moves", "loses"):
        table.add_column(Text(head), justify="right", no_wrap=True)
    for g in points:
        table.add_row(
            g.branch.removeprefix("branch ") or "-",
            *(f"{v:.4f}" for v in g.point),
            f"{g.energy:.6g}",
            f"{g.excluded_neighbours}/8",
            f"#{g.minimum}" if g.minimum else g.end,
            f"{g.distance:.3f}",
            f"{g.drop:.1e}",
        )
    console.print(table)
