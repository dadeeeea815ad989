"""Straight lines between the parameters of two problems."""

from __future__ import annotations

import numpy as np

from origami_nlp.continuation import ParameterLine
from origami_nlp.problem import Parameters, Problem


def line_between(a: Problem, b: Problem, length: float, weight: float = 0.3) -> ParameterLine:
    """Return the line from problem a at s = 0 to b at s = `length`, both of one structure and scale."""
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
