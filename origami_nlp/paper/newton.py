"""Newton along a stratum, to minima, saddles and maxima alike: of one state to rounding, of many to their vicinity."""

from __future__ import annotations

import numpy as np

from origami_nlp.kkt import State, Stratum, newton, project
from origami_nlp.numerics import FOLLOWED, NONZERO, RANK
from origami_nlp.problem import Contact, Problem

LONGEST_STEP = 0.3
"""Newton steps are cut to this length [rad]: a start belongs to the critical points near it."""
MANY_STEPS = 15
"""Of Newton."""
DIFFERENCE = 1e-5
"""Step of the differences by which many states learn how closure bends [rad]."""
NEAR = 1e-3
"""Length of a last step [rad] from which one state at a time goes on."""


def settle(problem: Problem, x: np.ndarray, rows: tuple[Contact, ...] = ()) -> Stratum | None:
    """Return the critical point along the stratum of `rows` near x [n], admissible or not; None where there is none."""
    found = newton(problem, project(problem, x, rows)[0], rows)[0]
    if found is None:
        return None
    held = State(problem, found.x).on(rows)
    off = max(held.state.residual, float(np.abs(held.openings).max(initial=0.0)))
    return held if off <= FOLLOWED else None


def approach(problem: Problem, x: np.ndarray) -> np.ndarray:
    """Run Newton on closed states [K, n] of two degrees of freedom; return those that come to rest."""
    length = np.zeros(len(x))
    for _ in range(MANY_STEPS):
        jac = problem.constraints(x)[1]
        z = np.linalg.svd(jac)[2][:, -2:]  # [K, 2, n]
        pull = problem.parameters.torque(x)
        lam = np.einsum("kij,kj->ki", np.linalg.pinv(jac.swapaxes(1, 2), rcond=RANK), pull)
        hessian = np.einsum("kin,knm,kjm->kij", z, problem.parameters.hessian(x), z)
        for i in (0, 1):  # less lam . c''
            ahead, back = (
                problem.constraints(x + h * z[:, i])[1] for h in (DIFFERENCE, -DIFFERENCE)
            )
            bent = np.einsum("km,kmn,kjn->kj", lam, ahead - back, z) / (2 * DIFFERENCE)
            hessian[:, i] -= bent
        step = -np.einsum("kij,kjn,kn->ki", np.linalg.pinv(hessian, rcond=RANK), z, pull)
        length = np.linalg.norm(step, axis=1)
        step *= np.minimum(1.0, LONGEST_STEP / np.maximum(length, NONZERO))[:, None]
        x = project(problem, x + np.einsum("ki,kin->kn", step, z), steps=4)[0]
        inside = problem.fold_limits.inside(x, LONGEST_STEP).all(axis=1)
        x, length = x[inside], length[inside]
    return np.asarray(x[length <= NEAR])
