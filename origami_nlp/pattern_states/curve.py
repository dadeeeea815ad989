"""A pattern with one degree of freedom left, traced: the curve of its closed states, from limit to limit.

The curve is followed by `continuation.tracer` along the kernel of the Jacobian of closure; where rows lose more rank
(at a flat or flat-folded state, branches cross) it goes straight on, so that each branch is followed through the
crossing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.continuation import CLOSED_CURVE, ContinuationOptions, End, trace
from origami_nlp.numerics import CLOSURE_TOL, EXPLORED, NONZERO, dense, null_space
from origami_nlp.pattern_problem import PatternProblem

STEP = 0.05
"""Largest step of a walk [rad], in the norm over creases divided by the square root of their number."""
SHORTEST = 1e-7
BENT = 0.95
"""Share of a unit vector that the kernel holds, and cosine between tangents of a step and the next, at least."""
SHARPEST = math.sqrt(2 - 2 * BENT)
"""Length of the difference of unit tangents with that cosine."""
MOST_STEPS = 5_000
DIFFERENCE = 1e-5
"""Step of differences of the Jacobian [rad]: an error of some 1e-11."""
LOST = "lost: no closed state ahead"
"""Why a curve ends where even the shortest step fails."""


@dataclass(frozen=True, eq=False)
class ClosureCurve:
    """A curve of closed states.

    Attributes
    ----------
    phi
        Fold angles along it, [S, n] [rad].
    arc
        Length from its first state, in the norm over creases over sqrt n, [S].
    ends
        Why it ends at either side: ``"limit"``, ``"closed"`` (it returns to its start), or the reason that it was lost.
    tangents, bends
        Unit tangent phi' and curvature phi'' over the length in the norm over creases, [S, n].
    """

    phi: np.ndarray
    arc: np.ndarray
    ends: tuple[str, str]
    tangents: np.ndarray
    bends: np.ndarray

    @property
    def complete(self) -> bool:
        """Whether both ends are fold limits, or the curve is closed."""
        return all(end in ("limit", "closed") for end in self.ends)


def tangents(problem: PatternProblem, phi: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the kernel of the Jacobian, [n, t]."""
    return null_space(dense(problem.closure.jacobian(phi)))


def second(
    problem: PatternProblem, phi: np.ndarray, one: np.ndarray, other: np.ndarray
) -> np.ndarray:
    """Return the second derivative of closure along two directions [n], [m], by differences of the Jacobian."""
    ahead = problem.closure.jacobian(phi + DIFFERENCE * other) @ one
    behind = problem.closure.jacobian(phi - DIFFERENCE * other) @ one
    return (ahead - behind) / (2 * DIFFERENCE)


@dataclass(frozen=True, eq=False)
class Sample:
    """A state of a curve with its unit tangent and curvature, [n] each: a `continuation.CurveFrame`."""

    x: np.ndarray
    tangent: np.ndarray
    bend: np.ndarray


@dataclass(frozen=True, eq=False)
class ClosedStates:
    """The closed states of a pattern, as a curve for pseudo-arclength continuation; where several degrees of freedom
    are left, straight on."""

    problem: PatternProblem

    @property
    def root(self) -> np.ndarray:
        """Metric of all fold angles, [n]."""
        return self.problem.root

    def correct(self, x: np.ndarray) -> np.ndarray | None:
        """Move x [n] onto closure."""
        new, residual = self.problem.project(x, steps=12)
        return new if residual <= CLOSURE_TOL and self.problem.closure.lifts_to_one(new) else None

    def frame(self, x: np.ndarray, along: np.ndarray) -> Sample | None:
        """Return where the curve goes at x: where branches cross, the kernel is larger, and it goes straight on."""
        size = float(np.linalg.norm(self.problem.along(x, along)))
        return None if size < BENT else self.at(x, along)

    def at(self, x: np.ndarray, along: np.ndarray) -> Sample:
        """Return the sample at x with its tangent on the side of `along` [n]."""
        normal = self.problem.normal(x)
        tangent = normal.along(along)
        tangent /= max(float(np.linalg.norm(tangent)), NONZERO)
        # phi'' = -J^+ c''(phi', phi'), as J phi'' + c''(phi', phi') = 0 all along the curve
        return Sample(x, tangent, -normal.step(second(self.problem, x, tangent, tangent)))

    def limit(self, here: Sample, beyond: Sample) -> Sample | None:
        """Return the state inside a step at which creases reach fold limits: all that do together, or the first."""
        went = beyond.x - here.x
        limits = self.problem.fold_limits
        near = limits.room(beyond.x) < np.abs(went) + EXPLORED
        # creases that are fully folded and stay so do not end the curve
        side = limits.side(beyond.x)
        opening = np.where(side > 0, limits.high - here.x, here.x - limits.low)
        opening = np.where(opening > EXPLORED, opening, math.inf)
        share = opening / np.maximum(side * went, NONZERO)
        share[limits.inside(beyond.x)] = math.inf
        first = np.arange(len(share)) == share.argmin()
        for held, start in ((near, beyond.x), (first, here.x + min(share.min(), 1.0) * went)):
            start = np.where(held, limits.hold(start, limits.side(start)), start)
            end, residual = self.problem.project(start, held, steps=12)
            there = end - here.x
            size = float(np.linalg.norm(there))
            good = residual <= CLOSURE_TOL and bool(limits.inside(end, EXPLORED).all())
            good = good and self.problem.closure.lifts_to_one(end)
            ahead = float(there @ here.tangent) >= BENT * size
            if good and ahead and size <= 1.5 * float(np.linalg.norm(went)):
                return self.at(limits.clip(end), here.tangent)
        return None


def follow_curve(
    problem: PatternProblem, phi: np.ndarray, along: np.ndarray, step: float = STEP
) -> ClosureCurve:
    """Trace the curve through a closed state both ways.

    Parameters
    ----------
    problem
        The problem.
    phi
        A closed state, [n] [rad].
    along
        Direction in which it begins, [n]; the other way is traced as well.
    step
        Largest step [rad].

    Returns
    -------
    ClosureCurve
        From the end against `along` to the other.
    """
    curve, root = ClosedStates(problem), math.sqrt(problem.size)
    first = curve.frame(phi, along / np.linalg.norm(along))
    steps = ContinuationOptions(
        first=step * root,
        longest=step * root,
        shortest=SHORTEST * root,
        turn=SHARPEST,
        sharpest=SHARPEST,
        growth=1.5,
        most=MOST_STEPS,
    )

    limits = problem.fold_limits

    def inside(samples: object) -> int:
        beyond = [not limits.inside(s.x, EXPLORED).all() for s in samples]  # type: ignore[attr-defined]
        return beyond.index(True) if True in beyond else len(beyond)

    found = first and trace(curve, first, steps, [End(inside, "limit", curve.limit)])
    if not found:
        none = np.zeros((1, problem.size))
        return ClosureCurve(phi[None], np.zeros(1), (LOST, LOST), none, none)
    ends = []
    for why, last in ((found.start, found.frames[0]), (found.end, found.frames[-1])):
        at_limit = bool((limits.room(last.x) <= EXPLORED).any())
        known = {CLOSED_CURVE: "closed", "limit": "limit" if at_limit else "lost at a fold limit"}
        ends.append(known.get(why, f"lost: {why}" if why.startswith("more") else LOST))
    states = limits.clip(found.states)
    chords = np.linalg.norm(np.diff(states, axis=0), axis=1) / root
    return ClosureCurve(
        states,
        np.concatenate([[0.0], np.cumsum(chords)]),
        (ends[0], ends[1]),
        found.signs[:, None] * np.array([s.tangent for s in found.frames]),
        np.array([s.bend for s in found.frames]),
    )
