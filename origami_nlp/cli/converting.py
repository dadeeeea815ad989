"""The command `convert`: a crease pattern from format to format."""

from __future__ import annotations

from collections import Counter
from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.errors import OptionError


def convert(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SOURCE", help="FOLD, SVG, .cp, .opx or DXF file, - for stdin, or an example."
        ),
    ],
    to: Annotated[
        str,
        typer.Argument(
            metavar="OUT", help="Its ending says what is written: .fold .svg .cp .opx .dxf."
        ),
    ],
    frame: o.FrameNumber = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            metavar="SHARE",
            help="Share of the sheet within which ends are joined (default: the smallest at which it is whole).",
        ),
    ] = None,
    colour: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=LETTER",
            help="What a colour (#EE1032=M) or a layer of DXF is: M, V, B, C, U, F, or - to leave it out; repeatable.",
        ),
    ] = None,
    curves: Annotated[
        str,
        typer.Option(
            metavar="refuse|leave|N",
            help="Refuse curves, leave them out, or take N chords for each.",
        ),
    ] = "refuse",
    part: Annotated[
        int | None,
        typer.Option(metavar="K", help="One of several sheets, from 1, the largest first."),
    ] = None,
    scale: Annotated[
        float | None, typer.Option(metavar="MM", help="Millimetres for one unit of the file.")
    ] = None,
    size: Annotated[
        float | None,
        typer.Option("--longest", metavar="MM", help="Millimetres of the longest side."),
    ] = None,
) -> None:
    """Write the crease pattern of SOURCE as OUT, in another format.

    What was repaired, left out or taken is listed.  A frame with a folded form (--frame K) is drawn flat, with its fold
    angles.
    """
    from origami_nlp.drawings import DrawingOptions, WriteOptions
    from origami_nlp.pattern import convert as written

    out = Output()
    out.check(("OUT", to))
    asked = DrawingOptions(
        tolerance, _letters(colour or []), int(curves) if curves.isdigit() else curves, part
    )
    made = written(
        source,
        to,
        frame=frame,
        drawing=asked if asked != DrawingOptions() else None,
        write=WriteOptions(scale, size),
    )
    for note in made.notes:
        out.say(f"note: {note}")
    counts = Counter(made.letters)
    letters = ", ".join(f"{counts[a]} {a}" for a in "MVUFCB" if counts[a])
    out.say(f"written: {to}: {len(made.points)} vertices, {len(made.edges)} edges ({letters})")


def _letters(given: list[str]) -> dict[str, str]:
    """Return what colours are, as they were typed."""
    pairs = [one.rpartition("=") for one in given]
    for key, sign, letter in pairs:
        if not (key and sign and letter):
            raise OptionError(
                f"--colour = {key + sign + letter!r} must be KEY=LETTER, such as '#EE1032=M'"
            )
    return {key: letter.upper() for key, _, letter in pairs}
