"""Rows as straight-line programs: what NumPy computes of angles by sums and products is noted once, and C runs it.

The rows of a scene are computed with `Traced` numbers in place of arrays of boxes, which note every operation.  What is
noted is the computation itself: each operation on doubles, rounded once, in the order of NumPy's; so what `affine`
proves of its rounding (bounds of sums in any order, and of products) holds of it.  Left out is what changes no value:
operations on numbers that are known (done at once, in the same doubles), products with 0 and 1 and sums with 0, which
are exact for what is finite, and what was computed before.  Sines and cosines are NumPy's: they are arguments.  So are
springs: a vertex is noted once, whatever its springs are.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, fields
from typing import Any, Protocol

import numpy as np

from origami_nlp.numerics import address
from origami_nlp.proof.affine import Affine, Turn
from origami_nlp.proof.angles import Angles
from origami_nlp.proof.compiled_boxes import CODES, LANES, library
from origami_nlp.proof.law_torques import LawTorques

LOAD, STORE, KEEP, ADD, SUB, MUL, NEG, ABS, DIV, ROOT, MOST, AT_MOST = range(len(CODES))
UNARY = frozenset((NEG, ABS, ROOT))


class EnclosedRows(Protocol):
    """Rows of so many variables."""

    size: int
    laws: LawTorques | None

    @property
    def geometry(self) -> tuple[Hashable, ...]: ...  # noqa: D102
    @property
    def springs(self) -> np.ndarray: ...  # noqa: D102

    def enclosed(self, angles: Angles) -> tuple[Affine, Affine]: ...  # noqa: D102


class Traced:
    """A number that notes what is computed of it.

    Parameters
    ----------
    tape
        The operations so far, [code, first, second], each once, and their numbers.
    at
        Its own number.
    """

    __slots__ = ("at", "tape")

    def __init__(self, tape: dict[tuple[Any, ...], Traced], at: int) -> None:
        self.tape, self.at = tape, at

    def noted(self, code: int, a: int, b: Any = 0) -> Traced:
        """Return the result of an operation on numbers noted before."""
        key = code, a, b
        found = self.tape.get(key)
        if found is None:
            found = self.tape[key] = Traced(self.tape, len(self.tape))
        return found

    def number(self, other: Any) -> int:
        """Return the number under which something is noted."""
        return other.at if type(other) is Traced else self.noted(KEEP, 0, float(other)).at

    def __add__(self, other: Any) -> Traced:
        if type(other) is not Traced and other == 0:
            return self
        a, b = self.at, self.number(other)
        return self.noted(ADD, a, b) if a < b else self.noted(ADD, b, a)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Traced:
        if type(other) is not Traced and other == 0:
            return self
        return self.noted(SUB, self.at, self.number(other))

    def __rsub__(self, other: Any) -> Traced:
        return -self if other == 0 else self.noted(SUB, self.number(other), self.at)

    def __mul__(self, other: Any) -> Any:
        if type(other) is not Traced:
            if other == 0:
                return 0.0
            if other == 1:
                return self
            if other == -1:
                return -self
        a, b = self.at, self.number(other)
        return self.noted(MUL, a, b) if a < b else self.noted(MUL, b, a)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Traced:
        return self.noted(DIV, self.at, self.number(other))

    def __neg__(self) -> Traced:
        return self.noted(NEG, self.at)

    def __abs__(self) -> Traced:
        return self.noted(ABS, self.at)

    def __pow__(self, other: int) -> Any:
        return self * self  # NumPy squares so too

    def sqrt(self) -> Traced:
        """Return the square root; NumPy calls it by this name."""
        return self.noted(ROOT, self.at)


def length(vectors: np.ndarray, least: float) -> np.ndarray:
    """Return the lengths of vectors [3, K], or `least` where they are shorter, [K]."""
    out = np.sqrt((vectors**2).sum(axis=0))
    if out.dtype != object:
        return np.maximum(out, least)
    return np.frompyfunc(lambda v: v.noted(MOST, v.at, v.number(least)), 1, 1)(out)


def at_most(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return 1.0 where a <= b, 0.0 elsewhere."""
    if object not in (a.dtype, b.dtype):
        return (a <= b).astype(float)

    def noted(x: Any, y: Any) -> Any:
        some = x if type(x) is Traced else y
        return some.noted(AT_MOST, some.number(x), some.number(y))

    return np.frompyfunc(noted, 2, 1)(a, b)


def _arguments(angles: Angles) -> list[np.ndarray]:
    """Return what rows are computed of, [rows, K] each."""
    turns = [getattr(t, f.name) for t in (angles.whole, angles.halves) for f in fields(Turn)]
    torques = () if angles.torque is None else angles.torque
    return [angles.middle, angles.half, angles.sines, angles.share[None], *turns, *torques]


def _traced_angles(n: int, laws: bool) -> tuple[Angles, dict[tuple[Any, ...], Traced]]:
    """Return the angles of one box as numbers that note, and what they note to."""
    tape: dict[tuple[Any, ...], Traced] = {}
    nothing = Traced(tape, 0)

    def rows(count: int) -> np.ndarray:
        return np.array([[nothing.noted(LOAD, len(tape))] for _ in range(count)], dtype=object)

    middle, half, sines, share = (rows(k) for k in (n, n, 2, 1))
    whole, halves = (Turn(*(rows(n) for _ in fields(Turn))) for _ in range(2))
    torque = np.stack([rows(n) for _ in range(3)]) if laws else None
    springs = None if laws else np.stack([rows(n) for _ in range(2)])
    return Angles(middle, half, whole, halves, sines, share[0], torque, springs), tape


@dataclass(frozen=True, eq=False)
class Noted:
    """What rows compute, whatever the springs are.

    Attributes
    ----------
    ops, slots
        As `_allocated`.
    shapes
        Of closure and of minors and twins: centre, slopes and error of each, but for the boxes.
    known
        Numbers of results that do not hang on the box, and their values.
    count
        Results.
    """

    ops: np.ndarray
    slots: np.ndarray
    shapes: tuple[tuple[int, ...], ...]
    known: tuple[tuple[int, float], ...]
    count: int


def noted(forms: EnclosedRows) -> Noted:
    """Note what rows compute."""
    angles, tape = _traced_angles(forms.size, forms.laws is not None)
    shapes, results = list[tuple[int, ...]](), list[Any]()
    for form in forms.enclosed(angles):
        for part in (form.centre, form.slopes, form.error):
            shapes.append(part.shape[:-1])
            results += part.ravel().tolist()
    wanted: dict[int, list[int]] = {}
    for i, v in enumerate(results):
        if type(v) is Traced:
            wanted.setdefault(v.at, []).append(i)
    known = tuple((i, v) for i, v in enumerate(results) if type(v) is not Traced)
    return Noted(*_allocated(list(tape), wanted), tuple(shapes), known, len(results))


class StraightLine:
    """The rows of a scene as a compiled program; called with angles it returns closure, and minors and twins.

    Parameters
    ----------
    run
        The compiled function.
    forms
        The rows.
    """

    def __init__(self, run: Any, forms: EnclosedRows) -> None:
        key = type(forms), forms.laws is None, forms.geometry
        if key not in _NOTED:
            if len(_NOTED) >= MOST_KEPT:
                _NOTED.pop(next(iter(_NOTED)), None)
            _NOTED[key] = noted(forms)
        self._run, self._noted = run, _NOTED[key]
        self._slots = self._noted.slots.copy()  # it works in them: threads have their own
        self._springs = forms.springs.reshape(-1, 1) if forms.laws is None else np.zeros((0, 1))

    def __call__(self, angles: Angles) -> tuple[Affine, Affine]:
        """Enclose closure, and minors and twins, over boxes."""
        boxes, own, made = angles.middle.shape[1], self._springs, self._noted
        given = np.concatenate([*_arguments(angles), np.broadcast_to(own, (len(own), boxes))])
        out = np.empty((made.count, boxes))
        for i, value in made.known:
            out[i] = value
        self._run(
            len(made.ops),
            *map(address, (made.ops, self._slots, given, out)),
            boxes,
        )
        parts, first = [], 0
        for shape in made.shapes:
            count = int(np.prod(shape))
            parts.append(out[first : first + count].reshape(*shape, boxes))
            first += count
        return Affine(*parts[:3]), Affine(*parts[3:])


MOST_KEPT = 64
"""Vertices, with what touches, of which it is kept what their rows compute."""
_NOTED: dict[tuple[Hashable, ...], Noted] = {}


def _allocated(
    tape: list[tuple[Any, ...]], wanted: dict[int, list[int]]
) -> tuple[np.ndarray, np.ndarray]:
    """Return operations [P, 4] for C, those that are needed, and their slots [S, LANES], in which constants stand."""
    last = [-1] * len(tape)  # the operation that needs a number last
    for i in range(len(tape) - 1, -1, -1):
        code, a, b = tape[i]
        if last[i] < 0 and i in wanted:
            last[i] = i
        if last[i] >= 0 and code > KEEP:
            if last[a] < 0:
                last[a] = i
            if code not in UNARY and last[b] < 0:
                last[b] = i
    ops: list[int] = []
    slot, free, constants, count = [-1] * len(tape), list[int](), list[tuple[int, float]](), 0
    for i, (code, a, b) in enumerate(tape):
        if last[i] < 0:
            continue
        if free and code != KEEP:
            at = free.pop()
        else:
            at, count = count, count + 1
        slot[i] = at
        if code == KEEP:
            constants.append((at, b))
            last[i] = len(tape)  # it stays
            continue
        if code == LOAD:
            ops += (code, at, a, 0)
        else:
            if code in UNARY:
                b = a
            ops += (code, at, slot[a], slot[b])
            if last[a] == i:
                free.append(slot[a])
            if last[b] == i and a != b:
                free.append(slot[b])
        for row in wanted.get(i, ()):
            ops += (STORE, row, at, 0)
        if last[i] == i:
            free.append(at)
    slots = np.zeros((count, LANES))
    for place, value in constants:
        slots[place] = value
    return np.array(ops, dtype=np.int32).reshape(-1, 4), slots


def straight_line(forms: EnclosedRows) -> Callable[[Angles], tuple[Affine, Affine]] | None:
    """Return rows as a compiled program; None where nothing can be compiled.

    Parameters
    ----------
    forms
        The rows.
    """
    c = library()
    return None if c is None else StraightLine(c.run, forms)
