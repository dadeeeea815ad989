"""Corners of the space of closed states with some of their creases let go."""

from __future__ import annotations

import numpy as np

from origami_nlp.starts.family import StartFamily
from origami_nlp.starts.samples import Samples


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
        closed = s.shut != 0
        # place of each closed crease in a random order; open ones (2.0) come last
        order = np.where(closed, rng.random(s.x.shape), 2.0).argsort(axis=1).argsort(axis=1)
        keep = (rng.random(many) * closed.sum(axis=1)).astype(int)
        return Samples.on(s.x, np.where(order < keep[:, None], s.shut, 0), hold=True)
