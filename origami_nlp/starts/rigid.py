"""Isolated states of a model that cannot move."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import BESIDE, CLOSES
from origami_nlp.programme import Programme
from origami_nlp.starts.family import Listed
from origami_nlp.starts.foldings import flat_foldings
from origami_nlp.starts.projected import BATCH


class RigidStates(Listed):
    """Isolated closed states of a model without freedom, other than flat foldings.

    Gauss-Newton from random fold angles; states next to a flat folding are the slow approach to it.

    Parameters
    ----------
    model
        Without freedom.
    seed
        Of the fold angles.
    """

    name = "states that cannot move"
    sentence = "isolated states of what has no freedom"

    def __init__(self, model: Programme, seed: int) -> None:
        self.size = model.size
        self._model, self._seed = model, seed

    def states(self) -> list[np.ndarray]:
        """Return those that are reached."""
        model = self._model
        flat = flat_foldings(model)
        x = np.random.default_rng(self._seed).uniform(-math.pi, math.pi, (4 * BATCH, model.size))
        x, residual = project(model, x)
        found: list[np.ndarray] = []
        for state in x[(residual <= CLOSES) & (np.abs(x) <= model.bound).all(axis=1)]:
            known = [*flat, *found]
            if model.on_sheet(state) and all(np.abs(state - k).max() > BESIDE for k in known):
                found.append(state)
        return found
