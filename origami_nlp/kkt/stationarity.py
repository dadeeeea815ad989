"""How far a state is from stationary: the torque that no contact moment balances."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.kkt.multipliers import find_multipliers
from origami_nlp.numerics import null_space
from origami_nlp.programme import Model, closed_contacts, row_values


def distance_from_stationary(model: Model, x: np.ndarray, closed: float = 1e-7) -> float:
    """Return |grad U - J' lam - A' mu| / (pi sum k), smallest over lam and mu >= 0.

    The gradient is taken in the space of all N fold angles, as in the paper's appendix A; J is the Jacobian of loop
    closure, A holds the contacts that are closed to within `closed` [rad].  Where touching facets can be kept
    apart in several ways, the best is taken: an upper bound on how stationary the state is.
    """
    root = np.sqrt(model.multiplicity)
    local = model.local(x)
    z = null_space(local.closure_jacobian / root)
    cost = z.T @ (local.gradient / root)
    contacts = closed_contacts(model, x, local.gaps, closed)
    best = math.inf
    for rows in contacts.combinations() or [contacts.base]:
        _, a = row_values(model, x, rows, local.gaps, local.gaps_jacobian)
        b = (a / root @ z).T
        mu = np.maximum(find_multipliers(b, cost).smallest, 0.0)
        best = min(best, float(np.linalg.norm(cost - b @ mu)))
    total = float(np.sum(model.scene.stiffness))
    return best * model.scale / (math.pi * total)
