"""Random fold angles of a pattern, not closed, with and without creases that are shut."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.facets import Labels
from origami_nlp.starts.family import StartFamily
from origami_nlp.starts.samples import Samples


class Uniform(StartFamily):
    """Fold angles up to a random size, whatever closes.

    Parameters
    ----------
    labels
        Of the pattern: fold angles are drawn in their order.
    """

    name = "uniform"
    sentence = "any fold angles"

    def __init__(self, labels: Labels) -> None:
        self._labels = labels

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Draw states one after the other."""
        x = [self._labels.drawn(self._angles(rng)) for _ in range(many)]
        return Samples.at_limits(np.array(x).reshape(many, -1))

    def _angles(self, rng: np.random.Generator) -> np.ndarray:
        size = rng.uniform(0.3, math.pi)
        return rng.uniform(-size, size, len(self._labels.order))


class UniformShut(Uniform):
    """The same with up to half of the creases shut, which is kept as long as their springs push."""

    name = "uniform, some shut"
    sentence = "any fold angles, some creases shut"

    def _angles(self, rng: np.random.Generator) -> np.ndarray:
        angles = super()._angles(rng)
        n = len(angles)
        shut = rng.permutation(n)[: int(rng.integers(1, max(2, n // 2)))]
        angles[shut] = rng.choice([-math.pi, math.pi], len(shut))
        return angles
