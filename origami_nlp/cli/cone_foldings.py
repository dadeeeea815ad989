"""`origami-nlp cone foldings`: how many foldings of a cone are different, and which."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output

MOST_DIGITS = 28_000
"""Largest degree whose numbers are written out: Python converts integers of up to 4,300 digits."""


def foldings(
    degree: o.Degree,
    listed: Annotated[
        bool | None,
        typer.Option("--list/--no-list", help="List them (up to degree 32; default: up to 16)."),
    ] = None,
    json: o.JsonFile = None,
) -> None:
    """Count foldings up to rotation (necklaces) and up to rotation and reflection (bracelets)."""
    from origami_nlp.cone import (
        LARGEST_LISTED,
        check_degree,
        foldings_to_dict,
        print_foldings,
        write_lines,
    )

    check_degree(degree, LARGEST_LISTED if listed else MOST_DIGITS)
    out = Output(json=json)
    shown = degree <= 16 if listed is None else listed
    print_foldings(degree, out.console, shown)
    out.save("json", write_lines, foldings_to_dict(degree, shown))
