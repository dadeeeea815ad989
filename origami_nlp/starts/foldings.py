"""Flat foldings: states whose fold angles are all 0 or +-pi, which may be isolated points that no descent finds."""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.numerics import CLOSES
from origami_nlp.programme import Programme
from origami_nlp.starts.family import Listed

MOST_FLAT_VARIABLES = 9
"""Flat foldings are listed for up to this many variables (3^9 = 19683 candidates)."""


def flat_foldings(model: Programme) -> list[np.ndarray]:
    """Return every state of the model whose fold angles are 0 or +-pi and that closes on the sheet.

    Candidates only: layers are not ordered here.  Only the flat state without fold limits, or for too
    many variables.
    """
    n = model.size
    few = model.has_limits and n <= MOST_FLAT_VARIABLES
    places = itertools.product((-1.0, 0.0, 1.0), repeat=n) if few else [(0.0,) * n]
    x = math.pi * np.array(list(places))
    closed = np.abs(model.closure(x)[0]).max(axis=1) <= CLOSES
    return [state for state in x[closed] if model.on_sheet(state)]


class FlatFoldings(Listed):
    """Every flat folding of a model (`flat_foldings`).

    Parameters
    ----------
    model
        Of any scene.
    """

    name = "flat foldings"
    sentence = "every fold angle 0 or +-pi"

    def __init__(self, model: Programme) -> None:
        self.size = model.size
        self._model = model

    def states(self) -> list[np.ndarray]:
        """List them."""
        return flat_foldings(self._model)
