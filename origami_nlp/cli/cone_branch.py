"""`origami-nlp cone branch`: fold angles of one state of a branch."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli.cone_count import EndRule
from origami_nlp.cli.minima import JsonFile

Flaps = Annotated[
    str, typer.Option(help='Valley and mountain flaps around the ring: "VVM", or "V2M".')
]
Elevation = Annotated[str, typer.Option(help='Elevation nu, up > 0 and down < 0: 0.3 or "-pi/6".')]


def branch(
    flaps: Flaps,
    elevation: Elevation,
    end: EndRule = "contract",
    json: JsonFile = None,
) -> None:
    """Print the fold angles of a folded cone, in radians and (as in FOLD files) in degrees."""
    from origami_nlp.cone import branch as cone_branch, branch_to_dict, print_branch, write_lines
    from origami_nlp.files import check_writable, is_stdout, screen
    from origami_nlp.pattern import parse_angle

    check_writable(json, "--json")
    nu = parse_angle(elevation, "--elevation")
    state = cone_branch(flaps, -1 if nu < 0 else 1, end=end)
    data = branch_to_dict(state, nu)  # complains past the end, before anything is written
    if not is_stdout(json):
        print_branch(state, nu, screen())
    if json:
        write_lines(data, json)
