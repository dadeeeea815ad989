"""Commands that judge what is stated: `check`, is it real, and `layers`, in how many orders."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output, answers, writes
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import FoldFileError, OptionError

if TYPE_CHECKING:
    from origami_nlp.validity import Validity

Files = Annotated[
    list[str],
    typer.Argument(
        metavar="ORIGAMI...",
        help="FOLD files, - for stdin, or examples by name, such as miura:8x8.",
    ),
]


@writes("json", "figure")
def check(
    out: Output,
    files: Files,
    frame: Annotated[
        int | None, typer.Option(metavar="N", help="Frame that is checked, from 0 (default: all).")
    ] = None,
    flat_frame: Annotated[
        int | None,
        typer.Option(
            "--flat-frame",
            metavar="N",
            help="Crease pattern that folded forms are compared with (default: the first that is numbered as they "
            "are).",
        ),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            metavar="SHARE",
            help="By how much places may be off, over the size of the sheet (default: by the digits of a folded form, "
            "1e-6 to 1e-4; 1e-4 of a drawing).",
        ),
    ] = None,
    verbose: o.Verbose = False,
) -> None:
    """Check whether folded states are real, and whether crease patterns fold flat: all faults, with place and size.

    Lengths as in the crease pattern, plane faces, fold angles and letters as the coordinates have them, closure,
    faces that pass through each other, faceOrders; of a crease pattern Kawasaki, Maekawa, big-little-big and layers.
    -o FILE.png marks the faults.  Exit code 0: all valid; 1: faults, or not decided; 2: a file cannot be read.
    """
    from origami_nlp.validity import check as check_file

    if len(files) > 1:
        out.refuse("a picture is of one file: give one", "figure")
    seen: list[Validity] = []
    unread: list[str] = []
    for file in files:
        try:
            one = check_file(file, frame=frame, flat_frame=flat_frame, tolerance=tolerance)
        except (FoldFileError, OptionError) as error:
            if len(files) == 1:
                raise
            unread.append(file)
            out.say(f"{file}: not read: {error}")
            continue
        one.print_to(out.console, verbose)
        seen.append(one)
    if len(files) > 1:
        valid = sum(one.verdict == "valid" for one in seen)
        faulty = sum(one.verdict == "faults" for one in seen)
        out.say(
            f"{len(files)} files: {valid} valid, {faulty} with faults, {len(seen) - valid - faulty} not decided, "
            f"{len(unread)} not read"
        )
    out.write("json", lambda: seen[0].to_dict() if len(files) == 1 else [s.to_dict() for s in seen])
    out.write("figure", lambda: seen[0].draw())
    if unread or any(one.verdict != "valid" for one in seen):
        raise typer.Exit(2 if unread else 1)


@takes_scene(o.PatternFile, whole=True, springs=False)
@answers("json", "fold")
def layers(
    scene: Source,
    most: Annotated[int, typer.Option(metavar="N", help="Orders that are listed in files.")] = 100,
) -> Any:
    """Count the layer orders of PATTERN's folded state, by components; -o FILE.fold lists them as frames.

    The state is the one that the file describes, or the pattern folded flat; there unassigned creases may be mountain
    or valley.
    """
    from origami_nlp.validity import layer_orders

    return layer_orders(scene.read_pattern(), most=most)
