"""The console of every command: rich's, which reads nothing as markup and cuts nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from origami_nlp.io.writing import Target, is_stdout

if TYPE_CHECKING:
    from rich.console import Console

WIDE = 1_000_000
"""Columns of a file or a pipe, which has no edge at which to fold."""


def screen(*targets: Target | None) -> Console:
    """Return the console for people: standard error where one of the files to write is standard output.

    Parameters
    ----------
    targets
        Files that will be written, None for those that will not.

    Returns
    -------
    rich.console.Console
        The console.
    """
    from rich.console import Console

    console = Console(
        stderr=any(map(is_stdout, targets)),
        markup=False,
        emoji=False,
        highlight=False,
        soft_wrap=True,
    )
    if not console.is_terminal:
        console.width = WIDE
    return console
