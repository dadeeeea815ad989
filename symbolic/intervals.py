"""Certified signs over boxes, where an exact argument is out of reach: interval arithmetic.

`certify_sign` subdivides a box until mpmath's outward-rounded intervals decide the sign of an
expression on every piece.  A True answer is a proof for the stated box.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import mpmath
import sympy as sp

Box = Mapping[sp.Symbol, tuple[Any, Any]]


@dataclass(frozen=True)
class Certificate:
    """Outcome of `certify_sign`: whether it holds, and how many boxes were examined."""

    holds: bool
    boxes: int
    failed: tuple[tuple[float, float], ...] | None = None


def certify_sign(expr: Any, box: Box, sign: Literal[-1, 1], max_boxes: int = 20_000) -> Certificate:
    """Whether `expr` has the strict sign everywhere in the box (exact rational ends, radians).

    Gives up, with `holds` False and the offending piece in `failed`, as soon as an interval lies on
    the wrong side or `max_boxes` pieces were examined.
    """
    symbols = sorted(box, key=str)
    expr, constants = _enclosed_constants(sp.sympify(expr))
    raw = sp.lambdify([*symbols, *constants], expr, modules=[_IV, "math"])
    enclosures = tuple(constants.values())

    def function(*piece: Any) -> Any:
        return raw(*piece, *enclosures)

    stack = [tuple(_interval(*box[s]) for s in symbols)]
    examined = 0
    while stack:
        piece = stack.pop()
        examined += 1
        value = mpmath.iv.mpf(function(*piece)) * sign
        if value.a > 0:
            continue
        if value.b <= 0 or examined >= max_boxes:
            ends = tuple((float(x.a), float(x.b)) for x in piece)
            return Certificate(False, examined, ends)
        widest = max(range(len(piece)), key=lambda i: float(piece[i].delta))
        x = piece[widest]
        for half in (mpmath.iv.mpf([x.a, x.mid.a]), mpmath.iv.mpf([x.mid.a, x.b])):
            stack.append((*piece[:widest], half, *piece[widest + 1 :]))
    return Certificate(True, examined)


def _enclosed_constants(expr: Any) -> tuple[Any, dict[sp.Dummy, Any]]:
    """Replace rationals that are no binary fractions by symbols with enclosing intervals.

    Generated code would round them to the nearest double, outside the interval arithmetic.
    """
    names: dict[sp.Dummy, Any] = {}
    swap = {}
    for number in expr.atoms(sp.Rational):
        if number.q & (number.q - 1):
            dummy = sp.Dummy("constant")
            swap[number], names[dummy] = dummy, _enclose(number)
    return expr.xreplace(swap), names


def _interval(low: Any, high: Any) -> Any:
    """Interval enclosing two exact numbers."""
    return mpmath.iv.mpf([_enclose(low).a, _enclose(high).b])


def _enclose(number: Any) -> Any:
    """Interval around an exact rational multiple of pi, or a rational."""
    number = sp.sympify(number)
    part = number.coeff(sp.pi)
    rest = number - part * sp.pi
    if not (part.is_Rational and rest.is_Rational):
        raise ValueError(f"{number} is not rational + rational * pi")
    ratio = [mpmath.iv.mpf(int(r.p)) / mpmath.iv.mpf(int(r.q)) for r in (part, rest)]
    return ratio[0] * mpmath.iv.pi + ratio[1]


_IV = {
    "cos": mpmath.iv.cos,
    "sin": mpmath.iv.sin,
    "sqrt": mpmath.iv.sqrt,
    "pi": mpmath.iv.pi,
}
