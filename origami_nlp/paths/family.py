"""Origami over one or two parameters, and the lines of problems between them.

What a crease gets, its images under the symmetry that is kept get too (`with_generic_symmetry`); names: see
`parameter_range`.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from origami_nlp.continuation import STEPS, ContinuationOptions, GeometryLine, Line, ParameterLine
from origami_nlp.errors import OptionError
from origami_nlp.numerics import RESOLVED
from origami_nlp.paths.parameter_range import PLACE, ParameterRange, kind_of, meant_by
from origami_nlp.pattern import (
    LAW_NUMBER,
    LAW_PLACES,
    LawCourse,
    Scene,
    Vertex,
    as_pattern,
    check_law_place,
    examples,
    law_at,
    law_course,
    with_places,
    with_symmetry_of,
)
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import LawChange, Parameters

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
    course
        The hinge law that t is a number of, if it is.
    like
        A problem whose scale and numbers of contacts those of the family take.
    example
        The example by name where t is an option of it; "" elsewhere.
    """

    parameter: ParameterRange
    scene_of: Callable[[float], Any] = field(repr=False)
    samples: int = field(default=SAMPLES, repr=False)
    course: LawCourse | None = field(default=None, repr=False)
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
        stated = [self.scene_of(self.parameter.t_of(s)) for s in values]
        made = [(one, pose(one)) for one in stated]
        if self.like is not None:
            made[0][1].numbered_as(self.like)
        return same_problem(made, self.parameter.name, moving=self.course is not None)

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
            raise OptionError(
                f"the scenes over {self.parameter.name} do not change smoothly between {a:.6g} and {b:.6g}: "
                "these are two families, follow each alone"
            )
        first = whole.parameters
        direction = change_of(first, posed[-1].parameters, length)
        start = ParameterLine(whole, first, direction).at(-low).parameters
        if self.course is not None and direction.laws is not None:
            laws = replace(direction.laws, moving=LawChange(self.course, 0.0))
            direction = replace(direction, laws=laws)
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


def same_problem(
    made: list[tuple[Any, PatternProblem]], name: str, *, moving: bool = False
) -> list[PatternProblem]:
    """Return problems with the scale and the numbers of contacts of the first; name: of the parameter.

    Raises
    ------
    OptionError
        If some have other facets, another symmetry or contact, or, unless they move, hinge laws.
    """
    _, whole = made[0]
    for _, problem in made:
        one, other = _structure(whole), _structure(problem)
        if one[:-1] != other[:-1]:
            raise OptionError(
                f"over {name} facets, creases, symmetry or contact do not stay: state the symmetry, or follow a "
                "shorter range"
            )
        if not moving and one[-1] != other[-1]:
            raise OptionError(f"over {name} hinge laws change by more than a factor and a shift")
    return [_posed_as(whole, stated, problem) for stated, problem in made]


def _structure(p: PatternProblem) -> tuple[Any, ...]:
    """Return what problems that are posed alike share; last the laws, but for their factors and shifts."""
    orbit = None if p.orbits is None else p.orbits.orbit.tolist()
    laws = () if p.parameters.laws is None else p.parameters.laws.laws
    facets = p.pattern.polygons, p.pattern.ends.tolist()
    return *facets, p.contact, p.has_limits, orbit, laws


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
    names = [name.strip() for name in parameter.name.split("+")]
    example = stated.partition(":")[0] if isinstance(stated, str) else ""
    made = examples.BY_NAME.get(example)
    options = inspect.signature(made).parameters if made else {}
    if all(name in options for name in names):
        of: Any = partial(examples.pattern, stated)
        return Family(parameter, lambda t: of(**dict.fromkeys(names, t)), example=stated)
    base: Any
    if isinstance(stated, Scene):
        base = replace(stated.of_one_winding, symmetry=stated.group.name)
        sprung, bent = (partial(_replaced, base, name) for name in ("stiffness", "laws"))
        rest = base.rest_angles
    else:
        base = as_pattern(stated, "origami")
        base.check_alone("following states over a parameter")
        sprung, bent, rest = base.with_springs, base.with_laws, base.rest
    if parameter.name == "ratio":
        check_law_place(base.laws, "ratio")
        k = _stiffness_over_ratio(np.array(base.stiffness), np.array(rest))
        return Family(parameter, lambda t: sprung(k(t)))
    if LAW_NUMBER.fullmatch(parameter.name):
        course = law_course(base.laws, parameter.name, parameter.low, parameter.high)
        return Family(parameter, lambda t: bent(course.moved(base.laws, t)), course=course)
    if isinstance(stated, Scene):
        return Family(parameter, _over_scenes(base, parameter, names))
    try:
        with_places(base, dict.fromkeys(names, parameter.low))
    except OptionError as error:
        more = f"; of {example}: {', '.join(options)}" if options else ""
        raise OptionError(
            f"parameter = {error}, or ratio{more}{meant_by(parameter.name, options)}"
        ) from None
    return Family(parameter, lambda t: with_places(base, dict.fromkeys(names, t)))


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
    made = replace(scene, symmetry="none", mirror=None, winding=None)
    for k, parameter in enumerate(parameters, start=1):
        # no rational relation between parameters
        low, high = parameter.ends
        t = parameter.t_of(low + math.exp(-k) * (high - low))
        made = family_of(made, parameter).scene_of(t)
    return with_symmetry_of(scene, replace(made, symmetry="auto"))


def _replaced(scene: Scene, name: str, values: Sequence[Any]) -> Scene:
    changed: Any = {name: tuple(values)}
    return replace(scene, **changed)


def _stiffness_over_ratio(k: np.ndarray, rest: np.ndarray) -> Callable[[float], list[float]]:
    """Multiply stiffnesses [n] of mountains by sqrt(r / r_0), divide those of valleys by it."""
    mountain = rest < 0
    if mountain.all() or not mountain.any():
        raise OptionError(
            "parameter = 'ratio' is the stiffness of mountains over that of valleys: there is only one of them"
        )
    log = np.log(k)
    # k_m / k_v = r, their geometric mean unchanged (paper, section 3: k_m = 0.025 sqrt(r), k_v = 0.025 / sqrt(r))
    now = log[mountain].mean() - log[~mountain].mean()
    side = np.where(mountain, 0.5, -0.5)
    return lambda ratio: (k * np.exp(side * (math.log(ratio) - now))).tolist()  # type: ignore[no-any-return]


def _over_scenes(
    scene: Scene, parameter: ParameterRange, names: list[str]
) -> Callable[[float], Scene]:
    """Return what sets a parameter of a scene: sector angles of the paper's families, factors of forces, or places."""
    if parameter.name == "alpha":
        return _over_alpha(scene)
    if parameter.name == "loads" and scene.loads:
        return partial(at_places, scene, [("loads", k) for k in range(len(scene.loads))])
    places = []
    for name in names:
        match = PLACE.fullmatch(name)
        most = len(scene.loads) if match and match[3] else scene.degree
        number = int(next(filter(None, match.groups()))) if match else 0
        if not 1 <= number <= most:
            raise OptionError(
                f"parameter = {parameter.name!r} is no parameter of the scene: write ratio, alpha, stiffness[1], "
                f"rest_angles[1], preload[1], torque[1], sector_angles[1], law_scale[1], law_shift[1] or "
                f"laws.NAME.energy, with entries 1 to {scene.degree}"
                + (f", or loads, loads[1] to loads[{len(scene.loads)}]" if scene.loads else "")
                + meant_by(name)
            )
        places.append((kind_of(name), number - 1))
        check_law_place(scene.laws, *places[-1])
    return partial(at_places, scene, places)


def _over_alpha(scene: Scene) -> Callable[[float], Scene]:
    """Set alpha_1 of the paper's families, sector angles that are linear in it."""
    now = np.array(scene.vertex.sector_angles)
    for made in (examples.degree6, examples.degree8):
        zero, one = (np.array(made(t).vertex.sector_angles) for t in (0.5, 1.0))
        slope = 2 * (one - zero)
        if len(zero) == len(now) and np.abs(zero + (now[0] - 0.5) * slope - now).max() <= RESOLVED:
            slope = np.round(slope)
            origin = zero - 0.5 * slope
            return lambda t: replace(scene, vertex=Vertex(tuple((origin + t * slope).tolist())))
    raise OptionError(
        "parameter = 'alpha' needs the sector angles of the families degree6 or degree8 (`origami-nlp example`)"
    )


def _images(scene: Scene, entry: int, facet: bool) -> list[int]:
    """Return the creases, or facets, that a symmetry of the scene makes of one."""
    moved = ((s - entry - facet) if mirrored else entry + s for s, mirrored in scene.group.elements)
    return sorted({place % scene.degree for place in moved})


def at_places(scene: Scene, places: list[tuple[str, int]], t: float) -> Scene:
    """Return a scene with t at some places."""
    preload = scene.preload or (0.0,) * scene.degree
    lists = {name: list(getattr(scene, name)) for name in ("stiffness", "rest_angles")}
    lists |= {"preload": list(preload), "loads": list(scene.loads), "laws": list(scene.laws)}
    vertex = scene.vertex
    for what, entry in places:
        if what == "sector_angles":
            vertex = Vertex(_with_sector(scene, vertex, entry, t), vertex.flat)
        elif what == "loads":
            force: Any = tuple(t * f for f in scene.loads[entry].force or (0.0,) * 3)
            lists["loads"][entry] = replace(scene.loads[entry], force=force)
        else:
            for i in _images(scene, entry, False):
                if what in LAW_PLACES:
                    # of what is stated: an image may be named as well
                    lists["laws"][i] = law_at(scene.laws[i], what, t)
                elif what == "torque":
                    lists["preload"][i] = preload[i] + t
                else:
                    lists[what][i] = t
    changed: Any = {name: tuple(v) for name, v in lists.items()}
    return replace(scene, vertex=vertex, **changed)


def _with_sector(scene: Scene, vertex: Vertex, entry: int, t: float) -> tuple[float, ...]:
    """Return sector angles with t at a facet and its images; where the sheet is flat the others give way alike."""
    images, out = _images(scene, entry, True), np.array(vertex.sector_angles)
    others = [i for i in range(len(out)) if i not in images]
    if scene.vertex.flat and not others:
        raise OptionError(
            f"vertex.sector_angles[{entry + 1}]: its images are all facets of the sheet"
        )
    if scene.vertex.flat:
        # the sum stays 2 pi
        out[others] -= len(images) * (t - out[entry]) / len(others)
    out[images] = t
    return tuple(out.tolist())
