"""Files are written whole or not at all, and complained about before long work starts."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from origami_nlp.errors import OptionError


def write_whole(target: str | os.PathLike[str], content: bytes) -> None:
    """Write a file by way of a temporary one beside it, so that no reader sees half of it."""
    check_writable(target, "file")
    path = Path(target)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=path.name, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def check_writable(target: str | os.PathLike[str] | None, option: str) -> None:
    """Complain early, before long work, about a file that could not be written.

    Raises
    ------
    OptionError
        If the folder does not exist or the target is a folder.
    """
    if target is None or str(target) == "-":
        return
    path = Path(target)
    if path.is_dir():
        raise OptionError(f"{option} = {str(target)!r} is a folder: give a file name")
    if not path.parent.is_dir():
        raise OptionError(f"{option} = {str(target)!r}: folder {str(path.parent)!r} does not exist")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise OptionError(f"{option} = {str(target)!r}: no permission to write there")
