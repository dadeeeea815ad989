"""Things that hang together, and things that are near each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def groups(count: int, pairs: Sequence[tuple[int, int]] | np.ndarray) -> np.ndarray:
    """Number the groups of things that pairs join.

    Parameters
    ----------
    count
        Of the things.
    pairs
        Two things each, numbered from 0, [P, 2].

    Returns
    -------
    ndarray
        The group of each thing, [count]; groups are numbered from 0 in the order of their first things.

    Examples
    --------
    >>> groups(5, [(1, 3), (3, 4)]).tolist()
    [0, 1, 2, 1, 1]
    """
    one, other = np.asarray(pairs, dtype=int).reshape(-1, 2).T
    # a forest in which each thing points to an earlier one: roots of joined trees are hooked, paths shortened
    root = np.arange(count)
    while (apart := root[one] != root[other]).any():
        a, b = root[one[apart]], root[other[apart]]
        np.minimum.at(root, np.maximum(a, b), np.minimum(a, b))
        while not np.array_equal(further := root[root], root):
            root = further
    return np.unique(root, return_inverse=True)[1]


def pairs_within(points: np.ndarray, distance: float) -> np.ndarray:
    """List the pairs of points that differ by at most a distance in each coordinate.

    Parameters
    ----------
    points
        Shape [C, n].
    distance
        In the unit of the points.

    Returns
    -------
    ndarray
        Numbers of the points, the smaller one first, [P, 2], in order.

    Examples
    --------
    >>> pairs_within(np.array([[0, 0], [5, 5], [1, 2]]), 2).tolist()
    [[0, 2]]
    """
    pairs = [np.zeros((0, 2), dtype=int)]
    if len(points):
        along = points[:, np.ptp(points, axis=0).argmax()]
        order, place = np.argsort(along, kind="stable"), np.arange(len(points))
        end = np.searchsorted(along[order], along[order] + distance, side="right")
        # each point with the first, second, ... one after it along the longest coordinate, while one is near
        for shift in range(1, int((end - place).max())):
            one = np.flatnonzero(place + shift < end)
            pair = np.stack([order[one], order[one + shift]], axis=1)
            apart = np.abs(points[pair[:, 0]] - points[pair[:, 1]]).max(axis=1)
            pairs.append(np.sort(pair[apart <= distance], axis=1))
    found = np.concatenate(pairs)
    return np.asarray(found[np.lexsort(found.T[::-1])])
