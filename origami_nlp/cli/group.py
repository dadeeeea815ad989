"""A group of commands: listed in the order in which they are added, each with the first line of its docstring."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

WITHOUT_VALUE = "asked"
"""What an option whose value may be left out gets then."""
MAY_LACK_VALUE = ("--prove",)
"""Options whose value, a number, may be left out."""


class _Command(TyperCommand):
    """A command; an option that needs no value gets `WITHOUT_VALUE` where no number follows."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Fill in what is left out."""
        filled = []
        for arg, following in zip(args, [*args, ""][1:], strict=True):
            filled.append(arg)
            if arg in MAY_LACK_VALUE and not _is_number(following):
                filled.append(WITHOUT_VALUE)
        return super().parse_args(ctx, filled)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


class _Listed(TyperGroup):
    """What typer makes of a `Group`; alone it would list groups last."""

    names: list[str]
    open: list[str]

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names that help shows."""
        return self.names

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command of this group, or of one of its open groups."""
        groups = (self, *(self.commands[name] for name in self.open))
        return next((g.commands[cmd_name] for g in groups if cmd_name in g.commands), None)  # type: ignore[attr-defined]


class Group(typer.Typer):
    """Commands, and groups of them, under one name.

    Parameters
    ----------
    help
        What the group is about.
    """

    def __init__(self, help: str) -> None:
        self.about, self.names, self.open = help, list[str](), list[str]()
        super().__init__(
            cls=type("Listed", (_Listed,), {"names": self.names, "open": self.open}),
            help=help,
            no_args_is_help=True,
            add_completion=False,
            pretty_exceptions_enable=False,
            rich_markup_mode=None,  # rich takes "[rad]" for markup and drops it
        )

    def add(self, *commands: Callable[..., None]) -> None:
        """Add commands under the names of their functions."""
        for one in commands:
            about = (one.__doc__ or "").splitlines()[0]  # whole: typer would cut it
            name = one.__name__.replace("_", "-")
            self.command(name, cls=_Command, short_help=about)(one)
            self.names.append(name)

    def add_group(self, name: str, group: Group, open: bool = False) -> None:
        """Add a group of commands; open: its commands work without its name too, and no help says so."""
        self.add_typer(group, name=name, short_help=group.about)
        self.names.append(name)
        self.open += [name] if open else []
