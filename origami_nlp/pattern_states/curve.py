"""A pattern with one degree of freedom left, traced: the curve of its closed states, from limit to limit.

The curve is followed by `continuation.tracer` along the kernel of the Jacobian of closure; where rows lose more rank
(at a flat or flat-folded state, branches cross) it goes straight on, so that each branch is followed through the
crossing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.continuation import CLOSED_CURVE, ContinuationOptions, End, trace, trace_ahead
from origami_nlp.numerics import CLOSURE_TOL, EXPLORED, NONZERO, dense, null_space
from origami_nlp.pattern_problem import MOST_DENSE, PatternProblem

STEP = 0.05
"""Largest step of a walk [rad], in the norm over creases divided by the square root of their number."""
SHORTEST = 1e-7
BENT = 0.95
"""Share of a unit vector that the kernel holds, and cosine between tangents of a step and the next, at least."""
SHARPEST = math.sqrt(2 - 2 * BENT)
"""Length of the difference of unit tangents with that cosine."""
MOST_STEPS = 5_000
NEAR_FLAT = 4.0
"""Steps within which a state is beside the flat one."""
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
    odd
        Whether its first half is the negative of the second: through the flat state, in whose plane space is mirrored.
    """

    phi: np.ndarray
    arc: np.ndarray
    ends: tuple[str, str]
    tangents: np.ndarray
    bends: np.ndarray
    odd: bool = False

    @property
    def complete(self) -> bool:
        """Whether both ends are fold limits, or the curve is closed."""
        return all(end in ("limit", "closed") for end in self.ends)


def tangents(problem: PatternProblem, phi: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the kernel of the Jacobian, [n, t]."""
    if problem.size <= MOST_DENSE:  # it is asked for again where a descent begins
        return problem.kernel(phi)
    return null_space(dense(problem.closure.jacobian(phi)))


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
        if self.problem.closure.compiled.usable:
            self.problem.check_time()
            went = self.problem.closure.compiled.follow(x, along)
            if went is not None:
                return None if went[0] < BENT else Sample(x, *went[1:])
        size = float(np.linalg.norm(self.problem.along(x, along)))
        return None if size < BENT else self.at(x, along)

    def at(self, x: np.ndarray, along: np.ndarray) -> Sample:
        """Return the sample at x with its tangent on the side of `along` [n]."""
        if self.problem.closure.compiled.usable:
            went = self.problem.closure.compiled.follow(x, along)
            if went is not None:
                return Sample(x, *went[1:])
        normal = self.problem.normal(x)
        tangent = normal.along(along)
        tangent /= max(float(np.linalg.norm(tangent)), NONZERO)
        # phi'' = -J^+ c''(phi', phi'), as J phi'' + c''(phi', phi') = 0 all along the curve
        bend = self.problem.closure.second(x, tangent[:, None])[:, 0, 0]
        return Sample(x, tangent, -normal.step(bend))

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
    curve = ClosedStates(problem)
    first = curve.frame(phi, along / np.linalg.norm(along))
    found = first and trace(curve, first, _steps(problem, step), [_limit(curve)])
    if not found:
        none = np.zeros((1, problem.size))
        return ClosureCurve(phi[None], np.zeros(1), (LOST, LOST), none, none)
    ends = (_end(problem, found.start, found.frames[0]), _end(problem, found.end, found.frames[-1]))
    bends = np.array([s.bend for s in found.frames])
    turned = found.signs[:, None] * np.array([s.tangent for s in found.frames])
    return _curve(problem, found.states, ends, turned, bends)


def follow_from_flat(
    problem: PatternProblem, phi: np.ndarray, step: float = STEP
) -> ClosureCurve | None:
    """Trace the curve through a state beside the flat one away from that, and take its mirror image for the rest.

    Space mirrored in the plane of the flat sheet takes states to their negatives, and curves through it to themselves.

    Parameters
    ----------
    problem
        Of a flat pattern; fold limits on both sides alike.
    phi
        A closed state beside the flat one, [n] [rad].
    step
        Largest step [rad].

    Returns
    -------
    ClosureCurve or None
        None where there is no such curve, or the flat state is too far.
    """
    size, limits = float(np.linalg.norm(phi)), problem.fold_limits
    flat = problem.pattern.lies_flat and bool((limits.low == -limits.high).all())
    if not flat or not 0 < size <= NEAR_FLAT * step * math.sqrt(problem.size):
        return None
    curve = ClosedStates(problem)
    x, residual = problem.project(phi * (0.5 * step * math.sqrt(problem.size) / size))
    first = curve.frame(x, x / np.linalg.norm(x)) if residual <= CLOSURE_TOL else None
    if first is None:
        return None
    frames, _, why = trace_ahead(curve, first, _steps(problem, step), [_limit(curve)])
    if not frames or why == CLOSED_CURVE:
        return None
    frames, end = [first, *frames], _end(problem, why, frames[-1])
    x, tangents_, bends = (
        np.array([getattr(s, what) for s in frames]) for what in ("x", "tangent", "bend")
    )
    whole = (
        np.concatenate([turned * of[::-1], of])
        for of, turned in ((x, -1.0), (tangents_, 1.0), (bends, -1.0))
    )
    states, tangents_, bends = whole
    return _curve(problem, states, (end, end), tangents_, bends, odd=True)


def _steps(problem: PatternProblem, step: float) -> ContinuationOptions:
    root = math.sqrt(problem.size)
    return ContinuationOptions(
        first=step * root,
        longest=step * root,
        shortest=SHORTEST * root,
        turn=SHARPEST,
        sharpest=SHARPEST,
        growth=1.5,
        most=MOST_STEPS,
    )


def _limit(curve: ClosedStates) -> End[Sample]:
    """The end of a curve at a fold limit."""
    limits = curve.problem.fold_limits

    def inside(samples: Sequence[Sample]) -> int:
        beyond = [not limits.inside(s.x, EXPLORED).all() for s in samples]
        return beyond.index(True) if True in beyond else len(beyond)

    return End(inside, "limit", curve.limit)


def _end(problem: PatternProblem, why: str, last: Sample) -> str:
    """Say why a curve ends."""
    at_limit = bool((problem.fold_limits.room(last.x) <= EXPLORED).any())
    known = {CLOSED_CURVE: "closed", "limit": "limit" if at_limit else "lost at a fold limit"}
    return known.get(why, f"lost: {why}" if why.startswith("more") else LOST)


def _curve(
    problem: PatternProblem,
    x: np.ndarray,
    ends: tuple[str, str],
    tangents: np.ndarray,
    bends: np.ndarray,
    odd: bool = False,
) -> ClosureCurve:
    states = problem.fold_limits.clip(x)
    chords = np.linalg.norm(np.diff(states, axis=0), axis=1) / math.sqrt(problem.size)
    return ClosureCurve(
        states, np.concatenate([[0.0], np.cumsum(chords)]), ends, tangents, bends, odd
    )
