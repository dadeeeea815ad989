"""A family of origami over one parameter, and the line of its problems.

What a crease gets, its images under the symmetry that is kept get too (`with_generic_symmetry`); names: see
`parameter_range`.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from origami_nlp.continuation import (
    STEPS,
    ContinuationOptions,
    GeometryLine,
    Line,
    ParameterLine,
    line_between,
)
from origami_nlp.errors import OptionError
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import RESOLVED
from origami_nlp.paths.alike import linear_numbers, same_problem, sector_line
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
from origami_nlp.pattern_problem import PatternProblem, pose, state_frame, states_to_fold
from origami_nlp.pattern_states import find_states
from origami_nlp.problem import LawChange

CREASES, WEIGHT = 6, 0.3
"""Steps and weights of `path` are those of so many creases; their lengths grow as the root of the number."""
SAMPLES = 17
"""Scenes of a family that are posed before it is followed, to see whether it is smooth."""
FAMILIES = {
    "degree6": ((1.0, -2.0, 1.0, 1.0, -2.0, 1.0), (0.0, math.pi, 0.0, 0.0, math.pi, 0.0)),
    "degree8": (
        (1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0),
        tuple(math.pi / 2 * v for v in (0, 1, 1, 0, 0, 1, 1, 0)),
    ),
}
"""Sector angles of the paper's families: change with alpha_1, and value at alpha_1 = 0."""


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

    def scene(self, t: float) -> Any:
        """Return the scene at t, named after it."""
        made = self.scene_of(t)
        label = f"{label}, " if (label := getattr(made, "label", made.name)) else ""
        return replace(made, name=f"{label}{self.parameter.name} = {t:.10g}")

    @cached_property
    def sampled(self) -> Callable[[float], Any]:
        """`scene_of`, each scene made once: those that are posed here, and without their symmetry."""
        return lru_cache(maxsize=SAMPLES)(self.scene_of)

    @property
    def still(self) -> bool:
        """Whether the paper stays as it is along `line`."""
        return isinstance(self.line, ParameterLine)

    @cached_property
    def _posed(self) -> list[PatternProblem]:
        """Problems of equally many values, with the scale of the first."""
        low, high = self.parameter.ends
        values = [self.parameter.t_of(float(s)) for s in np.linspace(low, high, self.samples)]
        made = [(stated, pose(stated)) for stated in map(self.sampled, values)]
        if self.like is not None:
            made[0][1].numbered_as(self.like)
        names = [f"{self.parameter.name} = {t:.6g}" for t in values]
        return same_problem(made, self.parameter.name, names, moving=self.course is not None)

    @cached_property
    def line(self) -> Line:
        """The problems along it.

        Raises
        ------
        OptionError
            If they are not posed alike, or their numbers jump.
        """
        low, high = self.parameter.ends
        posed = self._posed
        whole, size = posed[0], math.sqrt(max(posed[0].size / CREASES, 1.0))
        first, last = (p.parameters.sectors for p in (posed[0], posed[-1]))
        corners = whole.pattern.corners
        moved = any(not np.array_equal(p.pattern.corners, corners) for p in posed)
        if moved and not len(first):
            return GeometryLine(whole, self._problem_at, high - low, WEIGHT * size)
        self._check()
        line = line_between(whole, posed[-1], high - low, WEIGHT * size).from_here(-low)
        laws = line.direction.laws
        if self.course is not None and laws is not None:
            laws = replace(laws, moving=LawChange(self.course, 0.0))
            line = replace(line, direction=replace(line.direction, laws=laws))
        return sector_line(line, first, (last - first) / (high - low), low, high - low)

    def _problem_at(self, s: float) -> PatternProblem:
        stated = self.scene_of(self.parameter.t_of(s))
        return pose(stated).numbered_as(self._posed[0])

    def winding(self, s: float) -> float:
        """Return the energy that it took to wind preloaded springs at s, which states on the line do not count."""
        p, scale = self.line.at(s).parameters, self.line.problem.scale
        # k/2 (phi - phi0 - l/k)^2 = k/2 (phi - phi0)^2 - l phi + l phi0 + l^2 / (2 k)
        # of laws it does not count
        load = p.load if p.laws is None else p.laws.linear(p.load)
        return scale * float(np.sum(load * (p.rest + 0.5 * load / p.stiffness)))

    @property
    def symmetric(self) -> bool:
        """Whether its states keep a symmetry."""
        return self._posed[0].orbits is not None

    @property
    def preloaded(self) -> bool:
        """Whether energies of its scenes count what it took to wind springs."""
        return any(p.parameters.load.any() for p in (self._posed[0], self._posed[-1]))

    @property
    def steps(self) -> ContinuationOptions:
        """Of the tracer: lengths are root mean squares over creases."""
        size = math.sqrt(max(self._posed[0].size / CREASES, 1.0))
        return replace(STEPS, first=size * STEPS.first, longest=size * STEPS.longest)

    def search(
        self, made: list[Any], seconds: float | None, **options: Any
    ) -> Sequence[MinimaResult]:
        """Search for the minima of some of its scenes or patterns in so many seconds together."""
        share = None if seconds is None else seconds / len(made)
        options = {"escape": False, "seconds": share, **options}
        if isinstance(made[0], Scene):
            return [find_states(one, **options, full=False) for one in made]
        return [find_states(one, **{**options, "prove": False}) for one in made]

    def to_fold(self, states: list[tuple[float, Any, str, dict[str, Any]]]) -> dict[str, Any]:
        """Return states (t, fold angles, title, what else is known) as FOLD data (spec 1.1), a frame each."""
        frames = [
            state_frame(self.sampled(t), phi, title, **more) for t, phi, title, more in states
        ]
        return states_to_fold(self.scene(self.parameter.low), frames)

    def _check(self) -> None:
        """Raise an error where the numbers of scenes are not linear in s."""
        # equal steps of s: numbers that are linear change by the same from scene to scene
        change = np.diff([linear_numbers(m.parameters) for m in self._posed], axis=0)
        apart = np.abs(change - np.median(change, axis=0)).max(axis=1)
        if apart.max() > RESOLVED:
            k, (low, high) = int(apart.argmax()), self.parameter.ends
            where = np.linspace(low, high, self.samples)
            a, b = (self.parameter.t_of(float(where[k + i])) for i in (0, 1))
            raise OptionError(
                f"the scenes over {self.parameter.name} do not change smoothly between {a:.6g} and {b:.6g}: "
                "these are two families, follow each alone"
            )


def family_of(scene: Scene, parameter: ParameterRange) -> Family:
    """Return the scenes that differ from one in a parameter.

    Parameters
    ----------
    scene
        Where the other numbers come from; its symmetry is kept.
    parameter
        The parameter and its range.

    Returns
    -------
    Family
        The scenes.

    Raises
    ------
    OptionError
        If the scene has no such parameter.
    """
    base = replace(scene.of_one_winding, symmetry=scene.group.name)
    if parameter.name == "ratio":
        return Family(parameter, _over_ratio(base))
    if parameter.name == "alpha":
        return Family(parameter, _over_alpha(base))
    if parameter.name == "loads" and base.loads:
        return Family(parameter, _over_places(base, [("loads", k) for k in range(len(base.loads))]))
    if LAW_NUMBER.fullmatch(parameter.name):
        course = law_course(base.laws, parameter.name, parameter.low, parameter.high)
        return Family(
            parameter, lambda t: replace(base, laws=course.moved(base.laws, t)), course=course
        )
    places = []
    for name in parameter.name.split("+"):
        match = PLACE.fullmatch(name.strip())
        most = len(base.loads) if match and match[3] else base.degree
        if match is None or not 1 <= int(match[4]) <= most:
            raise OptionError(
                f"parameter = {parameter.name!r} is no parameter of the scene: write ratio, alpha, stiffness[1], "
                f"rest_angles[1], preload[1], torque[1], sector_angles[1], law_scale[1], law_shift[1] or "
                f"laws.NAME.energy, with entries 1 to {base.degree}"
                + (f", or loads, loads[1] to loads[{len(base.loads)}]" if base.loads else "")
                + meant_by(name)
            )
        places.append((kind_of(name), int(match[4]) - 1))
        check_law_place(base.laws, *places[-1])
    return Family(parameter, _over_places(base, places))


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


def _over_ratio(scene: Scene) -> Callable[[float], Scene]:
    """Set the ratio of stiffnesses of a scene."""
    check_law_place(scene.laws, "ratio")
    k = stiffness_over_ratio(np.array(scene.stiffness), np.array(scene.rest_angles))
    return lambda ratio: replace(scene, stiffness=tuple(k(ratio)))


def stiffness_over_ratio(k: np.ndarray, rest: np.ndarray) -> Callable[[float], list[float]]:
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

    def at(ratio: float) -> list[float]:
        values: list[float] = (k * np.exp(side * (math.log(ratio) - now))).tolist()
        return values

    return at


def _over_alpha(scene: Scene) -> Callable[[float], Scene]:
    sectors = np.array(scene.vertex.sector_angles)
    for slope, start in FAMILIES.values():
        if len(slope) != len(sectors):
            continue
        change, origin = np.array(slope), np.array(start)
        if np.abs(origin + sectors[0] * change - sectors).max() <= RESOLVED:
            return lambda t: replace(scene, vertex=Vertex(tuple((origin + t * change).tolist())))
    raise OptionError(
        "parameter = 'alpha' needs the sector angles of the families degree6 or degree8 (`origami-nlp example`)"
    )


def _images(scene: Scene, entry: int, facet: bool) -> list[int]:
    """Return the creases, or facets, that a symmetry of the scene makes of one."""
    moved = ((s - entry - facet) if mirrored else entry + s for s, mirrored in scene.group.elements)
    return sorted({place % scene.degree for place in moved})


def _over_places(scene: Scene, places: list[tuple[str, int]]) -> Callable[[float], Scene]:
    def at(t: float) -> Scene:
        values = {
            "stiffness": list(scene.stiffness),
            "rest_angles": list(scene.rest_angles),
            "preload": list(scene.preload or (0.0,) * scene.degree),
        }
        sectors, loads = scene.vertex.sector_angles, list(scene.loads)
        laws = list(scene.laws)
        for what, entry in places:
            if what == "sector_angles":
                sectors = _with_sector(scene, sectors, entry, t)
            elif what == "loads":
                x, y, z = scene.loads[entry].force or (0.0, 0.0, 0.0)
                loads[entry] = replace(loads[entry], force=(t * x, t * y, t * z))
            else:
                for i in _images(scene, entry, False):
                    if what in LAW_PLACES:
                        # of what is stated: an image may be named as well
                        laws[i] = law_at(scene.laws[i], what, t)
                        continue
                    given = scene.preload[i] if what == "torque" and scene.preload else 0.0
                    values["preload" if what == "torque" else what][i] = given + t
        vertex = scene.vertex
        if sectors != vertex.sector_angles:
            vertex = Vertex(sectors, vertex.flat)
        k, rest, preload = (tuple(v) for v in values.values())
        return replace(
            scene, vertex=vertex, stiffness=k, rest_angles=rest, preload=preload, loads=tuple(loads),
            laws=tuple(laws),
        )  # fmt: skip

    return at


def _with_sector(
    scene: Scene, sectors: tuple[float, ...], entry: int, t: float
) -> tuple[float, ...]:
    """Return sector angles with t at a facet and its images; where the sheet is flat the others give way alike."""
    images, out = _images(scene, entry, True), np.array(sectors)
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


def pattern_family(stated: Any, parameter: ParameterRange) -> Family:
    """Return the patterns that differ from one in a parameter.

    Parameters
    ----------
    stated
        As `as_pattern` takes it; of an example by name, its options can be followed over.
    parameter
        The parameter and its range.

    Returns
    -------
    Family
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
        return Family(
            parameter,
            lambda t: examples.pattern(stated, **dict[str, Any](dict.fromkeys(names, t))),
            example=stated,
        )
    problem = as_pattern(stated, "origami")
    problem.check_alone("following states over a parameter")
    if parameter.name == "ratio":
        check_law_place(problem.laws, "ratio")
        k = stiffness_over_ratio(problem.stiffness, problem.rest)
        return Family(parameter, lambda t: problem.with_springs(k(t)))
    if LAW_NUMBER.fullmatch(parameter.name):
        course = law_course(problem.laws, parameter.name, parameter.low, parameter.high)
        return Family(
            parameter,
            lambda t: problem.with_laws(course.moved(problem.laws, t)),
            course=course,
        )
    try:
        with_places(problem, dict.fromkeys(names, parameter.low))
    except OptionError as error:
        more = f"; of {example}: {', '.join(options)}" if options else ""
        raise OptionError(
            f"parameter = {error}, or ratio{more}{meant_by(parameter.name, options)}"
        ) from None
    return Family(parameter, lambda t: with_places(problem, dict.fromkeys(names, t)))
