"""Springs that hold a vertex in given states: stationary and stable in each, by a few linear programs.

At a state x springs k and rest angles r balance if k (x - r) = J' lam for some lam, J the Jacobian of loop closure.
With two states that leaves k = (J1' lam1 - J2' lam2) / (x1 - x2), r = x1 - J1' lam1 / k: everything is linear in the
six numbers lam, also the reduced Hessians M = Z' (diag k - sum lam_j Hess v_j) Z, up to the division in r.  The
smallest eigenvalue of the M, a concave function of lam, is made largest by cutting planes.
"""

from __future__ import annotations

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import CLOSURE_TOL, null_space
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model

SOFTEST = 0.05
"""Least stiffness of a spring over the mean of all."""
MOST_CUTS = 60
INTERIOR = 2.8
"""Fold angles [rad] of states that springs are designed for are smaller."""
APART = 0.05
"""The two states differ by more in every fold angle [rad]: the stiffness is a quotient by the difference."""
FARTHEST_REST = 3.0
"""Rest angles [rad] are no larger."""


def interior_states(scene: Scene, rng: np.random.Generator, count: int = 2) -> list[np.ndarray]:
    """Draw closed, admissible states [N] of a scene without symmetry, away from fold limits and each other."""
    model, found = Model(scene), list[np.ndarray]()
    while len(found) < count:
        x, residual = project(model, rng.uniform(-INTERIOR, INTERIOR, model.size))
        inside = residual <= CLOSURE_TOL and np.abs(x).max() <= INTERIOR and not model.refuses(x)
        if inside and all(np.abs(x - y).min() > APART for y in found):
            found.append(x)
    return found


def design(scene: Scene, states: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray] | None:
    """Choose stiffness [N] (mean 1) and rest angles [N] for which two states are strict minima, or None.

    Parameters
    ----------
    scene
        Vertex and contact, no symmetry; its springs do not matter.
    states
        Two closed states [N] that no contact closes [rad].
    """
    from scipy.optimize import linprog

    model, n, m = Model(scene), scene.degree, 3
    jacobians = [model.closure(x)[1] for x in states]
    pull = np.hstack([jacobians[0].T, np.zeros((n, m))])  # J1' lam1, as a matrix on lam [n, 6]
    k = np.hstack([jacobians[0].T, -jacobians[1].T]) / (states[0] - states[1])[:, None]
    forms = [
        _reduced(model, x, j, k, s) for s, (x, j) in enumerate(zip(states, jacobians, strict=True))
    ]
    # rows @ (lam, t) <= 0: springs not too soft, rest angles within +-pi
    arm = states[0][:, None] * k - pull
    free = np.zeros((n, 1))
    rows = [
        np.hstack([SOFTEST * k.mean(axis=0) - k, free]),
        np.hstack([arm - FARTHEST_REST * k, free]),
        np.hstack([-arm - FARTHEST_REST * k, free]),
    ]
    unit = np.append(k.sum(axis=0), 0.0)[None]
    rows += [_cuts(form, np.eye(form.shape[1])) for form in forms]
    for _ in range(MOST_CUTS):
        out = linprog(
            np.eye(2 * m + 1)[-1] * -1,
            np.vstack(rows),
            np.zeros(sum(len(r) for r in rows)),
            unit,
            [n],
            bounds=[(None, None)] * (2 * m) + [(None, 1.0)],
        )
        if out.status != 0 or out.x[-1] <= SOFTEST * SOFTEST:
            return None
        lam, aim = out.x[:-1], out.x[-1]
        spectra = [np.linalg.eigh(np.tensordot(lam, form, 1)) for form in forms]
        if min(values[0] for values, _ in spectra) >= aim / 2:
            return k @ lam, (arm @ lam) / (k @ lam)
        rows += [
            _cuts(form, vectors[:, values < aim])
            for form, (values, vectors) in zip(forms, spectra, strict=True)
        ]
    return None


def _reduced(
    model: Model, x: np.ndarray, jacobian: np.ndarray, k: np.ndarray, state: int
) -> np.ndarray:
    """Return the reduced Hessian at a state as a linear form of lam, [6, t, t]."""
    z, m = null_space(jacobian), len(jacobian)
    none = np.zeros(len(model.structure.gaps))
    out = [z.T @ (column[:, None] * z) for column in k.T]
    for j, unit in enumerate(np.eye(m)):
        out[state * m + j] = out[state * m + j] - z.T @ model.hessian(x, unit, none, 0.0) @ z
    return np.array(out)


def _cuts(form: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return the rows of t <= v' M(lam) v for the columns v [t, c]."""
    values = np.einsum("ic,aij,jc->ca", vectors, form, vectors)
    return np.hstack([-values, np.ones((len(values), 1))])
