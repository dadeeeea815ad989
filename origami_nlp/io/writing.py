"""One writer for every file: whole or not at all, and refused before long work starts.

A regular file is written beside its place and moved there, through symbolic links to what they point at, with
the mode that it had (or that the umask gives a new one).  Devices, pipes, process substitutions and names of
open descriptors such as /dev/stdout cannot be replaced: they are written straight.
"""

from __future__ import annotations

import io
import json
import os
import secrets
import stat
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from origami_nlp.errors import OptionError, OrigamiError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Target = str | os.PathLike[str]


def write_whole(target: Target, content: bytes) -> None:
    """Write a file so that no reader ever sees half of it.

    Parameters
    ----------
    target
        The file, or ``"-"`` for standard output.
    content
        What it shall hold.

    Raises
    ------
    OptionError
        If it cannot be written; what was there before is untouched, unless it is no regular file.
    """
    check_writable(target, "file")
    with _named(target, "file"):
        if is_stdout(target):
            _to_stdout(content)
        elif _is_replaceable(_status(target)):
            _replace(os.path.realpath(target), content)
        else:
            with open(target, "wb") as file:
                file.write(content)


def save_figure(figure: Figure, target: Target, dpi: float | Literal["figure"] = "figure") -> None:
    """Write a matplotlib figure by `write_whole`, in the format that its name ends in.

    Parameters
    ----------
    figure
        The figure.
    target
        The file.
    dpi
        Dots an inch; by default those that the figure was made with.

    Raises
    ------
    OptionError
        If the ending names no picture format, or the file cannot be written.
    """
    ending = Path(target).suffix.lower().lstrip(".")
    known = figure.canvas.get_supported_filetypes()
    if ending not in known:
        some = ", ".join(f".{e}" for e in ("png", "pdf", "svg", "jpg") if e in known)
        raise OptionError(f"figure = {_shown(target)} must end in a picture format: {some}")
    write_whole(target, figure_bytes(figure, ending, dpi))


def figure_bytes(figure: Figure, ending: str, dpi: float | Literal["figure"] = "figure") -> bytes:
    """Return a matplotlib figure in a format.

    Parameters
    ----------
    figure
        The figure.
    ending
        Of the files of the format, such as ``"png"``.
    dpi
        Dots an inch; by default those that the figure was made with.

    Returns
    -------
    bytes
        What a file of it holds.
    """
    content = io.BytesIO()
    figure.savefig(content, format=ending, dpi=dpi)
    return content.getvalue()


def is_stdout(target: Target | None) -> bool:
    """Return whether a target is standard output.

    Parameters
    ----------
    target
        ``"-"``, /dev/stdout, or another name of descriptor 1, is; None is not.

    Returns
    -------
    bool
        Whether it is.
    """
    if target is None or os.fspath(target) == "-":
        return target is not None
    there = _status(target)
    try:
        return there is not None and os.path.samestat(there, os.fstat(1))
    except OSError:  # it is closed
        return False


def check_writable(target: Target | None, option: str) -> None:
    """Raise an error early, before long work, for a file that could not be written.

    Where a file will be made, one is made and taken away again: permissions, read-only and virtual file
    systems are the system's to judge.  That the disk fills up later, nobody can know.

    Parameters
    ----------
    target
        The file; None is always good, and ``"-"`` where standard output is open.
    option
        How messages call it.

    Raises
    ------
    OptionError
        If the target is a folder, its folder does not exist, or nothing can be written there.
    """
    if target is None:
        return
    if os.fspath(target) == "-":
        if sys.stdout is None:
            raise OptionError(f"{option} = '-' cannot be written: standard output is closed")
        return
    with _named(target, option):
        there = _status(target)
        if not os.path.basename(target) or (there and stat.S_ISDIR(there.st_mode)):
            raise OptionError(f"{option} = {_shown(target)} is a folder: give a file name")
        folder = os.path.dirname(os.path.realpath(target))
        if not there and not os.path.isdir(folder):
            where = f"folder {_shown(folder)} does not exist"
            raise OptionError(f"{option} = {_shown(target)}: {where}")
        if not os.access(target if there else folder, os.W_OK):
            raise OptionError(f"{option} = {_shown(target)}: no permission to write there")
        if _is_replaceable(there):
            probe = _temporary(folder)
            open(probe, "xb").close()
            os.unlink(probe)


def check_outputs(*named: tuple[str, Target | None], read: Iterable[Target] = ()) -> None:
    """Check every target as `check_writable` does, that no two are one file, and that none is read.

    Parameters
    ----------
    named
        Pairs (option, target).
    read
        Files that are read.

    Raises
    ------
    OptionError
        If one cannot be written, or would overwrite another.
    """
    seen = {os.path.realpath(path): "the file that is read" for path in read}
    for option, target in named:
        check_writable(target, option)
        if target is None or is_stdout(target) or not _is_replaceable(_status(target)):
            continue
        if (place := os.path.realpath(target)) in seen:
            raise OptionError(f"{option} = {_shown(target)} is {seen[place]} too")
        seen[place] = f"the file of {option}"


def make_folder(folder: Target, option: str) -> Path:
    """Make a folder where there is none, with those above it.

    Parameters
    ----------
    folder
        The folder.
    option
        How messages call it.

    Returns
    -------
    pathlib.Path
        The folder.

    Raises
    ------
    OptionError
        If it cannot be made.
    """
    with _named(folder, option):
        if os.path.isfile(folder):
            raise OptionError(f"{option} = {_shown(folder)} is a file: name a folder")
        os.makedirs(folder, exist_ok=True)
    return Path(folder)


@contextmanager
def _named(target: Target, option: str) -> Iterator[None]:
    """Turn every complaint of the system into one line that names the option and its value."""
    try:
        yield
    except (OrigamiError, BrokenPipeError):  # a reader that has gone is no complaint
        raise
    except (OSError, ValueError) as error:  # ValueError: a name with a null character in it
        why = getattr(error, "strerror", None) or str(error)
        raise OptionError(f"{option} = {_shown(target)} cannot be written: {why}") from None


def _shown(target: Target) -> str:
    text = repr(os.fspath(target))
    return text if len(text) <= 120 else f"{text[:60]}...{text[-57:]}"


def _status(target: Target) -> os.stat_result | None:
    """Return what the system knows of a file, links followed; None where there is none yet."""
    try:
        return os.stat(target)
    except FileNotFoundError:
        return None


def _is_replaceable(there: os.stat_result | None) -> bool:
    return there is None or stat.S_ISREG(there.st_mode)


def _temporary(folder: str) -> str:
    # short: the name of the file itself may be as long as the system allows
    return os.path.join(folder, f".{secrets.token_hex(8)}.part")


def _replace(path: str, content: bytes) -> None:
    """Write a file beside `path` and move it there; the mode stays, or is what the umask says."""
    there = _status(path)
    temporary = _temporary(os.path.dirname(path))
    try:
        with open(temporary, "xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if there is not None:
            if hasattr(os, "chown"):
                with suppress(PermissionError):  # only root may give files away
                    os.chown(temporary, there.st_uid, there.st_gid)
            os.chmod(temporary, stat.S_IMODE(there.st_mode))
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)
        raise


def _to_stdout(content: bytes) -> None:
    sys.stdout.flush()
    buffer = getattr(sys.stdout, "buffer", None)  # notebooks have none
    if buffer is None:
        sys.stdout.write(content.decode())
    else:
        buffer.write(content)
    sys.stdout.flush()


def write_json(data: Any, target: str | Path) -> None:
    """Write JSON to a file, whole or not at all.

    Parameters
    ----------
    data
        Plain data, without nan and inf.
    target
        The file, or ``"-"`` for standard output.

    Raises
    ------
    OptionError
        If the file cannot be written.
    """
    text = json.dumps(data, indent=2, allow_nan=False) + "\n"
    write_whole(target, text.encode())
