"""Closed states of a vertex by their creases at fold limits: corners, strata between them, the interior."""

from __future__ import annotations

import numpy as np

from origami_nlp.problem import random_strata, vertices
from origami_nlp.starts.batch_states import Samples
from origami_nlp.starts.family import StartFamily


class Corners(StartFamily):
    """Closed states whose creases at their fold limits leave the others no degree of freedom.

    Parameters
    ----------
    model
        Of any scene; without fold limits there are none.
    """

    name = "corners"
    sentence = "where fold limits leave no degree of freedom"

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Return all corners of up to `many` candidates, of a sample of these beyond (`problem.vertices`)."""
        return Samples.at_limits(vertices(self._model, many, rng), self._model.fold_limits)


class NearCorners(StartFamily):
    """Corners that hold a random subset of their closed creases.

    Parameters
    ----------
    corners
        Of `Corners`.
    """

    name = "near corners"
    sentence = "corners with some of their creases let go"

    def __init__(self, corners: Samples) -> None:
        self._corners = corners

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Draw corners, and of each how many of its creases it holds, fewer than all, and which."""
        s = self._corners[rng.integers(len(self._corners), size=many)]
        closed = s.at_limit != 0
        # place of each closed crease in a random order; open ones (2.0) come last
        order = np.where(closed, rng.random(s.x.shape), 2.0).argsort(axis=1).argsort(axis=1)
        keep = (rng.random(many) * closed.sum(axis=1)).astype(int)
        return Samples.on(s.x, np.where(order < keep[:, None], s.at_limit, 0), hold=True)


class Strata(StartFamily):
    """Closed states with random creases at their fold limits, held there until the descent has converged.

    Parameters
    ----------
    model
        With fold limits.
    """

    name = "strata"
    sentence = "with random creases at their fold limits"

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Draw as many of each number of closed creases; fewer in all where closed states are rare."""
        x = random_strata(self._model, rng, many)
        return Samples.at_limits(x, self._model.fold_limits, hold=True)


class Interior(StartFamily):
    """Closed states with no crease at its fold limit.

    Parameters
    ----------
    model
        Of any scene.
    """

    name = "interior"
    sentence = "with nothing closed"

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Draw fold angles uniformly, but those that close the vertex; fewer where closed states are rare."""
        return Samples.on(random_strata(self._model, rng, many, 0))
