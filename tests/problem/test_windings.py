"""States of every winding close the whole vertex with q = +1, and are told apart by the turn of a period."""

import math

import numpy as np
import pytest

from origami_nlp.chart import fold_vertex
from origami_nlp.kkt import project
from origami_nlp.pattern import Scene, Vertex, winding_number
from origami_nlp.pattern_problem import pose
from tests.computed_once import thinned


def scenes(kind, order, flat):
    """Vertices of a group with two to five creases a piece; not flat: of less than 2 pi."""
    rng = np.random.default_rng([order, flat, kind == "D"])
    whole = 2 * math.pi * (1.0 if flat else 0.8) / order
    for count in (2, 3, 4, 5):
        k, rest = rng.uniform(0.5, 2.0, count), rng.uniform(-2.0, 2.0, count)
        names = np.arange(count)
        if kind == "C":
            sectors = rng.uniform(0.5, 1.5, count)
            sectors *= whole / sectors.sum()
        else:
            half = rng.uniform(0.5, 1.5, count - 1)
            half *= whole / 2 / half.sum()
            sectors = np.concatenate([half, half[::-1]])
            names = np.concatenate([names, names[-2:0:-1]])
        each = (tuple(np.tile(v, order)) for v in (sectors, k[names], rest[names]))
        sectors, k, rest = each
        yield Scene(Vertex(sectors, flat), k, rest, f"{kind}{order}", "fold-limits")


@pytest.mark.parametrize("flat", thinned([False, True], 2))
@pytest.mark.parametrize("order", thinned([3, 4, 5, 6, 7], 4))
@pytest.mark.parametrize("kind", ["C", "D"])
def test_every_winding_closes_the_whole_vertex(kind, order, flat):
    rng, seen = np.random.default_rng(0), set()
    for scene in scenes(kind, order, flat):
        problem = pose(scene)
        x, residual = project(problem, rng.uniform(-3.0, 3.0, (100, problem.size)))
        x = x[(residual < 1e-10) & (np.abs(x) <= 2 * math.pi).all(axis=1)]
        if not len(x):
            continue
        _, q = fold_vertex(scene.vertex, problem.expand(x))
        assert np.abs(q[:, 1:]).max() < 1e-8
        lifted = problem.lifts_to_one(x)
        assert ((q[:, 0] > 0) == lifted).all()
        seen |= {winding_number(scene.vertex, scene.group, problem.expand(y)) for y in x[lifted]}
    assert seen == set(scene.windings)
