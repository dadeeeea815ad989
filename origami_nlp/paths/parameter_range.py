"""What states are followed over: a parameter by name, and its range.

Names: see `numbers`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass

from origami_nlp.arguments import did_you_mean
from origami_nlp.errors import AngleError, OptionError
from origami_nlp.pattern import LAW_NUMBER, parse_angle

UNITS = {"stiffness": "N m/rad", "preload": "N m", "torque": "N m"}
UNITS |= dict.fromkeys(("ratio", "x", "y", "loads", "law_scale"), "")
UNITS |= dict.fromkeys(("alpha", "rest_angles", "sector_angles", "law_shift"), "rad")
"""Of what can be followed over."""
LAW = "laws."
"""Before the kind of a number of a hinge law."""
LAW_UNITS = {"energy": "J", "stiffness": "N m/rad", "coefficients": "N m"}
"""Of numbers of laws that are no angles; coefficients [N m/rad, N m/rad^2, ...]."""
_DEGREES = re.compile(r"(.*?)\s*deg")
_IN_DEGREES = re.compile(
    r"(rest_angles|sector_angles|law_shift|^laws\..*\.(?:at|width|centre|rest))_deg(\[|$)"
)


@dataclass(frozen=True)
class ParameterRange:
    """What is followed over.

    Attributes
    ----------
    name
        Of the parameter, see the module.
    low, high
        From and to, in its unit.
    unit
        ``"rad"``, ``"N m"``, ``"N m/rad"`` or ``""``.
    log
        Whether steps are ratios.
    """

    name: str
    low: float
    high: float
    unit: str
    log: bool

    def s_of(self, t: float) -> float:
        """Return the number that is followed: t, or its logarithm."""
        return math.log(t) if self.log else t

    @property
    def ends(self) -> tuple[float, float]:
        """The coordinate at both ends of the range."""
        return self.s_of(self.low), self.s_of(self.high)

    def t_of(self, s: float) -> float:
        """Return the parameter, exact at both ends of the range."""
        if s == self.s_of(self.low):
            return self.low
        if s == self.s_of(self.high):
            return self.high
        return math.exp(s) if self.log else s

    def drawn(self, t: float) -> float:
        """Return a value as axes have it: angles in degrees."""
        return math.degrees(t) if self.unit == "rad" else t

    @property
    def axis(self) -> str:
        """The name for an axis, with its unit."""
        unit = "deg" if self.unit == "rad" else self.unit
        return f"{self.name} [{unit}]" if unit else self.name

    def shown(self, t: float, digits: int = 6) -> str:
        """Return a value in words, angles in degrees."""
        if self.unit == "rad":
            return f"{math.degrees(t):.{digits}g} deg"
        return f"{t:.{digits}g} {self.unit}".rstrip()


def parse_parameter_range(text: str) -> ParameterRange:
    """Read ``NAME=FROM:TO``, angles in radians, as multiples of pi, or with ``deg``.

    Parameters
    ----------
    text
        Such as ``"ratio=0.01:100"``, ``"alpha=30deg:60deg"``, ``"rest_angles[1]=-pi:pi/2"`` or
        ``"torque[1]=-0.15:0"``.

    Returns
    -------
    ParameterRange
        The parameter and its range.

    Raises
    ------
    OptionError
        If it is not written so, an end is no number, or the range is empty.
    AngleError
        If an end of a range of angles is no angle.

    Examples
    --------
    >>> from origami_nlp.paths import parse_parameter_range
    >>> parse_parameter_range("ratio=0.01:100").log
    True
    """
    name, equals, ends = text.partition("=")
    low, colon, high = ends.partition(":")
    if not equals or not colon:
        raise OptionError(f"parameter = {text!r} must be NAME=FROM:TO, such as ratio=0.01:100")
    name, values = _stated(name.strip(), low, high)
    kind, *others = {kind_of(part) for part in name.split("+")}
    log, (a, b) = kind in ("ratio", "stiffness", "law_scale"), values
    for wrong, why in (
        (others, "what takes the same value must be of one kind"),
        (not a < b, "the range must run from a smaller to a larger value"),
        (log and a <= 0, f"{name} must be above 0"),
    ):
        if wrong:
            raise OptionError(f"parameter = {text!r}: {why}")
    return ParameterRange(name, a, b, unit_of(kind), log)


def unit_of(kind: str) -> str:
    """Return the unit of a kind of parameter (`kind_of`)."""
    units = LAW_UNITS if kind.startswith(LAW) else UNITS
    return units.get(kind.removeprefix(LAW), "rad")


def kind_of(name: str) -> str:
    """Return what a parameter is, such as ``stiffness``, without its place; of a law's number `LAW` before it."""
    if number := LAW_NUMBER.fullmatch(name.strip()):
        return LAW + number["key"]
    return re.sub(r".*\.|\[.*", "", name.strip())


def meant_by(name: str, options: Iterable[str] = ()) -> str:
    """Return ``; did you mean ...?`` for a parameter that is not one, or nothing; options: what it could be as well."""
    known = [*UNITS, *options]
    bare = (re.sub(r".*\.|\[.*", "", part.strip()) for part in name.split("+"))
    return "".join(did_you_mean(part, known) for part in bare if part not in known)


def _stated(name: str, *ends: str) -> tuple[str, list[float]]:
    """Return a name and values in radians: with ``_deg`` in the name, as in scene files, numbers are degrees."""
    if _IN_DEGREES.search(name):
        name = _IN_DEGREES.sub(r"\1\2", name)
        ends = tuple(text.strip().removesuffix("deg") + "deg" for text in ends)
    return name, [_number(text.strip(), name) for text in ends]


def _number(text: str, name: str) -> float:
    if match := _DEGREES.fullmatch(text):
        return math.radians(parse_angle(match[1], name))
    try:
        return parse_angle(text, name)
    except AngleError:
        if unit_of(kind_of(name.partition("+")[0])) == "rad":
            raise
        raise OptionError(f"parameter: {name} = {text} must be a finite number") from None
