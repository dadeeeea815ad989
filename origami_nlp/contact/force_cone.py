"""The cone of forces that a set of contacts can exert, and how deep inside it a pull lies."""

from __future__ import annotations

import itertools

import numpy as np

from origami_nlp.numerics import INDEPENDENT


def distance_to_boundary(b: np.ndarray, c: np.ndarray) -> tuple[float, np.ndarray] | None:
    """Find the distance of c from the boundary of cone(b) = {b mu: mu >= 0} within its span.

    The cone is bounded by planes through its generators; each is found by enumeration (contacts are few).

    Parameters
    ----------
    b, c
        Generators [t, r] (contact gradients in the tangent space) and a point of the cone [t].

    Returns
    -------
    distance, direction
        c - distance * direction lies on the boundary, direction a unit vector [t]; or None where the cone is
        a linear space and has no boundary: the contacts lock one another.
    """
    length = np.linalg.norm(b, axis=0)
    g = b[:, length > INDEPENDENT] / length[length > INDEPENDENT]
    u, s, _ = np.linalg.svd(g, full_matrices=False)
    rank = int((s > INDEPENDENT).sum())
    if rank == 0:
        return None
    span = u[:, :rank]
    g, p = span.T @ g, span.T @ c
    best: tuple[float, np.ndarray] | None = None
    # a facet of the cone is spanned by rank - 1 of its generators, and has all others on one side
    for chosen in itertools.combinations(range(g.shape[1]), rank - 1):
        wall = g[:, list(chosen)]
        _, s, vt = np.linalg.svd(wall.T) if rank > 1 else (None, np.zeros(0), np.eye(1))
        if (s > INDEPENDENT).sum() < rank - 1:
            continue
        inward = vt[-1]
        for w in (inward, -inward):
            # w . p is the distance of p from that facet's plane, negative outside; the smallest over all facets counts
            if (w @ g >= -INDEPENDENT).all() and (best is None or w @ p < best[0]):
                best = (float(w @ p), span @ w)
    return best
