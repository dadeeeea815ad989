"""Integers beyond what a float or a reader bears."""

from __future__ import annotations

SAFE = 2**53
"""Largest integer that JSON readers do not round."""
LONGEST = 9
"""Digits of an integer that is written out."""


def exact(number: int) -> int | str:
    """Return an integer as JSON carries it without rounding: as text beyond `SAFE`."""
    return number if abs(number) <= SAFE else str(number)


def number_words(number: int) -> str:
    """Write an integer with separators, or as 1.23e150 where it is long."""
    text = str(number)
    return f"{number:,}" if len(text) <= LONGEST else f"{text[0]}.{text[1:4]}e{len(text) - 1}"


def share_words(part: int, whole: int) -> str:
    """Write part/whole as a decimal, also for integers beyond the range of floats."""
    return f"{part * 10**8 // whole / 10**8:.6g}"
