"""Angles as users write them: numbers in radians, or rational multiples of pi such as
``"-3*pi/4"``.

The parser is a single regular expression: user text is data and is never evaluated.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from fractions import Fraction
from numbers import Real

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import AngleError
from origami_nlp.numerics import EPS

_NUMBER = r"(?:\d+\.?\d*(?:[eE][-+]?\d{1,3})?|\.\d+(?:[eE][-+]?\d{1,3})?)"
_ANGLE = re.compile(
    rf"\s*(?P<sign>[-+]?)\s*(?:(?P<factor>{_NUMBER})\s*(?P<times>\*?)\s*)?(?P<pi>pi|π)?"
    rf"\s*(?:/\s*(?P<divisor>{_NUMBER}))?\s*"
)
_LONGEST = 64
_HOW = 'write radians as a number, or a multiple of pi such as "-3*pi/4"'


def parse_angle(value: object, field: str = "angle") -> float:
    """Read one angle from a number or a string; nothing is evaluated.

    Parameters
    ----------
    value
        A number [rad], or ``"0.7"``, ``"pi"``, ``"-pi/4"``, ``"5*pi/12"``, ``"5pi/12"``, ``"1/3"``.
    field
        How messages call it.

    Returns
    -------
    float
        The angle [rad].

    Raises
    ------
    AngleError
        If `value` is anything else, or is not finite; the message names `field`.

    Examples
    --------
    >>> from origami_nlp.pattern import parse_angle
    >>> parse_angle("pi/4")
    0.7853981633974483
    """
    if isinstance(value, Real) and not isinstance(value, bool):
        try:
            angle = float(value)
        except OverflowError:
            angle = math.inf
    elif isinstance(value, str):
        match = _ANGLE.fullmatch(value) if len(value) <= _LONGEST else None
        if (
            match is None
            or (match["factor"] is None and match["pi"] is None)
            or (match["times"] and match["pi"] is None)
        ):
            cut = value if len(value) <= _LONGEST else value[:_LONGEST] + "..."
            raise AngleError(f"{field} = {cut!r} is not an angle: {_HOW}")
        divisor = float(match["divisor"] or 1)
        if divisor == 0:
            raise AngleError(f"{field} = {value!r} divides by zero: {_HOW}")
        angle = float(match["factor"] or 1) * (math.pi if match["pi"] else 1) / divisor
        if match["sign"] == "-":
            angle = -angle
    else:
        raise AngleError(f"{field} = {shown(value)} is not an angle: {_HOW}")
    if not math.isfinite(angle):
        raise AngleError(f"{field} = {shown(value)} is not finite: {_HOW}")
    return angle


def parse_angles(values: object, field: str, *, degrees: bool = False) -> tuple[float, ...]:
    """Read a list of angles.

    Parameters
    ----------
    values
        Numbers [rad] or strings, as `parse_angle` takes them.
    field
        How messages call the list.
    degrees
        Take plain numbers in degrees, and no strings.

    Returns
    -------
    tuple of float
        The angles [rad].

    Raises
    ------
    AngleError
        If `values` is not a list of angles; the message names the entry, 1-based.
    """
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise AngleError(f"{field} must be a list of angles, one for each crease")
    out: list[float] = []
    for i, value in enumerate(values, start=1):
        if degrees:
            number = check_number(f"{field}[{i}] [deg]", value, error=AngleError)
            out.append(math.radians(number))
        else:
            out.append(parse_angle(value, f"{field}[{i}]"))
    return tuple(out)


def format_angle(angle: float) -> str:
    """Write an angle as a multiple of pi where it is one to rounding, else as a number.

    Parameters
    ----------
    angle
        The angle [rad].

    Returns
    -------
    str
        ``parse_angle(format_angle(a)) == a`` to within one unit in the last place.

    Examples
    --------
    >>> from origami_nlp.pattern import format_angle
    >>> format_angle(0.75 * 3.141592653589793), format_angle(0.1)
    ('3*pi/4', '0.1')
    """
    if angle == 0:
        return "0"
    ratio = Fraction(angle / math.pi).limit_denominator(720)
    if ratio and abs(float(ratio) * math.pi - angle) <= 2 * EPS * max(1.0, abs(angle)):
        p, q = abs(ratio.numerator), ratio.denominator
        head = "pi" if p == 1 else f"{p}*pi"
        return ("-" if ratio < 0 else "") + head + ("" if q == 1 else f"/{q}")
    return repr(angle)
