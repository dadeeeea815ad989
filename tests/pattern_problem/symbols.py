"""The problem of a pattern as CasADi symbols, for any solver: closure as independent rows, gaps of features as rows.

Written from the folds alone, by turns of quaternions along loops and of points along walks of facets: it shares neither
values nor derivatives with `closure`, `poses` and `touches`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np
from scipy.linalg import qr

from origami_nlp.kkt import State, classify
from origami_nlp.minima import Confirmation, JudgedState, confirm_posed, gaps_of
from origami_nlp.numerics import RANK, dense, quaternion as quat
from origami_nlp.pattern import Loop, Pattern
from origami_nlp.pattern_problem import ContactPair, CoplanarContact, PatternProblem
from origami_nlp.problem import Contact, Nlp, law_energy


def independent_rows(problem: PatternProblem, phi: np.ndarray) -> np.ndarray:
    """Return the numbers of closure equations that span all of them at a state [n], ascending."""
    # pivoting puts independent equations first
    _, r, order = qr(dense(problem.jacobian(phi)).T, mode="economic", pivoting=True)
    return np.sort(order[: int((np.abs(np.diag(r)) > RANK).sum())])


def pose(problem: PatternProblem, rows: np.ndarray, touches: Sequence[ContactPair] = ()) -> Nlp:
    """Pose min U subject to some closure equations and gaps.

    Rows are numbers of the equations; gaps of `touches`, over the sheet's size, are the last rows, free.
    """
    n = problem.size
    x, k, rest, load = (ca.SX.sym(name, n) for name in ("x", "k", "rest", "load"))
    laws = [law and law.origin[0] for law in problem.pattern.laws]
    springs = ca.DM([float(law is None) for law in laws]) if laws else ca.DM.ones(n)
    weight, shift = ca.SX.sym("w", len(laws)), ca.SX.sym("d", len(laws))
    energy = 0.5 * ca.dot(springs * k, (x - rest) ** 2) - ca.dot(load, x)
    for v, law in enumerate(laws):
        if law is not None:
            energy += weight[v] * law_energy(law, x[v] - shift[v])
    turns = x - ca.DM(problem.pattern.reference)
    away = problem.pattern.corners - problem.pattern.corners.mean(axis=0)
    size = float(np.abs(away).max(initial=0.0)) or 1.0
    turning = (*problem.pattern.vertices, *problem.pattern.generators)
    loops = [_loop(problem, turns, loop)[:3] for loop in turning]
    for loop in problem.pattern.holes:
        whole = _loop(problem, turns, loop)
        moved = ca.DM(loop.moved or (0.0, 0.0, 0.0))
        loops.append(ca.vertcat(whole[:3], (whole[3:] + moved) / size))
    closure = ca.vertcat(ca.SX(0, 1), *loops)
    gaps = [_gap(problem, turns, touch) / problem.crossings.size for touch in touches]
    free = np.full(len(gaps), math.inf)
    lower, upper = (np.append(np.zeros(len(rows)), s * free) for s in (-1.0, 1.0))
    g = ca.vertcat(closure[rows.tolist()], *gaps)
    return Nlp(x, ca.vertcat(k, rest, load, weight, shift), energy, g, lower, upper)


def _loop(problem: PatternProblem, turns: ca.SX, loop: Loop) -> ca.SX:
    """Return where the folds round a loop lead: vector part of the turn, and shift, [6]."""
    q, shift, p = quat.IDENTITY, ca.SX.zeros(3), problem.pattern
    copies = loop.shifts or ((0, 0),) * len(loop.creases)
    for crease, sign, copy in zip(loop.creases, loop.signs, copies, strict=True):
        fold, point = _fold(p, turns[crease], crease, sign)
        if p.cell:
            point = (point + np.array(copy) @ p.cell.lattice).tolist()
        after = quat.multiply(q, fold)
        # as in `closure`: the axis passes through `point`
        shift += ca.vertcat(*quat.rotate(q, point)) - ca.vertcat(*quat.rotate(after, point))
        q = after
    return ca.vertcat(*(-x if loop.moved else x for x in q[1:]), shift)


def _fold(p: Pattern, turn: ca.SX, crease: int, sign: float) -> tuple[Any, list[float]]:
    """Return the fold of a crease as a quaternion, and a point on its axis."""
    half = 0.5 * turn
    axis = (sign * p.directions[crease]).tolist()
    return quat.fold(ca.cos(half), ca.sin(half), axis), p.corners[p.ends[crease, 0]].tolist()


def _gap(problem: PatternProblem, turns: ca.SX, touch: ContactPair) -> ca.SX:
    """Return the gap of two features, seen from the first facet."""
    poses = problem.crossings.poses
    p = poses.pattern
    first, second = touch.facets

    def seen(x: np.ndarray) -> ca.SX:
        """Move a point of the second facet as the folds between the two do."""
        here: ca.SX = ca.SX(ca.DM(x))
        for crease, sign in reversed(poses.path(first, second)):
            fold, point = _fold(p, turns[int(poses.own([crease])[0])], crease, sign)
            turned = quat.rotate(fold, ca.vertsplit(here - ca.DM(point)))
            here = ca.SX(ca.vertcat(*turned) + ca.DM(point))
        return here

    a, b, c, d = (p.corners[i] for i in touch.corners)
    if touch.type == "edge-edge":
        e, f = seen(c), seen(d)
        normal, off = ca.cross(ca.DM(b - a), f - e), e - ca.DM(a)
    else:
        normal = ca.SX(ca.DM(np.cross(c - b, d - b)))
        off = seen(np.array(touch.place) if isinstance(touch, CoplanarContact) else a) - ca.DM(b)
    return touch.sign * ca.dot(off, normal) / ca.norm_2(normal)


def confirm_minimum(
    problem: PatternProblem, minimum: JudgedState
) -> tuple[Confirmation, tuple[np.ndarray, np.ndarray], float] | None:
    """Let IPOPT solve from a minimum with its contacts closed; None where no choice of rows stands for closure.

    Returned are what it says, our multipliers and its own over the mean stiffness, and the largest torque, over it too,
    that its multipliers leave along closure.
    """
    state = State(problem, minimum.phi)
    if not state.regular:
        return None
    stratum = state.on([c.contact for c in classify(state).contacts if c.contact is not None])
    rows = independent_rows(problem, state.x)
    touches = [problem.touch(Contact("gap", k, 1)) for k in gaps_of(stratum)]
    solver, forces = confirm_posed(pose(problem, rows, touches), stratum, rows)
    torque = state.kernel.T @ (state.gradient - stratum.slopes.T @ forces)
    return solver, (stratum.multiplier_set.smallest, forces), float(np.abs(torque).max(initial=0.0))
