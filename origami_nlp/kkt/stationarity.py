"""How far a state is from stationary: the torque that no contact moment balances."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.kkt.state import State


def distance_from_stationary(state: State) -> float:
    """Return |grad U - J' lam - A' mu| / (pi sum k), smallest over lam and mu >= 0.

    The gradient is taken in the space of all N fold angles, as in the paper's appendix A; J is the Jacobian of loop
    closure, A holds the contacts that are closed to within the state's `tolerance` [rad].  Where touching facets can
    be kept apart in several ways, the best is taken: an upper bound on how stationary the state is.
    """
    p, z = state.programme, state.kernel
    best = math.inf
    for rows in state.pieces:
        piece = state.on(rows)
        mu = np.maximum(piece.multiplier_set.smallest, 0.0)
        left = z.T @ (state.gradient - piece.slopes.T @ mu)
        best = min(best, float(np.linalg.norm(left)))
    total = float(np.sum(p.parameters.stiffness))
    return best / (math.pi * total)
