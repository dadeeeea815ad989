"""Springs by a penalty method: squares of torques that are out of balance, and of stability that is missing.

The usual way to design springs for given states: stiffness (its logarithm) and rest angles are unknowns within their
bounds, everything else becomes a square in the cost.  It can find springs; that it finds none proves nothing.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares, minimize

from origami_nlp.inverse_design import ConvexDesign, Targets
from origami_nlp.kkt import State, classify, newton
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model

WEIGHT = 10.0
"""Of what is missing of the stability, beside torques [per rad]; both over the mean stiffness."""
STABLE = 0.05
"""Stability that is asked for: smallest eigenvalue of the reduced Hessian over the mean stiffness."""
STARTS = 3
NEAR = 0.01
"""A minimum this near to each target [rad] is a success."""
MOST_STEPS = 2000


@dataclass(frozen=True)
class Tried:
    """What a penalty method made of a question.

    Attributes
    ----------
    found
        Whether its springs have minima within 0.01 rad of all states.
    seconds
        Processor time, of the starts up to the first that did, or of all.
    worst
        Largest distance of such a minimum from its target [rad]; inf without.
    """

    found: bool
    seconds: float
    worst: float


class Cost:
    """Residuals of a question of interior states, and their Jacobian, over (log stiffness, rest angles) [2 N]."""

    def __init__(self, targets: Targets) -> None:
        self.targets = targets
        self.states = [balance for _, balance, _ in ConvexDesign(targets).balances]
        low, high = np.log(targets.stiffness)
        n = targets.blank.degree
        least, most = targets.rest
        self.low = np.repeat([low, least], n)
        self.high = np.repeat([high, most], n)

    def residuals(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what is out of balance and what is missing of the stability, [r], and its derivatives, [r, 2 N]."""
        k, rest = np.exp(p[: len(p) // 2]), p[len(p) // 2 :]
        mean = k.mean()
        values, slopes = [], []
        for b in self.states:
            x = b.stratum.state.x
            torque = k * (x - rest) / mean
            d_torque = np.hstack([np.diag(torque), np.diag(-k / mean)])
            d_torque[:, : len(k)] -= np.outer(torque, k / k.sum())
            values.append(b.kernel.T @ torque)
            slopes.append(b.kernel.T @ d_torque)
            d_lam = b.to_closure @ d_torque
            bent = np.diag(k / mean) - np.tensordot(b.to_closure @ torque, b.curvatures, 1)
            own, vectors = np.linalg.eigh(b.tangent.T @ bent @ b.tangent)
            low = own < STABLE
            v = b.tangent @ vectors[:, low]
            d_k = np.diag(k / mean) - np.outer(k / mean, k / k.sum())
            change = v.T**2 @ d_k
            change = np.hstack([change, np.zeros_like(change)])
            change -= np.einsum("ia,kij,ja,kp->ap", v, b.curvatures, v, d_lam)
            missing, d_missing = np.zeros(len(own)), np.zeros((len(own), len(p)))
            missing[low], d_missing[low] = WEIGHT * (STABLE - own[low]), -WEIGHT * change
            values.append(missing)
            slopes.append(d_missing)
        return np.concatenate(values), np.vstack(slopes)

    def square(self, p: np.ndarray) -> tuple[float, np.ndarray]:
        """Return half the sum of squares, and its gradient."""
        r, j = self.residuals(p)
        return 0.5 * float(r @ r), j.T @ r


def by_penalties(targets: Targets, method: str, seed: int = 0) -> Tried:
    """Look for springs from a few random ones.

    Parameters
    ----------
    targets
        Interior states, no symmetry.
    method
        ``"L-BFGS"`` on the sum of squares, or ``"Gauss-Newton"`` (SciPy's trust-region reflective).
    seed
        Of the starts.

    Returns
    -------
    Tried
    """
    start = time.process_time()
    cost, rng = Cost(targets), np.random.default_rng(seed)
    best = np.inf
    for _ in range(STARTS):
        p = rng.uniform(cost.low, cost.high)
        if method == "L-BFGS":
            found = minimize(
                cost.square,
                p,
                jac=True,
                method="L-BFGS-B",
                bounds=np.transpose([cost.low, cost.high]),
                options={
                    "maxiter": MOST_STEPS,
                    "maxfun": 2 * MOST_STEPS,
                    "ftol": 0.0,
                    "gtol": 1e-9,
                },
            ).x
        else:
            found = least_squares(
                lambda p: cost.residuals(p)[0],
                p,
                jac=lambda p: cost.residuals(p)[1],
                bounds=(cost.low, cost.high),
                max_nfev=MOST_STEPS // 10,
                xtol=1e-12,
                ftol=1e-12,
                gtol=1e-12,
            ).x
        best = min(best, distance(targets, _scene(targets, found)))
        if best <= NEAR:
            break
    return Tried(best <= NEAR, time.process_time() - start, best)


def _scene(targets: Targets, p: np.ndarray) -> Scene:
    k, rest = np.exp(p[: len(p) // 2]), p[len(p) // 2 :]
    inside = np.clip(rest, -np.pi, np.pi)
    return Scene(
        targets.blank.vertex,
        tuple(k),
        tuple(inside),
        symmetry="none",
        contact=targets.contact,
        preload=tuple(k * (rest - inside)) if np.any(rest != inside) else (),
    )


def distance(targets: Targets, scene: Scene) -> float:
    """Return the largest distance of a target from the minimum that Newton reaches from it [rad]; inf without."""
    model, out = Model(scene), 0.0
    for placed in targets.placed:
        x = placed.state.x
        state, _ = newton(model, x, ())
        if state is None or not state.converged:
            return np.inf
        if classify(State(model, state.x)).verdict != "minimum":
            return np.inf
        out = max(out, float(np.abs(state.x - x).max()))
    return out
