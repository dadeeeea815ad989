"""Bytes of a file that a user names, or of standard input: one clear line where they cannot be had."""

from __future__ import annotations

import sys
from pathlib import Path

from origami_nlp.errors import OrigamiError
from origami_nlp.state.arguments import check_path


def read_limited(source: str | Path, largest: int, what: str, error: type[OrigamiError]) -> bytes:
    """Read a file, or standard input for ``"-"``, up to `largest` bytes.

    what: how messages call it, such as "scene".

    Raises
    ------
    error
        If it cannot be read, or is larger.
    OptionError
        If `source` is no path.
    """
    check_path(f"source of the {what}", source)
    if str(source) == "-":
        raw = sys.stdin.buffer.read(largest + 1)
    else:
        try:
            with open(source, "rb") as file:
                raw = file.read(largest + 1)
        except OSError as problem:
            raise error(f"cannot read {what} {str(source)!r}: {problem.strerror}") from None
    if len(raw) > largest:
        raise error(
            f"{what} {str(source)!r} is larger than {largest // 10**6} MB: not a {what} file"
        )
    return raw
