"""Starts that are listed: flat foldings and rigid states, isolated points that no descent may find."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import CLOSURE_TOL, NEAR_SINGULAR_TOL
from origami_nlp.problem import CreaseChain, Model
from origami_nlp.starts.family import Listed

MOST_FLAT_VARIABLES = 9
"""Flat foldings are listed for up to this many variables (3^9 = 19683 candidates)."""
DRAWS = 256
"""States that are closed to find those that cannot move."""


def flat_foldings(model: Model) -> list[np.ndarray]:
    """Return every state of the model whose fold angles are 0 or +-pi and that closes with q = +1.

    Candidates only: layers are not ordered here.  Only the flat state without fold limits, or for too
    many variables.
    """
    n = model.size
    few = model.has_limits and n <= MOST_FLAT_VARIABLES
    x = math.pi * (np.indices((3,) * n).reshape(n, -1).T - 1.0) if few else np.zeros((1, n))
    chain = CreaseChain(model)
    if chain.kind == "C" and few:
        # a turn by -pi is that by pi with the opposite sign: so many are folded, and carried over
        _, q = chain.fold(math.pi * np.indices((2,) * n).reshape(n, -1).T)
        which = (x != 0) @ 2 ** np.arange(n)[::-1]
        off = chain.misses_of(q[:, which] * (-1.0) ** (x < 0).sum(axis=1))
    else:
        off = chain.misses(x)
    closed = off <= CLOSURE_TOL
    closed &= model.fold_limits.inside(x).all(axis=1)
    return [state for state in x[closed] if model.lifts_to_one(state)]


class FlatFoldings(Listed):
    """Every flat folding of a model (`flat_foldings`).

    Parameters
    ----------
    model
        Of any scene.
    """

    name = "flat foldings"
    sentence = "every fold angle 0 or +-pi"

    def states(self) -> list[np.ndarray]:
        """List them."""
        return flat_foldings(self._model)


class RigidStates(Listed):
    """Isolated closed states of a model without degrees of freedom, other than flat foldings.

    Gauss-Newton from random fold angles; states next to a flat folding are the slow approach to it.

    Parameters
    ----------
    model
        Without degrees of freedom.
    seed
        Of the fold angles.
    """

    name = "states that cannot move"
    sentence = "isolated states of models without degrees of freedom"

    def __init__(self, model: Model, seed: int) -> None:
        super().__init__(model)
        self._seed = seed

    def states(self) -> list[np.ndarray]:
        """Return those that are reached."""
        model = self._model
        flat = flat_foldings(model)
        x = np.random.default_rng(self._seed).uniform(-math.pi, math.pi, (DRAWS, model.size))
        x, residual = project(model, x)
        found: list[np.ndarray] = []
        for state in x[(residual <= CLOSURE_TOL) & model.fold_limits.inside(x).all(axis=1)]:
            known = [*flat, *found]
            if model.lifts_to_one(state) and all(
                np.abs(state - k).max() > NEAR_SINGULAR_TOL for k in known
            ):
                found.append(state)
        return found
