"""Minima beside flat foldings with facets on each other, to second order: as `near_flat`, with contacts held.

Where a sheet is folded in half, closure loses a rank as at the flat state, and closed states leave along a cone
y'Fy = 0 in the kernel of closure, as far as fold limits and facets that touch let them: A y >= 0.  A minimum of the
springs beside the folding holds some of these rows; on their kernel it is one of the second-order states of
`near_flat`, and what is left over across it are moments >= 0 of the rows held.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from origami_nlp.kkt import State
from origami_nlp.numerics import RANK, SETTLED, null_space
from origami_nlp.programme import Model
from origami_nlp.starts.family import Listed
from origami_nlp.starts.near_flat import NEAR, cone_at, on_cone

MOST_SHUT = 2
"""Variables shut in a folding: with more there are more contacts than a state beside it could leave."""
MOST_PIECES, MOST_ROWS = 8, 8
"""Pieces of what contacts allow at a folding, and rows of each."""
INSIDE = (1e-3, 2e-2)
"""Starts are moved off the contacts held by these shares of their distance: closing them may push them beyond."""


class NearFolded(Listed):
    """Starts beside flat foldings where second order says that the springs have a minimum.

    Parameters
    ----------
    model
        Of any scene.
    foldings
        Its flat foldings, [n] each; of images under its own symmetries only the first is looked at.
    """

    name = "starts beside flat foldings"
    sentence = "where second order puts a minimum beside a flat folding"

    def __init__(self, model: Model, foldings: Sequence[np.ndarray]) -> None:
        super().__init__(model)
        self._foldings = foldings

    def states(self) -> np.ndarray:
        """Return them closed to second order, shape [K, n] [rad]."""
        model = self._model
        found: list[np.ndarray] = []
        done: list[np.ndarray] = []
        for x in self._foldings:
            if not 0 < np.count_nonzero(x) <= MOST_SHUT or _known(model, done, x):
                continue
            done.append(x)
            state = State(model, x)
            if not state.refused:
                found += _beside(state)
        return np.array(found).reshape(-1, model.size)


def _known(model: Model, done: list[np.ndarray], x: np.ndarray) -> bool:
    images = [sign * x[order] for order, sign in model.own_symmetries]
    return any(np.abs(image - other).max() < SETTLED for image in images for other in done)


def _beside(state: State) -> Iterator[np.ndarray]:
    """Yield starts beside one folding."""
    model: Model = state.programme  # type: ignore[assignment]
    pieces = state.contacts.combinations()
    cone = cone_at(model, state.x, state.local.closure_jacobian)
    if pieces is None or len(pieces) > MOST_PIECES or cone is None:
        return
    root, kernel, form, torque = cone
    for rows in pieces:
        if len(rows) > MOST_ROWS:
            continue
        a = state.local.openings(tuple(rows))[1] / root @ kernel
        for held in _subsets(len(rows)):
            for y in _held(form, torque, a, held):
                yield state.x + kernel @ y / root


def _subsets(count: int) -> Iterator[list[int]]:
    for size in range(count + 1):
        yield from map(list, itertools.combinations(range(count), size))


def _held(
    form: np.ndarray, torque: np.ndarray, a: np.ndarray, held: list[int]
) -> Iterator[np.ndarray]:
    """Yield minima on the cone with rows of a held, which push, and others open."""
    z = null_space(a[held]) if held else np.eye(len(form))
    if z.shape[1] < 2:
        return
    some, lam = on_cone(z.T @ form @ z, z.T @ torque)
    for y, multiplier in zip(some @ z.T, lam, strict=True):
        size = float(np.linalg.norm(y))
        # gradient of the Lagrangian: moments >= 0 of the rows held must balance it
        left = y + torque + multiplier * (form @ y)
        push = np.linalg.lstsq(a[held].T, left, rcond=None)[0]
        opens = np.delete(a @ y, held)
        if RANK < size <= NEAR and (push > 0).all() and (opens > -RANK * size).all():
            # opens every row held at the same rate and leaves the others as they are
            off = np.linalg.lstsq(a, np.isin(np.arange(len(a)), held).astype(float), rcond=None)[0]
            yield from (y + share * size * off for share in (INSIDE if held else (0.0,)))
