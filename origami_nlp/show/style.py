"""The style that our figures share."""

from __future__ import annotations

import math
from typing import Any


def label_text(text: str) -> str:
    """Text that matplotlib does not take for a formula."""
    pretty = (
        text.replace("alpha_1", "α₁").replace("r_k", "rₖ").replace("*pi", "π").replace("pi/", "π/")
    )
    return pretty.replace("$", r"\$")


def short_label(text: str) -> str:
    """Shorten the label of a scene of the paper to what differs: ``N = 6, pi/3, 1``."""
    return text.replace("degree ", "N = ").replace("alpha_1 = ", "").replace("r_k = ", "")


def pi_label(numerator: int, denominator: int = 1) -> str:
    """Write a multiple of pi for the tick of an axis, such as ``−3π/4``."""
    common = math.gcd(numerator, denominator) or 1
    top, below = abs(numerator) // common, denominator // common
    if not top:
        return "0"
    sign = "−" if numerator < 0 else ""
    return f"{sign}{'' if top == 1 else top}π{'' if below == 1 else f'/{below}'}"


def angle_ticks(axis: Any, low: float, high: float) -> None:
    """Put ticks at multiples of pi/4 between low and high, pi/2 where there are many."""
    quarters = [q for q in range(-8, 9) if low - 1e-9 <= q * math.pi / 4 <= high + 1e-9]
    if high - low > 1.1 * math.pi:
        quarters = [q for q in quarters if q % 2 == 0]
    axis.set_ticks([q * math.pi / 4 for q in quarters], [pi_label(q, 4) for q in quarters])
