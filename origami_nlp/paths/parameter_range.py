"""What states are followed over: a parameter by name, and its range.

Names: see `pattern.with_numbers`.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from origami_nlp.errors import AngleError, OptionError
from origami_nlp.pattern import parse_angle

UNITS = {"stiffness": "N m/rad", "preload": "N m", "torque": "N m"}
UNITS |= dict.fromkeys(("ratio", "x", "y", "loads", "law_scale"), "")
UNITS |= dict.fromkeys(("alpha", "rest_angles", "sector_angles", "law_shift"), "rad")
"""Of what can be followed over."""


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

    @property
    def names(self) -> tuple[str, ...]:
        """Of the numbers that take the same value."""
        return tuple(name.strip() for name in self.name.split("+"))

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

    def share_of(self, s: float) -> float:
        """Return which share of its range the number that is followed is at."""
        low, high = self.ends
        return (s - low) / (high - low)

    def at_share(self, share: float) -> float:
        """Return the parameter at a share of its range, exact at both ends."""
        low, high = self.ends
        return self.t_of(high if share == 1.0 else low + share * (high - low))

    def drawn(self, t: float) -> float:
        """Return a value as axes have it: angles in degrees."""
        return math.degrees(t) if self.unit == "rad" else t

    @property
    def axis(self) -> str:
        """The name for an axis, with its unit."""
        unit = "deg" if self.unit == "rad" else self.unit
        return f"{self.name} [{unit}]" if unit else self.name

    @property
    def stated(self) -> str:
        """The name with the unit of its values."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

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
    # with ``_deg`` in the name, as in scene files, numbers are degrees
    bare = re.sub(r"_deg(?=\[|$)", "", name.strip())
    unit = "deg" * (bare != name.strip())
    a, b = (_number(v.strip().removesuffix(unit) + unit, bare) for v in (low, high))
    kind, *others = {kind_of(part) for part in bare.split("+")}
    log = kind in ("ratio", "stiffness", "law_scale")
    for wrong, why in (
        (others, "what takes the same value must be of one kind"),
        (not a < b, "the range must run from a smaller to a larger value"),
        (log and a <= 0, f"{bare} must be above 0"),
    ):
        if wrong:
            raise OptionError(f"parameter = {text!r}: {why}")
    return ParameterRange(bare, a, b, UNITS.get(kind, "rad"), log)


def _number(text: str, name: str) -> float:
    try:
        return parse_angle(text, name)
    except AngleError:
        if UNITS.get(kind_of(name.partition("+")[0]), "rad") == "rad":
            raise
        raise OptionError(f"parameter: {name} = {text} must be a finite number") from None


def kind_of(name: str) -> str:
    """Return what a number is, such as ``stiffness``, without its place."""
    return re.sub(r".*\.|\[.*", "", name.strip())
