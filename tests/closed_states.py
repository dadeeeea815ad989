"""Random closed states of a model, some with a crease at its fold limit, the same for the same generator."""

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import CLOSURE_TOL


def closed_states(model, rng, count, *, at_limits=True):
    """Return closed states within the fold limits on the lift of paper, [count, n]."""
    found = []
    while len(found) < count:
        x = rng.uniform(-np.pi, np.pi, (64, model.size))
        frozen = np.zeros(x.shape, bool)
        for row in range(0, 64 * at_limits, 2):
            held = rng.permutation(model.size)[: rng.integers(1, 2 + max(model.dof - 1, 0))]
            x[row, held], frozen[row, held] = rng.choice([-np.pi, np.pi], len(held)), True
        x, residual = project(model, x, frozen=frozen)
        good = (residual <= CLOSURE_TOL) & model.fold_limits.inside(x).all(axis=1)
        found += [state for state in x[good] if model.lifts_to_one(state)]
    return np.array(found[:count])
