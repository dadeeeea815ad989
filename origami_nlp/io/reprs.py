"""Objects on one line: numbers rounded, long lists cut, arrays by their shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from textwrap import shorten
from typing import Any

import numpy as np

MOST = 12
"""Numbers of a list that are shown; of a longer one the first three and the last."""
WORDS, LINE = 48, 220
"""Characters of a text, and of the whole."""


class ShortRepr:
    """A dataclass (``repr=False``) whose repr is short; what is in it is in its attributes.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> from origami_nlp.io import ShortRepr
    >>> @dataclass(repr=False)
    ... class Found(ShortRepr):
    ...     energy: float
    ...     states: tuple
    >>> Found(2 / 3, tuple(range(100)))
    Found(energy=0.666667, states=[0, 1, 2, ..., 99])
    """

    def __repr__(self) -> str:
        own = [f for f in fields(self) if f.repr]  # type: ignore[arg-type]
        entries = ", ".join(f"{f.name}={short_repr(getattr(self, f.name))}" for f in own)
        return f"{type(self).__name__}({shorten(entries, LINE, placeholder=' ...')})"


class PrettyRepr:
    """An object whose ``str`` says all and whose ``repr`` is one line; alone in a Jupyter cell it shows all."""

    def __init_subclass__(cls, **given: Any) -> None:
        super().__init_subclass__(**given)
        cls._repr_pretty_ = PrettyRepr._repr_pretty_  # type: ignore[method-assign]  # else IPython takes a subclass's repr

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        alone = not cycle and len(getattr(printer, "stack", ())) <= 1  # and not within a list
        printer.text(str(self) if alone else repr(self))


def cut(texts: Sequence[str]) -> str:
    """Return texts with commas between; of more than `MOST` the first three and the last.

    Parameters
    ----------
    texts
        One an entry.

    Returns
    -------
    str
        Such as ``"1, 2, 3, ..., 9"``.
    """
    return ", ".join(texts if len(texts) <= MOST else [*texts[:3], "...", texts[-1]])


def short_repr(value: Any) -> str:
    """Return a value on a part of a line.

    Parameters
    ----------
    value
        Anything.

    Returns
    -------
    str
        Numbers to six digits, long texts and lists cut, arrays by their shape, objects by their class.
    """
    if isinstance(value, bool | int) or value is None:
        return repr(value)
    if isinstance(value, float | np.floating):
        return f"{value:.6g}"
    if isinstance(value, str):
        return repr(shorten(value, WORDS, placeholder=" ..."))
    if isinstance(value, np.ndarray):
        return f"array{list(value.shape)}"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{short_repr(k)}: {short_repr(v)}" for k, v in value.items()) + "}"
    if is_dataclass(value):
        return f"{type(value).__name__}(...)"
    if isinstance(value, list | tuple):
        if any(
            isinstance(entry, list | tuple | np.ndarray) or is_dataclass(entry) for entry in value
        ):
            return f"[{len(value)} x {type(value[0]).__name__}]"
        return f"[{cut([short_repr(entry) for entry in value])}]"
    return f"{type(value).__name__}(...)"
