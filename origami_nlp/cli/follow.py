"""`origami-nlp follow`: the states of a scene over a parameter, as branches with events."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.followed import follows
from origami_nlp.cli.source import Source, takes_scene


@takes_scene(o.OrigamiFile, whole=True)
@follows
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
    morse: Annotated[
        bool, typer.Option("--morse", help="Check the Morse identity at each check.")
    ] = False,
    prove: o.ProveChecks = None,
    starts: o.Starts = None,
    **search: Any,
) -> Any:
    """Follow the states of ORIGAMI over a parameter, and locate where they appear, change and vanish."""
    from origami_nlp.atlas import follow as follow_states

    # options of an example by name are among what it can be followed over
    named = scene.is_example and not scene.given
    return follow_states(
        scene.name if named else scene.read_whole(),
        over,
        checks=checks,
        through_folds=through_folds,
        morse=morse or None,
        prove=o.wanted_proof(prove),
        starts=starts,
        **search,
    )
