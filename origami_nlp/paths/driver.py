"""What drives a load path: a torque on creases, a force on a sheet, or a factor of the forces that a scene states."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, TypeAlias

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.continuation import ContinuationOptions, ParameterLine, load_line
from origami_nlp.errors import Interrupted, NothingInTime, OptionError
from origami_nlp.kkt import classified
from origami_nlp.minima import JudgedState, MinimaResult
from origami_nlp.numerics import DUPLICATE_TOL, SETTLED
from origami_nlp.pattern import Pattern, Scene, dead_loads, most_torque, with_numbers
from origami_nlp.pattern_problem import DeadForce, Pull, Torque, Work, Worked, pose
from origami_nlp.pattern_states import find_states
from origami_nlp.problem import Parameters

CUT = "seconds: the time was over before the search for the state at load 0 was through: give more"
Begun: TypeAlias = "tuple[Driver, int, np.ndarray]"
IDENTITY = ((0, False),)
"""The symmetry that every state keeps."""


def search_minima(origami: Scene | Pattern, until: float, **asked: Any) -> MinimaResult:
    """Search for the minima of an origami, without ways out and the full space, up to a time (`time.monotonic`)."""
    left = None if until == math.inf else max(until - time.monotonic(), 0.0)
    plain: dict[str, Any] = {"seconds": left, "escape": False, "prove": False, "full": False}
    return find_states(origami, **{**plain, **asked})


@dataclass(frozen=True, eq=False)
class OwnForces:
    """The forces of a scene's loads, as what a factor of them works on.

    Attributes
    ----------
    scene
        The scene.
    """

    scene: Scene
    name: ClassVar[str] = "factor of the loads"
    unit: ClassVar[str] = ""
    coordinate: ClassVar[str] = "position of the loads along their forces [m]"
    creases: ClassVar[tuple[int, ...]] = ()

    def __post_init__(self) -> None:
        if not self.scene.loads or not self.arm:
            raise OptionError("crease = None: the scene has no [[loads]] with forces, or zero ones")

    @property
    def arm(self) -> float:
        """Largest torque of the forces."""
        each = self.scene.loads
        return sum(float(np.linalg.norm(load.force or 0.0)) * load.place[0] for load in each)

    def conjugate(self, phi: np.ndarray) -> np.ndarray:
        """Return where they are along themselves: of several sum f . p over the root of the sum of their squares."""
        dead: Any = dead_loads(self.scene.loads, self.scene.fixed_facet)
        work = -dead.energy(np.array(self.scene.vertex.sector_angles), np.asarray(phi, float))
        return np.asarray(work / float(np.linalg.norm(dead.forces)))


@dataclass(frozen=True, eq=False)
class Driver:
    """A load t on what it works on.

    Attributes
    ----------
    work
        A torque on creases, of a scene on a crease and its images under the symmetry; a force.
    scene
        What is loaded, if that is one vertex; else it is the pattern of `work`.
    elements
        Symmetries that the load has.
    """

    work: Torque | Pull | DeadForce | OwnForces
    scene: Scene | None = None
    elements: Any = field(default=IDENTITY, repr=False, metadata={"plain": False})
    ALSO = ("name", "unit", "coordinate", "creases")

    @property
    def origami(self) -> Any:
        """What is loaded."""
        return self.scene or self.work.pattern  # type: ignore[union-attr]

    @cached_property
    def unloaded(self) -> Any:
        """The origami without what drives the path."""
        own = isinstance(self.work, OwnForces)
        return with_numbers(self.origami, {"loads": 0.0}) if own else self.origami

    name = property(lambda self: self.work.name, doc="What t is.")
    unit = property(lambda self: self.work.unit, doc="Of t.")
    creases = property(lambda self: self.work.creases, doc="Each of which bears t, from 1.")

    @property
    def coordinate(self) -> str:
        """What the load works on, with its unit; of images the mean."""
        mean = f"mean fold angle of creases {', '.join(map(str, self.creases))} [rad]"
        return mean if self.scene and len(self.creases) > 1 else self.work.coordinate

    def conjugate(self, fold_angles: np.ndarray) -> np.ndarray:
        """Return what the load works on at states [..., N]; of images, which turn alike, the mean."""
        return self.work.conjugate(fold_angles) / (len(self.creases) or 1 if self.scene else 1)

    @property
    def farthest(self) -> float:
        """A t beyond which springs no longer matter: what would turn all of them once round."""
        return most_torque(list(self.origami.stiffness), self.origami.laws) / self.work.arm

    @cached_property
    def problem(self) -> Any:
        """The problem at load 0, a `PatternProblem`."""
        return pose(self.origami)

    @property
    def keeps(self) -> str:
        """The symmetry that all states of the path are asked to keep; "" of none."""
        return "" if self.problem.orbits is None else self.origami.group.name

    def images(self, fold_angles: np.ndarray, at: np.ndarray | None = None) -> list[np.ndarray]:
        """Return the images of a state under symmetries of the load; at: under those that keep another state."""
        n = np.arange(len(fold_angles))
        every = [(shift + (-n if mirrored else n)) % len(n) for shift, mirrored in self.elements]
        kept = (i for i in every if at is None or np.abs(at[i] - at).max() <= SETTLED)
        return [fold_angles[i] for i in kept]

    @property
    def free(self) -> Driver:
        """The same load on states of any symmetry."""
        return replace(self, scene=self.scene.without_symmetry) if self.scene else self

    def line(self) -> ParameterLine:
        """Return the problems over t; a load that could turn all springs is one [rad] long."""
        problem, work, k = self.problem, self.work, np.array(self.origami.stiffness)
        p, none = problem.parameters, np.zeros(problem.size)
        weight = math.sqrt(len(k)) * work.arm / float(k.sum())
        if isinstance(work, Torque):
            load = problem.gathered(work.gradient(np.empty(0))) / problem.scale
            return load_line(problem, load, weight)
        dead: Any = p.dead if isinstance(work, OwnForces) else Worked(work, 1 / problem.scale)
        still = dead.times(0.0)  # over t only forces change: their points stay
        change = Parameters(0 * p.sectors, none, none, none, dead.moved(still, -1.0))
        return ParameterLine(problem, replace(p, dead=still), change, weight)

    def steps(self, steps: ContinuationOptions | None, until: float) -> ContinuationOptions:
        """Return the steps of the tracer; lengths are stated as root mean squares over creases."""
        rms, size = steps or ContinuationOptions(), math.sqrt(len(self.origami.stiffness))
        until = min(until, rms.until)
        return replace(rms, first=size * rms.first, longest=size * rms.longest, until=until)

    def begin(self, state: Any, until: float, asked: Any, full: bool) -> Begun:
        """Return the driver, the number of the stable state (0 where it was given itself), and its variables.

        asked: of the search.  full: whether states may break the symmetry, if this one is stable without it; the path
        keeps the winding of its first state where they may not.
        """
        number, driver = 0, self
        if not isinstance(state, JudgedState):
            check_whole("state", state, 1)
            try:
                result = search_minima(self.unloaded, until, **asked)
            except Interrupted:  # what it found is no path
                raise KeyboardInterrupt from None
            if result.search.stopped_by == "time":
                raise NothingInTime(CUT)
            number = check_whole("state", state, 1, len(result.minima))
            state = result.minima[number - 1]
        which, phi = f"state = {number}" if number else "state", np.array(state.fold_angles)
        if state.verdict != "minimum" or len(phi) != len(self.origami.stiffness):
            raise OptionError(f"{which} is no stable state of this origami: {state.certificate}")
        if self.scene is None and not phi.any():
            why = "is the flat state, from which many branches go on: load a folded one"
            raise OptionError(f"{which} {why}")
        if isinstance(self.work, Pull) and self.conjugate(phi) <= DUPLICATE_TOL * self.work.arm:
            a, b = self.work.corners
            raise OptionError(f"pull = {a}, {b}: these vertices lie on each other in that state")
        free = self.free
        if full and classified(free.problem, free.problem.reduce(phi)).verdict == "minimum":
            driver = free
        elif self.scene and len(self.scene.windings) > 1:
            driver = replace(self, scene=replace(self.scene, winding=state.winding))
        return driver, number, driver.problem.reduce(phi)


def driver_of(origami: Scene | Pattern, load: Any) -> Driver:
    """Return what drives a path: of a scene the number of a crease, or None; of a pattern a number, several, or a work.

    Raises
    ------
    OptionError
        If it is none of these.
    """
    if isinstance(origami, Pattern):
        origami.check_alone("a load")
        if isinstance(load, Work):
            if load.pattern is not origami:
                raise OptionError("load is one of another pattern: make it of the loaded one")
            return Driver(load)
        several = isinstance(load, Sequence) and not isinstance(load, str)
        return Driver(Torque(origami, tuple(load) if several else (load,)))
    if load is None:
        return Driver(OwnForces(origami), origami, origami.group.elements)
    orbit = origami.group.orbit
    here = orbit[check_whole("crease", load, 1, origami.degree) - 1]
    creases = tuple(i for i, o in enumerate(orbit, start=1) if o == here)
    return Driver(Torque(origami.paper, creases), origami, origami.group.elements)
