"""Origami over one parameter, and the line of problems along it.

What a crease gets, its images under the symmetry that is kept get too (`with_generic_symmetry`); names: see
`pattern.with_numbers`.
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
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.pattern import (
    Example,
    Scene,
    as_pattern,
    examples,
    with_numbers,
    with_symmetry_of,
)
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
        posed = list[PatternProblem]()
        for s in values:
            made = self.scene_of(self.parameter.t_of(s))
            like = posed[0] if posed else self.like
            posed.append(posed_as(like, pose(made), made, self.parameter.name))
        return posed

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
        over, posed, weight = self.parameter, self._posed, WEIGHT * self._size
        (low, high), whole, first = over.ends, posed[0], posed[0].parameters
        length, corners = high - low, [p.pattern.corners for p in posed]
        moved = not all(np.array_equal(c, corners[0]) for c in corners)
        if moved and not len(first.sectors):
            return GeometryLine(whole, self._problem_at, length, weight)
        direction = change_of(first, posed[-1].parameters, length)
        start = ParameterLine(whole, first, direction).at(-low).parameters
        line = ParameterLine(whole, start, direction, weight)
        values = np.linspace(low, high, self.samples).tolist()

        def sectors(s: float) -> np.ndarray:
            return first.sectors + (s - low) * direction.sectors

        off = np.array([_numbers(p.parameters, p.parameters.sectors) for p in posed])
        off -= [_numbers(line.at(s).parameters, sectors(s)) for s in values]
        if np.abs(off).max() > RESOLVED * (1 + np.abs(first.vector).max()):
            k = int(np.abs(np.diff(off, axis=0)).max(axis=1).argmax())
            a, b = map(over.t_of, values[k : k + 2])
            where = f"the scenes over {over.name} jump between {a:.6g} and {b:.6g}"
            raise OptionError(f"{where}: these are two families, follow each alone")
        if not direction.sectors.any():
            return line

        def at(s: float) -> Any:
            problem: Any = line.at(s)
            return problem.shaped(sectors(s))

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


def _numbers(p: Parameters, sectors: np.ndarray) -> np.ndarray:
    """Return the numbers of a problem; hinges with laws have no others."""
    springs = 1.0 if p.laws is None else p.laws.weight == 0
    return replace(
        p, sectors=sectors, stiffness=springs * p.stiffness, rest=springs * p.rest
    ).vector


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


def posed_as(like: PatternProblem | None, problem: PatternProblem, made: Any, name: str) -> Any:
    """Return a problem with scale and contacts of another one, and preload as a load; name: of the parameter.

    A load is linear in the preload whatever the stiffness does; the angle to which it winds a spring is not.

    Raises
    ------
    OptionError
        If it has other facets, hinge laws, another symmetry or contact.
    """
    if like is not None:
        one, other = map(_structure, (like, problem))
        if one[:-1] != other[:-1]:
            why = "do not stay: state the symmetry, or follow a shorter range"
            raise OptionError(f"over {name} facets, creases, symmetry or contact {why}")
        if one[-1] != other[-1]:
            raise OptionError(f"over {name} hinge laws change by more than a factor and a shift")
    if len(preload := getattr(made, "preload", ())):
        load = problem.gathered(np.array(preload)) / problem.scale
        rest = problem.reduce(made.rest)
        problem = problem.varied(replace(problem.parameters, rest=rest, load=load))
    return problem if like is None else problem.numbered_as(like)


def _structure(p: PatternProblem) -> tuple[Any, ...]:
    """Return what problems that are posed alike share; last the laws, but for their factors and shifts."""
    orbit = None if p.orbits is None else p.orbits.orbit.tolist()
    laws = () if p.parameters.laws is None else p.parameters.laws.laws
    return p.pattern.polygons, p.pattern.ends.tolist(), p.contact, p.has_limits, orbit, laws


def family_of(stated: Any, *parameters: ParameterRange, at: Sequence[float] = ()) -> Family:
    """Return the scenes, or patterns, that differ from one in a parameter.

    Parameters
    ----------
    stated
        Where the other numbers come from: a scene, whose symmetry is kept, or a pattern as `as_pattern` takes it; of an
        example by name, its options can be followed over.
    *parameters
        The parameter and its range, and others that are held.
    at
        Values of the others.

    Returns
    -------
    Family
        The scenes or patterns.

    Raises
    ------
    OptionError
        If there is no such parameter.
    """
    parameter, *others = parameters
    names, held = parameter.names, dict[str, float]()
    for other, value in zip(others, at, strict=True):
        held |= dict.fromkeys(other.names, value)
    example, of = "", stated
    if isinstance(stated, str) and examples.is_example(stated.partition(":")[0]):
        of = Example.of(stated, True)
        example = stated if {*names} <= {*of.options} - {"rows", "columns"} else ""
    if isinstance(stated, Scene):
        of = replace(stated.of_one_winding, symmetry=stated.group.name)
    elif not example:
        of = as_pattern(stated, "origami")
        of.check_alone("following states over a parameter")
    made: Any = lambda t: with_numbers(of, {**held, **{name: t for name in names}})  # noqa: E731
    try:
        made(parameter.low)
    except OptionError as error:
        raise OptionError(f"parameter = {error}") from None
    except OrigamiError:  # a value that does not fit is said where it is followed
        pass
    return Family(parameter, made, example=example)


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
        values |= dict.fromkeys(parameter.names, parameter.at_share(math.exp(-k)))
    generic = with_numbers(replace(scene, mirror=None, winding=None), values)
    return with_symmetry_of(scene, generic)  # type: ignore[arg-type]
