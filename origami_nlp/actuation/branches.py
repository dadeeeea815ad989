"""Branches of the flat state, and what a load starts and reaches along each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from origami_nlp.actuation.cones import FlatMotion, cones, cut, driven_nappe, subspace, ways
from origami_nlp.actuation.driving import DrivenSet, driven_set, signed_set
from origami_nlp.actuation.result import BranchWay, FlatBranch
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, SAME_DIRECTION, coarse, first_largest
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import PatternProblem, Torque
from origami_nlp.pattern_states import (
    Interpolant,
    contact_descent_off,
    descend,
    follow_curve,
    follow_from_flat,
    halves,
    interpolate,
    judge_end,
    list_branches,
    split,
    wells,
)

GENERIC = 2.0
"""Step of the angles whose cosines make a direction of a family that nothing distinguishes [rad]."""


def torque_of(pattern: Pattern, load: np.ndarray) -> tuple[Torque, float] | None:
    """Return a load [n] as a torque in shares and its size; None where it is 0.

    Parameters
    ----------
    pattern
        The sheet.
    load
        Torques, [n] [N m].

    Returns
    -------
    tuple or None
        What is worked on, and the largest torque.
    """
    size = float(np.abs(load).max())
    if not size:
        return None
    creases = np.flatnonzero(load)
    shares = tuple((load[creases] / size).tolist())
    return Torque(pattern, tuple((creases + 1).tolist()), shares), size


def flat_branches(pattern: Pattern, until: float = math.inf) -> tuple[list[FlatMotion], str]:
    """Enumerate the branches of the flat state: flat velocities that closed states follow.

    Parameters
    ----------
    pattern
        Flat.
    until
        Value of `time.monotonic` at which the time is over.

    Returns
    -------
    branches : list of FlatMotion
        Lines first, then subspaces of several dimensions, or the two nappes of a cone.
    reason : str
        Why they were not enumerated; "" where they were.
    """
    problem = PatternProblem(pattern)
    problem.until = until
    stops = problem.fold_limits.near(np.zeros(pattern.creases), SAME_DIRECTION)
    several = "a stop of the flat state cuts motions of several degrees of freedom"
    cone = list_branches(pattern, None, problem.check_time)
    if cone.reason:
        if max((len(loop.creases) for loop in pattern.vertices), default=0) <= 4:
            return [], cone.reason
        found, reason = cones(pattern, problem.check_time)
        for motion in found:
            generic, _ = ways(motion, np.cos(GENERIC * np.arange(pattern.creases)))
            if not all(follows(problem, way) for way in generic):
                return [], "a cone of motions is not closed to higher order"
        if stops.any() and any(not motion.side for motion in found):
            return [], several
        left = [part for motion in found if (part := cut(motion, stops)) is not None]
        return left, reason
    cone = split(problem, np.zeros(pattern.creases), cone)
    lines = []
    for line in cone.lines:
        problem.check_time()
        if follows(problem, line):
            tidy = coarse(line)
            line = line * np.sign(tidy[first_largest(np.abs(tidy))])
            ways_on = [way for way in (line, -line) if not held(way, stops)]
            lines += ways_on[:1]
    lines.sort(key=lambda line: tuple((-coarse(line)).tolist()))
    if cone.families and stops.any():
        return [], several
    for basis in cone.families:
        generic = basis @ (basis.T @ np.cos(GENERIC * np.arange(len(basis))))
        if not follows(problem, generic):
            return (
                [],
                f"motions of {basis.shape[1]} degrees of freedom are not closed to higher order",
            )
    return [subspace(basis) for basis in (*(line[:, None] for line in lines), *cone.families)], ""


def held(way: np.ndarray, stops: np.ndarray) -> bool:
    """Return whether stops of the flat state, -1, 0 or 1 of each crease [n], are in the way of velocities [n]."""
    return bool((way * stops > SAME_DIRECTION).any())


def driven_alone(found: Sequence[FlatMotion], k: int, most: int | None = None) -> DrivenSet | None:
    """Find few creases on which torques start one branch alone.

    Parameters
    ----------
    found
        Of `flat_branches`.
    k
        Index of the branch.
    most
        Sets of creases that are gone through; None: as many as `driven_set` does.

    Returns
    -------
    DrivenSet or None
        See `driven_set` and `driven_nappe`.
    """
    mine = found[k]
    others = [m.basis for m in found if m.basis is not mine.basis]
    rest = np.column_stack([np.zeros((len(mine.basis), 1)), *others])
    more = {} if most is None else {"most": most}
    if mine.side:
        return driven_nappe(k + 1, mine, rest, **more)
    return driven_set(k + 1, mine.basis, rest, **more)


def driven_by_signs(found: Sequence[FlatMotion], signs: Sequence[int]) -> list[DrivenSet]:
    """Find sizes of torques with given signs that start a branch alone, for each where there are any; none of cones.

    Parameters
    ----------
    found
        Of `flat_branches`.
    signs
        1, -1 or 0 on each crease.

    Returns
    -------
    list of DrivenSet
        See `signed_set`.
    """
    bases = [] if any(m.side for m in found) else [m.basis for m in found]
    sets = []
    for k, mine in enumerate(bases):
        rest = [np.zeros((len(mine), 1)), *bases[:k], *bases[k + 1 :]]
        sets.append(signed_set(k + 1, mine, np.column_stack(rest), signs))
    return [one for one in sets if one is not None]


def released(
    pattern: Pattern,
    load: np.ndarray,
    found: Sequence[FlatMotion],
    until: float,
    *,
    release: bool = True,
) -> tuple[list[FlatBranch], list[JudgedState]]:
    """Go from the flat state along each branch on which a load and the springs work.

    Parameters
    ----------
    pattern
        Flat.
    load
        Torques, [n] [N m].
    found
        Of `flat_branches`.
    until
        Value of `time.monotonic` at which the time is over.
    release
        Whether to go; without, branches are compared alone.

    Returns
    -------
    branches : list of FlatBranch
        In the same order.
    reached : list of JudgedState
        Each state once, of the pattern with springs wound by the torques.
    """
    work = torque_of(pattern, load)
    wound = pattern if work is None else work[0].loaded(work[1])
    problem = PatternProblem(wound)
    problem.until = until
    force = -problem.torque(np.zeros(pattern.creases)) * problem.scale
    least = SAME_DIRECTION * float(np.linalg.norm(force))
    limit = problem.fold_limits.near(np.zeros(pattern.creases), SAME_DIRECTION)
    branches, reached = [], list[JudgedState]()
    for k, motion in enumerate(found):
        problem.check_time()  # sheets have thousands of branches
        basis = motion.basis
        kind: Any = "cone" if motion.side else "line" if basis.shape[1] == 1 else "family"
        drivable = bool(motion.side) or driven_alone(found, k, 0) is not None
        along = basis @ (basis.T @ force)
        size = float(np.linalg.norm(along))
        some, alone = [along / size] if size > least else [], True
        if motion.side:
            some, alone = ways(motion, force)
        if not some or not release:
            branches.append(FlatBranch(kind, basis, 0.0, drivable, side=motion.side))
            continue
        worth, blocked = float(some[0] @ force), ""
        if any(held(way, limit) for way in some):
            worth, blocked = 0.0, "a stop holds it"
        elif not alone:
            blocked = "not decided whether it is unique: work is most in a continuum of directions"
        gone = []
        for way in () if blocked else some:
            problem.check_time()
            state, why = release_along(problem, way, kind == "line")
            number = 0
            if state is not None:
                near = [np.abs(state.phi - r.phi).max() <= DUPLICATE_TOL for r in reached]
                number = 1 + (near.index(True) if True in near else len(reached))
                reached += [state] * (number > len(reached))
            gone.append(BranchWay(way, float(way @ force), number, why))
        first = gone[0] if gone else BranchWay(along, 0.0, 0, blocked)
        several = tuple(gone) if motion.side else ()
        branches.append(
            FlatBranch(kind, basis, worth, drivable, first.reached, first.why, several, motion.side)
        )
    return branches, reached


STEP = 0.05
"""Of curves, and first step into a family of several dimensions [rad], root mean square over creases."""
SHRINKS = 0.75
"""How much nearer, over its length, the half of a step must be to closed states than the whole."""
HALVINGS = 0.5, 0.25
"""Of that first step, where a descent does not arrive."""
LOST = "no states follow from the flat one"


def follows(problem: PatternProblem, direction: np.ndarray) -> bool:
    """Return whether closed states leave the flat one along a direction [n].

    Parameters
    ----------
    problem
        Of a flat pattern.
    direction
        Of flat velocities, [n].

    Returns
    -------
    bool
        Whether closed states are near at a step and at half of it, at an angle that shrinks with the step.
    """
    off = []
    for share in (1.0, 0.5):
        step = share * _step(problem, direction)
        phi, residual = problem.project(step)
        if residual > CLOSURE_TOL:
            return False
        off.append(float(np.linalg.norm(phi - step) / np.linalg.norm(step)))
    return off[1] <= max(SHRINKS * off[0], SAME_DIRECTION)


def release_along(
    problem: PatternProblem, direction: np.ndarray, is_line: bool
) -> tuple[JudgedState | None, str]:
    """Go down from the flat state along a branch.

    Parameters
    ----------
    problem
        Of the flat pattern, its springs wound by the torques.
    direction
        Flat velocity on whose side the energy falls, [n].
    is_line
        Whether the branch has one degree of freedom: then it is traced, and its first well is taken.

    Returns
    -------
    state : JudgedState or None
        The first minimum; None where none was reached.
    why : str
        Why not; "" otherwise.
    """
    start, residual = problem.project(_step(problem, direction))
    if residual > CLOSURE_TOL:
        return None, LOST
    if is_line:
        half = _half(problem, start, direction)
        found = wells(problem, half)
        if not found:
            return None, f"no minimum along the branch: {half.ends[1]}"
        well, residual = problem.project(found[0])
        if residual > CLOSURE_TOL:
            return None, f"no minimum along the branch: does not close, {residual:.1e}"
        upto = 1 + int(np.linalg.norm(half.states - well, axis=1).argmin())
        path, end = [*half.states[1:upto], well], descend(problem, well)
    else:
        end = descend(problem, start)
        for share in HALVINGS:  # a descent may stall in rounding beside its end
            if end.arrived:
                break
            start, residual = problem.project(share * _step(problem, direction))
            end = descend(problem, start) if residual <= CLOSURE_TOL else end
        path = [start, *end.path]
    held = contact_descent_off(problem, path)
    end = end if held is None else held
    if not end.arrived:
        return None, end.why
    state = judge_end(problem, end.phi)
    return (state, "") if state.verdict == "minimum" else (None, state.certificate)


def _step(problem: PatternProblem, direction: np.ndarray) -> np.ndarray:
    size = STEP * np.sqrt(problem.size) / np.linalg.norm(direction)
    out: np.ndarray = size * direction
    return out


def _half(problem: PatternProblem, start: np.ndarray, direction: np.ndarray) -> Interpolant:
    """Return the curve through a state beside the flat one [n], from the flat state on."""
    odd = follow_from_flat(problem, start, STEP)
    if odd is not None:
        whole = interpolate(problem, odd)
        at = len(whole.control) // 2
        states = np.concatenate([np.zeros((1, problem.size)), whole.states[at + 1 :]])
        control = np.concatenate([halves(whole.control[at])[1][None], whole.control[at + 1 :]])
        return replace(
            whole, states=states, control=control, ends=("flat", whole.ends[1]), odd=False
        )
    # fold limits differ on the two sides
    curve = follow_curve(problem, np.zeros(problem.size), direction, STEP)
    at = int(np.linalg.norm(curve.phi, axis=1).argmin())
    return interpolate(
        problem,
        replace(
            curve,
            phi=curve.phi[at:],
            arc=curve.arc[at:],
            tangents=curve.tangents[at:],
            bends=curve.bends[at:],
            ends=("flat", curve.ends[1]),
        ),
    )
