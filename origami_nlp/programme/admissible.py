"""Is a state admissible: the one test, for contacts that the programme models and for all facets."""

from __future__ import annotations

import numpy as np

from origami_nlp.folding import crossing_depth, examine
from origami_nlp.programme.model import Model


def broken_gap(model: Model, gaps: np.ndarray, tolerance: float = 1e-9) -> int | None:
    """Return the position of a mirror or axis gap that is negative, or None."""
    for index, gap in enumerate(model.structure.gaps):
        if gap.type != "facet-pair" and gaps[index] < -tolerance:
            return index
    return None


def crossed_pairs(
    model: Model, x: np.ndarray, tolerance: float = 1e-9
) -> tuple[tuple[int, int], ...]:
    """Return the modelled facet pairs that cross at x by more than `tolerance`."""
    pairs = model.structure.pairs
    if not pairs:
        return ()
    rays = model.rays(x)
    n = len(rays)
    first, second = np.array(pairs).T
    arcs = np.stack([rays, np.roll(rays, -1, axis=0)], axis=1)
    depth = crossing_depth(arcs[first % n], arcs[second % n])
    return tuple(pair for pair, d in zip(pairs, depth, strict=True) if d > tolerance)


def is_admissible(model: Model, x: np.ndarray) -> bool:
    """Tell whether a closed state satisfies the contact that the scene asks for."""
    if model.structure.limits and (np.abs(x) > model.bound + 1e-11).any():
        return False
    if not model.on_sheet(x):
        return False
    if model.scene.contact != "full":
        return True
    if model.structure.gaps and broken_gap(model, model.local(x).gaps) is not None:
        return False
    state = examine(model.scene.vertex, model.expand(x), elements=model.scene.group.elements)
    return state.admissible
