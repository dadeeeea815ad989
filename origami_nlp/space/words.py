"""Fold angles in words."""

from __future__ import annotations

from collections.abc import Iterable

from origami_nlp.numerics import OUTSIDE
from origami_nlp.pattern import format_angle


def angle_words(values: Iterable[float]) -> str:
    """Write fold angles for people: multiples of pi as such, others with four decimals.

    Parameters
    ----------
    values
        Fold angles [rad].

    Returns
    -------
    str
        Such as ``"(pi/2, 0.1234)"``.
    """
    texts = []
    for v in values:
        text = format_angle(v) if abs(v) > OUTSIDE else "0"
        texts.append(text if "pi" in text or text == "0" else f"{v:.4f}")
    return "(" + ", ".join(texts) + ")"
