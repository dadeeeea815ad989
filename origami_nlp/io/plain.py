"""Plain data, as JSON holds it, from the fields of dataclasses and back by the types that they state.

A key is the name of its field.  nan and inf, which JSON does not have, are null: nan is read back, or inf where the
type is `Unbounded`.  Indices that are 0-based in arrays, `OneBased`, are 1-based in files.  Properties that a class
names in ``ALSO`` are written too, and left alone when they are read; a field whose metadata say ``plain=False`` is not
written, one with ``omit=True`` only where it is not its default.  Of several classes the one that is meant stands under
``type``.  A class with `_to_plain` and `_from_plain` has plain
data of its own, and so has one that names in ``PLAIN`` the functions of its room that write and read it.
"""

from __future__ import annotations

import math
import types
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cache
from importlib import import_module
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError, OrigamiError

if TYPE_CHECKING:
    from cattrs import Converter

T = TypeVar("T")

Unbounded = Annotated[float, "null is inf"]
"""A number that may be inf."""
Finite = Annotated[float, "never null"]
"""A number that is known."""
OneBased = Annotated[int, "1-based in files"]
"""An index, 0-based in arrays."""


def to_plain(value: Any) -> Any:
    """Return a value as lists, dictionaries, texts, numbers and None.

    Dataclasses and named tuples become dictionaries of their fields, in order; tuples and arrays lists; nan and inf
    None.

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
    >>> from origami_nlp.io import to_plain
    >>> to_plain((1, float("nan"), {"a": (2.0,)}))
    [1, None, {'a': [2.0]}]
    """
    return _converter().unstructure(value)


def from_plain(
    kind: type[T], data: Any, what: str = "", error: type[OrigamiError] = OptionError
) -> T:
    """Read a dataclass or named tuple back from what `to_plain` wrote.

    Parameters
    ----------
    kind
        The class.
    data
        Its fields.
    what
        How messages call the whole, such as a file.
    error
        Class of the complaint.

    Returns
    -------
    object
        Of that class.

    Raises
    ------
    error
        If an entry is missing, unknown, or not of the type that its field states: with its path, its value and what is
        expected.
    """
    try:
        return _converter().structure(data, kind)
    except (ValueError, TypeError, LookupError, AttributeError, ExceptionGroup) as problem:
        raise error(": ".join(filter(None, (what, _told(problem))))) from None


def check_schema(
    data: Any, schema: str, what: str = "", error: type[OrigamiError] = OptionError
) -> None:
    """Raise an error for data that is no object of a schema.

    Parameters
    ----------
    data
        What was read.
    schema
        The schema's name with its version.
    what
        How messages call the whole, such as a file.
    error
        Class of the complaint.

    Raises
    ------
    error
        With the schema found and the one that is read.
    """
    found = data.get("schema") if isinstance(data, dict) else data
    if not isinstance(data, dict) or found != schema:
        raise error(f"{what and f'{what}: '}schema = {shown(found)}: this reads {schema!r}")


class _Unfit(ValueError):
    """A value that is not what it should be."""

    def __init__(self, value: Any, expected: str) -> None:
        super().__init__(f"= {shown(value)} must be {expected}")


def _told(problem: BaseException, path: str = "") -> str:
    """Return the first complaint within a group of `cattrs` on one line, with its path, entries of lists from 1."""
    from cattrs import BaseValidationError, ForbiddenExtraKeysError

    for note in getattr(problem, "__notes__", ()):
        name, index = getattr(note, "name", None), getattr(note, "index", None)
        if name is not None:
            path += f".{name}" if path else name
        elif index is not None:
            path += f"[{index + 1 if isinstance(index, int) else index!r}]"
    if isinstance(problem, BaseValidationError):
        return _told(problem.exceptions[0], path)
    if isinstance(problem, OrigamiError) and not path:
        return str(problem)
    where = path or "data"
    if isinstance(problem, KeyError):
        key = str(problem.args[0])
        return f"{path if path.endswith(key) else '.'.join(filter(None, (path, key)))} is missing"
    if isinstance(problem, ForbiddenExtraKeysError):
        own: Any = problem.cl
        known = ", ".join(f.name for f in fields(own)) if is_dataclass(own) else own._fields
        return f"{where} has the unknown key {shown(min(problem.extra_fields))}: it takes {known}"
    return f"{where} {problem}" if isinstance(problem, _Unfit) else f"{where}: {problem}"


@cache
def _converter() -> Converter:
    """Return the converter; `cattrs` loads here."""
    from cattrs import Converter, cols, override
    from cattrs.gen import make_dict_structure_fn, make_dict_unstructure_fn
    from cattrs.strategies import use_class_methods

    made = Converter(
        unstruct_collection_overrides={tuple: list, list: list},
        unstructure_fallback_factory=_by_value,
    )

    def how(kind: type) -> dict[str, Any]:
        hints = get_type_hints(kind, include_extras=True)  # cattrs by itself drops the extras
        own = {}
        for f in fields(kind):
            f.type = hints[f.name]
            written, omit = f.metadata.get("plain", True), f.metadata.get("omit", False)
            own[f.name] = override(omit=None if written else True, omit_if_default=omit)
        return own

    def writes(kind: type) -> Callable[[Any], dict[str, Any]]:
        own: Callable[[Any], dict[str, Any]] = make_dict_unstructure_fn(kind, made, **how(kind))
        also = getattr(kind, "ALSO", ())
        if not also:
            return own
        return lambda v: own(v) | {name: made.unstructure(getattr(v, name)) for name in also}

    def reads(kind: type) -> Callable[[Any, Any], Any]:
        own: Any
        if get_origin(kind) is dict:
            own = cols.mapping_structure_factory(kind, made)
        elif cols.is_namedtuple(kind):
            own = cols.namedtuple_dict_structure_factory(kind, made, "from_converter", True)
        else:
            own = make_dict_structure_fn(kind, made, _cattrs_forbid_extra_keys=True, **how(kind))
        also = frozenset(getattr(kind, "ALSO", ()))

        def read(value: Any, _: Any) -> Any:
            data = _of(dict, value, "an object")
            return own({k: v for k, v in data.items() if k not in also} if also else data, kind)

        return read

    def reads_tuple(kind: Any) -> Callable[[Any, Any], Any]:
        kinds = get_args(kind)
        several = len(kinds) == 2 and kinds[1] is Ellipsis
        whole = types.GenericAlias(list, kinds[:1]) if several else kind
        own = (made.get_structure_hook if several else made.gen_structure_hetero_tuple)(whole)
        wanted = "a list" if several else f"a list of {len(kinds)}"

        def read(value: Any, _: Any) -> Any:
            listed = _of(list, value, wanted)
            if several and kinds[0] in (float, Finite) and all(type(v) is float for v in listed):
                return tuple(map(_number, listed))
            if not several and len(listed) != len(kinds):
                raise _Unfit(value, wanted)
            return tuple(own(listed, list if several else kind))

        return read

    def reads_union(kind: Any) -> Callable[[Any, Any], Any]:
        named = {one.__name__: one for one in get_args(kind)}

        def read(value: Any, _: Any) -> Any:
            data = dict(_of(dict, value, "an object"))
            return made.structure(data, named[_one_of(tuple(named), data.pop("type"))])

        return read

    made.register_unstructure_hook(float, lambda v: float(v) if math.isfinite(v) else None)
    made.register_unstructure_hook(int, int)
    made.register_unstructure_hook(bool, bool)
    made.register_unstructure_hook(type(None), lambda v: v)
    made.register_unstructure_hook(np.ndarray, _listed)
    made.register_unstructure_hook(np.generic, _listed)
    made.register_structure_hook(float, lambda v, _: math.nan if v is None else _number(v))
    made.register_structure_hook(np.ndarray, lambda v, _: _array(v))
    named: dict[Any, str] = {int: "a whole number", bool: "true or false", str: "a text"}
    for kind, words in named.items():
        made.register_structure_hook(kind, _exactly(words))
    made.register_structure_hook_factory(lambda t: get_origin(t) is tuple, reads_tuple)
    made.register_structure_hook_factory(
        lambda t: get_origin(t) is Literal, lambda t: lambda v, _: _one_of(get_args(t), v)
    )
    made.register_structure_hook_factory(_is_union, reads_union)
    made.register_unstructure_hook_func(
        _is_union, lambda v: {"type": type(v).__name__, **to_plain(v)}
    )
    made.register_unstructure_hook_factory(is_dataclass, writes)
    made.register_unstructure_hook_factory(
        cols.is_namedtuple, lambda t: cols.namedtuple_dict_unstructure_factory(t, made)
    )
    made.register_structure_hook_factory(
        lambda t: is_dataclass(t) or cols.is_namedtuple(t) or get_origin(t) is dict, reads
    )
    use_class_methods(made, "_from_plain", "_to_plain")
    made.register_unstructure_hook_factory(lambda t: hasattr(t, "PLAIN"), lambda t: _of_room(t, 0))
    made.register_structure_hook_factory(
        lambda t: hasattr(t, "PLAIN"),
        lambda t: lambda v, _: _of_room(t, 1)(_of(dict, v, "an object")),
    )
    made.register_structure_hook_func(
        lambda t: t == Unbounded, lambda v, _: math.inf if v is None else _number(v)
    )
    made.register_structure_hook_func(lambda t: t == Finite, lambda v, _: _number(v))
    made.register_structure_hook_func(
        lambda t: t == OneBased, lambda v, _: int(_of(int, v, "a whole number")) - 1
    )
    made.register_unstructure_hook_func(lambda t: t == OneBased, lambda v: int(v) + 1)
    return made


def _by_value(kind: Any) -> Callable[[Any], Any]:
    """Return what writes values of a type that says no more than their own class does."""
    if not isinstance(kind, type):
        return to_plain
    raise TypeError(f"{getattr(kind, '__name__', kind)} has no plain form")


def _is_union(kind: Any) -> bool:
    return get_origin(kind) in (Union, types.UnionType) and all(map(is_dataclass, get_args(kind)))


def _of_room(kind: Any, which: int) -> Callable[[Any], Any]:
    room = import_module(kind.__module__.rpartition(".")[0])
    function: Callable[[Any], Any] = getattr(room, kind.PLAIN[which])
    return function


def _of(kind: type, value: Any, expected: str) -> Any:
    if isinstance(value, kind) and (kind is bool or not isinstance(value, bool)):
        return value
    raise _Unfit(value, expected)


def _exactly(words: str) -> Callable[[Any, Any], Any]:
    return lambda value, kind: _of(kind, value, words)


def _one_of(words: tuple[Any, ...], value: Any) -> Any:
    if any(value == word and type(value) is type(word) for word in words):
        return value
    raise _Unfit(value, "one of " + ", ".join(map(repr, words)))


def _number(value: Any) -> float:
    good = isinstance(value, int | float) and not isinstance(value, bool)
    if good and abs(value) < math.inf and abs(value) < 2**1024:
        return float(value)
    raise _Unfit(value, "a finite number")


def _array(value: Any) -> np.ndarray:
    """Return nested lists of numbers, all of one shape, as an array; null among numbers is nan."""
    try:
        read = np.array(_of(list, value, "a list"))
        read = read.astype(float) if read.dtype == object else read
    except (ValueError, TypeError, OverflowError):
        read = np.array("")
    if read.dtype.kind not in "bif" or np.isinf(read).any():
        raise _Unfit(value, "finite numbers in lists that are equally long")
    return read


def _listed(value: Any) -> Any:
    """Return an array, or a number of NumPy, as lists and numbers."""
    listed = value.tolist()
    kind = value.dtype.kind
    exact = kind in "biuU" or (kind == "f" and bool(np.isfinite(value).all()))
    return listed if exact else to_plain(listed)
