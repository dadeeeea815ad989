"""`origami-nlp cone foldings`: how many foldings of a cone are different, and which."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli.cone_count import Degree
from origami_nlp.cli.minima import JsonFile

MOST_DIGITS = 28_000
"""Largest degree whose numbers are written out: Python converts integers of up to 4,300 digits."""


def foldings(
    degree: Degree,
    listed: Annotated[
        bool | None,
        typer.Option("--list/--no-list", help="List them (up to degree 32; default: up to 16)."),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Count foldings up to rotation (necklaces) and up to rotation and reflection (bracelets)."""
    from origami_nlp.cone import (
        LARGEST_LISTED,
        check_degree,
        foldings_to_dict,
        print_foldings,
        write_lines,
    )
    from origami_nlp.files import check_writable, is_stdout, screen

    check_degree(degree, LARGEST_LISTED if listed else MOST_DIGITS)
    check_writable(json, "--json")
    shown = degree <= 16 if listed is None else listed
    if not is_stdout(json):
        print_foldings(degree, screen(), shown)
    if json:
        write_lines(foldings_to_dict(degree, shown), json)
