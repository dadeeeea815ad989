"""Things that hang together."""

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
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    one, other = np.asarray(pairs, dtype=int).reshape(-1, 2).T
    graph = coo_array((np.ones(len(one)), (one, other)), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    _, first, label = np.unique(label, return_index=True, return_inverse=True)
    return np.asarray(first.argsort().argsort()[label])
