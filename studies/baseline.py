"""The paper's own test of a symmetric candidate in the full space, written from appendix A alone.

Contact is ignored.  Around the candidate phi*, states are phi* + Z q + Y eta with Z, Y orthonormal bases of
the kernel and row space of the deformed crease matrix C (singular-value decomposition), and eta(q) solves
ax log F_N = 0 (paper, eq. fullspace-retraction).  Gradient and Hessian of U(q) come from centred differences;
the candidate is a strict minimum when |g| / (pi sum k) <= eps_g and the smallest eigenvalue of H exceeds
eps_lambda, at all three steps.

A yardstick for the exact verdicts of this package (`kkt.classify`, `minima.full_space`); it shares with them
nothing but the state's fold angles: rotation matrices instead of quaternions, no CasADi, no polish.
"""

from __future__ import annotations

import itertools
import math
import time
from dataclasses import dataclass
from typing import Literal

import numpy as np

from origami_nlp.pattern import Scene

STEPS = (3e-4, 1e-3, 3e-3)
"""Finite-difference steps h of the paper [rad]."""
EPS_GRADIENT = 5e-3
"""Largest |g| / (pi sum k) of a stationary candidate, as the paper states it."""
EPS_EIGENVALUE = 1e-6
"""Eigenvalues of H within this of zero are marginal [N m/rad]."""
CLOSURE = 1e-9
"""Residual of ax log F_N at which the retraction stops, and beyond which a state is refused."""
RANK = 1e-8
"""Singular values of C below this, relative to the largest, count as zero (the paper gives no number)."""
START = 1e-6
"""Largest ax log F_N of a candidate that counts as closed: published states carry seven digits."""

Verdict = Literal[
    "strict minimum", "saddle", "marginal", "not stationary", "singular", "not closed", "failed"
]


@dataclass(frozen=True)
class StepResult:
    """What one finite-difference step says.

    step: h [rad].  gradient: |g| / (pi sum k).  eigenvalues: of H, ascending [N m/rad].
    """

    step: float
    verdict: Verdict
    gradient: float
    eigenvalues: tuple[float, ...]


@dataclass(frozen=True)
class Baseline:
    """The paper's verdict on a candidate.

    verdict: common to all steps, else ``marginal`` (the paper keeps only verdicts that no step changes).
    robust: whether all steps agree.  steps: one result a step; empty where the test does not apply.
    seconds: the cost of the whole test.
    """

    verdict: Verdict
    robust: bool
    steps: tuple[StepResult, ...]
    seconds: float


def appendix_a(
    scene: Scene,
    fold_angles: np.ndarray,
    *,
    steps: tuple[float, ...] = STEPS,
    eps_gradient: float = EPS_GRADIENT,
) -> Baseline:
    """Run the paper's test on a state of `scene`.

    Parameters
    ----------
    fold_angles
        All N fold angles [rad].
    steps
        Finite-difference steps h [rad].
    eps_gradient
        Largest |g| / (pi sum k) of a stationary candidate.
    """
    begin = time.perf_counter()
    phi = np.asarray(fold_angles, dtype=float)
    _, residual = crease_matrix(scene, phi)
    if np.linalg.norm(residual) > START:
        return Baseline("not closed", True, (), time.perf_counter() - begin)
    restored = _restore(scene, phi)
    if restored is None:
        return Baseline("failed", True, (), time.perf_counter() - begin)
    phi = restored
    creases, _ = crease_matrix(scene, phi)
    _, s, vt = np.linalg.svd(creases)
    if s[2] <= RANK * s[0]:
        return Baseline("singular", True, (), time.perf_counter() - begin)
    normal, tangent = vt[:3].T, vt[3:].T
    results = tuple(_at_step(scene, phi, tangent, normal, h, eps_gradient) for h in steps)
    verdicts = {r.verdict for r in results}
    robust = len(verdicts) == 1
    verdict: Verdict = results[0].verdict if robust else "marginal"
    return Baseline(verdict, robust, results, time.perf_counter() - begin)


def crease_matrix(scene: Scene, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the deformed crease matrix C [3, N] and r = ax log F_N [3] (paper, eq. fullspace-retraction)."""
    f = np.eye(3)
    columns = []
    for b, angle in zip(scene.vertex.creases, phi, strict=True):
        columns.append(f @ b)
        f = f @ _rotation(b, angle)
    if not scene.vertex.flat:  # close the unrolled sheet
        f = f @ _rotation(np.array([0.0, 0.0, 1.0]), scene.vertex.excess)
    return np.stack(columns, axis=1), _axial_log(f)


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotate about a unit axis (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * (cross @ cross)


def _axial_log(f: np.ndarray) -> np.ndarray:
    """Return the rotation vector of a rotation matrix, |r| < pi."""
    axial = 0.5 * np.array([f[2, 1] - f[1, 2], f[0, 2] - f[2, 0], f[1, 0] - f[0, 1]])
    sine = float(np.linalg.norm(axial))
    angle = math.atan2(sine, 0.5 * (float(np.trace(f)) - 1.0))
    return axial * (angle / sine if sine > 1e-12 else 1.0)


def _restore(scene: Scene, phi: np.ndarray) -> np.ndarray | None:
    """Bring a state of printed accuracy onto closure along the row space of C."""
    for _ in range(8):
        creases, residual = crease_matrix(scene, phi)
        if np.linalg.norm(residual) <= CLOSURE:
            return phi
        phi = phi - np.linalg.lstsq(creases, residual, rcond=RANK)[0]
    return None


def _retract(
    scene: Scene, phi: np.ndarray, moved: np.ndarray, normal: np.ndarray
) -> np.ndarray | None:
    """Solve r(phi + moved + Y eta) = 0 for eta by Newton; d r / d eta = C Y to first order."""
    eta = np.zeros(3)
    for _ in range(30):
        state = phi + moved + normal @ eta
        creases, residual = crease_matrix(scene, state)
        if np.linalg.norm(residual) <= CLOSURE:
            return state
        try:
            eta = eta - np.linalg.solve(creases @ normal, residual)
        except np.linalg.LinAlgError:
            return None
    return None


def _at_step(
    scene: Scene,
    phi: np.ndarray,
    tangent: np.ndarray,
    normal: np.ndarray,
    h: float,
    eps_gradient: float,
) -> StepResult:
    """Evaluate g and H at q = 0 by centred differences and classify."""
    t = tangent.shape[1]

    def energy(q: np.ndarray) -> float:
        state = _retract(scene, phi, tangent @ q, normal)
        return math.nan if state is None else float(scene.energy(state))

    e = h * np.eye(t)
    middle = energy(np.zeros(t))
    up = np.array([energy(e[a]) for a in range(t)])
    down = np.array([energy(-e[a]) for a in range(t)])
    gradient = (up - down) / (2 * h)
    hessian = np.diag((up - 2 * middle + down) / h**2)
    for a, b in itertools.combinations(range(t), 2):
        mixed = (
            energy(e[a] + e[b]) - energy(e[a] - e[b]) - energy(e[b] - e[a]) + energy(-e[a] - e[b])
        )
        hessian[a, b] = hessian[b, a] = mixed / (4 * h**2)
    if not (np.isfinite(gradient).all() and np.isfinite(hessian).all()):
        return StepResult(h, "failed", math.nan, ())
    size = float(np.linalg.norm(gradient)) / (math.pi * sum(scene.stiffness))
    values = np.linalg.eigvalsh(hessian)
    if size > eps_gradient:
        verdict: Verdict = "not stationary"
    elif values[0] > EPS_EIGENVALUE:
        verdict = "strict minimum"
    elif values[0] < -EPS_EIGENVALUE:
        verdict = "saddle"
    else:
        verdict = "marginal"
    return StepResult(h, verdict, size, tuple(values.tolist()))
