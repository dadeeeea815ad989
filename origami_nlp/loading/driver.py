"""What drives a load path of a vertex: a torque on creases, or a factor of the forces that a scene states.

`Driver` says what a load path asks of a driver, of a vertex here or of a pattern (`pattern_driver.PatternDriver`).
"""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.continuation import ContinuationOptions, ParameterLine, SpecialPoint, load_line
from origami_nlp.errors import OptionError
from origami_nlp.kkt import Classification, State, follow
from origami_nlp.minima import JudgedState, find_minima, full_scene
from origami_nlp.numerics import SETTLED, first_largest
from origami_nlp.pattern import Scene, dead_loads, most_torque
from origami_nlp.pattern_problem import pose
from origami_nlp.problem import Parameters

STEPS = ContinuationOptions(longest=0.2, growth=3.0)
"""Of vertices: such that curves look smooth, by how far they turn; where they hardly do longer steps meet the same."""
BRANCHES = ("branching", "breaks-symmetry")
"""Events at which states lose stability without a limit point."""
OFF_BRANCH = 1e-3
"""How far beside such a state a descent begins [rad]."""
CUT = "seconds: the time was over before the search for the state at load 0 was through: give more"
IDENTITY = ((0, False),)
"""The symmetry that every state keeps."""
SIDE = 0.01
"""Torque over `Model.scale`, or factor over that of the snap, between a snap and the loads beside it."""


@dataclass(eq=False)
class LoadSearch:
    """Searches for stable states with what is left of the time.

    Attributes
    ----------
    options
        Of `find_minima`.
    until
        Value of `time.monotonic` at which the time is over.
    cut
        Whether the last one ended for it.
    """

    options: dict[str, Any]
    until: float
    cut: bool = False

    @property
    def left(self) -> float | None:
        """Seconds that are left; None without end."""
        return None if self.until == math.inf else max(self.until - time.monotonic(), 0.0)


@dataclass(frozen=True)
class VertexDriver:
    """A torque t on a crease and its images under the symmetry of the scene, or t times the scene's own forces.

    Attributes
    ----------
    scene
        As stated.
    crease
        Number (1-based) of the crease; None for the forces.
    images
        Creases (1-based) that bear the torque where the scene no longer imposes the symmetry that makes them images.
    """

    scene: Scene
    crease: int | None
    images: tuple[int, ...] = ()
    ALSO = ("name", "unit", "coordinate", "creases")
    WAY = ""
    arm = 1.0

    def __post_init__(self) -> None:
        n = self.scene.degree
        if self.crease is None:
            if not self.scene.loads:
                raise OptionError(
                    "crease = None: the scene has no [[loads]] with forces to be multiplied"
                )
        elif (
            isinstance(self.crease, bool)
            or not isinstance(self.crease, int)
            or not 1 <= self.crease <= n
        ):
            raise OptionError(f"crease = {self.crease!r} must be the number of a crease, 1 to {n}")

    @property
    def creases(self) -> tuple[int, ...]:
        """Creases (1-based) on each of which the torque acts; empty for forces."""
        if self.crease is None or self.images:
            return self.images
        orbit = self.scene.group.orbit
        return tuple(i + 1 for i, o in enumerate(orbit) if o == orbit[self.crease - 1])

    @property
    def name(self) -> str:
        """What t is."""
        if self.crease is None:
            return "factor of the loads"
        numbers = ", ".join(map(str, self.creases))
        return (
            f"torque on each of creases {numbers}"
            if len(self.creases) > 1
            else f"torque on crease {numbers}"
        )

    @property
    def unit(self) -> str:
        """Of t."""
        return "" if self.crease is None else "N m"

    @property
    def farthest(self) -> float:
        """A t beyond which springs no longer matter: what would turn all of them once round."""
        total = most_torque(self.scene.stiffness, self.scene.laws)
        arms = [
            float(np.linalg.norm(load.force or 0.0)) * load.place[0] for load in self.scene.loads
        ]
        if self.crease is not None:
            return total
        if not any(arms):
            raise OptionError("crease = None: all forces of the scene are zero")
        return total / sum(arms)

    @property
    def coordinate(self) -> str:
        """What the load works on, with its unit."""
        if self.crease is None:
            return "position of the loads along their forces [m]"
        numbers = ", ".join(map(str, self.creases))
        mean = "mean fold angle of creases" if len(self.creases) > 1 else "fold angle of crease"
        return f"{mean} {numbers} [rad]"

    def keeping(self, elements: Collection[tuple[int, bool]]) -> VertexDriver:
        """Return the same load on states that keep but some of the symmetries, or fewer where no scene states those."""
        full, n = full_scene(self.scene), self.scene.degree
        order = sum(not mirrored for _, mirrored in elements)
        mirrors = [s for s, mirrored in elements if mirrored]
        kept = replace(full, symmetry=f"C{order}")
        if mirrors:
            through = [k + 1 for k in range(n) if 2 * k % n in mirrors]
            several = replace(full, symmetry=f"D{order}", mirror=through[0] if through else None)
            kept = several if set(several.group.elements) == set(elements) else kept
        # a winding belongs to its group
        kept = full if len(kept.windings) > 1 else kept
        return replace(self, scene=kept, images=self.creases)

    @property
    def unloaded(self) -> Scene:
        """The scene without what drives the path."""
        return self.scene if self.crease is not None else replace(self.scene, loads=())

    def conjugate(self, fold_angles: np.ndarray) -> np.ndarray:
        """Return what the load works on at states [..., N]: an angle [rad], or where forces are along themselves [m].

        The mean angle of all creases that bear the torque: without the symmetry these may differ.

        Several forces: sum f . p over the root of the sum of their squares.
        """
        phi = np.asarray(fold_angles, dtype=float)
        if self.crease is not None:
            return phi[..., np.array(self.creases) - 1].mean(axis=-1)
        dead = dead_loads(self.scene.loads, self.scene.fixed_facet)
        assert dead is not None
        work = -dead.energy(np.array(self.scene.vertex.sector_angles), phi)
        return work / float(np.linalg.norm(dead.forces))

    @property
    def label(self) -> str:
        """What is loaded."""
        return self.scene.title

    def line(self) -> ParameterLine:
        """Return the problems of the scene over t."""
        return self._line(self.scene)

    def full_line(self) -> ParameterLine | None:
        """Return those without the symmetry; None where there is none."""
        return None if self.scene.group.is_trivial else self._line(full_scene(self.scene))

    def _line(self, scene: Scene) -> ParameterLine:
        problem = pose(scene)
        p = problem.parameters
        if self.crease is not None:
            load = np.zeros(scene.degree)
            load[np.array(self.creases) - 1] = 1.0
            return load_line(problem, problem.gathered(load) / problem.scale)
        assert p.dead is not None
        # over t only the forces change: the points stay
        still = replace(p.dead, points=np.zeros_like(p.dead.points))
        zeros = [np.zeros_like(v) for v in (p.sectors, p.stiffness, p.rest, p.load)]
        change = Parameters(zeros[0], zeros[1], zeros[2], zeros[3], still)
        return ParameterLine(problem, replace(p, dead=p.dead.times(0.0)), change)

    def scene_at(self, t: float) -> Scene:
        """Return the scene under the load t; its energy may differ from the path's by a constant."""
        name = f"{self.scene.label + ', ' if self.scene.label else ''}{self.name} = {t:.10g}"
        if self.crease is None:
            forces = [[t * f for f in load.force or ()] for load in self.scene.loads]
            pairs = zip(self.scene.loads, forces, strict=True)
            loads = tuple(replace(load, force=(f[0], f[1], f[2])) for load, f in pairs)
            return replace(self.scene, loads=loads, name=name)
        preload = np.array(self.scene.preload or np.zeros(self.scene.degree))
        preload[np.array(self.creases) - 1] += t
        return replace(self.scene, preload=tuple(preload.tolist()), name=name)

    def steps(self, steps: ContinuationOptions | None) -> ContinuationOptions:
        """Return the steps of the tracer."""
        return steps or STEPS

    def begin(self, state: Any, search: LoadSearch) -> tuple[VertexDriver, int, np.ndarray]:
        """Return the driver, the number of the minimum that is loaded, and its variables.

        The path keeps the winding of its first state.
        """
        minima = self._minima(0.0, search)
        if search.cut:
            raise OptionError(CUT)
        if not minima:
            raise OptionError("no minimum was found at load 0")
        check_whole("state", state, 1, len(minima))
        start, driver = minima[state - 1], self
        if len(self.scene.windings) > 1:
            driver = replace(self, scene=replace(self.scene, winding=start.winding))
        return driver, state, pose(driver.scene).reduce(np.array(start.fold_angles))

    def _minima(self, t: float, search: LoadSearch) -> Sequence[JudgedState]:
        scene, left = self.scene_at(t), search.left
        asked: dict[str, Any] = {"full": False, "prove": False, "escape": False, "seconds": left}
        result = find_minima(scene, **asked, **search.options)
        search.cut = result.search.stopped_by == "time"
        return result.minima

    def down(
        self, line: ParameterLine, s: float, node: SpecialPoint, near: float, until: float
    ) -> tuple[np.ndarray, Classification] | str:
        """Descend at s from the end of a state to a minimum farther away than `near` [rad], or return why not."""
        problem, phi = line.at(s), node.point[:-1]
        starts, why = [phi], ""
        if node.type in BRANCHES:  # balanced: the energy falls to second order, to either side
            soft = State(problem, phi).on(State(problem, phi).pieces[0]).softest
            if soft is not None:
                aside = OFF_BRANCH * soft * np.sign(soft[first_largest(np.abs(soft))])
                starts = [phi + aside, phi - aside]
        for start in starts:
            try:
                end = follow(problem, start, curved=True)
            except ValueError as refused:
                why = str(refused)
                continue
            if end.what.verdict == "minimum" and np.abs(end.end - phi).max() > near:
                return end.end, end.what
        return why

    def beside(self, t: float) -> float:
        """Return the distance between a snap at t and the loads beside it at which it is confirmed."""
        return SIDE * (pose(self.scene).scale if self.crease else abs(t))

    def states_at(self, t: float, search: LoadSearch) -> list[np.ndarray]:
        """Return the fold angles of the minima at t."""
        return [np.array(m.fold_angles) for m in self._minima(t, search)]

    def led_to(self, t: float, states: Sequence[np.ndarray]) -> list[np.ndarray] | None:
        """Return the minima at t, once each, to which states [N] descend; None where one comes to none."""
        model, found = pose(self.scene_at(t)), list[np.ndarray]()
        for phi in states:
            try:
                end = follow(model, model.reduce(phi), curved=True)
            except ValueError:  # of another winding
                return None
            if end.what.verdict != "minimum":
                return None
            phi = model.expand(end.end)
            if all(np.abs(phi - other).max() > SETTLED for other in found):
                found.append(phi)
        return found


def image_of(n: int, element: tuple[int, bool]) -> np.ndarray:
    """Return the creases (0-based) whose fold angles those of the image of a state are, [n]."""
    shift, mirrored = element
    i = np.arange(n)
    return (shift - i if mirrored else shift + i) % n


def kept_by(
    elements: Sequence[tuple[int, bool]], phi: np.ndarray, near: float = SETTLED
) -> tuple[tuple[int, bool], ...]:
    """Return the symmetries that a state of all fold angles keeps, known as `near` [rad]."""
    return tuple(e for e in elements if np.abs(phi[image_of(len(phi), e)] - phi).max() <= near)
