"""`origami-nlp cone`: uniform vertices of any even degree; its commands are registered here."""

from __future__ import annotations

from collections.abc import Callable

import typer

from origami_nlp.cli.cone_branch import branch
from origami_nlp.cli.cone_count import count
from origami_nlp.cli.cone_draw import draw
from origami_nlp.cli.cone_foldings import foldings
from origami_nlp.cli.cone_phase import fractions, full, limits, phase
from origami_nlp.cli.cone_speed import speed


def first_line(command: Callable[..., None]) -> str:
    """Return what a list of commands says of one; typer would cut it."""
    return (command.__doc__ or "").splitlines()[0]


cone = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Cones (uniform vertices of even degree): branches, their minima, different foldings.",
)
for command in (count, foldings, branch, draw, phase, fractions, full, limits, speed):
    cone.command(command.__name__, short_help=first_line(command))(command)
