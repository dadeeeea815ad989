"""`origami-nlp cone branch`: fold angles of one state of a branch."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.pattern import parse_angle


def branch(
    flaps: Annotated[
        str, typer.Option(help='Valley and mountain flaps around the ring: "VVM", or "V2M".')
    ],
    elevation: Annotated[
        str, typer.Option(help='Elevation nu, up > 0 and down < 0: 0.3 or "-pi/6".')
    ],
    end: o.EndRule = "contract",
    json: o.JsonFile = None,
) -> None:
    """Print the fold angles of a folded cone, in radians and (as in FOLD files) in degrees."""
    from origami_nlp.cone import ConeBranch, branch_to_dict, parse_flaps, print_branch, write_lines

    out = Output(json=json)
    nu = parse_angle(elevation, "--elevation")
    state = ConeBranch(parse_flaps(flaps), -1 if nu < 0 else 1, end)
    data = branch_to_dict(state, nu)  # complains past the end, before anything is written
    print_branch(state, nu, out.console)
    out.save("json", write_lines, data)
