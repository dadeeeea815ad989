"""Corners of the space of closed states: creases at their fold limits that leave the others no freedom."""

from __future__ import annotations

import numpy as np

from origami_nlp.programme import Model, vertices
from origami_nlp.starts.family import StartFamily
from origami_nlp.starts.samples import Samples


class Corners(StartFamily):
    """Closed states whose creases at their fold limits leave the others no freedom.

    Parameters
    ----------
    model
        Of any scene; without fold limits there are none.
    """

    name = "corners"
    sentence = "where fold limits leave no freedom"

    def __init__(self, model: Model) -> None:
        self._model = model

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Return all corners of up to `many` candidates, of a sample of these beyond (`programme.vertices`)."""
        return Samples.at_limits(vertices(self._model, many, rng))
