"""`origami-nlp load`: a stable state under a growing torque or force, through its snaps."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.followed import follows
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import OptionError


@takes_scene(o.SceneFile)
@follows
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
    **search: Any,
) -> Any:
    """Load a stable state of SCENE until it snaps, or to a given load: load against angle, snaps, hysteresis."""
    from origami_nlp.loading import load_path

    end = to if to == "snap" else load_number(to)
    return load_path(
        scene.read(), crease, to=end, state=state, back=back, confirm=confirm, **search
    )


def load_number(text: str) -> float:
    """Return the load that ``--to`` says."""
    try:
        return float(text)
    except ValueError:
        raise OptionError(f"--to = {text!r} must be a load, or snap") from None
