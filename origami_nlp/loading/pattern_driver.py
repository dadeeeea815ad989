"""What drives a load path of a pattern: a torque on creases, or forces on corners."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.continuation import ContinuationOptions, ParameterLine, SpecialPoint
from origami_nlp.errors import OptionError
from origami_nlp.kkt import Classification, State, classify
from origami_nlp.loading.driver import CUT, SIDE, LoadSearch
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import DUPLICATE_TOL, NEARLY
from origami_nlp.pattern import Pattern, most_torque
from origami_nlp.pattern_problem import (
    DeadForce,
    PatternProblem,
    Pull,
    Torque,
    Work,
    Worked,
)
from origami_nlp.pattern_states import (
    Descended,
    classified,
    contact_descent,
    descend,
    find_states,
    judge,
)
from origami_nlp.problem import Parameters


@dataclass(frozen=True, eq=False)
class PatternDriver:
    """A load t on what it works on.

    Attributes
    ----------
    work
        A `Torque`, `Pull` or `DeadForce`.
    """

    work: Work
    ALSO = ("name", "unit", "coordinate")
    WAY = (
        "crossing of facets is checked at the states of the path and of descents, not between them"
    )

    @property
    def pattern(self) -> Pattern:
        """The pattern that is loaded."""
        return self.work.pattern

    @property
    def unloaded(self) -> Pattern:
        """The pattern, with its energy without the load."""
        return self.work.pattern

    @property
    def label(self) -> str:
        """What is loaded."""
        return self.pattern.title

    @property
    def name(self) -> str:
        """What t is."""
        return self.work.name

    @property
    def unit(self) -> str:
        """Of t."""
        return self.work.unit

    @property
    def coordinate(self) -> str:
        """What the load works on, with its unit."""
        return self.work.coordinate

    @property
    def creases(self) -> tuple[int, ...]:
        """Creases (1-based) on each of which a torque acts; empty for forces."""
        return self.work.creases

    @property
    def arm(self) -> float:
        """Size of the derivative of what the load works on."""
        return self.work.arm

    @property
    def farthest(self) -> float:
        """A t beyond which springs no longer matter: what would turn all of them once round."""
        return most_torque(self.pattern.stiffness.tolist(), self.pattern.laws) / self.arm

    def conjugate(self, fold_angles: np.ndarray) -> np.ndarray:
        """Return what the load works on at states [..., n]."""
        return self.work.conjugate(fold_angles)

    def line(self) -> ParameterLine:
        """Return the problems of the pattern over t; a load that could turn all springs is one [rad] long."""
        problem = PatternProblem(self.pattern).under(self.work, 0.0)
        none = np.zeros(problem.size)
        change = Parameters(none[:0], none, none, none, Worked(self.work, 1 / problem.scale))  # type: ignore[arg-type]
        weight = math.sqrt(problem.size) * self.arm / float(self.pattern.stiffness.sum())
        return ParameterLine(problem, problem.parameters, change, weight=weight)

    def full_line(self) -> None:
        """None: no symmetry is imposed."""

    def steps(self, steps: ContinuationOptions | None) -> ContinuationOptions:
        """Return the steps of the tracer, whose lengths are stated as root mean squares over creases."""
        rms, size = steps or ContinuationOptions(), math.sqrt(self.pattern.creases)
        return replace(rms, first=size * rms.first, longest=size * rms.longest)

    def begin(self, state: Any, search: LoadSearch) -> tuple[PatternDriver, int, np.ndarray]:
        """Return the driver, the number of the stable state (0 where it was given itself), and its fold angles."""
        number = 0
        if not isinstance(state, JudgedState):
            number = check_whole("state", state, 1)
            found = self._states(self.pattern, search)
            if not found and not search.cut:
                raise OptionError("no stable state was found at load 0")
            if search.cut:
                raise OptionError(CUT)
            state = found[check_whole("state", state, 1, len(found)) - 1]
        which = f"state = {number}" if number else "state"
        if state.verdict != "minimum" or len(state.fold_angles) != self.pattern.creases:
            raise OptionError(f"{which} is no stable state of this pattern: {state.certificate}")
        if not np.any(state.fold_angles):
            raise OptionError(
                f"{which} is the flat state, from which many branches go on: load a folded one (rest angles other than "
                "0)"
            )
        if (
            isinstance(self.work, Pull)
            and self.conjugate(state.fold_angles) <= DUPLICATE_TOL * self.arm
        ):
            a, b = self.work.corners
            raise OptionError(
                f"pull = {a}, {b}: these vertices lie on each other in the state that is loaded: no line leads from "
                "one to the other"
            )
        return self, number, state.phi

    @staticmethod
    def _states(pattern: Pattern, search: LoadSearch) -> tuple[JudgedState, ...]:
        limit: dict[str, Any] = {} if search.left is None else {"seconds": search.left}
        found = find_states(pattern, **search.options, **limit, escape=False, prove=False)
        search.cut = bool(found.search.left_out)
        return found.minima

    def down(
        self, line: ParameterLine, s: float, node: SpecialPoint, near: float, until: float
    ) -> tuple[np.ndarray, Classification] | str:
        """Descend at s from the end of a state to one farther away than `near` [rad], or return why there is none."""
        loaded: Any = line.at(s)
        loaded.until = until
        phi, touching = node.point[:-1], any(not c.is_limit for c in node.held)
        begun: np.ndarray | None = phi
        if node.type == "slides":  # lower states are beside where a facet ends, unless others hold
            begun = classify(State(line.at(node.s), phi)).lower
        if begun is None:
            return ""
        end = _descended(loaded, begun, touching)
        if np.abs(end.phi - phi).max() <= near:
            # of equilibria that stay ones no torque leads away
            lower = classify(State(loaded, phi)).lower if not loaded.sparse else None
            end = end if lower is None else contact_descent(loaded, lower)
            if np.abs(end.phi - phi).max() <= near:
                return ""
        if not end.arrived:
            flat = "beside the flat state" if np.abs(end.phi).max() < NEARLY else end.why
            return f"the descent does not come to rest, {flat}"
        found = judge(loaded, end.phi)
        if found.verdict != "minimum":
            return found.certificate
        return end.phi, classified(loaded, end.phi)

    def beside(self, t: float) -> float:
        """Return the distance between a snap at t and the loads beside it at which it is confirmed."""
        return SIDE * float(self.pattern.stiffness.mean())

    def states_at(self, t: float, search: LoadSearch) -> list[np.ndarray] | None:
        """Return the fold angles of the stable states at t; None under forces, which no search takes."""
        if not isinstance(self.work, Torque):
            return None
        return [m.phi for m in self._states(self.work.loaded(t), search)]

    def led_to(self, t: float, states: Sequence[np.ndarray]) -> list[np.ndarray] | None:
        """Return None: of patterns what is beyond a snap is searched for."""
        return None


def _descended(loaded: PatternProblem, phi: np.ndarray, touching: bool) -> Descended:
    """Descend from a state: where facets touch, or would come to cross, along states that do not cross."""
    if not touching:
        end = descend(loaded, phi)
        if not any(loaded.crossings.find(x) for x in (*end.path, end.phi)):
            return end
    return contact_descent(loaded, phi)


def work_on(pattern: Pattern, load: Any) -> Work:
    """Return what a load on a pattern works on: given as such, or as the number of a crease or several."""
    if isinstance(load, Torque | Pull | DeadForce):
        if load.pattern is not pattern:
            raise OptionError("load is one of another pattern: make it of the one that is loaded")
        return load
    several = isinstance(load, Sequence) and not isinstance(load, str)
    return Torque(pattern, tuple(load) if several else (load,))
