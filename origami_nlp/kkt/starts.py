"""Starting states spread over the feasible set, the same for the same seed.

Uniform random fold angles are projected onto loop closure by Gauss-Newton, all at once; those that
leave the fold limits, the sheet or the contact set are kept only when too few feasible ones are
found.  Every fourth start lies on a fold limit, each limit in turn, so that sets that exist only at
phi = +-pi (the paper's 1-handles) are searched as well.  States whose fold angles are all 0 or +-pi
may be isolated points that no descent can find: `flat_foldings` lists them all.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt.projection import project
from origami_nlp.numerics import BESIDE, CLOSES, ROUNDED
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


def rest_state(model: Programme) -> list[np.ndarray]:
    """Return the rest angles where they are a closed state of the model to rounding, else nothing.

    No state has less energy, however near a singular set it lies.  Beside one, what misses by d closes to d^2:
    the move that would close it decides, not the residual.  Under forces in space they are nothing special.
    """
    if model.parameters.dead is not None:
        return []
    x = model.parameters.rest.copy()
    value, jacobian = model.closure(x)
    singular = np.linalg.svd(jacobian, compute_uv=False)
    move = np.linalg.norm(value) / max(float(singular.min()), 1e-300) if value.any() else 0.0
    flat = bool((np.abs(x) % math.pi == 0).all())  # flat foldings are exact, and listed as such
    return [x] if move <= ROUNDED and not flat and model.on_sheet(x) else []


def rigid_states(model: Programme, seed: int) -> list[np.ndarray]:
    """Return isolated closed states of a model without freedom, other than flat foldings.

    Gauss-Newton from random fold angles; states next to a flat folding are the slow approach to it.
    """
    flat = flat_foldings(model)
    x = np.random.default_rng(seed).uniform(-math.pi, math.pi, (4 * BATCH, model.size))
    x, residual = project(model, x)
    found: list[np.ndarray] = []
    for state in x[(residual <= CLOSES) & (np.abs(x) <= model.bound).all(axis=1)]:
        known = [*flat, *found]
        if model.on_sheet(state) and all(np.abs(state - k).max() > BESIDE for k in known):
            found.append(state)
    return found
