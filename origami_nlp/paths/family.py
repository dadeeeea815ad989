"""Origami over one or two parameters, and the lines of problems between them.

What a crease gets, its images under the symmetry that is kept get too (`with_generic_symmetry`); names: see `numbers`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.continuation import STEPS, ContinuationOptions, GeometryLine, Line, ParameterLine
from origami_nlp.errors import OptionError, OrigamiError
from origami_nlp.numerics import RESOLVED
from origami_nlp.paths.numbers import Example, with_numbers
from origami_nlp.paths.parameter_range import ParameterRange, meant_by
from origami_nlp.pattern import Scene, as_pattern, examples, with_symmetry_of
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import Parameters

CREASES, WEIGHT = 6, 0.3
"""Steps and weights of `path` are those of so many creases; their lengths grow as the root of the number."""
SAMPLES = 17
"""Scenes of a family that are posed before it is followed: whether it is smooth."""


@dataclass(frozen=True, eq=False)
class Family:
    """Origami over one parameter t.

    Attributes
    ----------
    parameter
        The parameter and its range.
    scene_of
        Makes the scene, or the pattern, at t; sector angles, rest angles, preload, forces and logarithms of stiffness
        must be linear in t (in ln t where `ParameterRange.log`).
    samples
        How many are posed before it is followed, to see whether it is smooth.
    like
        A problem whose scale and numbers of contacts those of the family take.
    example
        The example by name where t is an option of it; "" elsewhere.
    """

    parameter: ParameterRange
    scene_of: Callable[[float], Any] = field(repr=False)
    samples: int = field(default=SAMPLES, repr=False)
    like: PatternProblem | None = field(default=None, repr=False)
    example: str = ""

    @property
    def still(self) -> bool:
        """Whether the paper stays as it is along `line`."""
        return isinstance(self.line, ParameterLine)

    @cached_property
    def _posed(self) -> list[PatternProblem]:
        """Problems of equally many values, with the scale of the first."""
        values = np.linspace(*self.parameter.ends, self.samples).tolist()
        stated = (self.scene_of(self.parameter.t_of(s)) for s in values)
        made = [(one, pose(one)) for one in stated]
        if self.like is not None:
            made[0][1].numbered_as(self.like)
        return same_problem(made, self.parameter.name)

    @property
    def _size(self) -> float:
        return math.sqrt(max(self._posed[0].size / CREASES, 1.0))

    @cached_property
    def line(self) -> Line:
        """The problems along it.

        Raises
        ------
        OptionError
            If they are not posed alike, or their numbers jump.
        """
        (low, high), posed, weight = self.parameter.ends, self._posed, WEIGHT * self._size
        whole, length = posed[0], high - low
        corners = [p.pattern.corners for p in posed]
        moved = not all(np.array_equal(c, corners[0]) for c in corners)
        if moved and not len(whole.parameters.sectors):
            return GeometryLine(whole, self._problem_at, length, weight)
        numbers = np.array([linear_numbers(p.parameters) for p in posed])
        # equal steps of s: numbers that are linear change by the same from scene to scene
        change = np.diff(numbers, axis=0)
        apart = np.abs(change - np.median(change, axis=0)).max(axis=1)
        if apart.max() > RESOLVED:
            cuts = np.linspace(low, high, self.samples)[int(apart.argmax()) :][:2]
            a, b = (self.parameter.t_of(float(s)) for s in cuts)
            where = f"the scenes over {self.parameter.name} jump between {a:.6g} and {b:.6g}"
            raise OptionError(f"{where}: these are two families, follow each alone")
        first = whole.parameters
        direction = change_of(first, posed[-1].parameters, length)
        start = ParameterLine(whole, first, direction).at(-low).parameters
        line = ParameterLine(whole, start, direction, weight)
        if not direction.sectors.any():
            return line

        def at(s: float) -> Any:
            problem: Any = line.at(s)
            return problem.shaped(first.sectors + (s - low) * direction.sectors)

        return GeometryLine(whole, at, length, weight)

    def _problem_at(self, s: float) -> PatternProblem:
        return pose(self.scene_of(self.parameter.t_of(s))).numbered_as(self._posed[0])

    @property
    def symmetric(self) -> bool:
        """Whether its states keep a symmetry."""
        return self._posed[0].orbits is not None

    @property
    def steps(self) -> ContinuationOptions:
        """Of the tracer: lengths are root mean squares over creases."""
        return replace(STEPS, first=self._size * STEPS.first, longest=self._size * STEPS.longest)


@dataclass(frozen=True, eq=False)
class Plane:
    """Scenes that differ from one in two parameters.

    Attributes
    ----------
    scene
        Where the other numbers come from.
    parameters
        Both parameters with their ranges.
    """

    scene: Scene
    parameters: tuple[ParameterRange, ParameterRange]

    def family(self, value: float, axis: int = 0, samples: int = SAMPLES) -> Family:
        """Return the scenes over the first parameter (axis 0) or the second at one value of the other."""
        along, other = self.parameters[axis], self.parameters[1 - axis]
        made = family_of(family_of(self.scene, other).scene_of(value), along)
        return replace(made, like=self._like, samples=samples)

    @cached_property
    def _like(self) -> PatternProblem:
        """Whose scale and numbers of contacts all problems of the plane take."""
        return pose(self.scene)

    def share(self, s: float, axis: int) -> float:
        """Return which share of its range a parameter is at, as it is followed (logarithms of ratios)."""
        low, high = self.parameters[axis].ends
        return (s - low) / (high - low)

    def value(self, share: float, axis: int) -> float:
        """Return a parameter at a share of its range, exact at both ends."""
        low, high = self.parameters[axis].ends
        return self.parameters[axis].t_of(high if share == 1.0 else low + share * (high - low))


def linear_numbers(p: Parameters) -> np.ndarray:
    """Return the numbers that are linear along a line: in the order of `Parameters`, stiffness as its logarithm."""
    more = [] if p.dead is None else [p.dead.vector]
    k, rest = p.stiffness, p.rest
    if p.laws is not None:
        # a law has a factor and a shift
        none = p.laws.weight == 0
        k, rest = np.where(none, k, p.laws.weight + none), np.where(none, rest, p.laws.shift)
    return np.concatenate([p.sectors, np.log(k), rest, p.load, *more])


def change_of(p: Parameters, q: Parameters, length: float) -> Parameters:
    """Return the direction (`ParameterLine`) that leads from parameters to others over a length."""
    springs = 1.0 if p.laws is None else p.laws.weight == 0
    return Parameters(
        (q.sectors - p.sectors) / length,
        springs * np.log(q.stiffness / p.stiffness) / length,
        springs * (q.rest - p.rest) / length,
        (q.load - p.load) / length,
        None if p.dead is None else q.dead.moved(p.dead, -1.0).divided(length),
        None if p.laws is None or q.laws is None else p.laws.towards(q.laws, length),
    )


def same_problem(made: list[tuple[Any, PatternProblem]], name: str) -> list[PatternProblem]:
    """Return problems with the scale and the numbers of contacts of the first; name: of the parameter.

    Raises
    ------
    OptionError
        If some have other facets, hinge laws, another symmetry or contact.
    """
    _, whole = made[0]
    one = _structure(whole)
    for other in (_structure(problem) for _, problem in made):
        if one[:-1] != other[:-1]:
            why = "do not stay: state the symmetry, or follow a shorter range"
            raise OptionError(f"over {name} facets, creases, symmetry or contact {why}")
        if one[-1] != other[-1]:
            raise OptionError(f"over {name} hinge laws change by more than a factor and a shift")
    return [_posed_as(whole, stated, problem) for stated, problem in made]


def _structure(p: PatternProblem) -> tuple[Any, ...]:
    """Return what problems that are posed alike share; last the laws, but for their factors and shifts."""
    orbit = None if p.orbits is None else p.orbits.orbit.tolist()
    laws = () if p.parameters.laws is None else p.parameters.laws.laws
    return p.pattern.polygons, p.pattern.ends.tolist(), p.contact, p.has_limits, orbit, laws


def _posed_as(whole: PatternProblem, stated: Any, problem: PatternProblem) -> PatternProblem:
    """Return a problem with the scale of another, and preload as a load.

    A load is linear in the preload whatever the stiffness does; the angle to which it winds a spring is not.
    """
    preload = getattr(stated, "preload", ())
    if len(preload):
        load = problem.gathered(np.array(preload)) / problem.scale
        rest = problem.reduce(np.array(stated.rest_angles))
        problem = problem.varied(replace(problem.parameters, rest=rest, load=load))
    return problem if problem is whole else problem.numbered_as(whole)


def family_of(stated: Any, parameter: ParameterRange) -> Family:
    """Return the scenes, or patterns, that differ from one in a parameter.

    Parameters
    ----------
    stated
        Where the other numbers come from: a scene, whose symmetry is kept, or a pattern as `as_pattern` takes it; of an
        example by name, its options can be followed over.
    parameter
        The parameter and its range.

    Returns
    -------
    Family
        The scenes or patterns.

    Raises
    ------
    OptionError
        If there is no such parameter.
    """
    names = parameter.names
    example, of = "", stated
    if isinstance(stated, str) and examples.is_example(stated.partition(":")[0]):
        of = Example.of(stated, True)
        example = stated if {*names} <= {*of.options} - {"rows", "columns"} else ""
    if isinstance(stated, Scene):
        of = replace(stated.of_one_winding, symmetry=stated.group.name)
    elif not example:
        of = as_pattern(stated, "origami")
        of.check_alone("following states over a parameter")
    family = Family(parameter, lambda t: with_numbers(of, dict.fromkeys(names, t)), example=example)
    try:
        family.scene_of(parameter.low)
    except OptionError as error:
        more = f", or ratio{meant_by(parameter.name)}" * (not isinstance(stated, Scene))
        raise OptionError(f"parameter = {error}{more}") from None
    except OrigamiError:  # a value that does not fit is said where it is followed
        pass
    return family


def with_generic_symmetry(scene: Scene, parameters: Sequence[ParameterRange]) -> Scene:
    """Return a scene with the symmetry that it keeps at generic values of parameters; one that is stated stays.

    A parameter of a crease then moves that crease alone, as in a sweep; its images only under a stated symmetry.

    Parameters
    ----------
    scene
        With its symmetry stated or ``"auto"``.
    parameters
        Parameters and their ranges.

    Returns
    -------
    Scene
        With the symmetry that all scenes over the ranges share.

    Raises
    ------
    OptionError
        If the scene has no such parameter.
    """
    if scene.symmetry != "auto" or scene.group.is_trivial:
        return scene
    values: dict[str, float] = {}
    for k, parameter in enumerate(parameters, start=1):
        # no rational relation between parameters
        low, high = parameter.ends
        t = parameter.t_of(low + math.exp(-k) * (high - low))
        values |= dict.fromkeys(parameter.names, t)
    generic = with_numbers(replace(scene, mirror=None, winding=None), values)
    return with_symmetry_of(scene, generic)  # type: ignore[arg-type]
