"""`origami-nlp cone`: uniform vertices of any even degree; its commands are registered here."""

from __future__ import annotations

import typer

from origami_nlp.cli.cone_branch import branch
from origami_nlp.cli.cone_count import count
from origami_nlp.cli.cone_draw import draw
from origami_nlp.cli.cone_foldings import foldings
from origami_nlp.cli.cone_phase import fractions, full, limits, phase
from origami_nlp.cli.cone_speed import speed

cone = typer.Typer(
    no_args_is_help=True,
    help="Cones (uniform vertices of even degree): branches, their minima, different foldings.",
)
for command in (count, foldings, branch, draw, phase, fractions, full, limits, speed):
    cone.command(command.__name__)(command)
