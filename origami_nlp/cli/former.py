"""Names of options and commands that were others before: each works for one more version, and says so."""

from __future__ import annotations

import sys

OPTIONS: dict[str, dict[str, str]] = {
    "cone count": {"--elevation": "--rest-elevation"},
    "cone full": {"--elevation": "--rest-elevation"},
    "cone speed": {"--points": "--samples"},
    "critical": {"--search": "--compare", "--no-search": "--no-compare"},
    "space": {"--size": "--rings"},
    "transitions": {"--size": "--rings"},
}
"""Of each command, the former names of its options and those of now."""
COMMANDS: dict[str, str] = {
    **{
        name: f"paper {name}" for name in ("demo", "panels", "reproduce", "verify", "audit", "grid")
    },
    "cone fractions": "paper fractions",
    "cone limits": "paper limits",
}
"""Former names of commands, and those of now."""


def say_former(former: str, now: str) -> None:
    """Say on standard error that a name has changed."""
    print(
        f"note: {former} is now {now}; the former name works for one more version", file=sys.stderr
    )


def renamed(path: str, arguments: list[str], quiet: bool) -> list[str]:
    """Return the arguments of a command with the option names of now.

    Parameters
    ----------
    path
        The command, such as ``"cone count"``.
    arguments
        What follows it; after ``--`` there are no options.
    quiet
        Say nothing of former names.
    """
    table = OPTIONS.get(path, {})
    end = arguments.index("--") if "--" in arguments else len(arguments)
    found = []
    for argument in arguments[:end]:
        name, equals, value = argument.partition("=")
        if now := table.get(name):
            if not quiet:
                say_former(name, now)
            argument = now + equals + value
        found.append(argument)
    return found + arguments[end:]
