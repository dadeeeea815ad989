"""The rest state, where it closes."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.numerics import NONZERO, ROUNDED
from origami_nlp.programme import Programme
from origami_nlp.starts.family import Listed


class RestState(Listed):
    """The rest angles where they are a closed state of the model to rounding.

    No state has less energy, however near a singular set it lies.  Beside one, what misses by d closes to d^2:
    the move that would close it decides, not the residual.  Under forces in space they are nothing special.

    Parameters
    ----------
    model
        Of any scene.
    """

    name = "the rest state"
    sentence = "the rest angles, where they close"

    def __init__(self, model: Programme) -> None:
        self.size = model.size
        self._model = model

    def states(self) -> list[np.ndarray]:
        """Return it, or nothing."""
        model = self._model
        if model.parameters.dead is not None:
            return []
        x = model.parameters.rest.copy()
        value, jacobian = model.closure(x)
        singular = np.linalg.svd(jacobian, compute_uv=False)
        move = np.linalg.norm(value) / max(float(singular.min()), NONZERO) if value.any() else 0.0
        flat = bool((np.abs(x) % math.pi == 0).all())  # flat foldings are exact, and listed as such
        return [x] if move <= ROUNDED and not flat and model.on_sheet(x) else []
