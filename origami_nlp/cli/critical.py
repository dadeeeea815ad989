"""`origami-nlp critical`: every critical point, and whether their count matches the shape of the space."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli.minima import JsonFile, Seed, progress_bar
from origami_nlp.cli.progress import progress
from origami_nlp.errors import OptionError
from origami_nlp.pattern import read_scene


def critical(
    scene: Annotated[
        str | None,
        typer.Argument(
            metavar="[SCENE]", help="Scene file (TOML), or - for stdin; none: the paper's panels."
        ),
    ] = None,
    seed: Seed = 0,
    json: JsonFile = None,
    search: Annotated[
        bool, typer.Option(help="Also search for minima, and compare the two lists.")
    ] = True,
    everything: Annotated[
        bool, typer.Option("--all", help="Show points that are not essential as well.")
    ] = False,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the row of each scene as Markdown.")
    ] = None,
) -> None:
    """Find minima, saddles and maxima of SCENE, contacts included, and check the Morse identity."""
    from rich.text import Text

    from origami_nlp.critical import (
        PANEL_HEADS,
        compare_minima,
        find_critical_points,
        panel_row,
        point_lines,
        points_table,
    )
    from origami_nlp.files import check_outputs, screen, write_json, write_whole
    from origami_nlp.minima import check_options, find_minima
    from origami_nlp.pattern import panels
    from origami_nlp.show import rows_markdown, rows_table
    from origami_nlp.space import analyse_space

    check_options(seed, 1)
    check_outputs(("--json", json), ("--markdown", markdown))
    if json == "-" and scene is None:
        raise OptionError("--json = '-': give a SCENE, or a file name for the panels")
    scenes = panels() if scene is None else [read_scene(scene)]
    console = screen(json, markdown)
    rows, data = [], []
    euler: dict[object, int] = {}
    for number, stated in enumerate(scenes):
        name = stated.label or str(scene)
        with progress("critical points", len(scenes)) as report:
            report(number, text=name)
            found = find_critical_points(stated, seed=seed)
            if search:
                with progress_bar(name) as searching:
                    minima = find_minima(stated, seed=seed, progress=searching)
                found = compare_minima(found, minima)
            shape = (stated.vertex, stated.group.name, stated.mirror)
            if shape not in euler:
                report(text=f"{name}: space")
                euler[shape] = analyse_space(stated).euler_characteristic
        verdict = found.verdict(euler[shape])
        rows.append(panel_row(found, verdict.euler_characteristic))
        data.append(
            {
                **found.to_dict(),
                "euler_characteristic": verdict.euler_characteristic,
                "closes": verdict.closes,
                "verdict": verdict.text,
            }
        )
        if scene is not None:
            console.print(points_table(found, everything))
            for line in point_lines(found, everything):
                console.print(Text(line))
            console.print(verdict.text)
        elif console.is_terminal:
            console.print(f"{stated.label}: {verdict.text}")
    if scene is None:
        console.print(rows_table(PANEL_HEADS, rows, "critical points of the paper's panels"))
    if markdown:
        write_whole(markdown, rows_markdown(PANEL_HEADS, rows).encode())
    if json:
        write_json(data[0] if scene is not None else data, json)
