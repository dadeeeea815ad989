"""`origami-nlp pattern`: a whole crease pattern, its counts and freedoms."""

from __future__ import annotations

import math
from typing import Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.errors import OptionError


def pattern(
    file: o.FoldFile,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    seed: o.Seed = 0,
    frame: o.FrameNumber = None,
    stiffness: o.FoldStiffness = None,
    per_length: Annotated[
        bool,
        typer.Option("--per-length", help="Stiffness is per length [N/rad]: times the crease's."),
    ] = False,
    rest_angle: o.FoldRestAngle = None,
    rest_angles: o.FoldRestAngles = None,
) -> None:
    """Say what a crease pattern is: facets, creases, vertices, holes, freedoms, redundant equations, what is odd.

    All its vertices are coupled by rigid facets.  --figure draws the sheet folded.
    """
    from origami_nlp.pattern import read_pattern
    from origami_nlp.sheets import draw_overview, overview

    out = Output(json=json, figure=figure)
    options: dict[str, Any] = {"rest_angles": rest_angles}
    if stiffness is not None:
        if not 0 < stiffness < math.inf:
            raise OptionError(f"--stiffness = {stiffness:g} must be positive and finite")
        options["stiffness"] = stiffness
    if rest_angle is not None:
        options["rest_angle"] = math.radians(rest_angle)
    sheet = read_pattern(file, frame, **options)
    if per_length:
        sheet = sheet.with_springs(per_length=True)
    seen = overview(sheet, seed)
    seen.tell(out.console)
    out.write("json", seen.to_dict)
    out.save("figure", draw_overview, seen)
