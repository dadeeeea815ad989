"""Random questions of designs."""

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.inverse_design import Target, Targets, solve
from origami_nlp.kkt import project
from origami_nlp.pattern_problem import pose


def random_vertex(rng, n):
    while True:
        a = rng.dirichlet(np.ones(n) * 2) * 2 * math.pi
        if a.min() > 0.2 and a.max() < math.pi - 0.1:
            return o.Vertex(tuple(a))


def random_state(model, rng, pinned=False):
    """An admissible state, with a fold limit closed where `pinned`."""
    from origami_nlp.problem import Contact

    for _ in range(400):
        start = rng.uniform(-2.7, 2.7, model.size)
        rows = ()
        if pinned:
            k, side = int(rng.integers(model.size)), int(rng.choice([-1, 1]))
            start[k] = side * math.pi
            rows = (Contact("limit", k, 1 if side > 0 else -1),)
        x, left = project(model, start, rows)
        if left < 1e-12 and not model.refuses(x) and np.sort(np.abs(x))[-1 - pinned] < 3.05:
            return tuple(model.expand(x).tolist())
    return None


def question(seed, n, count, pinned=0, flat=0, **more):
    """A question of `count` random states; None where none were drawn."""
    rng = np.random.default_rng(seed)
    vertex = random_vertex(rng, n)
    model = pose(o.Scene(vertex, (1,) * n, (0,) * n, symmetry="none"))
    found = [random_state(model, rng, i < pinned) for i in range(count - flat)]
    found += [(0.0,) * n] * flat
    if None in found:
        return None
    states = tuple(Target(f"s{i}", phi) for i, phi in enumerate(found))
    return Targets(vertex, states, stiffness=(0.01, 1.0), **more)


def built(n, seed, count, pinned, flat, **more):
    """The first feasible question from a seed on."""
    for k in range(40):
        asked = question(1000 * seed + k, n, count, pinned, flat, **more)
        if asked is not None and (posed := solve(asked)).feasible:
            return asked, posed
    pytest.fail("no feasible question was drawn")
