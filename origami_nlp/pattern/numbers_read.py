"""Numbers as users write them: angles as multiples of pi such as ``"3*pi/4"``, and lists, one a crease."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from fractions import Fraction
from numbers import Real
from typing import Any

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import AngleError, SceneError
from origami_nlp.numerics import EPS, INPUT_TOL

_NUMBER = r"(?:\d+\.?\d*(?:[eE][-+]?\d{1,3})?|\.\d+(?:[eE][-+]?\d{1,3})?)"
_ANGLE = re.compile(
    rf"\s*(?P<sign>[-+]?)\s*(?:(?:(?P<times>{_NUMBER})\s*\*?\s*)?(?P<pi>pi|π)|(?P<factor>{_NUMBER}))"
    rf"\s*(?:/\s*(?P<divisor>{_NUMBER}))?\s*(?(pi)|(?P<degrees>deg)?)\s*"
)
_LONGEST = 64
_HOW = 'write radians as a number, a multiple of pi such as "-3*pi/4", or degrees such as "45deg"'


def parse_angle(value: object, field: str = "angle") -> float:
    """Read one angle from a number or a string; nothing is evaluated.

    Parameters
    ----------
    value
        A number [rad], or ``"0.7"``, ``"pi"``, ``"-pi/4"``, ``"5*pi/12"``, ``"5pi/12"``, ``"1/3"``, ``"45deg"``.
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
        return check_number(field, value, error=AngleError)
    short = isinstance(value, str) and len(value) <= _LONGEST
    match = _ANGLE.fullmatch(value) if short else None  # type: ignore[call-overload]
    divisor = float(match["divisor"] or 1) if match else 0.0
    if match is None or divisor == 0:
        raise AngleError(f"{field} = {shown(value)} is not an angle: {_HOW}")
    unit = math.pi if match["pi"] else 1
    angle = float(match["times"] or match["factor"] or 1) * unit / divisor
    angle = math.radians(angle) if match["degrees"] else angle
    return check_number(field, -angle if match["sign"] == "-" else angle, error=AngleError)


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
    named = ((f"{field}[{i}]", value) for i, value in enumerate(values, start=1))
    if not degrees:
        return tuple(parse_angle(value, name) for name, value in named)
    return tuple(math.radians(check_number(f"{n} [deg]", v, error=AngleError)) for n, v in named)


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


LARGEST_RATIO = 1e8
"""Largest ratio of two stiffnesses.  At 1e12 the torque of a soft spring is below the rounding of a stiff one's: along
a line of states that only soft springs order, every point seems to balance, and a search never ends."""
MOST_WOUND = 1e3
"""Largest |wound angle| [rad]: the energy of such a spring is 1e6 times that of one radian, and loses 6 digits."""
SMALLEST, LARGEST = 1e-300, 1e300
"""Bounds of a stiffness, in any unit: energies beyond them overflow, or lose digits."""


def check_range(stiffness: Sequence[float]) -> None:
    """Raise an error for stiffnesses that cannot be computed with, or not together."""
    for i, k in enumerate(stiffness, start=1):
        if not SMALLEST <= k <= LARGEST:
            span = f"{SMALLEST:g} to {LARGEST:g} N m/rad"
            raise SceneError(f"stiffness[{i}] = {k:.6g} is not within {span}")
    soft, stiff = min(stiffness, default=1.0), max(stiffness, default=1.0)
    if stiff > LARGEST_RATIO * soft * (1 + INPUT_TOL):
        i, j = stiffness.index(soft) + 1, stiffness.index(stiff) + 1
        of = f"more than {LARGEST_RATIO:g} times stiffness[{i}] = {soft:.6g}"
        cure = "soft springs are lost in rounding: merge the facets at the stiff crease"
        raise SceneError(f"stiffness[{j}] = {stiff:.6g} is {of}: {cure}")


def read_rest_angles(values: object, degree: int) -> tuple[float, ...]:
    """Read rest angles [rad]; texts as `parse_angles`."""
    rest = check_length(parse_angles(values, "rest_angles"), "rest_angles", degree)
    for i, a in enumerate(rest, start=1):
        if abs(a) > math.pi * (1 + 4 * EPS):
            span = "outside [-pi, pi] radians (degrees: rest_angles_deg; beyond: preload)"
            raise SceneError(f"rest_angles[{i}] = {a:.6g} is {span}")
    return rest


def read_preload(
    values: object, stiffness: Sequence[float], rest: Sequence[float]
) -> tuple[float, ...]:
    """Read the preload [N m] of each crease; () where there is none."""
    if isinstance(values, tuple) and not values:
        return ()
    preload = read_numbers(values, "preload", len(stiffness))
    for i, (m, k, a) in enumerate(zip(preload, stiffness, rest, strict=True), start=1):
        if abs(a + m / k) > MOST_WOUND:
            wound = f"winds a spring of {k:.6g} N m/rad to {a + m / k:.6g} rad"
            raise SceneError(f"preload[{i}] = {m:.6g} N m {wound}: at most {MOST_WOUND:g} rad")
    return preload if any(preload) else ()


def check_length(values: tuple[float, ...], name: str, degree: int) -> tuple[float, ...]:
    """Return values, of which there must be one for each crease."""
    if len(values) != degree:
        raise SceneError(f"{name} has {len(values)} entries: give one for each of {degree} creases")
    return values


def read_numbers(values: object, name: str, degree: int) -> tuple[float, ...]:
    """Read `degree` floats, or one for all, or raise an error about field `name`."""
    if isinstance(values, int | float) and not isinstance(values, bool):
        return (check_number(name, values, error=SceneError),) * degree
    items = read_list(values, f"{name} = {shown(values)} must be numbers, one for each crease")
    numbers = (check_number(f"{name}[{i}]", v, error=SceneError) for i, v in enumerate(items, 1))
    return check_length(tuple(numbers), name, degree)


def read_list(values: object, wrong: str, count: int | None = None) -> list[Any]:
    """Return the entries of a list, so many if a number is given, or raise an error."""
    listed = isinstance(values, Iterable) and not isinstance(values, str | bytes)
    items = list(values) if listed else None  # type: ignore[call-overload]
    if items is None or count not in (None, len(items)):
        raise SceneError(wrong)
    return items
