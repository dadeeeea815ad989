"""A line of parameters: which problem belongs to each value of one number s.

Rest angles, loads and shifts of hinge laws are linear in s, stiffnesses and factors of laws log-linear, so that a ratio
of stiffnesses r is followed in s = ln r.  What moves paper changes closure itself: there every value has equations of
its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any, TypeAlias, cast

import numpy as np

from origami_nlp.problem import Contact, Parameters, Problem

Rows: TypeAlias = Sequence[Contact]
Rates: TypeAlias = tuple[np.ndarray, np.ndarray]
"""Of torques [n], and of closure and openings [m + r]."""


@dataclass(frozen=True, eq=False)
class ParameterLine:
    """Problems along a line of parameters.

    Attributes
    ----------
    problem
        Whose structure, scale and contacts all of them share.
    start
        Parameters at s = 0.
    direction
        Their change with s; for stiffness that of its logarithm.  Forces in space that it does not state stay.
    weight
        Length of a step ds beside one of the states [rad], for the length of steps alone.
    """

    problem: Problem
    start: Parameters
    direction: Parameters
    weight: float = 0.3

    def at(self, s: float) -> Problem:
        """Return the problem at s."""
        a, d = self.start, self.direction
        parameters = Parameters(
            a.sectors + s * d.sectors,
            # log-linear: positive for every s, and even in both directions
            a.stiffness * np.exp(s * d.stiffness),
            a.rest + s * d.rest,
            a.load + s * d.load,
            a.dead if a.dead is None or d.dead is None else a.dead.moved(d.dead, s),
            a.laws if a.laws is None or d.laws is None else a.laws.along(d.laws, s),
        )
        return cast(Problem, self.problem.varied(parameters))

    def drift(self, p: Problem, s: float, x: np.ndarray, nu: np.ndarray, contacts: Rows) -> Rates:
        """Differentiate the KKT system with multipliers nu by s at a state [n] of the problem p at s."""
        return cast(Rates, p.drift(x, nu, contacts, self.slope(s)))

    def slope(self, s: float) -> np.ndarray:
        """Return the derivative of `Parameters.vector` by s."""
        a, d = self.start.stiffness, self.direction.stiffness
        out, first = self._slope.copy(), len(self.start.sectors)
        # d(a e^(s d))/ds
        out[first : first + len(d)] = a * np.exp(s * d) * d
        if self.start.laws is not None and (change := self.direction.laws) is not None:
            at = self.start.laws.along(change, s).weight * change.weight
            out[-2 * len(at) : -len(at)] = at
        return out

    @cached_property
    def _slope(self) -> np.ndarray:
        """Derivative of `Parameters.vector` by s, that of the logarithm for stiffness."""
        a, d = self.start, self.direction
        still = None if a.dead is None else a.dead.divided(math.inf)
        laws = a.laws if a.laws is None else d.laws or a.laws.towards(a.laws, 1.0)
        return replace(d, dead=d.dead or still, laws=laws).vector


SHARE = 1e-3
"""Of the range: the step of the difference that follows closure along it; its error is the fourth power."""
KEPT = 64
"""Problems of a line that are kept: a point, what it is differentiated by, and the points before."""


@dataclass(frozen=True, eq=False)
class GeometryLine:
    """Problems of one structure whose paper moves with s: what `ParameterLine` is for springs.

    Attributes
    ----------
    problem
        Whose scale and numbers of contacts all of them share.
    problem_of
        The problem at s.
    length
        Of the range of s.
    weight
        Length of a step ds beside one of the states [rad], for the length of steps alone.
    """

    problem: Problem
    problem_of: Callable[[float], Any] = field(repr=False)
    length: float
    weight: float = 0.3

    @cached_property
    def at(self) -> Callable[[float], Any]:
        """Return the problem at s; the last ones are kept."""
        return lru_cache(maxsize=KEPT)(self.problem_of)

    def drift(self, p: Problem, s: float, x: np.ndarray, nu: np.ndarray, contacts: Rows) -> Rates:
        """Differentiate the KKT system by s at a state [n], by differences of fourth order."""
        h = SHARE * self.length

        def system(s: float) -> np.ndarray:
            local = self.at(s).rows(x)
            values, slopes = local.openings(contacts)
            m = len(local.closure)
            torque = local.gradient - local.closure_jacobian.T @ nu[:m]
            return np.concatenate([torque - slopes.T @ nu[m:], local.closure, values])

        ahead, behind = ([system(s + sign * k * h) for k in (1, 2)] for sign in (1.0, -1.0))
        rate = (8 * (ahead[0] - behind[0]) - (ahead[1] - behind[1])) / (12 * h)
        return rate[: len(x)], rate[len(x) :]


Line: TypeAlias = ParameterLine | GeometryLine


def load_line(problem: Problem, load: np.ndarray, weight: float = 0.05) -> ParameterLine:
    """Return the line along which the load `load` [n] is multiplied by s, over `scale`, and added to what is there."""
    p = problem.parameters
    none = np.zeros_like(p.rest)
    still = Parameters(np.zeros_like(p.sectors), none, none, load)
    return ParameterLine(problem, p, still, weight=weight)
