"""`origami-nlp cone count`: how many branches of a cone hold a minimum."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.pattern import parse_angle


def count(
    degree: o.Degree,
    ratio: o.Ratio,
    elevation: o.RestElevation,
    depth: Annotated[
        float,
        typer.Option(help="Count wells deeper than this share of U_flat; 0 counts all minima."),
    ] = 0.0,
    rest: o.RestRule = "waterbomb",
    end: o.EndRule = "contract",
    json: o.JsonFile = None,
) -> None:
    """Count the minima on all 2^(N/2 + 1) branches exactly: interior, pinned by contact, falling at a cut."""
    from origami_nlp.cone import branch_minima, count_to_dict, print_count, write_lines

    out = Output(json=json)
    nu = parse_angle(elevation, "--elevation")
    found = branch_minima(degree, ratio, nu, rest=rest, depth=depth, end=end)
    print_count(found, out.console)
    out.save("json", write_lines, count_to_dict(found))
