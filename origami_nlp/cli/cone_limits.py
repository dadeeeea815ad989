"""`origami-nlp cone limits`: how fast cones of many creases become the continuum cone."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.pattern import parse_angle


def limits(
    elevation: Annotated[str, typer.Option(help="Elevation in (0, pi/4).")] = "0.6",
    ratio: o.Ratio = 1.0,
    json: o.JsonFile = None,
) -> None:
    """Measure how fast the cone approaches the continuum cone as N grows, against its series."""
    from origami_nlp.paper import LIMIT_HEADS, limit_row, limits as measure, limits_to_dict
    from origami_nlp.show import folding_table

    out = Output(json=json)
    found = measure(parse_angle(elevation, "--elevation"), ratio)
    out.say(folding_table(LIMIT_HEADS, [limit_row(q) for q in found], "errors ~ c (2 pi/N)^p"))
    out.write("json", limits_to_dict, found)
