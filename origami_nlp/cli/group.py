"""A group of commands: listed in the order in which they are added, each with the first line of its docstring."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import typer
from typer.core import TyperGroup

Command = Callable[..., None]


class _Listed(TyperGroup):
    """A group whose help lists its commands in the order of `Group.names`: typer would put groups last."""

    names: list[str]

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names that are shown."""
        return self.names


class Group(typer.Typer):
    """Commands, and groups of them, under one name.

    Parameters
    ----------
    help
        What the group is about.
    """

    def __init__(self, help: str) -> None:
        self.about, self.names = help, list[str]()
        super().__init__(
            cls=type("Listed", (_Listed,), {"names": self.names}),
            help=help,
            no_args_is_help=True,
            add_completion=False,
            pretty_exceptions_enable=False,
            rich_markup_mode=None,  # rich takes "[rad]" for markup and drops it
        )

    def add(self, *commands: Command, hidden: bool = False) -> None:
        """Add commands under the names of their functions; hidden: they work, and no help lists them."""
        for one in commands:
            about = (one.__doc__ or "").splitlines()[0]  # whole: typer would cut it
            self.command(one.__name__, short_help=about, hidden=hidden)(one)
            self.names += [] if hidden else [one.__name__]

    def add_group(self, name: str, group: Group) -> None:
        """Add a group of commands."""
        self.add_typer(group, name=name, short_help=group.about)
        self.names.append(name)
