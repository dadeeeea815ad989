"""`origami-nlp critical`: every critical point, and whether their count matches the shape of the space."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.search import search as search_minima
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.cli.timed import bounded
from origami_nlp.errors import OptionError
from origami_nlp.pattern import examples


@bounded
@takes_scene(o.SceneUnlessPanels)
def critical(
    scene: Source | None = None,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    compare: Annotated[
        bool,
        typer.Option(
            "--compare/--no-compare", help="Also search for minima, and compare the two lists."
        ),
    ] = True,
    panels: o.Panels = False,
    everything: Annotated[
        bool, typer.Option("--all", help="Show points that are not essential as well.")
    ] = False,
    markdown: o.MarkdownFile = None,
) -> None:
    """Find minima, saddles and maxima of SCENE, contacts included, and check the Morse identity."""
    from rich.text import Text

    from origami_nlp.critical import (
        PANEL_HEADS,
        compare_minima,
        find_critical_points,
        panel_row,
    )
    from origami_nlp.show import rows_markdown, rows_table
    from origami_nlp.space import find_space

    out = Output(json=json, markdown=markdown)
    given = scene.name if scene else None
    if panels and scene is not None:
        raise OptionError(f"SCENE = {given!r}: give a scene file or --panels, and not both")
    if scene is None and not panels:
        raise OptionError("SCENE is missing: give a scene file, or --panels for those of the paper")
    scenes = [scene.read()] if scene else examples.panels()
    rows, data = [], []
    euler: dict[object, int] = {}
    for number, stated in enumerate(scenes):
        name = stated.label or str(given)
        with progress("critical points", len(scenes)) as report:
            report(number, text=name)
            found = find_critical_points(stated, seed=seed)
            if compare:
                found = compare_minima(found, search_minima(stated, given, seed=seed, escape=False))
            shape = (stated.vertex, stated.group.name, stated.mirror)
            if shape not in euler:
                report(text=f"{name}: space")
                euler[shape] = find_space(stated).euler_characteristic
        verdict = found.verdict(euler[shape])
        rows.append(panel_row(found, verdict.euler_characteristic))
        data.append(replace(found, morse=verdict).to_dict())
        if scene is not None:
            out.say(found.table(everything))
            for line in found.lines(everything):
                out.say(Text(line))
            out.say(verdict.text)
        elif out.console.is_terminal:
            out.say(f"{stated.label}: {verdict.text}")
    if scene is None:
        out.say(rows_table(PANEL_HEADS, rows, "critical points of the paper's panels"))
    out.write("markdown", rows_markdown, PANEL_HEADS, rows)
    out.write("json", lambda: data[0] if scene is not None else data)
