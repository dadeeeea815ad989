"""A family of patterns over one parameter, and the line of its problems.

Springs change along a `ParameterLine` as those of scenes do: names are those of `pattern.with_places`, and ``ratio``.
What moves vertices (``vertices.x[5]``, or an option of an example such as ``alpha`` of ``miura:3x3``) changes closure
itself: there every value has equations of its own, on a `PatternLine`.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from origami_nlp.bifurcation.family import Family, stiffness_over_ratio
from origami_nlp.bifurcation.parameter_range import ParameterRange, meant_by
from origami_nlp.continuation import STEPS, ContinuationOptions, ParameterLine, line_between
from origami_nlp.errors import OptionError
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern import (
    LAW_NUMBER,
    Pattern,
    as_pattern,
    check_law_place,
    examples,
    law_course,
    with_places,
)
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import find_states
from origami_nlp.problem import Contact

SHARE = 1e-3
"""Of the range: the step of the difference that follows closure along it; its error is the fourth power."""
KEPT = 64
"""Problems of a line that are kept: a point, what it is differentiated by, and the points before."""
CREASES = 6
"""Steps and weights of `path` are those of so many creases; their lengths grow as the root of the number."""


class MovedVertices(PatternProblem):
    """The problem of a pattern on a `PatternLine`: its KKT system is differentiated along that line alone."""

    line: PatternLine
    s: float

    def drift(
        self,
        x: np.ndarray,
        multipliers: np.ndarray,
        contacts: Sequence[Contact],
        change: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Differentiate the KKT system along the line, by differences of fourth order; change: of s, [1]."""
        h = SHARE * self.line.length

        def system(s: float) -> np.ndarray:
            p = self.line.at(s)
            local = p.rows(x)
            values, slopes = local.openings(contacts)
            m = p.equation_count
            torque = local.gradient - local.closure_jacobian.T @ multipliers[:m]
            return np.concatenate([torque - slopes.T @ multipliers[m:], local.closure, values])

        ahead, behind = ([system(self.s + sign * k * h) for k in (1, 2)] for sign in (1.0, -1.0))
        rate = (8 * (ahead[0] - behind[0]) - (ahead[1] - behind[1])) / (12 * h) * float(change[0])
        return rate[: self.size], rate[self.size :]


@dataclass(frozen=True, eq=False)
class PatternLine:
    """Problems of patterns of one structure whose vertices move with s: what `ParameterLine` is for springs.

    Attributes
    ----------
    pattern_of
        The pattern at s.
    start
        Value of s whose problem lends scale and numbers of contacts to all.
    length
        Of the range of s.
    weight
        Length of a step ds beside one of the states [rad], for the length of steps alone.
    """

    pattern_of: Callable[[float], Pattern] = field(repr=False)
    start: float
    length: float
    weight: float

    sector_angles = None

    @cached_property
    def problem(self) -> PatternProblem:
        """Whose scale and contacts all of them share."""
        return self._made(self.start)

    @cached_property
    def at(self) -> Callable[[float], Any]:
        """Return the problem at s; the last ones are kept."""

        def made(s: float) -> PatternProblem:
            return self.problem if s == self.start else self._made(s, self.problem)

        return lru_cache(maxsize=KEPT)(made)

    def _made(self, s: float, like: PatternProblem | None = None) -> PatternProblem:
        problem = MovedVertices(self.pattern_of(s))
        problem.line, problem.s = self, s
        return problem if like is None else problem.numbered_as(like)

    def slope(self, s: float) -> np.ndarray:
        """Return the change of s along itself, [1]: the problems know the rest."""
        return np.ones(1)

    def moved_torque(self, p: Any, s: float, x: np.ndarray) -> float:
        """Return 0: no law moves beside vertices."""
        return 0.0


@dataclass(frozen=True, eq=False)
class PatternFamily(Family):
    """Patterns over one parameter t: a `Family` whose `scene_of` makes patterns of one structure.

    Attributes
    ----------
    example
        The example by name where t is an option of it; "" elsewhere.
    """

    example: str = ""

    symmetric, preloaded = False, False

    @cached_property
    def line(self) -> ParameterLine | PatternLine:  # type: ignore[override]
        """The problems along it.

        Raises
        ------
        OptionError
            If patterns along it have not the same facets and creases, or their springs jump.
        """
        parameter = self.parameter
        low, high = parameter.ends
        where = np.linspace(low, high, self.samples)
        made: list[Any] = [self.sampled(parameter.t_of(float(s))) for s in where]
        first = made[0]
        for one, s in zip(made, where, strict=True):
            if one.polygons != first.polygons or not np.array_equal(one.ends, first.ends):
                raise OptionError(
                    f"{parameter.name} = {parameter.t_of(float(s)):.6g}: facets and creases are not those at the "
                    "other end: follow a shorter range"
                )
        weight = 0.3 * math.sqrt(max(first.creases / CREASES, 1.0))
        if any(not np.array_equal(one.corners, first.corners) for one in made):
            pattern_of: Any = self.scene_of
            return PatternLine(lambda s: pattern_of(parameter.t_of(s)), low, high - low, weight)
        whole = PatternProblem(first)
        posed = [PatternProblem(one).numbered_as(whole) for one in made]
        self._check(posed, where)
        return self.with_moving(line_between(posed[0], posed[-1], high - low, weight), low)

    @property
    def steps(self) -> ContinuationOptions:
        """Of the tracer: lengths are root mean squares over creases."""
        first: Any = self.sampled(self.parameter.low)
        size = math.sqrt(max(first.creases / CREASES, 1.0))
        return replace(STEPS, first=size * STEPS.first, longest=size * STEPS.longest)

    def search(  # type: ignore[override]
        self, made: list[Any], seconds: float | None, **options: Any
    ) -> list[MinimaResult]:
        """Search for the stable states of some of its patterns, one after the other, in so many seconds together."""
        share = None if seconds is None else seconds / len(made)
        options = {"escape": False, "seconds": share, "prove": False, **options}
        return [find_states(one, **options) for one in made]

    def problem(self, made: Any) -> PatternProblem:
        """Pose one of its patterns."""
        return PatternProblem(made)


def pattern_family(stated: Any, parameter: ParameterRange) -> PatternFamily:
    """Return the patterns that differ from one in a parameter.

    Parameters
    ----------
    stated
        As `as_pattern` takes it; of an example by name, its options can be followed over.
    parameter
        The parameter and its range.

    Returns
    -------
    PatternFamily
        The patterns.

    Raises
    ------
    OptionError
        If the pattern has no such parameter.
    """
    names = [name.strip() for name in parameter.name.split("+")]
    example = stated.partition(":")[0] if isinstance(stated, str) else ""
    options = (
        inspect.signature(examples.BY_NAME[example]).parameters
        if example in examples.BY_NAME
        else {}
    )
    if all(name in options for name in names):
        return PatternFamily(
            parameter,
            lambda t: examples.pattern(stated, **dict.fromkeys(names, t)),  # type: ignore[arg-type, return-value]
            example=stated,
        )
    problem = as_pattern(stated, "origami")
    problem.check_alone("following states over a parameter")
    if parameter.name == "ratio":
        check_law_place(problem.laws, "ratio")
        k = stiffness_over_ratio(problem.stiffness, problem.rest)
        return PatternFamily(parameter, lambda t: problem.with_springs(k(t)))  # type: ignore[arg-type, return-value]
    if LAW_NUMBER.fullmatch(parameter.name):
        course = law_course(problem.laws, parameter.name, parameter.low, parameter.high)
        return PatternFamily(
            parameter,
            lambda t: problem.with_laws(course.moved(problem.laws, t)),  # type: ignore[arg-type, return-value]
            course=course,
        )
    try:
        with_places(problem, dict.fromkeys(names, parameter.low))
    except OptionError as error:
        more = f"; of {example}: {', '.join(options)}" if options else ""
        raise OptionError(
            f"parameter = {error}, or ratio{more}{meant_by(parameter.name, options)}"
        ) from None
    return PatternFamily(parameter, lambda t: with_places(problem, dict.fromkeys(names, t)))  # type: ignore[arg-type, return-value]
