"""Flat foldings: isolated points that no descent may find."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.folding import fold_vertex
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.problem import Model
from origami_nlp.starts.family import Listed

MOST_FLAT_VARIABLES = 9
"""Flat foldings are listed for up to this many variables (3^9 = 19683 candidates)."""


def flat_foldings(model: Model) -> list[np.ndarray]:
    """Return every state of the model whose fold angles are 0 or +-pi and that closes with q = +1.

    Candidates only: layers are not ordered here.  Only the flat state without fold limits, or for too
    many variables.
    """
    n = model.size
    few = model.has_limits and n <= MOST_FLAT_VARIABLES
    x = math.pi * (np.indices((3,) * n).reshape(n, -1).T - 1.0) if few else np.zeros((1, n))
    x = x[model.fold_limits.inside(x).all(axis=1)]
    _, q = fold_vertex(model.scene.vertex, model.expand(x))
    closed = (np.abs(q[:, 1:]).max(axis=1, initial=0.0) <= CLOSURE_TOL) & (q[:, 0] > 0)
    # those of the winding of the model
    return [state for state in x[closed] if np.abs(model.closure(state)[0]).max() <= CLOSURE_TOL]


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
