"""`origami-nlp example`: print the paper's vertex families as scene files."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.errors import OptionError
from origami_nlp.pattern import examples, format_scene

FAMILIES = {"degree6": examples.degree6, "degree8": examples.degree8}


def example(
    family: o.Family,
    alpha: Annotated[
        str,
        typer.Option(metavar="ANGLE", help='Sector angle alpha_1 [rad], a number or e.g. "pi/4".'),
    ] = "pi/4",
    ratio: o.Ratio = 1.0,
    symmetry: Annotated[
        str | None, typer.Option(metavar="GROUP", help="Override the paper's symmetry.")
    ] = None,
    contact: Annotated[
        str, typer.Option(metavar="full|fold-limits|none", help="full, fold-limits or none.")
    ] = "full",
) -> None:
    """Print a scene file of the paper's FAMILY of vertices (sections 3.1 and 3.2)."""
    if family not in FAMILIES:
        raise OptionError(f"FAMILY = {family!r} is unknown: use {' or '.join(FAMILIES)}")
    given = {} if symmetry is None else {"symmetry": symmetry}
    scene = FAMILIES[family](alpha, ratio, contact=contact, **given)  # type: ignore[arg-type]
    sys.stdout.write(format_scene(scene))
