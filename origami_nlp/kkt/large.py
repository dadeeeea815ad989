"""States of problems too large for singular values and kernels: certificates by sparse factors, fold limits alone.

That the reduced Hessian is positive definite on the null space of closure and loaded limits is shown by H + rho J'J > 0
(Finsler), whatever the rank of J: the smallest eigenvalue of that matrix bounds the curvature on the null space from
below.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from origami_nlp.kkt.certificates import BY_CLOSURE, BranchJudgement
from origami_nlp.kkt.descent_witness import BENDS, FAR, DescentWitness
from origami_nlp.kkt.multipliers import Multipliers
from origami_nlp.kkt.state import State
from origami_nlp.numerics import (
    CLOSURE_TOL,
    CURVED,
    EPS,
    FULL,
    LEVEL,
    STATIONARY,
    dense,
    nonnegative_least_squares,
)
from origami_nlp.problem import Contact

if TYPE_CHECKING:
    import scipy as sp

PENALTIES = (1e4, 1e7, 1e10)
"""Weights rho, of which one that shows it is enough: where closure has small singular values s, rho s^2 is to be more
than curvature across the null space, but rounding of rho J'J is to be less than that along it."""
DRAWN = 10
"""Directions that are tried beside the steepest one."""


def judge_large(state: State) -> Iterator[BranchJudgement]:
    """Judge a state by its fold limits: Lagrange multipliers >= 0, and a positive definite reduced Hessian.

    Yields
    ------
    BranchJudgement
        What is found; where nothing balances then also what the tangent cone says, which takes long to list.
    """
    p, x, rows = state.problem, state.x, state.contacts.base
    at_limit = np.array([c.index for c in rows], int)
    lam, moments, left = p.multipliers(x, at_limit)
    size = 1.0 + float(np.abs(p.torque(x)).max(initial=0.0))
    if moments.min(initial=0.0) < -STATIONARY * size:  # they may depend on closure: others may push
        slopes = _slopes(state, rows)
        moments = nonnegative_least_squares(slopes.T, p.torque(x))
        left = p.along(x, p.torque(x) - slopes.T @ moments)
        lam = p.multipliers(x)[0]
    moments = np.maximum(moments, 0.0)
    residual = float(np.abs(left).max(initial=0.0))
    found = Multipliers(residual, True, moments)

    # rows of closure depend on each other: creases less rows would call sheets that move isolated
    say = partial(BranchJudgement, rows=rows, multipliers=found, cone_dimension=len(x) - p.rank(x))
    if residual > STATIONARY * 10 * size:
        why = "no multipliers >= 0 balance the springs"
        yield say("undecided", why, 0, more=(-left,))
        rises, falling, _ = state.tangent_cone.slopes(p.torque(x), _slopes(state, rows))
        down = tuple(falling)
        yield say("minimum", BY_CLOSURE, 5) if rises else say("undecided", why, 0, more=down)
        return
    # critical cone: strongly active limits stay active
    free = np.setdiff1d(np.arange(len(x)), at_limit[moments > 10 * STATIONARY * size])
    if not len(free):
        why = "sharp: the energy grows to first order in every feasible direction"
        yield say("minimum", why, 3)
        return
    lowest, vector = smallest_curvature(p.hessian(x, lam)[free][:, free], p.jacobian(x)[:, free])
    way = np.zeros(len(x))
    way[free] = vector
    values = np.array([lowest] if math.isfinite(lowest) else [])
    if lowest > CURVED:
        why = "Hessian positive definite on the critical cone"
        yield say("minimum", why, 2 if rows else 1, eigenvalues=values)
    else:
        why = "neither first nor second order decides"
        yield say("undecided", why, 0, eigenvalues=values, more=(way, -way))


def _slopes(state: State, limits: tuple[Contact, ...]) -> np.ndarray:
    out = np.zeros((len(limits), len(state.x)))
    out[np.arange(len(limits)), [c.index for c in limits]] = [-c.side for c in limits]
    return out


def lower_beside(state: State, branch: BranchJudgement) -> DescentWitness | None:
    """Look for a lower admissible state along the directions that were found, and some that are drawn."""
    p, x = state.problem, state.x
    noise = LEVEL * max(abs(p.energy(x)), p.scale)
    for d in _directions(state, branch):
        for step in FAR:
            start = p.fold_limits.clip(x + step * d)
            y, residual = p.project(start, p.fold_limits.room(start) == 0)
            moved = float(np.abs(y - x).max())
            if residual > CLOSURE_TOL or not 0.1 * step <= moved <= 3 * step:
                continue
            change = p.energy_change(x, y)
            if change > noise:  # it rises first: what is lower further on lies behind that
                break
            if not p.fold_limits.inside(y).all() or change >= -noise:
                continue
            if p.refuses(y) or not _closes_along(state, (y - x) / moved):
                break
            return DescentWitness(d, step, -change, y)
    return None


def _closes_along(state: State, d: np.ndarray) -> bool:
    """Whether what closes along a direction [n] also does at the end of `FAR`, where that says more than rounding."""
    p, x, step = state.problem, state.x, FAR[-1]
    start = p.fold_limits.clip(x + step * d)
    end, residual = p.project(start, p.fold_limits.room(start) == 0)
    return bool(residual <= CLOSURE_TOL and np.abs(end - start).max() <= BENDS * step)


def _directions(state: State, branch: BranchJudgement) -> Iterator[np.ndarray]:
    drawn = np.random.default_rng(0).normal(size=(DRAWN, len(state.x)))
    # at the flat state others come in pairs, x and -x
    both = (1.0,) if state.x.any() else (1.0, -1.0)
    for d in (*branch.more, *(drawn if not state.x.any() else ())):
        size = float(np.abs(d).max())
        yield from (s * d / size for s in both if size > 0)


def smallest_curvature(h: sp.sparse.sparray, j: sp.sparse.sparray) -> tuple[float, np.ndarray]:
    """Return the smallest curvature along what closure allows, from below, and its direction.

    Parameters
    ----------
    h
        Hessian of the Lagrangian, [n, n].
    j
        Jacobian of closure, [m, n].

    Returns
    -------
    smallest : float
        The smallest eigenvalue of H + rho J'J, less its residual and rounding, for the weight that shows most; nan
        where Lanczos' method does not converge.
    way : numpy.ndarray
        Its vector, [n].
    """
    import scipy as sp

    n, found = h.shape[0], (math.nan, np.zeros(h.shape[0]))
    full = h.nnz > FULL * n * n  # the curvature of one long loop
    held, j = (dense(m) if full else sp.sparse.csc_array(m) for m in (h, j))
    # below every eigenvalue (Gershgorin; J'J adds none below), the closest one is the smallest
    below = -float(abs(held).sum(axis=1).max()) - 1.0
    square, inverse = j.T @ j, None
    for penalty in PENALTIES:
        # Finsler: on the kernel of J the penalty adds nothing, so that what is positive with it is positive there
        whole = held + penalty * square
        if full:
            factor = sp.linalg.cho_factor(whole - below * np.eye(n), check_finite=False)
            solve = partial(sp.linalg.cho_solve, factor, check_finite=False)
            inverse = sp.sparse.linalg.LinearOperator((n, n), solve)
        try:
            values, vectors = sp.sparse.linalg.eigsh(
                whole, k=1, sigma=below, which="LM", v0=np.ones(n), OPinv=inverse
            )
        except sp.sparse.linalg.ArpackNoConvergence:
            continue
        vector = vectors[:, 0]
        # an eigenvalue lies within the residual of a unit vector's Rayleigh quotient, and within what rounding altered
        left = float(np.linalg.norm(whole @ vector - values[0] * vector))
        left += EPS * float(abs(whole).sum(axis=1).max())
        if not values[0] - left <= found[0]:
            found = float(values[0] - left), vector
        if found[0] > CURVED:
            break
    return found
