"""`origami-nlp boundary`: curves of events over two parameters, and the number of states between them."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.cli.timed import end_of


@takes_scene(o.SceneFile)
def boundary(
    scene: Source,
    event: Annotated[
        str,
        typer.Option(
            metavar="NAME=FROM:TO",
            help="The parameter in whose range events are looked for; NAME=VALUE for those nearby.",
        ),
    ],
    over: o.Over,
    lines: Annotated[
        int,
        typer.Option(metavar="N", help="Values of the second at which the first is followed."),
    ] = 3,
    effort: o.Effort = "normal",
    seed: o.Seed = 0,
    seconds: o.Seconds = None,
    figure: o.FigureFile = None,
    json: o.JsonFile = None,
) -> None:
    """Draw where states of SCENE appear, change and vanish over two parameters, as exact curves."""
    from origami_nlp.atlas import draw_boundaries, find_boundaries

    out = Output(json=json, figure=figure)
    found = find_boundaries(
        scene.read(), event, over, lines=lines, seed=seed, effort=effort, seconds=seconds
    )
    found.tell(out.console)
    out.write("json", found.to_dict)
    out.write("figure", draw_boundaries, found)
    end_of(found)
