"""`origami-nlp follow`: the states of a scene over a parameter, as branches with events."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.source import Source, takes_scene


@takes_scene(o.SceneFile)
def follow(
    scene: Source,
    over: o.Over,
    checks: Annotated[
        int,
        typer.Option(metavar="N", help="Searches: both ends, the middle, then the widest gaps."),
    ] = 3,
    through_folds: Annotated[
        bool, typer.Option(help="Follow states through folds, where they are saddles.")
    ] = True,
    full_space: Annotated[
        bool, typer.Option(help="Locate where a state loses stability without its symmetry.")
    ] = True,
    morse: Annotated[
        bool, typer.Option("--morse", help="Check the Morse identity at each check.")
    ] = False,
    effort: o.Effort = "normal",
    seed: o.Seed = 0,
    max_starts: o.MaxStarts = 100_000,
    figure: o.FigureFile = None,
    json: o.JsonFile = None,
    fold: o.PathsFold = None,
    html: o.HtmlFile = None,
) -> None:
    """Follow the states of SCENE over a parameter, and locate where they appear, change and vanish."""
    from origami_nlp.atlas import draw_atlas, follow as follow_states, write_frames

    out = Output(json=json, figure=figure, fold=fold, html=html)
    atlas = follow_states(
        scene.read(),
        over,
        checks=checks,
        through_folds=through_folds,
        full_space=full_space,
        morse=morse,
        effort=effort,
        seed=seed,
        max_starts=max_starts,
    )
    atlas.tell(out.console)
    out.write("json", atlas.to_dict)
    out.save("figure", draw_atlas, atlas)
    out.save("fold", write_frames, atlas)
    out.turn(atlas)
