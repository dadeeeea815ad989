"""Downhill along closed states: Newton in the null space of closure with a trust region, projected back."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy as sp

from origami_nlp.kkt import State, newton
from origami_nlp.numerics import (
    BALANCED,
    CLOSURE_TOL,
    DECREASE,
    EXPLORED,
    NEAR_SINGULAR_TOL,
    NONZERO,
    OUTSIDE,
    RANK,
    RESOLVED,
    ROUNDED,
    SETTLED,
    SINGULAR,
    TINY,
    Factor,
    Matrix,
    Normal,
    NullSpaces,
)
from origami_nlp.pattern_problem import MOST_DENSE, PatternProblem
from origami_nlp.search.descend import CLOSES_NOT, NO_LOWER, StartState

TRUST = 0.3
"""First and largest step [rad]."""
WEIGHTS = (1e-10, 1e-13)
"""Of multipliers in sparse systems of steps: along a singular value s of closure a step leaves it by a share of
weight over s^2.  The second one, which takes more elimination, where the first lets it leave."""
LEAVES = 1e-8
"""Share of a step by which it may leave closure to first order."""
STILL = 1e-12
"""Reduced torque over the mean stiffness at which a descent has arrived."""
MOST_SPECTRAL = 60
"""Creases up to which steps are taken from a spectrum, which leaves saddles; beyond, curvature is shifted."""
FALLS = 0.5
"""Steps that lower no energy go on while each leaves a smaller share of the torque: beside states where closure loses
rank they end nowhere."""
FAR_FROM_SINGULAR = 1e-4
"""Of closure: smaller singular values are left to systems that do not decide on a rank."""
FAR = 4.0
"""A step that is cut by more than this goes along the softest ways alone: curvature is shifted instead."""
BESIDE_FLAT = math.sqrt(RESOLVED)
"""Starts that end with all fold angles smaller [rad] lead back to the flat state."""


@dataclass(frozen=True)
class Descended:
    """Where a descent ended.

    Attributes
    ----------
    phi
        Fold angles [rad], [n].
    arrived
        Whether the torque along all free motions vanishes.
    steps
        Taken.
    why
        How it ended.
    path
        Closed states on the way, from the start on.
    """

    phi: np.ndarray
    arrived: bool
    steps: int
    why: str
    path: tuple[np.ndarray, ...] = ()


def descend_by_newton(
    problem: PatternProblem,
    phi: np.ndarray,
    most: int = 200,
    side: np.ndarray | None = None,
) -> Descended:
    """Follow the energy downhill from a closed state, by Newton in a trust region with an active set of fold limits.

    Parameters
    ----------
    problem
        The problem.
    phi
        A closed state within the fold limits, [n] [rad].
    most
        Steps.
    side
        Direction [n] that says to which side saddles are left.

    Returns
    -------
    Descended
        A stationary state where it arrived: not yet judged.
    """
    radius = TRUST
    limited = problem.fold_limits
    held = np.abs(limited.room(phi)) <= OUTSIDE
    energy, path = problem.scaled_energy(phi), [phi]
    crept, before = False, math.inf
    for step in range(most):
        where = np.flatnonzero(held)
        lam, limits, balance = problem.multipliers(phi, where)
        normal = problem.normal(phi, where)  # the factors of the multipliers
        if len(where) and limits.min() < -STILL:  # negative multiplier: it leaves the active set
            held[where[int(limits.argmin())]] = False
            crept = False
            continue
        # beside the flat state multipliers are large, and rounding with them
        size, left = max(1.0, float(np.abs(lam).max(initial=0.0))), float(np.abs(balance).max())
        still = STILL * size
        if crept and left > FALLS * before:
            return Descended(phi, left <= BALANCED, step, NO_LOWER, tuple(path))
        before = left
        if left <= ROUNDED * size and problem.size > MOST_SPECTRAL:  # no step leaves a saddle there
            return Descended(phi, True, step, "still", tuple(path))
        d = _direction(problem, phi, lam, held, radius, normal, side)
        slope = float(balance @ d)
        if left <= still and slope > -(still**2):
            return Descended(phi, True, step, "still", tuple(path))
        moved = False
        while radius > ROUNDED:
            trial = _capped(d, radius)
            new, closes = _retract(problem, phi + trial, held, phi)
            share = float(np.linalg.norm(trial)) / max(float(np.linalg.norm(d)), NONZERO)
            lower = problem.scaled_energy(new) < energy - DECREASE * abs(slope) * share
            tiny = np.abs(trial).max() < TINY and problem.scaled_energy(new) <= energy + ROUNDED * (
                1 + abs(energy)
            )
            if closes and (lower or tiny) and np.abs(new - phi).max() <= 3 * radius + OUTSIDE:
                phi, energy, moved, crept = new, problem.scaled_energy(new), True, not lower
                path.append(phi)
                held = held | (np.abs(limited.room(phi)) <= OUTSIDE)
                if np.abs(trial).max() >= 0.9 * radius:
                    radius = min(TRUST, 2 * radius)
                break
            radius *= 0.3
        if not moved:
            at_rest = np.abs(balance).max() <= BALANCED
            return Descended(phi, at_rest, step, NO_LOWER, tuple(path))
        radius = max(radius, SETTLED)
    return Descended(phi, False, most, "too many steps", tuple(path))


def _direction(
    problem: PatternProblem,
    phi: np.ndarray,
    lam: np.ndarray,
    held: np.ndarray,
    radius: float,
    normal: Normal,
    side: np.ndarray | None,
) -> np.ndarray:
    """Newton's step in the tangent space with negative curvature turned round."""
    free = np.flatnonzero(~held)
    out = np.zeros(problem.size)
    g = problem.torque(phi)
    h = problem.hessian(phi, lam)
    if problem.size <= MOST_SPECTRAL:
        z = problem.kernel(phi, np.flatnonzero(held))
        if not z.shape[1]:
            return out
        values, vectors = np.linalg.eigh(z.T @ (h @ z))
        slope = vectors.T @ (z.T @ g)
        size = np.maximum(np.abs(values), SINGULAR)
        y = -slope / size
        if values[0] < -BALANCED and abs(slope[0]) < BALANCED:  # it leaves a saddle
            towards = slope[0] if side is None else -float(side @ (z @ vectors[:, 0]))
            y[0] = -math.copysign(radius, towards or 1.0)
        return np.asarray(z @ (vectors @ y))
    j = normal.jacobian
    h = h[free][:, free] if held.any() else h
    steps = _steps(problem, phi, h, j, j.T @ lam - g[free])
    shift = 0.0
    for _ in range(8):
        d = steps(shift)
        bent = float(d @ (h @ d + shift * d)) <= SINGULAR * float(d @ d) and d.any()
        if not bent and np.abs(d).max() <= FAR * radius:
            break
        shift = max((10 if bent else 3) * shift, 0.1)
    out[free] = d
    return out


def _steps(
    problem: PatternProblem, phi: np.ndarray, h: Matrix, j: Matrix, left: np.ndarray
) -> Callable[[float], np.ndarray]:
    """Return Newton's step along closure for a torque that is left, by what is added to the curvature h.

    By the spectrum on the null space of j where that is far from losing rank; beside such states by the system that
    does not decide on it.
    """
    if isinstance(h, np.ndarray) and isinstance(j, np.ndarray):
        whole = j.shape[1] == problem.size
        spaces = problem.null_spaces(phi) if whole else NullSpaces(j)
        if spaces.gap[0] < RANK and spaces.gap[1] > FAR_FROM_SINGULAR:
            z = spaces.kernel
            values, vectors = np.linalg.eigh(z.T @ h @ z)
            z = z @ vectors
            slope = z.T @ left

            def spectral(shift: float) -> np.ndarray:
                curvature = values + shift
                tiny = np.abs(curvature) < NONZERO
                return np.asarray(z @ (slope / np.where(tiny, NONZERO, curvature)))

            return spectral
    if isinstance(h, np.ndarray):
        unit, none = np.eye(len(left)), np.zeros(j.shape[0])
        return lambda shift: Factor(h + shift * unit, j).solve(left, none)[0]

    def along_closure(shift: float) -> np.ndarray:
        matrix = h + shift * sp.sparse.eye_array(len(left))
        for weight in WEIGHTS:
            factor = Factor(matrix, j, weight=weight)
            d, change = factor.solve(left, np.zeros(j.shape[0]))
            if np.abs(j @ d).max(initial=0.0) <= LEAVES * np.abs(d).max(initial=0.0):
                return d
        return d + factor.solve(left - matrix @ d - j.T @ change, -(j @ d))[0]

    return along_closure


def _capped(d: np.ndarray, radius: float) -> np.ndarray:
    return d * min(1.0, radius / max(float(np.abs(d).max(initial=0.0)), NONZERO))


def _retract(
    problem: PatternProblem, phi: np.ndarray, held: np.ndarray, near: np.ndarray
) -> tuple[np.ndarray, bool]:
    """Project back; creases that would pass a limit stop there."""
    held = held.copy()
    limits = problem.fold_limits
    phi, residual = problem.project(limits.clip(phi), held, near=near)
    for _ in range(6):
        beyond = ~limits.inside(phi)
        if not beyond.any():
            break
        held |= beyond
        phi = np.where(beyond, limits.clip(phi), phi)
        phi, residual = problem.project(phi, held)
    good = residual <= CLOSURE_TOL and bool(limits.inside(phi).all())
    return phi, good and problem.closure.lifts_to_one(phi)


class ByNewton:
    """Ways down of a sheet too large for dense matrices, as `Follower` has them: facets may cross on the way."""

    usable, work = True, 0  # of Newton's method nothing is counted

    def __init__(self, problem: PatternProblem) -> None:
        self.problem = problem

    def __call__(
        self, start: StartState, aside: np.ndarray, *given: object
    ) -> tuple[np.ndarray, str]:
        """Return where a start leads, [n], and why it ends there: ``""`` where that is stationary."""
        x = self.problem.fold_limits.hold(start.x, start.side)
        if (closed := close(self.problem, x)) is None:
            return x, CLOSES_NOT
        end = descend_by_newton(self.problem, closed, side=aside)
        if not end.arrived and (better := stationary_beside(self.problem, end.phi)) is not None:
            return better, ""
        return end.phi, "" if end.arrived else end.why

    def each(
        self, starts: Sequence[StartState], asides: np.ndarray, *given: object
    ) -> list[Callable[[], tuple[np.ndarray, str]]]:
        """Return what tells where each of some starts leads."""
        return [partial(self, *both) for both in zip(starts, asides, strict=True)]


def close(problem: PatternProblem, start: np.ndarray) -> np.ndarray | None:
    """Close a start within the fold limits, fully folded creases left so if possible; None where it does not close.

    What comes as near to the flat state as `BESIDE_FLAT` without closing is that state: closure holds to the square of
    the distance there and has singular values of its size, so that rounding says in which step, if ever, it closes.
    """
    limits = problem.fold_limits
    start = limits.clip(start)
    at_limit = limits.room(start) == 0
    for held in (at_limit, None) if at_limit.any() else (None,):
        phi, residual = problem.project(start, held)
        within = limits.inside(phi, EXPLORED).all()
        phi = limits.clip(phi)
        if residual <= CLOSURE_TOL and within and problem.closure.lifts_to_one(phi):
            return phi
    flat = np.zeros(problem.size)
    beside = problem.pattern.lies_flat and bool(np.abs(phi).max() < BESIDE_FLAT)
    return flat if beside and limits.inside(flat).all() else None


def stationary_beside(problem: PatternProblem, phi: np.ndarray) -> np.ndarray | None:
    """Solve for the stationary state beside a closed one, contacts that are closed kept so.

    Parameters
    ----------
    problem, phi
        The problem and a closed state, [n] [rad].

    Returns
    -------
    numpy.ndarray or None
        The state, [n]; None where it is far, or the sheet has more than `MOST_DENSE` creases.
    """
    if problem.size > MOST_DENSE:
        return None
    better, _ = newton(problem, phi, State(problem, phi).pieces[0])
    return None if better is None or np.abs(better.x - phi).max() >= NEAR_SINGULAR_TOL else better.x
