"""Followed states, of an atlas or of a load path, as frames of a FOLD file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from origami_nlp.arguments import check_type
from origami_nlp.folding import save_fold


@runtime_checkable
class Framed(Protocol):
    """What was followed."""

    def to_fold(self) -> dict[str, Any]:
        """Return its states as FOLD data, one frame each."""


def write_frames(followed: Framed, target: str | Path) -> None:
    """Write the states along all paths as a FOLD file.

    Parameters
    ----------
    followed
        Of `follow` or `load_path`.
    target
        The file, written whole or not at all; ``"-"`` for standard output.

    Raises
    ------
    OptionError
        If `followed` is neither, or the file cannot be written.
    """
    check_type("followed", followed, Framed)
    save_fold(followed.to_fold(), target)
