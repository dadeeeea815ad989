"""Groups of commands as typer makes them, with headings in their plain help, and quick to start."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from origami_nlp.io import is_number

WITHOUT_VALUE = "asked"
"""What an option whose value may be left out gets then."""
MAY_LACK_VALUE = ("--prove",)
"""Options whose value, a number, may be left out."""
WRITES = "FILE"
"""Metavar of every option that writes what a command found, and of no other option."""
FOLD_FILES = "Options for FOLD files and examples"
"""Heading of the options that say what a FOLD file leaves open; `rich_help_panel` of each."""


class _Plain:
    """A command, or a group of them, whose help has a section for each `rich_help_panel`."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the parameters, which take plain values without pydantic."""
        found = super().get_params(ctx)  # type: ignore[misc]
        for one in found:
            one.process_value = partial(_value, one, type(one).process_value)
        return found

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments, options and commands."""
        sections: dict[str, list[tuple[str, str]]] = {}
        for one in self.get_params(ctx):
            name, about = one.get_help_record(ctx)
            is_option = one.param_type_name == "option"
            panel = getattr(one, "rich_help_panel", None)
            heading = panel or ("Options" if is_option else "Arguments")
            row = (name if is_option else one.metavar, about)
            sections.setdefault(heading, []).append(row)
        for name, one in getattr(self, "commands", {}).items():
            row = (name, one.help.split("\n\n")[0])
            sections.setdefault(one.rich_help_panel or "Commands", []).append(row)
        for heading, rows in sections.items():
            with formatter.section(heading):
                formatter.write_dl(rows)


class _Command(_Plain, TyperCommand):
    """A command; an option that needs no value gets `WITHOUT_VALUE` where no number follows."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Fill in what is left out."""
        filled = []
        for arg, following in zip(args, [*args, ""][1:], strict=True):
            filled.append(arg)
            if arg in MAY_LACK_VALUE and not is_number(following):
                filled.append(WITHOUT_VALUE)
        return super().parse_args(ctx, filled)


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
        options = {"add_completion": False, **options}
        # without markup: rich would take "[rad]" for it, and cut what is too long for a narrow terminal
        super().__init__(
            cls=_Commands, help=help, no_args_is_help=True, rich_markup_mode=None, **options
        )

    def add(self, *commands: Callable[..., None], under: str | None = None) -> None:
        """Add commands under the names of their functions, and a heading."""
        for one in commands:
            name = one.__name__.replace("_", "-")
            self.command(name, cls=_Command, rich_help_panel=under)(one)
