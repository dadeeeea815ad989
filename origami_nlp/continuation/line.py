"""A line of parameters: which problem belongs to each value of one number s.

Sector angles, rest angles, loads and shifts of hinge laws are linear in s, stiffnesses and factors of laws log-linear,
so that a ratio of stiffnesses r is followed in s = ln r; a law may move with a number that it is stated with.
Several lines can be added: two parameters, or several creases at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from origami_nlp.problem import Parameters, Problem


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
    sector_angles, sector_change
        Of the whole vertex at s = 0 and their change with s, shape [N]; None where they do not change.
    weight
        Length of a step ds beside one of the states [rad], for the length of steps alone.
    """

    problem: Problem
    start: Parameters
    direction: Parameters
    sector_angles: np.ndarray | None = None
    sector_change: np.ndarray | None = None
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
        sectors = None
        if self.sector_angles is not None and self.sector_change is not None:
            sectors = self.sector_angles + s * self.sector_change
        other: Problem = self.problem.varied(parameters, sectors)
        return other

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

    def from_here(self, s: float) -> ParameterLine:
        """Return the same line with s = 0 where it is s now."""
        here = self.at(s)
        sectors = None
        if self.sector_angles is not None and self.sector_change is not None:
            sectors = self.sector_angles + s * self.sector_change
        d = self.direction
        if d.laws is not None:
            d = replace(d, laws=d.laws.from_here(s))
        return replace(self, start=here.parameters, direction=d, sector_angles=sectors)

    def moved_torque(self, p: Problem, s: float, x: np.ndarray) -> np.ndarray | float:
        """Return how torques of the problem p at s change at a state [n] by laws that move: `slope` has the rest."""
        change, laws = self.direction.laws, p.parameters.laws
        if change is None or change.moving is None or laws is None:
            return 0.0
        return change.moving.rate(laws, s, x)


def line_between(a: Problem, b: Problem, length: float, weight: float = 0.3) -> ParameterLine:
    """Return the line from problem a at s = 0 to b at s = `length`, both of one structure and scale.

    Sector angles of the whole vertex are for the caller to add (`dataclasses.replace`) where they differ.
    """
    p, q = a.parameters, b.parameters
    direction = Parameters(
        (q.sectors - p.sectors) / length,
        np.log(q.stiffness / p.stiffness) / length,
        (q.rest - p.rest) / length,
        (q.load - p.load) / length,
        None if p.dead is None or q.dead is None else q.dead.moved(p.dead, -1.0).divided(length),
        None if p.laws is None or q.laws is None else p.laws.towards(q.laws, length),
    )
    return ParameterLine(a, p, direction, weight=weight)


def load_line(problem: Problem, load: np.ndarray, weight: float = 0.05) -> ParameterLine:
    """Return the line along which the load `load` [n] is multiplied by s, over `scale`, and added to what is there."""
    p = problem.parameters
    none = np.zeros_like(p.rest)
    still = Parameters(np.zeros_like(p.sectors), none, none, load)
    return ParameterLine(problem, p, still, weight=weight)
