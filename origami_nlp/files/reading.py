"""Bytes of a file that a user names, or of standard input: one clear line where they cannot be had."""

from __future__ import annotations

import codecs
import json
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_path
from origami_nlp.errors import OrigamiError

MOST_PARTS = 100
"""Parts of a dotted key; `tomllib` takes time and memory that grow with their square."""
_PART = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*\.[ \t]*{_PART}){{{MOST_PARTS}}}")


def read_limited(source: str | Path, largest: int, what: str, error: type[OrigamiError]) -> bytes:
    """Read a file that a user names, if it is not too large.

    Parameters
    ----------
    source
        The file, or ``"-"`` for standard input.
    largest
        Bytes that are read at most.
    what
        How messages call it, such as "scene".
    error
        Class of the complaint.

    Returns
    -------
    bytes
        What it holds, without a byte order mark, which some editors put before UTF-8.

    Raises
    ------
    error
        If it cannot be read, or is larger.
    OptionError
        If `source` is no path.
    """
    check_path(f"source of the {what}", source)
    if str(source) == "-":
        if sys.stdin is None:
            raise error(f"cannot read {what} '-': standard input is closed")
        raw = sys.stdin.buffer.read(largest + 1)
    else:
        try:
            with open(source, "rb") as file:
                raw = file.read(largest + 1)
        except (OSError, ValueError) as problem:  # ValueError: a null character in the name
            why = getattr(problem, "strerror", None) or problem
            raise error(f"cannot read {what} {str(source)!r}: {why}") from None
    if len(raw) > largest:
        raise error(
            f"{what} {str(source)!r} is larger than {largest // 10**6} MB: not a {what} file"
        )
    return raw.removeprefix(codecs.BOM_UTF8)


def read_json(source: str | Path, largest: int, what: str, error: type[OrigamiError]) -> Any:
    """Read a JSON file that a user names.

    Parameters
    ----------
    source, largest, what, error
        As of `read_limited`.

    Returns
    -------
    object
        What the file holds.

    Raises
    ------
    error
        If it cannot be read, is larger, or is no JSON: NaN and Infinity are none.
    OptionError
        If `source` is no path.
    """
    raw = read_limited(source, largest, what, error)
    try:
        return json.loads(raw, parse_constant=_refuse)
    except RecursionError:
        raise error(f"{what} {str(source)!r} is no JSON file: too deeply nested") from None
    except ValueError as problem:
        raise error(f"{what} {str(source)!r} is no JSON file: {problem}") from None


def _refuse(name: str) -> float:
    raise ValueError(f"{name} is no number there")


def parse_toml(text: str, what: str, error: type[OrigamiError]) -> dict[str, Any]:
    """Read TOML text.

    Parameters
    ----------
    text
        The text.
    what
        How messages call it, such as "scene".
    error
        Class of the complaint.

    Returns
    -------
    dict
        Its tables.

    Raises
    ------
    error
        If it is no TOML, or has a dotted key of more than `MOST_PARTS` parts.
    """
    if _LONG_KEY.search(text):
        raise error(
            f"{what} has a key of more than {MOST_PARTS} dotted parts: no key of ours has more than two"
        )
    try:
        return tomllib.loads(text)
    except (
        ValueError,
        RecursionError,
    ) as problem:  # TOMLDecodeError, or an integer of too many digits
        raise error(f"{what} is not valid TOML: {str(problem).splitlines()[0]}") from None
