"""Parameters that examples share: an angle below a bound, and springs from one stiffness ratio."""

from __future__ import annotations

import math
import sys
from numbers import Real

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError
from origami_nlp.pattern.angles import parse_angle

STIFFNESS = 0.025
"""Geometric mean of mountain and valley stiffness in the paper [N m/rad]."""


def between(alpha: float | str, upper: float, upper_text: str) -> float:
    """Return `alpha` [rad] as a number in (0, upper)."""
    a = parse_angle(alpha, "alpha")
    if not 0 < a < upper:
        raise OptionError(f"alpha = {alpha!r} must lie between 0 and {upper_text} [rad]")
    return a


def positive(ratio: float) -> float:
    """Return a stiffness ratio as a positive number."""
    number = isinstance(ratio, Real) and not isinstance(ratio, bool)
    if not number or not 0 < ratio <= sys.float_info.max:
        raise OptionError(f"ratio = {shown(ratio)} must be a positive number")
    return float(ratio)


def springs(rest: tuple[float, ...], ratio: float) -> tuple[float, ...]:
    """k_m = 0.025 sqrt(r_k) on creases with a mountain rest angle, k_v = 0.025 / sqrt(r_k) else."""
    root = math.sqrt(ratio)
    return tuple(STIFFNESS * root if phi < 0 else STIFFNESS / root for phi in rest)
