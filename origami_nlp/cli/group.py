"""Groups of commands as typer makes them: functions as commands, with headings in their plain help, quick to start."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import partial, wraps
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from origami_nlp.cli import options as o
from origami_nlp.cli.exits import Ended
from origami_nlp.cli.output import Output, endings
from origami_nlp.cli.source import Source
from origami_nlp.cli.timed import Clock

NAMED = inspect.Parameter.KEYWORD_ONLY
_STATED = inspect.signature(Source, eval_str=True).parameters
OF_FILE = {name: one.replace(kind=NAMED) for name, one in _STATED.items()}
"""What a command that takes ORIGAMI has, by name."""


def writes(*kinds: str, verbose: bool = False) -> Callable[..., Callable[..., None]]:
    """Make a function a command that writes files of these kinds.

    Its parameter of type `Source` becomes ORIGAMI with the options of files, `Output` becomes ``-o``, with ``-v`` where
    the results have details, and a parameter ``clock`` is the time of ``--seconds``, which every command has.  What it
    returns is printed and written; an exit code where it returns one.
    """

    def decorate(command: Callable[..., Any]) -> Callable[..., None]:
        stated = inspect.signature(command, eval_str=True).parameters
        more: dict[str, tuple[Any, Any]] = {"seconds": (float | None, o.SECONDS)}
        if kinds:
            more["output"] = (list[str] | None, o.output(endings(kinds)))
        if verbose:
            more["verbose"] = (bool, o.VERBOSE)
        names = [name for name, p in stated.items() if p.annotation is Source]

        @wraps(command)
        def run(**given: Any) -> None:
            clock = Clock(given.pop("seconds"))
            out = Output(given.pop("output", None), kinds, given.pop("verbose", False))
            given |= {k: v for k, v in (("out", out), ("clock", clock)) if k in stated}
            for name in names:
                given[name] = Source(**{k: given.pop(k) for k in OF_FILE})
            _end(command, given, out, clock)

        of = [*OF_FILE.values()] if names else []
        own = [p for name, p in stated.items() if name not in ("out", "clock", *names)]
        own = [p.replace(kind=NAMED) for p in own]
        own += [inspect.Parameter(k, NAMED, annotation=a, default=d) for k, (a, d) in more.items()]
        run.__signature__ = inspect.Signature([*of[:1], *own, *of[1:]])  # type: ignore[attr-defined]
        return run

    return decorate


def _end(command: Callable[..., Any], given: dict[str, Any], out: Output, clock: Clock) -> None:
    """Run a command, report what it found, and end with its exit code."""
    found = clock.run(command, **given)
    early = found is None and (clock.late or clock.interrupted)
    code, found = (found, None) if isinstance(found, int) else (Ended.DONE, found)
    if (found := clock.found if early else found) is not None:
        out.report(found)
    if clock.interrupted:
        raise KeyboardInterrupt
    if clock.late and early:
        out.say(clock.said())
    if out.gone:
        raise BrokenPipeError
    if clock.late or code:
        raise typer.Exit(Ended.OUT_OF_TIME if clock.late else code)


class _Plain:
    """A command, or a group of them, whose help has a section for each `rich_help_panel`."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the parameters, which take plain values without pydantic: to load it takes 0.15 s."""
        found = super().get_params(ctx)  # type: ignore[misc]
        for one in found:
            one.process_value = partial(_value, one, type(one).process_value)
        return found

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments, options and commands."""
        sections: dict[str, list[tuple[str, str]]] = {}
        for one in self.get_params(ctx):
            name, about = one.get_help_record(ctx)
            usual = "Options"
            if one.param_type_name != "option":
                usual, name = "Arguments", one.metavar
            heading = getattr(one, "rich_help_panel", None) or usual
            sections.setdefault(heading, []).append((name, about))
        for name, one in getattr(self, "commands", {}).items():
            row = (name, one.help.split("\n\n")[0])
            sections.setdefault(one.rich_help_panel or "Commands", []).append(row)
        for heading, rows in sections.items():
            with formatter.section(heading):
                formatter.write_dl(rows)


class _Command(_Plain, TyperCommand):
    """A command."""


class _Commands(_Plain, TyperGroup):
    """A group of commands."""


def _value(parameter: Any, process: Callable[..., Any], ctx: Any, given: Any) -> Any:
    """Return the value of a parameter; all but plain text and numbers are left to typer, which loads pydantic."""
    kind = getattr(getattr(parameter, "type_descriptor", None), "annotation", None)
    many = parameter.multiple or parameter.nargs != 1
    whole = kind is int and isinstance(given, str) and given.isascii() and given.isdigit()
    value: Any
    if given is None and kind is not None and not parameter.required:
        value = () if many else None
    elif kind == list[str] and isinstance(given, list | tuple):
        value = list(given) or ()
    elif not many and (whole or (kind in (str, int, float) and type(given) is kind)):
        value = int(given) if whole else given
    else:
        return process(parameter, ctx, given)
    return parameter.callback(ctx, parameter, value) if parameter.callback else value


class Group(typer.Typer):
    """Commands, and groups of them, under one name.

    Parameters
    ----------
    help
        What the group is about.
    options
        Of `typer.Typer`.
    """

    def __init__(self, help: str, **options: Any) -> None:
        options = {"add_completion": False, "no_args_is_help": True, **options}
        # without markup: rich would take "[rad]" for it, and cut what is too long for a narrow terminal
        super().__init__(cls=_Commands, help=help, rich_markup_mode=None, **options)

    def add(self, *commands: Callable[..., None], under: str | None = None) -> None:
        """Add commands under the names of their functions, and a heading."""
        for one in commands:
            name = one.__name__.replace("_", "-")
            self.command(name, cls=_Command, rich_help_panel=under)(one)
