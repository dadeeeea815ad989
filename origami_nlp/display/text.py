"""Words and ticks that our figures share."""

from __future__ import annotations

import math
from typing import Any


def label_text(text: str) -> str:
    """Return text that matplotlib does not take for a formula.

    Parameters
    ----------
    text
        Of a user or a file.

    Returns
    -------
    str
        The text.
    """
    pretty = (
        text.replace("alpha_1", "α₁").replace("r_k", "rₖ").replace("*pi", "π").replace("pi/", "π/")
    )
    return pretty.replace("$", r"\$")


def subscript(number: int) -> str:
    """Write a number below the line.

    Parameters
    ----------
    number
        At least 0.

    Returns
    -------
    str
        Such as ``₁₂``.

    Examples
    --------
    >>> from origami_nlp.display import subscript
    >>> subscript(12)
    '₁₂'
    """
    return str(number).translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉"))


def angle_ticks(axis: Any, low: float, high: float) -> None:
    """Put ticks in degrees at multiples of 45, or of 90 where there are many.

    Parameters
    ----------
    axis
        Of matplotlib.
    low, high
        Ends of the axis [rad].
    """
    quarters = [q for q in range(-8, 9) if low - 1e-9 <= q * math.pi / 4 <= high + 1e-9]
    if high - low > 1.1 * math.pi:
        quarters = [q for q in quarters if q % 2 == 0]
    axis.set_ticks(
        [q * math.pi / 4 for q in quarters], [f"{45 * q}°".replace("-", "−") for q in quarters]
    )
