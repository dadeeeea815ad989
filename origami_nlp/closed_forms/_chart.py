"""What a closed form returns: values, two derivatives, and a reason wherever there is no answer.

Shapes: for inputs that broadcast to shape S, m outputs and d chart coordinates, `value` has shape
S + (m,), `first` S + (m, d), `second` S + (m, d, d), `reason`, `existence` and `own_side` S.
Angles are radians.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

ROUNDOFF = 16 * np.finfo(float).eps


class Reason(IntEnum):
    """Why a chart point has (not) a state.  Only OK and FOLD carry values; only OK derivatives."""

    OK = 0
    SINGULAR = 1  # a whole family of states sits on this chart point: nothing to return
    OTHER_LIFT = 2  # closes only with |phi| > pi, or on the lift q = -1
    NO_SOLUTION = 3  # the existence condition is negative
    FOLD = 4  # the two branches meet (existence = 0): value valid, derivatives infinite
    NOT_FINITE = 5  # an input is nan or infinite


@dataclass(frozen=True)
class ChartPoint:
    """Dependent fold angles over a chart, with first and second derivatives.

    value: fold angles in [-pi, pi], nan where `reason` is neither OK nor FOLD.
    first, second: derivatives with respect to the chart coordinates, nan unless `reason` is OK.
    reason: entries of `Reason`.
    existence: signed margin of the existence condition (>= 0 where a state exists); its meaning
        is said by the function that made it.
    own_side: whether the mirror creases are on their own side of the axis (contact, not closure);
        all True where the question does not arise.
    """

    value: np.ndarray
    first: np.ndarray
    second: np.ndarray
    reason: np.ndarray
    existence: np.ndarray
    own_side: np.ndarray

    @property
    def ok(self) -> np.ndarray:
        """Where value and derivatives are all valid."""
        return self.reason == Reason.OK


def stack_jets(flat: dict[str, Any], values: list[str], coordinates: list[str]) -> tuple[Any, ...]:
    """(value, first, second) arrays from the flat outputs of a generated function."""
    shape = np.broadcast_shapes(*(np.shape(flat[v]) for v in flat))
    d = len(coordinates)
    value = np.empty((*shape, len(values)))
    first = np.empty((*shape, len(values), d))
    second = np.empty((*shape, len(values), d, d))
    for m, name in enumerate(values):
        value[..., m] = flat[name]
        for i, a in enumerate(coordinates):
            first[..., m, i] = flat[f"{name}_d_{a}"]
            for j in range(i, d):
                entry = flat[f"{name}_d_{a}_d_{coordinates[j]}"]
                second[..., m, i, j] = entry
                second[..., m, j, i] = entry
    return value, first, second


def refine(flat: dict[str, Any], near: np.ndarray, fine: dict[str, Any]) -> None:
    """Overwrite the masked points of flat outputs by values computed in extended precision."""
    for name, values in fine.items():
        flat[name] = np.broadcast_to(flat[name], near.shape).copy()
        flat[name][near] = values


def finish(
    jets: tuple[Any, ...], reason: np.ndarray, existence: np.ndarray, own_side: np.ndarray
) -> ChartPoint:
    """Blank out what `reason` forbids and pack the rest."""
    value, first, second = jets
    has_value = (reason == Reason.OK) | (reason == Reason.FOLD)
    value = np.where(has_value[..., None], np.clip(value, -np.pi, np.pi), np.nan)
    first = np.where((reason == Reason.OK)[..., None, None], first, np.nan)
    second = np.where((reason == Reason.OK)[..., None, None, None], second, np.nan)
    return ChartPoint(value, first, second, reason, existence, own_side)


def not_finite(*inputs: Any) -> np.ndarray:
    """Where any of the broadcast inputs is nan or infinite."""
    mask = np.array(False)
    for x in inputs:
        mask = mask | ~np.isfinite(x)
    return mask
