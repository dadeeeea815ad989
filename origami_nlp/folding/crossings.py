"""How deep facets of a folded vertex cross, from the heights of rays off the planes of facets.

Two arcs cross where their four ends alternate; each end is off the plane of the other arc by the sine of its distance
from the common point times that of the angle between the arcs, so that the smallest of the four is the depth.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from origami_nlp.numerics import NONZERO, cross


def pair_depths(rays: np.ndarray, pairs: Sequence[tuple[int, int]] | np.ndarray) -> np.ndarray:
    """Return how deep pairs of facets cross, 0 where they do not; facet i is the arc from ray i to the next.

    Parameters
    ----------
    rays
        Unit vectors, shape [..., R, 3].
    pairs
        Positions of the facets, shape [P, 2].

    Returns
    -------
    numpy.ndarray
        Sine of the smallest angle of an end off the other facet's plane, of facets that cross, shape [..., P].
    """
    return _depth(_off_planes(rays, *_ends(_pairs(pairs), rays.shape[-2])))


def facet_heights(rays: np.ndarray, facets: np.ndarray | None = None) -> np.ndarray:
    """Return the sines of rays [..., R, 3] off the planes of facets (all, or [F] of them), [..., F, R]."""
    first = np.arange(rays.shape[-2]) if facets is None else facets
    normals = cross(rays[..., first, :], rays[..., (first + 1) % rays.shape[-2], :])
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), NONZERO)
    return np.asarray(normals @ rays.swapaxes(-1, -2))


def depths_at(heights: np.ndarray, pairs: Sequence[tuple[int, int]] | np.ndarray) -> np.ndarray:
    """Return `pair_depths` of a state where the heights of all rays off all facets are known, [N, N]."""
    table = _ends(_pairs(pairs), len(heights))[0]
    return _depth(heights[table[:, :, 1], table[:, :, 0]] * _SIGNS)


# of j and j + 1 on facet i, i and i + 1 on facet j: where ends alternate, heights times these have one sign
_SIGNS = np.array([1.0, -1.0, -1.0, 1.0])


Pairs = tuple[tuple[int, int], ...]


def _pairs(pairs: Sequence[tuple[int, int]] | np.ndarray) -> Pairs:
    return pairs if isinstance(pairs, tuple) else tuple((int(i), int(j)) for i, j in pairs)


@lru_cache(maxsize=256)
def _ends(pairs: Pairs, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return `pair_rows` [P, 4, 2], the facets that they are on, and which of these each end is on [P, 4]."""
    table = pair_rows(pairs, count)
    facets, on = np.unique(table[:, :, 1], return_inverse=True)
    return table, facets, on.reshape(table.shape[:2])


def _off_planes(
    rays: np.ndarray, table: np.ndarray, facets: np.ndarray, on: np.ndarray
) -> np.ndarray:
    """Sines of the ends of pairs (`_ends`) off the other facet, [..., P, 4]: of one sign where they cross."""
    return np.asarray(facet_heights(rays, facets)[..., on, table[:, :, 0]] * _SIGNS)


def _depth(v: np.ndarray) -> np.ndarray:
    # all of one sign: the ends alternate around a common point (mixed signs: they miss, or meet antipodally)
    return np.asarray(np.maximum(np.maximum(v.min(axis=-1), (-v).min(axis=-1)), 0.0))


def pair_rows(pairs: Sequence[tuple[int, int]] | np.ndarray, count: int) -> np.ndarray:
    """Return the ends of each pair (i, j) on the other facet: j on i, j + 1 on i, i on j, i + 1 on j.

    Parameters
    ----------
    pairs
        Facets, shape [P, 2].
    count
        Number of rays N.

    Returns
    -------
    numpy.ndarray
        (k, j) of each end, shape [P, 4, 2]; those with k - j in {2, N - 1} are fold limits, no rows.
    """
    i, j = np.asarray(pairs, dtype=int).reshape(-1, 2).T % count
    ends = ((j, i), (j + 1, i), (i, j), (i + 1, j))
    return np.stack([np.stack([k % count, on], axis=-1) for k, on in ends], axis=1)
