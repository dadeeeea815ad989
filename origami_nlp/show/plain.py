"""Results as plain JSON data and back, from the fields of their dataclasses.

`to_plain` writes a whole dataclass, `pick` some of it under other names, and `from_plain` reads it back by the
types that the fields state.  JSON has no nan and no inf: both are written as null.  A schema is a name with a version,
such as ``origami-nlp/minima/1``, under the key ``schema`` of the outermost object.
"""

from __future__ import annotations

import math
import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from origami_nlp.errors import OrigamiError

T = TypeVar("T")


def to_plain(value: Any) -> Any:
    """Return a value as lists, dictionaries, texts, numbers and None.

    Dataclasses and named tuples become dictionaries of all their fields, in order; tuples and arrays lists;
    nan and inf None.

    Parameters
    ----------
    value
        Any of these.

    Returns
    -------
    object
        What JSON can hold.

    Raises
    ------
    TypeError
        If something is in it that is neither of these.

    Examples
    --------
    >>> from origami_nlp.show import to_plain
    >>> to_plain((1, float("nan"), {"a": (2.0,)}))
    [1, None, {'a': [2.0]}]
    """
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, np.ndarray | np.generic):
        listed = value.tolist()
        kind = value.dtype.kind
        exact = kind in "biuU" or (kind == "f" and bool(np.isfinite(value).all()))
        return listed if exact else to_plain(listed)
    if isinstance(value, Mapping):
        return {key: to_plain(entry) for key, entry in value.items()}
    names = _names(type(value))
    if names:
        left_out = {
            f.name
            for f in (fields(value) if is_dataclass(value) else ())
            if f.metadata.get("omit") and getattr(value, f.name) == f.default
        }
        return {name: to_plain(getattr(value, name)) for name in names if name not in left_out}
    if isinstance(value, list | tuple):
        return [to_plain(entry) for entry in value]
    raise TypeError(f"{type(value).__name__} has no plain form")


def pick(value: Any, *keys: str, **more: Any) -> dict[str, Any]:
    """Return some attributes of an object as a plain dictionary.

    Parameters
    ----------
    value
        The object.
    keys
        ``"name"``, or ``"key=name"`` for an attribute that is written under another key; ``"a.b"`` is an attribute of
        an attribute.
    more
        Entries that are no attributes; a key among `keys` that is given here keeps its place there.

    Returns
    -------
    dict
        What JSON can hold.
    """
    out: dict[str, Any] = {}
    for text in keys:
        key, _, path = text.partition("=")
        if key in more:
            out[key] = to_plain(more.pop(key))
            continue
        found = value
        for name in (path or key).split("."):
            found = getattr(found, name)
        out[key] = to_plain(found)
    return out | to_plain(more)


def from_plain(kind: type[T], data: Mapping[str, Any], null: Mapping[str, float] = {}) -> T:
    """Read a dataclass or named tuple back from what `to_plain` wrote; keys that are no fields are left alone.

    Parameters
    ----------
    kind
        The class.
    data
        Its fields.
    null
        What null stands for in fields of numbers, by name of the field; nan where nothing is said.

    Returns
    -------
    object
        Of that class.

    Raises
    ------
    TypeError, ValueError
        If an entry is missing that has no default, or is of the wrong form.
    """
    hints = get_type_hints(kind)
    given = {n: _read(hints[n], data[n], null, n) for n in _names(kind) if n in data}
    return kind(**given)


def check_schema(data: Any, schema: str, error: type[OrigamiError]) -> None:
    """Complain about data that is no object of a schema.

    Parameters
    ----------
    data
        What was read.
    schema
        The schema's name with its version.
    error
        Class of the complaint.

    Raises
    ------
    error
        With the schema found and the one that is read.
    """
    found = data.get("schema") if isinstance(data, dict) else data
    if not isinstance(data, dict) or found != schema:
        raise error(f"schema = {repr(found)[:60]}: this reads {schema!r}")


def _read(hint: Any, value: Any, null: Mapping[str, float], name: str) -> Any:
    """Return one entry as the type that its field states."""
    origin = get_origin(hint)
    if origin in (Union, types.UnionType):
        if value is None:
            return None
        hint = next(option for option in get_args(hint) if option is not type(None))
        return _read(hint, value, null, name)
    if hint is float:
        return null.get(name, math.nan) if value is None else float(value)
    if origin is tuple:
        kinds = get_args(hint)
        if len(kinds) == 2 and kinds[1] is Ellipsis:
            kinds = kinds[:1] * len(value)
        return tuple(_read(k, v, null, name) for k, v in zip(kinds, value, strict=True))
    if hint is np.ndarray:
        read = np.array(value)
        return read.astype(float) if read.dtype == object else read  # null among numbers
    return from_plain(hint, value, null) if _names(hint) else value


def _names(kind: Any) -> tuple[str, ...]:
    """Return the fields of a dataclass but those with ``plain`` false, or of a named tuple; none for other types."""
    if isinstance(kind, type) and is_dataclass(kind):
        return tuple(f.name for f in fields(kind) if f.metadata.get("plain", True))
    return tuple(getattr(kind, "_fields", ()))
