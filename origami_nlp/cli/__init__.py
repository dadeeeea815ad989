"""The command line: one file per command, registered here."""

from __future__ import annotations

import sys

import typer

from origami_nlp.cli.audit import audit
from origami_nlp.cli.barriers import barriers
from origami_nlp.cli.bench import bench
from origami_nlp.cli.cone import cone
from origami_nlp.cli.contacts import contacts
from origami_nlp.cli.critical import critical
from origami_nlp.cli.demo import demo
from origami_nlp.cli.example import example
from origami_nlp.cli.grid import grid
from origami_nlp.cli.landscape import landscape
from origami_nlp.cli.minima import minima
from origami_nlp.cli.model import model
from origami_nlp.cli.panels import panels
from origami_nlp.cli.reproduce import reproduce
from origami_nlp.cli.space import space
from origami_nlp.cli.sweep import sweep
from origami_nlp.cli.transitions import transitions
from origami_nlp.cli.verify import verify
from origami_nlp.cli.vertices import vertices
from origami_nlp.errors import OrigamiError

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Energy minima of an origami vertex: found, classified, and which are stable states.",
)
for command in (
    demo,
    minima,
    contacts,
    critical,
    barriers,
    model,
    example,
    grid,
    landscape,
    panels,
    audit,
    verify,
    vertices,
    sweep,
    space,
    transitions,
    reproduce,
    bench,
):
    app.command(command.__name__)(command)
app.add_typer(cone, name="cone")


def main() -> None:
    """Run the command line; bad input ends with one line and exit code 2."""
    try:
        app()
    except OrigamiError as error:
        print(f"origami-nlp: {error}", file=sys.stderr)
        sys.exit(2)
