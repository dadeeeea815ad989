"""`origami-nlp load`: a stable state under a growing torque or force, through its snaps."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.followed import follows
from origami_nlp.cli.loads import Creases, ForceOn, Held, PullOf, load_number, work_of
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import OptionError


@takes_scene(o.OrigamiFile, whole=True)
@follows
def load(
    scene: Source,
    crease: Creases = None,
    pull: PullOf = None,
    force: ForceOn = None,
    held: Held = 1,
    to: Annotated[
        str,
        typer.Option(
            metavar="LOAD|snap",
            help="Torque [N m], force [N] or factor at which the path ends, from 0; snap: both ways to the first snap.",
        ),
    ] = "snap",
    state: Annotated[
        int, typer.Option(metavar="K", help="Number of the minimum at load 0 that is loaded.")
    ] = 1,
    back: Annotated[bool, typer.Option("--back", help="Let the load fall back to 0.")] = False,
    confirm: Annotated[
        bool, typer.Option(help="Search for the minima on both sides of each snap.")
    ] = True,
    starts: o.Starts = None,
    **search: Any,
) -> Any:
    """Load a stable state of ORIGAMI until it snaps, or to a given load: load against angle, snaps, hysteresis.

    A FOLD file or an example is loaded as a whole, as a rigid sheet, unless --vertex names one vertex of it.  A vertex
    without --crease is loaded by the scene's own forces.
    """
    from origami_nlp.loading import load_path
    from origami_nlp.pattern import Scene

    what = scene.read_whole()
    work: Any
    if isinstance(what, Scene):
        if pull or force or len(crease or ()) > 1:
            raise OptionError("--pull, --force and several --crease are for patterns")
        work = crease[0] if crease else None
    else:
        if sum(map(bool, (crease, pull, force))) != 1:
            raise OptionError(
                "a pattern is loaded by one of --crease K, --pull V,W and --force V,X,Y,Z"
            )
        work = work_of(what, crease, pull, force, held)
    end = to if to == "snap" else load_number(to)
    return load_path(
        what, work, to=end, state=state, back=back, confirm=confirm, starts=starts, **search
    )  # fmt: skip
