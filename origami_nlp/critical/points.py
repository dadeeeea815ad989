"""Newton on the KKT system from many starts at once, along one stratum: minima, saddles and maxima alike."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import NONZERO, ROUNDED, STATIONARY
from origami_nlp.problem import Contact, Problem, held

LONGEST_STEP = 0.3
"""Newton steps are cut to this length [rad]: a start belongs to the critical points near it."""
MOST_STEPS = 25


@dataclass(frozen=True)
class KktPoints:
    """KKT points that Newton reached, not yet distinguished.

    x: [P, n].  multipliers: of the rows, [P, r] (scaled energy; > 0 where the contact pushes).
    residual: largest entry of stationarity (relative), closure and rows, [P].
    """

    x: np.ndarray
    multipliers: np.ndarray
    residual: np.ndarray


def kkt_newton(model: Problem, start: np.ndarray, rows: tuple[Contact, ...] = ()) -> KktPoints:
    """Run Newton on stationarity, closure and `rows` = 0 from every start [K, n].

    Finds minima, saddles and maxima along the stratum alike.  Starts whose Newton does not settle are dropped; a
    caller gives enough of them.
    """
    n, m, r = model.size, model.equation_count, len(rows)
    x = held(start, rows)
    todo = np.arange(len(x))
    residual = np.full(len(x), np.inf)
    multipliers = np.zeros((len(x), r))
    reached = np.zeros(len(x), dtype=bool)
    for _ in range(MOST_STEPS):
        if not len(todo):
            break
        y = x[todo]
        pull = model.parameters.torque(y)
        f, jac = model.constraints(y, rows)
        gram = jac @ jac.transpose(0, 2, 1)
        # least-squares multipliers by normal equations: next to singular states these fail, and so does Newton
        weights = _solve(gram, np.einsum("kij,kj->ki", jac, pull))
        stationarity = pull - np.einsum("kij,ki->kj", jac, weights)
        size = 1.0 + np.abs(pull).max(axis=1)
        residual[todo] = np.maximum(
            np.abs(stationarity).max(axis=1) / size, np.abs(f).max(axis=1, initial=0.0)
        )
        multipliers[todo] = weights[:, m:]
        system = np.zeros((len(todo), n + m + r, n + m + r))
        # Newton-KKT (Nocedal & Wright, 18.6): saddles and maxima attract it as minima do
        system[:, :n, :n] = model.lagrangian_hessian(y, weights, rows)
        system[:, :n, n:] = -jac.transpose(0, 2, 1)
        system[:, n:, :n] = jac
        step = _solve(system, -np.concatenate([stationarity, f], axis=1))[:, :n]
        length = np.linalg.norm(step, axis=1)
        good = np.isfinite(length)
        step[~good] = 0.0
        x[todo] += step * np.minimum(1.0, LONGEST_STEP / np.maximum(length, NONZERO))[:, None]
        for row in rows:
            row.hold(x)
        settled = good & (length <= model.parameters.step_noise) & (residual[todo] <= STATIONARY)
        reached[todo[settled]] = True
        inside = (np.abs(x[todo]) <= model.bound + 1.0).all(axis=1)
        todo = todo[good & ~settled & inside]
    return KktPoints(x[reached], multipliers[reached], residual[reached])


def _solve(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Solve many small systems; by pseudo-inverse where one of them is exactly singular."""
    try:
        return np.linalg.solve(a, b[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.einsum("kij,kj->ki", np.linalg.pinv(a, rcond=ROUNDED), b)
