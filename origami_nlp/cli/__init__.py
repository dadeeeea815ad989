"""The command line: one file per command, registered here."""

from __future__ import annotations

import io
import os
import sys
from typing import NoReturn

import typer

from origami_nlp.cli.audit import audit
from origami_nlp.cli.barriers import barriers
from origami_nlp.cli.bench import bench
from origami_nlp.cli.cone import cone, first_line
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
from origami_nlp.files import printable

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # rich takes "[rad]" for markup and drops it
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
    app.command(command.__name__, short_help=first_line(command))(command)
app.add_typer(cone, name="cone", short_help=str(cone.info.help))


def main() -> None:
    """Run the command line; bad input, and output that nobody takes, end with one line and exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # letters that the terminal does not know
            stream.reconfigure(errors="backslashreplace")
    try:
        try:
            app()
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()  # a full disk shows here, where it can still be said
    except OrigamiError as error:
        _stop(str(error))
    except BrokenPipeError:  # the reader, head say, has had enough
        _close_stdout()
        sys.exit(1)
    except OSError as error:
        _close_stdout()
        where = repr(error.filename) if error.filename else "input or output"
        _stop(f"{where}: {error.strerror or error}")


def _stop(line: str) -> NoReturn:
    print(f"origami-nlp: {printable(line)}", file=sys.stderr)
    sys.exit(2)


def _close_stdout() -> None:
    """Let Python not try again at its end what cannot be written now."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
