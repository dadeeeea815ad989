"""`origami-nlp load`: a stable state under a growing torque or force, through its snaps."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import OptionError


@takes_scene(o.SceneFile)
def load(
    scene: Source,
    crease: Annotated[
        int | None,
        typer.Option(
            metavar="K",
            help="Torque on crease K, and on its images under the symmetry; without it the scene's own forces grow.",
        ),
    ] = None,
    to: Annotated[
        str,
        typer.Option(
            metavar="LOAD|snap",
            help="Torque [N m] or factor at which the path ends, from 0; snap: both ways to the first snap.",
        ),
    ] = "snap",
    state: Annotated[
        int, typer.Option(metavar="K", help="Number of the minimum at load 0 that is loaded.")
    ] = 1,
    back: Annotated[bool, typer.Option("--back", help="Let the load fall back to 0.")] = False,
    confirm: Annotated[
        bool, typer.Option(help="Search for the minima on both sides of each snap.")
    ] = True,
    full_space: Annotated[
        bool, typer.Option(help="Locate where a state loses stability without its symmetry.")
    ] = True,
    effort: o.Effort = "normal",
    seed: o.Seed = 0,
    max_starts: o.MaxStarts = 100_000,
    figure: o.FigureFile = None,
    json: o.JsonFile = None,
    fold: o.PathsFold = None,
    html: o.HtmlFile = None,
) -> None:
    """Load a stable state of SCENE until it snaps, or to a given load: load against angle, snaps, hysteresis."""
    from origami_nlp.loading import draw_load, load_path, write_path

    out = Output(json=json, figure=figure, fold=fold, html=html)
    path = load_path(
        scene.read(),
        crease,
        to=to if to == "snap" else _number(to),
        state=state,
        back=back,
        confirm=confirm,
        full_space=full_space,
        effort=effort,
        seed=seed,
        max_starts=max_starts,
    )
    path.tell(out.console)
    out.write("json", path.to_dict)
    out.write("figure", draw_load, path)
    out.save("fold", write_path, path)
    out.turn(path)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise OptionError(f"--to = {text!r} must be a load, or snap") from None
