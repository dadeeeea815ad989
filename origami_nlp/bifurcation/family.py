"""A family of scenes over one parameter, and the line of its problems.

What a crease gets, its images under the symmetry that is kept get too (`with_generic_symmetry`); names: see
`parameter_range`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from origami_nlp.bifurcation.parameter_range import PLACE, ParameterRange, kind_of, meant_by
from origami_nlp.continuation import STEPS, ContinuationOptions, ParameterLine, line_between
from origami_nlp.errors import OptionError
from origami_nlp.minima import MinimaResult, find_minima_of_each
from origami_nlp.numerics import RESOLVED
from origami_nlp.pattern import (
    LAW_NUMBER,
    LAW_PLACES,
    HingeLaw,
    LawCourse,
    Scene,
    Vertex,
    check_law_place,
    law_at,
    law_course,
    with_symmetry_of,
)
from origami_nlp.pattern_problem import PatternProblem, pose, state_frame, states_to_fold
from origami_nlp.problem import LawChange, Parameters

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
    """Scenes over one parameter t.

    Attributes
    ----------
    parameter
        The parameter and its range.
    scene_of
        Makes the scene at t; sector angles, rest angles, preload, forces and logarithms of stiffness must be linear in
        t (in ln t where `ParameterRange.log`).
    samples
        How many scenes are posed before it is followed, to see whether it is smooth.
    course
        The hinge law that t is a number of, if it is.
    like
        A problem whose scale and numbers of contacts those of the family take.
    """

    parameter: ParameterRange
    scene_of: Callable[[float], Scene] = field(repr=False)
    samples: int = field(default=SAMPLES, repr=False)
    course: LawCourse | None = field(default=None, repr=False)
    like: PatternProblem | None = field(default=None, repr=False)

    def scene(self, t: float) -> Scene:
        """Return the scene at t, named after it."""
        made = self.scene_of(t)
        label = f"{label}, " if (label := getattr(made, "label", made.name)) else ""
        return replace(made, name=f"{label}{self.parameter.name} = {t:.10g}")

    @cached_property
    def sampled(self) -> Callable[[float], Scene]:
        """`scene_of`, each scene made once: those that are posed here, and without their symmetry."""
        return lru_cache(maxsize=SAMPLES)(self.scene_of)

    @property
    def one_vertex(self) -> bool:
        """Whether all scenes along `line` are of one vertex."""
        return self.line.sector_angles is None

    @cached_property
    def line(self) -> ParameterLine:
        """The problems along it.

        Raises
        ------
        OptionError
            If scenes along it are not posed alike, or their numbers jump.
        """
        parameter = self.parameter
        low, high = parameter.ends
        where = np.linspace(low, high, self.samples)
        scenes = [self.sampled(parameter.t_of(float(s))) for s in where]
        names = [f"{parameter.name} = {parameter.t_of(float(s)):.6g}" for s in where]
        models = [pose(scene) for scene in scenes]
        moving = self.course is not None
        if self.like is not None:
            models[0].numbered_as(self.like)
        posed = same_problem(
            list(zip(scenes, models, strict=True)), parameter.name, names, moving=moving
        )
        self._check(posed, where)
        line = self.with_moving(line_between(posed[0], posed[-1], high - low), low)
        first, last = (np.array(scenes[k].vertex.sector_angles) for k in (0, -1))
        if (first != last).any():
            change = (last - first) / (high - low)
            line = replace(line, sector_angles=first - low * change, sector_change=change)
        return line

    def with_moving(self, line: ParameterLine, low: float) -> ParameterLine:
        """Return a line from the lower end with s = t, or ln t, and the laws that it moves through."""
        line = line.from_here(-low)
        laws = line.direction.laws
        if self.course is None or laws is None:
            return line
        laws = replace(laws, moving=LawChange(self.course, 0.0))
        return replace(line, direction=replace(line.direction, laws=laws))

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
        return not self.scene(self.parameter.low).group.is_trivial

    @property
    def preloaded(self) -> bool:
        """Whether energies of its scenes count what it took to wind springs."""
        return bool(self.line.start.load.any() or self.line.direction.load.any())

    @property
    def steps(self) -> ContinuationOptions:
        """Of the tracer."""
        return STEPS

    def search(
        self, made: list[Scene], seconds: float | None, **options: Any
    ) -> Sequence[MinimaResult]:
        """Search for the minima of some of its scenes, together, in so many seconds."""
        return find_minima_of_each(made, seconds=seconds, **options)

    def problem(self, made: Scene) -> Any:
        """Pose one of its scenes."""
        return pose(made)

    def to_fold(self, states: list[tuple[float, Any, str, dict[str, Any]]]) -> dict[str, Any]:
        """Return states (t, fold angles, title, what else is known) as FOLD data (spec 1.1), a frame each."""
        frames = [
            state_frame(self.sampled(t), phi, title, **more) for t, phi, title, more in states
        ]
        return states_to_fold(self.scene(self.parameter.low), frames)

    def _check(self, posed: Sequence[Any], where: np.ndarray) -> None:
        """Raise an error where the numbers of scenes are not linear in s."""
        # equal steps of s: numbers that are linear change by the same from scene to scene
        change = np.diff([linear_numbers(m.parameters) for m in posed], axis=0)
        apart = np.abs(change - np.median(change, axis=0)).max(axis=1)
        if apart.max() > RESOLVED:
            k = int(apart.argmax())
            a, b = (self.parameter.t_of(float(where[k + i])) for i in (0, 1))
            raise OptionError(
                f"the scenes over {self.parameter.name} do not change smoothly between {a:.6g} and {b:.6g}: "
                "these are two families, follow each alone"
            )


def same_problem(
    made: list[tuple[Scene, PatternProblem]], name: str, names: list[str], *, moving: bool = False
) -> list[PatternProblem]:
    """Return the problems of scenes with the scale and the numbers of contacts of the first.

    Raises
    ------
    OptionError
        If some have another symmetry or contact, or, unless they move, hinge laws; name: of the parameter, names: of
        the scenes.
    """
    first, whole = made[0]
    for (scene, problem), where in zip(made, names, strict=True):
        if (scene.group.name, scene.contact) != (first.group.name, first.contact):
            raise OptionError(
                f"{where}: symmetry {scene.group.name} and contact {scene.contact!r} are not those of other scenes "
                f"over {name}: state the symmetry, or follow a shorter range"
            )
        if not moving and _laws_of(problem) != _laws_of(whole):
            raise OptionError(f"{where}: hinge laws are others than elsewhere over {name}")
    return [_posed_as(whole, scene, problem) for scene, problem in made]


def _laws_of(problem: PatternProblem) -> tuple[HingeLaw | None, ...]:
    """Return the laws of the variables, but for their factors and shifts."""
    laws = problem.parameters.laws
    return () if laws is None else laws.laws


def linear_numbers(p: Parameters) -> np.ndarray:
    """Return the numbers that are linear along a line: in the order of `Parameters`, stiffness as its logarithm."""
    more = [] if p.dead is None else [p.dead.vector]
    k, rest = p.stiffness, p.rest
    if p.laws is not None:
        # a law has a factor and a shift
        none = p.laws.weight == 0
        k, rest = np.where(none, k, p.laws.weight + none), np.where(none, rest, p.laws.shift)
    return np.concatenate([p.sectors, np.log(k), rest, p.load, *more])


def _posed_as(whole: PatternProblem, scene: Scene, problem: PatternProblem) -> PatternProblem:
    """Return a problem with the scale of another, and preload as a load.

    A load is linear in the preload whatever the stiffness does; the angle to which it winds a spring is not.
    """
    p = problem.parameters
    if scene.preload:
        rest = problem.reduce(np.array(scene.rest_angles))
        load = problem.reduce(np.array(scene.preload)) * problem.multiplicity / problem.scale
        p = replace(p, rest=rest, load=load)
    parameters = p.scaled(problem.scale / whole.scale)
    return whole.varied(parameters, np.array(scene.vertex.sector_angles))


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
