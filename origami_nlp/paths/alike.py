"""Problems that are posed alike, so that lines and planes lead from one to another."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from origami_nlp.continuation import GeometryLine, Line, ParameterLine
from origami_nlp.errors import OptionError
from origami_nlp.pattern import HingeLaw
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.problem import Parameters


def sector_line(
    line: ParameterLine, first: np.ndarray, change: np.ndarray, start: float, length: float
) -> Line:
    """Return a line along which the sector angles of one vertex change too.

    Parameters
    ----------
    line
        Of springs and loads.
    first
        Sector angles at `start` [N] [rad].
    change
        Of sector angles with s, [N].
    start, length
        Where the line begins, and its length.

    Returns
    -------
    ParameterLine or GeometryLine
        The line itself where no sector changes.
    """
    if not change.any():
        return line

    def at(s: float) -> Any:
        problem: Any = line.at(s)
        return problem.shaped(first + (s - start) * change)

    return GeometryLine(line.problem, at, length, line.weight)


def same_problem(
    made: list[tuple[Any, PatternProblem]], name: str, names: list[str], *, moving: bool = False
) -> list[PatternProblem]:
    """Return problems with the scale and the numbers of contacts of the first.

    Raises
    ------
    OptionError
        If some have other facets, another symmetry or contact, or, unless they move, hinge laws; name: of the
        parameter, names: of the scenes.
    """
    _, whole = made[0]
    for (_, problem), where in zip(made, names, strict=True):
        if not _is_like(problem, whole):
            raise OptionError(
                f"{where}: facets, creases, symmetry or contact are not those at the other end of {name}: state the "
                "symmetry, or follow a shorter range"
            )
        if not moving and _laws_of(problem) != _laws_of(whole):
            raise OptionError(f"{where}: hinge laws are others than elsewhere over {name}")
    return [_posed_as(whole, stated, problem) for stated, problem in made]


def _is_like(problem: PatternProblem, other: PatternProblem) -> bool:
    """Return whether two problems have the same facets, creases, symmetry and contact."""
    p, q = problem, other
    if (p.pattern.polygons, p.contact, p.has_limits) != (
        q.pattern.polygons,
        q.contact,
        q.has_limits,
    ):
        return False
    orbits = [None if x.orbits is None else x.orbits.orbit.tolist() for x in (p, q)]
    return np.array_equal(p.pattern.ends, q.pattern.ends) and orbits[0] == orbits[1]


def _laws_of(problem: PatternProblem) -> tuple[HingeLaw | None, ...]:
    """Return the laws of the variables, but for their factors and shifts."""
    laws = problem.parameters.laws
    return () if laws is None else laws.laws


def _posed_as(whole: PatternProblem, stated: Any, problem: PatternProblem) -> PatternProblem:
    """Return a problem with the scale of another, and preload as a load.

    A load is linear in the preload whatever the stiffness does; the angle to which it winds a spring is not.
    """
    preload = getattr(stated, "preload", ())
    if len(preload):
        p = problem.parameters
        load = problem.gathered(np.array(preload)) / problem.scale
        problem = problem.varied(
            replace(p, rest=problem.reduce(np.array(stated.rest_angles)), load=load)
        )
    return problem if problem is whole else problem.numbered_as(whole)


def linear_numbers(p: Parameters) -> np.ndarray:
    """Return the numbers that are linear along a line: in the order of `Parameters`, stiffness as its logarithm."""
    more = [] if p.dead is None else [p.dead.vector]
    k, rest = p.stiffness, p.rest
    if p.laws is not None:
        # a law has a factor and a shift
        none = p.laws.weight == 0
        k, rest = np.where(none, k, p.laws.weight + none), np.where(none, rest, p.laws.shift)
    return np.concatenate([p.sectors, np.log(k), rest, p.load, *more])
