"""What a machine reads as a statement: its form is checked before any proof starts.

A check decides what its statement says.  Text that says nothing, a number where a formula belongs or
a formula in unknown symbols must therefore never reach it: `Form.read` ends with a `StatementError`
that names the place, what was found and what belongs there.  `form_of` reads the form off a printed
statement (same kind, same length, same symbols); forms that cannot be read off are given by the claim.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import sympy as sp
from sympy.core.function import AppliedUndef

from origami_nlp.errors import OrigamiError


class StatementError(OrigamiError):
    """A statement that no machine can read: another kind, length, word or symbol than the claim's."""


class Form(Protocol):
    """What the statements of one claim are made of."""

    def read(self, value: Any, field: str) -> None:
        """Accept `value`, or raise a `StatementError` that names `field`."""


def _refuse(value: Any, field: str, wanted: str) -> StatementError:
    shown = repr(value)
    shown = shown if len(shown) <= 60 else shown[:57] + "..."
    return StatementError(f"{field}: {shown} is not {wanted}; give {wanted}")


@dataclass(frozen=True)
class Ratio:
    """An exact rational number; a multiple of `step` (0: any), and at least `least`."""

    step: Any = 0
    least: Any = -sp.oo

    def read(self, value: Any, field: str) -> None:
        """Accept a Python int or a SymPy rational of the right size."""
        exact = isinstance(value, int | sp.Rational) and not isinstance(value, bool)
        if not exact or value < self.least or (self.step and value % self.step):
            least = "" if self.least == -sp.oo else f" of at least {self.least}"
            kind = f"a multiple of {self.step}" if self.step else "an exact rational number"
            raise _refuse(value, field, kind + least)


WHOLE = Ratio(1)
DEGREE = Ratio(2, least=6)
"""Degree of a cone."""


@dataclass(frozen=True)
class Formula:
    """An exact SymPy expression in these symbols (None: in any), numbers included."""

    symbols: frozenset[Any] | None = frozenset()

    def read(self, value: Any, field: str) -> None:
        """Accept an expression without foreign symbols, floats or undefined values."""
        names = None if self.symbols is None else sorted(map(str, self.symbols))
        wanted = "an exact formula" + (
            "" if names is None else f" in {', '.join(names) or 'nothing'}"
        )
        if isinstance(value, bool) or not isinstance(value, int | sp.Expr):
            raise _refuse(value, field, wanted)
        expr = sp.sympify(value)
        used = expr.free_symbols | expr.atoms(AppliedUndef)
        if self.symbols is not None and not used <= self.symbols:
            raise _refuse(value, field, wanted)
        if expr.has(sp.Float, sp.nan, sp.zoo, sp.oo, -sp.oo):
            raise _refuse(value, field, wanted)


@dataclass(frozen=True)
class Text:
    """A text that matches a regular expression as a whole; `says` names it."""

    pattern: str
    says: str

    def read(self, value: Any, field: str) -> None:
        """Accept a matching text."""
        if not isinstance(value, str) or re.fullmatch(self.pattern, value) is None:
            raise _refuse(value, field, self.says)


@dataclass(frozen=True)
class OneOf:
    """One of a few words or numbers, each of which the claim's check decides by itself."""

    words: tuple[Any, ...]

    def read(self, value: Any, field: str) -> None:
        """Accept one of the words."""
        plain = isinstance(value, str | int | sp.Integer | tuple) and not isinstance(value, bool)
        if not plain or value not in self.words:
            raise _refuse(value, field, f"one of {', '.join(map(repr, self.words))}")


def one_of(*words: Any) -> OneOf:
    """Form of a statement that is one of these words or numbers."""
    return OneOf(words)


@dataclass(frozen=True)
class Contact:
    """A tuple with these parts in this order."""

    parts: tuple[Form, ...]

    def read(self, value: Any, field: str) -> None:
        """Accept a tuple of the right length whose entries can be read."""
        if not isinstance(value, tuple) or len(value) != len(self.parts):
            raise _refuse(value, field, f"a tuple of {len(self.parts)}")
        for i, (part, entry) in enumerate(zip(self.parts, value, strict=True)):
            part.read(entry, f"{field}[{i}]")


def row(*parts: Form) -> Contact:
    """Form of a tuple with these parts."""
    return Contact(parts)


@dataclass(frozen=True)
class Several:
    """A tuple of one or more parts of one form: no claim is about nothing."""

    part: Form

    def read(self, value: Any, field: str) -> None:
        """Accept a tuple with at least one entry, all readable."""
        if not isinstance(value, tuple) or not value:
            raise _refuse(value, field, "a tuple of at least one part")
        for i, entry in enumerate(value):
            self.part.read(entry, f"{field}[{i}]")


@dataclass(frozen=True)
class Table:
    """A dictionary; `keys` all of them where they are a tuple, else the form of each (at least one)."""

    keys: Form | tuple[Any, ...]
    values: Form

    def read(self, value: Any, field: str) -> None:
        """Accept a dictionary with readable keys and values."""
        if not isinstance(value, Mapping) or not value:
            raise _refuse(value, field, "a table of at least one entry")
        if isinstance(self.keys, tuple):
            if set(value) != set(self.keys):
                raise _refuse(value, field, f"a table with the keys {self.keys}")
        else:
            for key in value:
                self.keys.read(key, f"{field}, key")
        for key, entry in value.items():
            self.values.read(entry, f"{field}[{key!r}]")


@dataclass(frozen=True)
class Grid:
    """A SymPy matrix of this shape with these symbols."""

    shape: tuple[int, int]
    symbols: frozenset[Any]

    def read(self, value: Any, field: str) -> None:
        """Accept a matrix of the right shape."""
        if not isinstance(value, sp.MatrixBase) or value.shape != self.shape:
            raise _refuse(value, field, f"a matrix of shape {self.shape}")
        for entry in value:
            Formula(self.symbols).read(entry, field)


@dataclass(frozen=True)
class Subset:
    """A set of real numbers inside `whole`."""

    whole: sp.Set

    def read(self, value: Any, field: str) -> None:
        """Accept a SymPy set inside the whole one."""
        if not isinstance(value, sp.Set) or value.is_subset(self.whole) is not True:
            raise _refuse(value, field, f"a set of numbers inside {self.whole}")


@dataclass(frozen=True)
class Maps:
    """A function: tried at `sample`, it must give something of the form `value`."""

    sample: tuple[Any, ...]
    value: Form

    def read(self, value: Any, field: str) -> None:
        """Accept a function that takes the sample and returns what can be read."""
        if not callable(value):
            raise _refuse(value, field, f"a function of {len(self.sample)} arguments")
        try:
            result = value(*self.sample)
        except (TypeError, ValueError, AttributeError, LookupError, ArithmeticError) as error:
            raise _refuse(value, field, f"a function of {len(self.sample)} arguments") from error
        self.value.read(result, f"{field}(...)")


@dataclass(frozen=True)
class Has:
    """An object with these attributes."""

    attributes: tuple[tuple[str, Form], ...]

    def read(self, value: Any, field: str) -> None:
        """Accept an object whose attributes can be read."""
        for name, form in self.attributes:
            if not hasattr(value, name):
                raise _refuse(value, field, f"an object with the attribute {name!r}")
            form.read(getattr(value, name), f"{field}.{name}")


def has(**attributes: Form) -> Has:
    """Form of an object with these attributes."""
    return Has(tuple(attributes.items()))


@dataclass(frozen=True)
class That:
    """A form with one more condition; `says` names what belongs there."""

    form: Form
    holds: Callable[[Any], bool]
    says: str

    def read(self, value: Any, field: str) -> None:
        """Accept what the form accepts and the condition holds for."""
        self.form.read(value, field)
        if not self.holds(value):
            raise _refuse(value, field, self.says)


def formula(*symbols: Any) -> Formula:
    """Form of an exact expression in these symbols."""
    return Formula(frozenset(symbols))


def form_of(printed: Any) -> Form:
    """The form of a printed statement: whole numbers, formulas, matrices and tuples of those.

    Raises `TypeError` for anything else: a bare word or a function is no statement by itself, its
    claim must say what else could stand there.
    """
    if isinstance(printed, int | sp.Integer) and not isinstance(printed, bool):
        return WHOLE
    if isinstance(printed, sp.Expr):
        return Formula(frozenset(printed.free_symbols))
    if isinstance(printed, sp.MatrixBase):
        return Grid(printed.shape, frozenset(printed.free_symbols))
    if isinstance(printed, tuple):
        return Contact(tuple(form_of(part) for part in printed))
    raise TypeError(f"{printed!r} has no form of its own: the claim must give one")
