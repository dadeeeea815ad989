"""Branches of the flat state, and what a load starts and reaches along each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from origami_nlp.actuation.driving import driven_set
from origami_nlp.actuation.release import follows, release_along
from origami_nlp.actuation.result import FlatBranch
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import DUPLICATE_TOL, SAME_DIRECTION, coarse, first_largest
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import PatternProblem, Torque
from origami_nlp.pattern_states import list_branches, split

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


def flat_branches(pattern: Pattern, until: float = math.inf) -> tuple[list[np.ndarray], str]:
    """Enumerate the branches of the flat state: flat velocities that closed states follow.

    Parameters
    ----------
    pattern
        Flat.
    until
        Value of `time.monotonic` at which the time is over.

    Returns
    -------
    branches : list of numpy.ndarray
        An orthonormal basis of each, [n, k]: lines (k = 1) first.
    reason : str
        Why they were not enumerated; "" where they were.
    """
    problem = PatternProblem(pattern)
    problem.until = until
    cone = list_branches(pattern, None, problem.check_time)
    if cone.reason:
        return [], cone.reason
    cone = split(problem, np.zeros(pattern.creases), cone)
    lines = []
    for line in cone.lines:
        problem.check_time()
        if follows(problem, line):
            tidy = coarse(line)
            lines.append(line * np.sign(tidy[first_largest(np.abs(tidy))]))
    lines.sort(key=lambda line: tuple((-coarse(line)).tolist()))
    for basis in cone.families:
        generic = basis @ (basis.T @ np.cos(GENERIC * np.arange(len(basis))))
        if not follows(problem, generic):
            return (
                [],
                f"motions of {basis.shape[1]} degrees of freedom are not closed to higher order",
            )
    return [*(line[:, None] for line in lines), *cone.families], ""


def released(
    pattern: Pattern,
    load: np.ndarray,
    found: Sequence[np.ndarray],
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
    for k, basis in enumerate(found):
        others = [b for j, b in enumerate(found) if j != k]
        drivable = driven_set(
            k + 1, basis, np.column_stack([np.zeros((pattern.creases, 1)), *others]), 0
        )
        along = basis @ (basis.T @ force)
        size = float(np.linalg.norm(along))
        kind: Any = "line" if basis.shape[1] == 1 else "family"
        if size <= least or (along * limit > SAME_DIRECTION * size).any() or not release:
            worth = size if size > least and release else 0.0
            blocked = "a stop holds it" if worth else ""
            branches.append(FlatBranch(kind, basis, 0.0, drivable is not None, 0, blocked))
            continue
        problem.check_time()
        state, why = release_along(problem, along / size, kind == "line")
        number = 0
        if state is not None:
            near = [np.abs(state.phi - r.phi).max() <= DUPLICATE_TOL for r in reached]
            number = 1 + (near.index(True) if True in near else len(reached))
            reached += [state] * (number > len(reached))
        branches.append(FlatBranch(kind, basis, size, drivable is not None, number, why))
    return branches, reached
