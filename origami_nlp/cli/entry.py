"""The command `origami-nlp`: what it can do, in the order a new user needs, and how it ends."""

from __future__ import annotations

import io
import os
import platform
import signal
import sys
import traceback
from typing import Any, NoReturn

import typer
from typer.main import get_command

from origami_nlp.cli.exits import Ended
from origami_nlp.cli.files import check, convert, example, hinge, inspect
from origami_nlp.cli.group import Group
from origami_nlp.cli.paper import paper
from origami_nlp.cli.paths import boundary, follow, load
from origami_nlp.cli.states import barriers, check_proof, contacts, design, landscape, minima, sweep
from origami_nlp.errors import OrigamiError
from origami_nlp.io import printable
from origami_nlp.version import __version__

app = Group(
    "Stable states of rigid origami, of a vertex or a whole crease pattern: found, certified, loaded, designed.  "
    "Creases and facets count from 1, vertices and frames of FOLD files from 0 as in the file.",
    add_completion=True,
    epilog="""\b
First steps:
  example miura > my.toml; edit it; minima my.toml
  inspect my.fold; minima my.fold --stiffness 0.02 --rest-angle 90
  load my.toml --crease 1 --state 2 -o load.png
  example switch > two.toml; edit it; design two.toml -o my.toml
  minima my.toml -o states.pdf""",
)
app.add(minima, inspect, load, follow, design, example, hinge, check, convert, under="Start here")
app.add(landscape, barriers, contacts, boundary, sweep, check_proof, under="Analysis")
app.add_typer(paper, name="paper", rich_help_panel="The source paper")


def _version(asked: bool) -> None:
    if asked:
        print(f"origami-nlp {__version__}")
        raise typer.Exit()


_SHOW: Any = {"callback": _version, "is_eager": True, "help": "Show the version."}


@app.callback()
def origami_nlp(version: bool = typer.Option(False, "--version", **_SHOW)) -> None:
    """Take the options of the program itself."""


def run(commands: Group | None) -> None:
    """Run the command that was asked for, of `origami-nlp` or of other commands; `start.main` calls it."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # letters that the terminal does not know
            stream.reconfigure(errors="backslashreplace")
    try:
        try:
            code = get_command(commands or app).main(standalone_mode=False)
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()  # a full disk shows here, where it can still be said
    except Exception as error:
        _end(error)
    if code == 128 + signal.SIGINT:
        raise KeyboardInterrupt
    sys.exit(code)


def _end(error: Any) -> NoReturn:
    """End with one line, or without one where nobody reads."""
    if isinstance(error, OSError):
        try:  # let Python not try again at its end what cannot be written now
            sys.stdout.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):  # the reader, head say, has had enough
            sys.exit(Ended.CLOSED_PIPE)
        where = repr(error.filename) if error.filename else "input or output"
        _stop(f"{where}: {error.strerror or error}")
    if isinstance(error, OrigamiError):
        _stop(str(error))
    if isinstance(error, MemoryError):
        _stop("the memory does not suffice: give a smaller origami")
    if not hasattr(error, "format_message"):
        said = "".join(traceback.format_exception(error))
        print(printable(said, lines=True), file=sys.stderr)
        where = f"origami-nlp {__version__}, Python {platform.python_version()}"
        _stop(f"internal error, please report all of this, with the file; {where}", Ended.FAULT)
    if "Help" in type(error).__name__:  # a group that is called without a command
        print(error.format_message(), file=sys.stderr)
        sys.exit(Ended.WRONG)
    # a wrong call, of the parser that typer brings
    said = " ".join(error.format_message().split()).rstrip(".")
    path = error.ctx.command_path if error.ctx else "origami-nlp"
    _stop(f"{said[:1].lower()}{said[1:]}; {path} --help lists what there is")


def _stop(line: str, code: int = Ended.WRONG) -> NoReturn:
    print(f"origami-nlp: {printable(line)}", file=sys.stderr)
    sys.exit(code)
