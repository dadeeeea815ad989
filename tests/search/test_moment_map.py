"""The map of the constant internal moment: its derivative, and the lift."""

import math

import numpy as np

from origami_nlp import Scene, Vertex
from origami_nlp.pattern_problem import pose
from origami_nlp.search.moment_map import MomentMap


def draw(n, seed=0, *, contact="fold-limits", flat=True):
    rng = np.random.default_rng([seed, n])
    sectors = rng.dirichlet(np.full(n, 3.0)) * (2 * math.pi if flat else 5.5)
    k, rest = 10 ** rng.uniform(-1, 1, n), rng.uniform(-math.pi, math.pi, n)
    vertex = Vertex(tuple(sectors.tolist()), flat=flat)
    return Scene(vertex, tuple(k.tolist()), tuple(rest.tolist()), "none", contact)


def test_newtons_step_by_differences_the_long_way_too():
    model, h = pose(draw(8)), 1e-6
    chain, rng = MomentMap(model), np.random.default_rng(2)
    m = rng.normal(size=(200, 3)) * 5 * chain.smallest
    shot = chain.shoot(m)
    assert (np.linalg.norm(shot.miss, axis=1) > math.pi).sum() > 20
    columns = [
        (chain.shoot(m + h * e).miss - chain.shoot(m - h * e).miss) / (2 * h) for e in np.eye(3)
    ]
    jacobian = np.stack(columns, axis=2)
    same = np.linalg.cond(jacobian) < 1e3
    ours = np.linalg.solve(shot.slope[same], shot.miss[same, :, None])
    wanted = np.linalg.solve(jacobian[same], shot.miss[same, :, None])
    error = np.abs(ours - wanted).max(axis=(1, 2)) / np.abs(wanted).max(axis=(1, 2))
    # a limit between the two points of a difference makes it wrong
    assert (error < 1e-5).mean() > 0.98
