"""Whether a vertex folds flat: crimping against the order of layers."""

import json
import math

import numpy as np
import pytest

from origami_nlp import Vertex
from origami_nlp.pattern import fold_vertices, parse_fold
from origami_nlp.pattern_problem import check_admissible
from origami_nlp.validity import folds_flat
from origami_nlp.validity.flat_fold import crimped
from tests.fold_files import disc


def test_crimping_agrees_with_the_order_of_layers():
    """Random sector angles of degree 4 to 8 with Kawasaki's and Maekawa's conditions."""
    rng, seen = np.random.default_rng(0), []
    for _ in range(400):
        n = int(rng.choice([4, 6, 8]))
        halves = rng.dirichlet(np.ones(n // 2), 2) * math.pi
        sectors = halves.T.ravel()
        if sectors.max() > math.pi - 1e-3 or sectors.min() < 1e-2:
            continue
        letters = "".join(rng.permutation(list("M" * (n // 2 - 1) + "V" * (n // 2 + 1))))
        phi = np.array([math.pi if a == "V" else -math.pi for a in letters])
        answer = crimped(tuple(sectors), letters)
        if answer is not None:
            assert (
                answer == check_admissible(Vertex(tuple(sectors)), phi, tolerance=1e-4).admissible
            )
            seen.append(answer)
    assert 50 < sum(seen) < len(seen) - 50
    assert crimped((math.pi / 2,) * 4, "MVVV") is None  # no smallest: layers decide


@pytest.mark.parametrize("letters", ["MVVV", "MMVV", "VVMV", "MMMV", "MMMM"])
def test_equal_sectors_and_wrong_counts(letters):
    (v,) = fold_vertices(parse_fold(json.dumps(disc([90] * 4, letters)))[0])[0]
    phi = np.array([math.pi if a == "V" else -math.pi for a in v.assignment])
    assert (
        folds_flat(v)
        == check_admissible(Vertex((math.pi / 2,) * 4), phi, tolerance=1e-4).admissible
    )
