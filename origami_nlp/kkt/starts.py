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

from origami_nlp.programme import Model, broken_gap, crossed_pairs

BATCH = 64
"""Starts that are drawn and projected together."""


@dataclass(frozen=True)
class Start:
    """A starting state: fold angles x [n], and whether it satisfies every constraint."""

    x: np.ndarray
    feasible: bool


class StartStream:
    """An endless, seeded stream of starting states."""

    def __init__(self, model: Model, seed: int) -> None:
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
        if model.structure.limits and model.size > 1:
            for row in range(3, BATCH, 4):
                variable, value = next(self._faces)
                x[row, variable] = value
                frozen[row, variable] = True
        x, residual = project_batch(model, x, frozen)
        feasible = (residual <= 1e-9) & (np.abs(x) <= model.bound + 1e-12).all(axis=1)
        for k in np.flatnonzero(feasible):
            feasible[k] = model.on_sheet(x[k]) and gaps_hold(model, x[k])
        x = np.clip(x, -model.bound, model.bound)
        keep = feasible | frozen.any(axis=1)
        if keep.sum() < BATCH // 8:
            keep[:] = True
        return [Start(x[k].copy(), bool(feasible[k])) for k in np.flatnonzero(keep)[::-1]]


def project_batch(model: Model, x: np.ndarray, frozen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Project states [b, n] onto loop closure by Gauss-Newton, all at once, with some entries held.

    Returns the states and the largest entry of closure of each, [b].
    """
    closure = model.functions.closure.map(len(x))
    p = np.tile(model.parameters[:, None], (1, len(x)))
    residual = np.full(len(x), np.inf)
    for _ in range(25):
        g, jac = closure(x.T, p)
        g = np.asarray(g).T
        jac = np.asarray(jac).reshape(g.shape[1], len(x), -1).transpose(1, 0, 2)
        residual = np.abs(g).max(axis=1)
        if residual.max() <= 1e-12:
            break
        jac = np.where(frozen[:, None, :], 0.0, jac)
        step = -np.einsum("kij,kj->ki", np.linalg.pinv(jac, rcond=1e-6), g)
        length = np.linalg.norm(step, axis=1, keepdims=True)
        x = x + step * np.minimum(1.0, 1.0 / np.maximum(length, 1e-300))
    return x, residual


def gaps_hold(model: Model, x: np.ndarray, tolerance: float = 1e-9) -> bool:
    """Tell whether mirror and axis gaps are open and no modelled pair of facets crosses at x."""
    if not model.structure.gaps:
        return True
    if broken_gap(model, model.local(x).gaps, tolerance) is not None:
        return False
    return not crossed_pairs(model, x, tolerance)


MOST_FLAT_VARIABLES = 9
"""Flat foldings are listed for up to this many variables (3^9 = 19683 candidates)."""


def flat_foldings(model: Model) -> list[np.ndarray]:
    """Return every state of the model whose fold angles are 0 or +-pi and that closes on the sheet.

    Candidates only: layers are not ordered here.  Only the flat state without fold limits, or for too
    many variables.
    """
    n = model.size
    if not model.structure.limits or n > MOST_FLAT_VARIABLES:
        return [np.zeros(n)]
    x = math.pi * np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=n)))
    closure = model.functions.closure.map(len(x))
    g, _ = closure(x.T, np.tile(model.parameters[:, None], (1, len(x))))
    closed = np.abs(np.asarray(g)).max(axis=0) <= 1e-12
    return [state for state in x[closed] if model.on_sheet(state)]


def rest_state(model: Model) -> list[np.ndarray]:
    """Return the rest angles where they are a closed state of the model to rounding, else nothing.

    No state has less energy, however near a singular set it lies.  Beside one, what misses by d closes to d^2:
    the move that would close it decides, not the residual.
    """
    n = model.size
    x = model.parameters[-n:].copy()
    value, jacobian = model.closure(x)
    singular = np.linalg.svd(jacobian, compute_uv=False)
    move = np.linalg.norm(value) / max(float(singular.min()), 1e-300) if value.any() else 0.0
    flat = bool((np.abs(x) % math.pi == 0).all())  # flat foldings are exact, and listed as such
    return [x] if move <= 1e-14 and not flat and model.on_sheet(x) else []


def rigid_states(model: Model, seed: int) -> list[np.ndarray]:
    """Return isolated closed states of a model without freedom, other than flat foldings.

    Gauss-Newton from random fold angles; states next to a flat folding are the slow approach to it.
    """
    flat = flat_foldings(model)
    x = np.random.default_rng(seed).uniform(-math.pi, math.pi, (4 * BATCH, model.size))
    x, residual = project_batch(model, x, np.zeros_like(x, dtype=bool))
    found: list[np.ndarray] = []
    for state in x[(residual <= 1e-12) & (np.abs(x) <= model.bound).all(axis=1)]:
        known = [*flat, *found]
        if model.on_sheet(state) and all(np.abs(state - k).max() > 1e-3 for k in known):
            found.append(state)
    return found
