"""Closure of one loop of creases to second order: what motions of a state obey, vertex by vertex."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class LoopClosure:
    """Closure round one vertex, or one hole, at a closed state.

    Attributes
    ----------
    variables
        Of the programme that it turns, [d].
    jacobian
        Of its equations, [k, d].
    hessians
        Of each of its equations, [k, d, d]; zeros where second order is not asked for.
    """

    variables: np.ndarray
    jacobian: np.ndarray
    hessians: np.ndarray
