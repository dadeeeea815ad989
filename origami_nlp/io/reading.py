"""Bytes of a file that a user names, or of standard input: one clear line where they cannot be had."""

from __future__ import annotations

import codecs
import json
import re
import sys
import tomllib
from collections.abc import Collection, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_path, shown
from origami_nlp.errors import OrigamiError

MOST_PARTS = 100
"""Parts of a dotted key; `tomllib` takes time and memory that grow with their square."""
_PART = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*\.[ \t]*{_PART}){{{MOST_PARTS}}}")


def read_limited(
    source: str | PathLike[str], largest: int, what: str, error: type[OrigamiError]
) -> bytes:
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
        raise error(f"{what} {str(source)!r} is larger than {largest // 10**6} MB")
    if not raw.strip():
        name = "standard input" if str(source) == "-" else f"{what} {str(source)!r}"
        raise error(f"{name} is empty")
    return raw.removeprefix(codecs.BOM_UTF8)


def read_json(
    source: str | PathLike[str], largest: int, what: str, error: type[OrigamiError]
) -> Any:
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
        If it cannot be read, is larger, or is no JSON: NaN and Infinity are not JSON.
    OptionError
        If `source` is no path.
    """
    raw = read_limited(source, largest, what, error)
    return parse_json(raw, f"{what} {str(source)!r}", error)


def parse_json(text: str | bytes, what: str, error: type[OrigamiError]) -> Any:
    """Parse JSON, in which every number is finite.

    Parameters
    ----------
    text
        All of it.
    what
        Its name, for complaints.
    error
        What to raise.

    Returns
    -------
    Any
        Its data.
    """
    try:
        return json.loads(text, parse_constant=_refuse)
    except (ValueError, RecursionError) as problem:
        deep = isinstance(problem, RecursionError)
        why = "it is nested too deeply" if deep else str(problem).splitlines()[0]
        raise error(f"{what} is not valid JSON: {why}") from None


def _refuse(name: str) -> float:
    raise ValueError(f"{name} is no number there: write null or a number")


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
        raise error(f"{what} has a key of more than {MOST_PARTS} dotted parts")
    try:
        return tomllib.loads(text)
    except (
        ValueError,
        RecursionError,
    ) as problem:  # TOMLDecodeError, or an integer of too many digits
        raise error(f"{what} is not valid TOML: {str(problem).splitlines()[0]}") from None


def read_toml(
    source: str | Path, largest: int, what: str, error: type[OrigamiError]
) -> dict[str, Any]:
    """Read the tables of a TOML file that a user names.

    Parameters
    ----------
    source, largest
        As for `read_limited`.
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
        As of `read_limited` and `parse_toml`.
    """
    raw = read_limited(source, largest, what, error)
    name = f"{what} {str(source)!r}"
    return parse_toml(as_text(raw, name, error), name, error)


def as_text(raw: bytes, what: str, error: type[OrigamiError]) -> str:
    """Return the text that the bytes of a file are.

    Parameters
    ----------
    raw
        The bytes.
    what
        How a message calls the file, with its name.
    error
        Class of the complaint.

    Returns
    -------
    str
        They read as UTF-8.

    Raises
    ------
    error
        If they are not of this type.
    """
    try:
        return raw.decode()
    except UnicodeDecodeError as problem:
        raise error(f"{what} is not UTF-8 text: {problem.reason}") from None


def check_tables(
    data: Mapping[str, Any],
    known: Mapping[str, Collection[str]],
    whole: str,
    error: type[OrigamiError],
    lists: Collection[str] = (),
) -> None:
    """Raise an error for what a file of tables cannot have.

    Parameters
    ----------
    data
        The tables.
    known
        Keys of each table; with none of a table they are not looked at.
    whole
        How messages begin to say which tables there are, such as "a scene has".
    error
        Class of the complaint.
    lists
        Tables that stand in lists.

    Raises
    ------
    error
        If a table or one of its keys is unknown, or what must be a table is not one.
    """
    for table, content in data.items():
        if table not in known:
            raise error(f"unknown table [{table}]: {whole} {', '.join(known)}")
        many = isinstance(content, list)
        entries = content if many else [content]
        if many != (table in lists) or not all(isinstance(one, Mapping) for one in entries):
            should = f"a list of tables: write [[{table}]]" if table in lists else "a table"
            raise error(f"{table} = {shown(content)} must be {should}")
        for key in (key for one in entries for key in one if known[table]):
            if key not in known[table]:
                takes = ", ".join(known[table])
                raise error(f"unknown key {key!r} in [{table}]: it takes {takes}")


def one_of(
    table: Mapping[str, Any], name: str, keys: Collection[str], error: type[OrigamiError]
) -> str:
    """Return which one of some keys a table has.

    Parameters
    ----------
    table
        Of a file.
    name
        How messages call it.
    keys
        Of which it must have one.
    error
        Class of the complaint.

    Returns
    -------
    str
        The one.

    Raises
    ------
    error
        If it has none of them, or several.
    """
    given = [key for key in keys if key in table]
    if len(given) != 1:
        found = ", ".join(given) or "none"
        raise error(f"{name} needs exactly one of {', '.join(keys)}: found {found}")
    return given[0]
