"""Many states of a vertex at once: creases in space, and how deep facets cross, as the source paper has it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from origami_nlp.numerics import NONZERO, cross, quaternion as quat
from origami_nlp.pattern import Vertex


def fold_vertex(vertex: Vertex, fold_angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fold a vertex with its last facet held fixed (paper, eq. 2.1, fold-map).

    Parameters
    ----------
    vertex
        The vertex.
    fold_angles
        States, shape [..., N] [rad], valley positive; they need not close.

    Returns
    -------
    creases : numpy.ndarray
        Deformed unit creases c_i = F_{i-1} b_i, shape [..., N, 3].
    q : numpy.ndarray
        Product of all folds, and of the turn by `Vertex.excess` about e3 that closes the unrolled sheet of a
        vertex that is not flat, as a quaternion, shape [..., 4]; (1, 0, 0, 0) when the sheet closes.
        Every embedded vertex has +1: simple spherical polygons are deformed into each other through simple
        ones, along which the sign cannot change.

    Examples
    --------
    >>> from origami_nlp import Vertex
    >>> from origami_nlp.chart import fold_vertex
    >>> creases, q = fold_vertex(Vertex(("pi/2",) * 4), [3.141592653589793, 0, 3.141592653589793, 0])
    >>> creases.shape, q.round(12).tolist()
    ((4, 3), [1.0, 0.0, 0.0, 0.0])
    """
    half = np.asarray(fold_angles, dtype=float) / 2
    q = tuple(np.full(half.shape[:-1], v, dtype=float) for v in quat.IDENTITY)
    creases = []
    for i, b in enumerate(vertex.creases):
        # c_i = F_{i-1} b_i, the folds before it (paper, section 2)
        creases.append(np.stack(quat.rotate(q, b), axis=-1))
        q = quat.multiply(q, quat.fold(np.cos(half[..., i]), np.sin(half[..., i]), b))
    if not vertex.flat:
        turn = vertex.excess / 2
        q = quat.multiply(q, (math.cos(turn), 0.0, 0.0, math.sin(turn)))
    return np.stack(creases, axis=-2), np.stack(q, axis=-1)


def pair_depths(creases: np.ndarray, pairs: Sequence[tuple[int, int]]) -> np.ndarray:
    """Return how deep pairs of facets cross, 0 where they do not; facet i is the arc from crease i to the next.

    Two arcs cross where their four ends alternate; each end is off the plane of the other arc by the sine of its
    distance from the common point times that of the angle between the arcs: the smallest of the four is the depth.

    Parameters
    ----------
    creases
        Unit vectors, shape [..., N, 3].
    pairs
        Positions of the facets, shape [P, 2].

    Returns
    -------
    numpy.ndarray
        Shape [..., P].
    """
    facets = np.array(pairs, int).reshape(-1, 2).T
    first, last = creases[..., facets, :], creases[..., (facets + 1) % creases.shape[-2], :]
    normal = cross(first, last)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), NONZERO)
    off = [np.einsum("...i,...i->...", normal, end[..., ::-1, :, :]) for end in (first, last)]
    # of one sign where the ends alternate around a common point; mixed: they miss, or meet antipodally
    v = np.stack([off[0][..., 0, :], -off[1][..., 0, :], -off[0][..., 1, :], off[1][..., 1, :]])
    return np.asarray(np.maximum(np.maximum(v.min(axis=0), (-v).min(axis=0)), 0.0))
