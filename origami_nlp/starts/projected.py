"""Starting states spread over the feasible set, the same for the same seed.

Uniform random fold angles are projected onto loop closure by Gauss-Newton, all at once; those that
leave the fold limits, the lift q = +1 or the contact set are kept only when too few feasible ones are
found.  Every fourth start lies on a fold limit, each limit in turn, so that sets that exist only at
phi = +-pi (the paper's 1-handles) are searched as well.

`states_on_limits` are states with one or two creases at their fold limits: beside sets that exist only while these stay
closed.  A solver that needs an interior rarely ends on such a thin set (the paper's 1-handles), so they are looked for
on purpose; `kkt.lower_dimensional_at` decides which they are.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.starts.batch_states import Samples
from origami_nlp.starts.family import StartFamily

BATCH = 64
"""Starts that are drawn and projected together."""


@dataclass(frozen=True)
class Start:
    """A starting state: fold angles x [n], and whether it satisfies every constraint."""

    x: np.ndarray
    feasible: bool


class Projected(StartFamily):
    """Random fold angles projected onto closure.

    Parameters
    ----------
    model
        Of any scene.
    """

    name = "interior"
    sentence = "random fold angles, projected onto closure"

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Return the first of `starts`."""
        return Samples.on(np.array([start.x for start in itertools.islice(self.starts(rng), many)]))

    def starts(self, rng: np.random.Generator) -> Iterator[Start]:
        """Yield starts without end."""
        size = self._model.size
        ends = self._model.fold_limits.low, self._model.fold_limits.high
        faces = itertools.cycle([(v, float(end[v])) for v in range(size) for end in ends])
        while True:
            yield from self._batch(rng, faces)

    def _batch(self, rng: np.random.Generator, faces: Iterator[tuple[int, float]]) -> list[Start]:
        """Draw a batch: feasible starts where there are enough, else the others too."""
        model = self._model
        limits = model.fold_limits
        share = 1.0 if model.has_limits else 0.5  # without limits within +-pi
        x = rng.uniform(share * limits.low, share * limits.high, (BATCH, model.size))
        frozen = np.zeros_like(x, dtype=bool)
        if model.has_limits and model.size > 1:
            # the chance that a uniform start lies at phi = +-pi is 0, and sets exist only there
            for row in range(3, BATCH, 4):
                variable, value = next(faces)
                x[row, variable] = value
                frozen[row, variable] = True
        x, residual = project(model, x, frozen=frozen)
        feasible = residual <= CLOSURE_TOL
        feasible[feasible] = model.admissible(x[feasible])
        x = limits.clip(x)
        keep = feasible | frozen.any(axis=1)
        if keep.sum() < BATCH // 8:
            keep[:] = True
        return [Start(x[k].copy(), bool(feasible[k])) for k in np.flatnonzero(keep)]
