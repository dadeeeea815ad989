"""Moments added to the creases, and how a state with its contacts held responds to them.

In the metric of all N fold angles a state is y = sqrt(multiplicity) x for the model's variables x, and a load f
[n] adds -f . y to the (scaled) energy: |f| is the 2-norm of the moments over all N creases.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import null_space
from origami_nlp.programme import Model, Row, gap_weights, row_values


@dataclass(frozen=True)
class Sensitivity:
    """First-order behaviour of a pinned state, in the metric of all N fold angles and scaled energy.

    multipliers: of the rows, [r].  response: D = d multipliers / d load, [r, n].
    motion: d state / d load, [n, n].  stiffness: smallest eigenvalue of the Hessian on the contact-preserving
    space, inf if that is a point.
    """

    multipliers: np.ndarray
    response: np.ndarray
    motion: np.ndarray
    stiffness: float


def loaded_model(model: Model, load: np.ndarray) -> Model:
    """Return the model with energy U - m . phi, for `load` [n] in the metric of all N fold angles, scaled.

    The load moves the rest angles by m_i / k_i, so energies of the two models differ by a constant.
    """
    n = model.size
    loaded = copy.copy(model)
    loaded.parameters = model.parameters.copy()
    loaded.parameters[-n:] += np.sqrt(model.multiplicity) * load / model.parameters[-2 * n : -n]
    return loaded


def moments_of(model: Model, load: np.ndarray) -> np.ndarray:
    """Return the moment [N m] on each of the N creases of a load in the metric, [n] -> [N]."""
    return model.expand(model.scale * load / np.sqrt(model.multiplicity))


def sensitivity(model: Model, x: np.ndarray, rows: tuple[Row, ...]) -> Sensitivity:
    """Differentiate the KKT system of the state x [n] with `rows` held (independent gradients)."""
    root = np.sqrt(model.multiplicity)
    local = model.local(x)
    _, a = row_values(model, x, rows, local.gaps, local.gaps_jacobian)
    jac = np.vstack([local.closure_jacobian, a]) / root
    multipliers = np.linalg.lstsq(jac.T, local.gradient / root, rcond=None)[0]
    m, n = len(local.closure), model.size
    hessian = model.hessian(x, -multipliers[:m], -gap_weights(model, rows, multipliers[m:]))
    hessian = hessian / np.outer(root, root)
    count = len(jac)
    system = np.block([[hessian, -jac.T], [jac, np.zeros((count, count))]])
    right = np.vstack([np.eye(n), np.zeros((count, n))])
    solution = np.linalg.lstsq(system, right, rcond=1e-14)[0]
    z = null_space(jac)
    least = float(np.linalg.eigvalsh(z.T @ hessian @ z)[0]) if z.shape[1] else math.inf
    return Sensitivity(multipliers[m:], solution[n + m :], solution[:n], least)
