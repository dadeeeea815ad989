"""States with random creases at their fold limits, from the interior to all that leave a freedom."""

from __future__ import annotations

import numpy as np

from origami_nlp.programme import Model, random_strata
from origami_nlp.starts.family import StartFamily
from origami_nlp.starts.samples import Samples


class Strata(StartFamily):
    """Closed states with random creases at their fold limits, held there until the descent has converged.

    Parameters
    ----------
    model
        With fold limits.
    """

    name = "strata"
    sentence = "with random creases at their fold limits"

    def __init__(self, model: Model) -> None:
        self._model = model

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Draw as many of each number of closed creases; fewer in all where closed states are rare."""
        return Samples.at_limits(random_strata(self._model, rng, many), hold=True)


class Interior(StartFamily):
    """Closed states with no crease at its fold limit.

    Parameters
    ----------
    model
        Of any scene.
    """

    name = "interior"
    sentence = "with nothing closed"

    def __init__(self, model: Model) -> None:
        self._model = model

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Draw fold angles uniformly, but those that close the vertex; fewer where closed states are rare."""
        return Samples.on(random_strata(self._model, rng, many, 0))
