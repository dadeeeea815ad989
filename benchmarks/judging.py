"""What each answer of each method is: a minimum (which, and how far off), or what else.

The known minima of a problem are those that the package's main job lists, those of its union (`union`), and every
answer of any method that a polish and the classifier turn into a minimum; each gets a 50-digit reference.  An answer
counts for the nearest known minimum within `NEAR`; one that is near none is solved on from and classified: a false
minimum, unless the classifier finds a minimum there, which then joins the list (and counts as missed by all who did
not reach it).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from benchmarks.attempt import Attempt
from benchmarks.reference import Reference, Unsolved, solve_reference
from benchmarks.union import APART, Union
from origami_nlp.folding import check_admissible
from origami_nlp.kkt import State, classify, polish
from origami_nlp.minima import Record, find_minima, solve_without_crossing
from origami_nlp.numerics import ENDPOINT_TOL
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model, Problem

NEAR = 0.05
"""An answer within this of a minimum in every fold angle [rad] counts for it."""
OPEN = 1e-4
"""An answer that fails to close, or crosses facets, by more than this is no state at all."""


@dataclass
class KnownMinimum:
    """A verified minimum: variables x [n], kind, reference (or why there is none), and where it came from."""

    x: np.ndarray
    kind: str
    reference: Reference | None
    problem: str
    source: str


@dataclass(frozen=True)
class Outcome:
    """What an answer is.

    minimum: position in `Judge.known`, or -1.  reason: for others, what they are.
    angle, energy, multiplier, eigenvalue: errors against the reference: fold angles [rad], energy and reduced-Hessian
    eigenvalues relative to the largest, contact multipliers relative to the largest; NaN where undefined.
    """

    minimum: int
    reason: str = ""
    angle: float = math.nan
    energy: float = math.nan
    multiplier: float = math.nan
    eigenvalue: float = math.nan


@dataclass
class Judge:
    """Judges answers to one problem."""

    scene: Scene
    model: Model
    known: list[KnownMinimum] = field(default_factory=list)
    _false: list[tuple[np.ndarray, str]] = field(default_factory=list)

    @classmethod
    def of(cls, scene: Scene, seed: int, union: Union | None = None) -> Judge:
        """Start from the minima that the main job lists, and those of a union."""
        result = find_minima(scene, seed=seed, escape=False)
        judge = cls(scene, Model(scene))
        for m in result.minima:
            judge.learn(judge.model.reduce(np.array(m.fold_angles)), m.kind, "main job", m.polished)
        for u in union.members if union else ():
            x = judge.model.reduce(np.array(u.fold_angles))
            if judge._nearest(x)[1] > APART:
                judge.learn(x, u.kind, u.found_by[0])
        return judge

    def learn(self, x: np.ndarray, kind: str, source: str, polished: bool = True) -> int:
        """Add a verified minimum; returns its position."""
        reference, problem = None, ""
        if polished:
            reference, problem = self._reference(x)
        else:
            problem = "the polish did not reach rounding"
        self.known.append(KnownMinimum(np.array(x), kind, reference, problem, source))
        return len(self.known) - 1

    def _reference(self, x: np.ndarray) -> tuple[Reference | None, str]:
        model = self.model
        problem = ""
        for rows in State(model, x).pieces:
            try:
                return solve_reference(model, x, rows), ""
            except Unsolved as error:
                problem = problem or str(error)
        return None, problem

    def judge(self, attempt: Attempt) -> Outcome:
        """Describe what a claimed answer is."""
        assert attempt.x is not None
        x = attempt.x
        near, distance = self._nearest(x)
        if distance > NEAR:
            reason = self._what(x)
            if reason:
                return Outcome(-1, reason)
            near, distance = self._nearest(x)
        return self._errors(near, attempt)

    def false_state(self, x: np.ndarray) -> int:
        """Return the number of the distinct false state near x."""
        return next(k for k, (y, _) in enumerate(self._false) if np.abs(x - y).max() <= NEAR)

    def _nearest(self, x: np.ndarray) -> tuple[int, float]:
        if not self.known:
            return -1, math.inf
        distance = [float(np.abs(x - k.x).max()) for k in self.known]
        return int(np.argmin(distance)), min(distance)

    def _what(self, x: np.ndarray) -> str:
        """Describe what an answer far from all known minima is; empty if it is a new minimum, now known."""
        for y, reason in self._false:
            if np.abs(x - y).max() <= NEAR:
                return reason
        reason = self._examine(x)
        if reason:
            self._false.append((np.array(x), reason))
        return reason

    def _examine(self, x: np.ndarray) -> str:
        model = self.model
        if np.abs(model.closure(x)[0]).max() > OPEN:
            return "does not close"
        if not model.lifts_to_one(x):
            return "closes with q = -1: no sheet of paper"
        if (np.abs(x) > model.bound + OPEN).any():
            return "beyond a fold limit"
        if self.scene.contact == "full":
            paper = check_admissible(self.scene.vertex, model.expand(x), tolerance=OPEN)
            if not paper.admissible:
                return "facets cross" if "cross" in paper.reason else "not admissible"
        answer = solve_without_crossing(model, x, Record(), model.structure.pairs[:6])
        state = polish(model, answer) if answer.succeeded else None
        if state is None or np.abs(state.x - x).max() > NEAR:
            return "not stationary"
        if self._nearest(state.x)[1] <= ENDPOINT_TOL:  # a sloppy answer whose polish is known
            return ""
        what = classify(State(model, state.x), polished=state.converged)
        if what.verdict == "minimum":
            self.learn(state.x, str(what.kind), "an answer", state.converged)
            return ""
        return what.verdict

    def _errors(self, index: int, attempt: Attempt) -> Outcome:
        assert attempt.x is not None
        x, exact = attempt.x, self.known[index].reference
        if exact is None:
            return Outcome(index)
        # energies near zero are compared with that of one radian
        size = max(abs(exact.energy), self.model.scale)
        change = self.model.energy_change(exact.x, x) - _slope(self.model, exact)
        multiplier, eigenvalue = errors_of_derivatives(
            self.model, x, exact, attempt.bound_multipliers
        )
        return Outcome(index, "", exact.angle_error(x), abs(change) / size, multiplier, eigenvalue)


def _slope(model: Problem, exact: Reference) -> float:
    """Return the energy that the digits beyond a double of the exact state make."""
    k, rest = model.parameters.stiffness, model.parameters.rest
    return float(model.scale * np.sum(k * (exact.x - rest) * exact.x_rest))


def errors_of_derivatives(
    model: Problem, x: np.ndarray, exact: Reference, own: np.ndarray | None
) -> tuple[float, float]:
    """Return the relative errors of contact multipliers and of reduced-Hessian eigenvalues at an answer x.

    Multipliers are the solver's own for fold limits where it gives them, else least squares on the reference's
    active set, which the eigenvalues use too.  NaN where the reference has none.
    """
    rows = exact.rows
    if not len(exact.eigenvalues) and not len(exact.multipliers):
        return math.nan, math.nan
    state = State(model, x)
    both = np.vstack([state.local.closure_jacobian, state.local.openings(rows)[1]])
    lam = np.linalg.lstsq(both.T, state.local.gradient, rcond=None)[0]
    multiplier = math.nan
    if len(exact.multipliers):
        found = lam[model.equation_count :].copy()
        if own is not None:
            for r, row in enumerate(rows):
                if row.kind == "limit":
                    found[r] = own[row.index]
        size = max(1e-3, float(np.abs(exact.multipliers).max()))
        multiplier = float(np.abs(found - exact.multipliers).max()) / size
    if not len(exact.eigenvalues):
        return multiplier, math.nan
    z = state.on([row for row in rows if row in exact.loaded]).tangent
    values = model.scale * np.linalg.eigvalsh(z.T @ state.on(rows).hessian_with(lam) @ z)
    if len(values) != len(exact.eigenvalues):
        return multiplier, math.nan
    size = float(np.abs(exact.eigenvalues).max())
    return multiplier, float(np.abs(values - exact.eigenvalues).max()) / size
