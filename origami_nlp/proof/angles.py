"""Fold angles over boxes: their middles, and the turns by them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import EPS
from origami_nlp.proof.affine import Turn, variables, with_centre


@dataclass(frozen=True, eq=False)
class Angles:
    """Fold angles over K boxes, and what is computed of them by more than sums and products.

    Attributes
    ----------
    middle, half
        Of the boxes, [n, K] [rad].
    whole, halves
        Turns by the angles, and by half of them, [n, K].
    sines
        Bounds of |sin (phi / 2)|, added up, and that or 1, if that is less, [2, K].
    share
        Bound of the sum of twice the angles, or 1, [K].
    torque
        Of hinge laws: centre, slope and error, [3, n, K]; None for linear springs, whose torques are sums and products.
    """

    middle: np.ndarray
    half: np.ndarray
    whole: Turn
    halves: Turn
    sines: np.ndarray
    share: np.ndarray
    torque: np.ndarray | None = None

    @classmethod
    def over(cls, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray) -> Angles:
        """Return those of boxes lower, upper [n, K] [rad]; pinned (pins not 0) beside +-pi they are that exactly."""
        middle, half = variables(lower, upper)
        pins = folded_flat(middle, pins)
        size = np.abs(middle) + half
        sines = np.where(pins != 0, 1.0, np.minimum(1.0, 0.5 * size)).sum(axis=0)
        return cls(
            middle,
            half,
            angle_turns(middle, half, pins),
            half_turns(middle, half, pins),
            np.stack([sines, np.minimum(1.0, sines)]),
            np.minimum(1.0, 2.0 * size.sum(axis=0)),
        )


def folded_flat(angle: np.ndarray, pins: np.ndarray) -> np.ndarray:
    """Return the pins [n, K] of angles at +-pi, where facets lie on each other; 0 at other stops."""
    return np.where(np.abs(angle) >= np.pi * (1 - 2 * EPS), pins, 0)


def angle_turns(middle: np.ndarray, half: np.ndarray, pins: np.ndarray) -> Turn:
    """Turns by angles [n, K], by +-pi exactly where these are pinned."""
    pinned = pins != 0
    c, s = np.where(pinned, -1.0, np.cos(middle)), np.where(pinned, 0.0, np.sin(middle))
    return with_centre(c, s, np.where(pinned, 0.0, half))


def half_turns(middle: np.ndarray, half: np.ndarray, pins: np.ndarray) -> Turn:
    """Turns by half of angles [n, K], by +-pi/2 exactly where these are pinned."""
    pinned = pins != 0
    c = np.where(pinned, 0.0, np.cos(0.5 * middle))
    s = np.where(pinned, pins, np.sin(0.5 * middle))
    return with_centre(c, s, np.where(pinned, 0.0, 0.5 * half))
