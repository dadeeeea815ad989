"""`origami-nlp cone draw`: folded cones in three dimensions."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.errors import OptionError
from origami_nlp.pattern import parse_angle


def draw(
    figure: o.FigureWanted,
    degree: Annotated[
        int | None, typer.Option(help="Draw all different foldings of this degree (up to 16).")
    ] = None,
    flaps: Annotated[
        str | None, typer.Option(help='Draw this assignment only: "VVM", or "V2M".')
    ] = None,
    elevation: Annotated[
        list[str] | None,
        typer.Option(help='Elevation nu, such as 0.3 or "-pi/6"; with --flaps, may be repeated.'),
    ] = None,
    end: o.EndRule = "contract",
) -> None:
    """Draw all different foldings of a degree, or one assignment at one or more elevations."""
    from origami_nlp.cone import ConeBranch, check_degree, draw_branch, draw_foldings, parse_flaps

    out = Output(figure=figure)
    angles = [parse_angle(text, "--elevation") for text in elevation or []]
    if flaps is not None:
        word = parse_flaps(flaps, degree)
        branch = ConeBranch(word, -1 if any(v < 0 for v in angles) else 1, end)
        steps = [share * branch.end * branch.direction for share in (0.25, 0.5, 0.75, 1.0)]
        out.save("figure", draw_branch, branch, angles or steps)
    elif degree is None:
        raise OptionError("--degree is missing: give a degree, or an assignment with --flaps")
    elif len(angles) > 1:
        raise OptionError("--elevation is given twice: all foldings are drawn at one elevation")
    else:
        out.save("figure", draw_foldings, check_degree(degree), angles[0] if angles else 0.45)
