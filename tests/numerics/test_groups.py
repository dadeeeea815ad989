"""Groups and near pairs, against SciPy's graphs and trees, which they do without."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from origami_nlp.numerics import groups, pairs_within


@pytest.mark.parametrize("seed", range(40))
def test_groups_are_the_connected_components(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 80))
    pairs = rng.integers(0, count, (int(rng.integers(0, 80)), 2))
    found = groups(count, pairs)
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(count, count))
    number, label = connected_components(graph, directed=False)
    assert len(set(zip(found.tolist(), label.tolist(), strict=True))) == number
    assert found.max() + 1 == number
    firsts = [found.tolist().index(k) for k in range(number)]
    assert firsts == sorted(firsts)


def test_a_long_chain_is_one_group():
    order = np.random.default_rng(0).permutation(20_000)
    assert groups(20_000, np.stack([order[1:], order[:-1]], axis=1)).max() == 0


@pytest.mark.parametrize("seed", range(40))
def test_pairs_are_those_of_a_tree(seed):
    rng = np.random.default_rng(seed)
    shape = int(rng.integers(0, 200)), int(rng.integers(1, 6))
    points = np.round(rng.normal(size=shape) * rng.choice([1, 3, 30]), int(rng.integers(0, 3)))
    near = cKDTree(points).query_pairs(2.001, p=np.inf) if len(points) else set()
    assert list(map(tuple, pairs_within(points, 2.001).tolist())) == sorted(near)
