"""Starting states spread over the feasible set, the same for the same seed.

Uniform random fold angles are projected onto loop closure by Gauss-Newton, all at once; those that
leave the fold limits, the sheet or the contact set are kept only when too few feasible ones are
found.  Every fourth start lies on a fold limit, each limit in turn, so that sets that exist only at
phi = +-pi (the paper's 1-handles) are searched as well.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import CLOSES
from origami_nlp.programme import Programme

BATCH = 64
"""Starts that are drawn and projected together."""


@dataclass(frozen=True)
class Start:
    """A starting state: fold angles x [n], and whether it satisfies every constraint."""

    x: np.ndarray
    feasible: bool


class StartStream:
    """An endless, seeded stream of starting states."""

    def __init__(self, model: Programme, seed: int) -> None:
        self._model = model
        self._rng = np.random.default_rng(seed)
        self._buffer: list[Start] = []
        self._faces = itertools.cycle(
            [(v, side) for v in range(model.size) for side in (-math.pi, math.pi)]
        )

    def __iter__(self) -> StartStream:
        return self

    def __next__(self) -> Start:
        if not self._buffer:
            self._buffer = self._draw()
        return self._buffer.pop()

    def _draw(self) -> list[Start]:
        """Draw a batch: feasible starts where there are enough, else the others too."""
        model, rng = self._model, self._rng
        x = rng.uniform(-math.pi, math.pi, (BATCH, model.size))
        frozen = np.zeros_like(x, dtype=bool)
        if model.has_limits and model.size > 1:
            # the chance that a uniform start lies at phi = +-pi is 0, and sets exist only there
            for row in range(3, BATCH, 4):
                variable, value = next(self._faces)
                x[row, variable] = value
                frozen[row, variable] = True
        x, residual = project(model, x, frozen=frozen)
        feasible = residual <= CLOSES
        feasible[feasible] = model.admissible(x[feasible])
        x = np.clip(x, -model.bound, model.bound)
        keep = feasible | frozen.any(axis=1)
        if keep.sum() < BATCH // 8:
            keep[:] = True
        return [Start(x[k].copy(), bool(feasible[k])) for k in np.flatnonzero(keep)[::-1]]
