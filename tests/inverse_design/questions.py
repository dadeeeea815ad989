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


def flat_foldable(rng, n):
    """A random vertex whose alternate sectors sum to pi."""
    while True:
        a = np.empty(n)
        for k in (0, 1):
            a[k::2] = rng.dirichlet(np.ones(n // 2) * 2) * math.pi
        if a.min() > 0.2 and a.max() < math.pi - 0.1:
            return o.Vertex(tuple(a))


def flat_folded(model, rng):
    """An admissible state with all creases at +-pi."""
    for _ in range(200):
        x = math.pi * rng.choice([-1.0, 1.0], model.size)
        if not model.refuses(x):
            return tuple(model.expand(x).tolist())
    return None


def mixed(seed):
    """A question of one to three states of a vertex of degree 4 to 8: interior, pinned, flat and flat-folded ones.

    Every second one has wound springs; None where a state could not be drawn.
    """
    rng = np.random.default_rng([seed, 18])
    n, count = 4 + seed % 5, (1, 2, 2, 3, 3)[seed // 5 % 5]
    folded = n % 2 == 0 and rng.random() < 0.4
    vertex = flat_foldable(rng, n) if folded else random_vertex(rng, n)
    model = pose(o.Scene(vertex, (1,) * n, (0,) * n, symmetry="none"))
    states, kinds = [], []
    for i in range(count):
        if i == 0 and folded:
            kinds.append("flat-folded")
            states.append(flat_folded(model, rng))
            continue
        kind = rng.choice(["interior", "interior", "pinned", "flat"])
        kind = "interior" if kind in kinds and kind == "flat" else str(kind)
        kinds.append(kind)
        states.append((0.0,) * n if kind == "flat" else random_state(model, rng, kind == "pinned"))
    if None in states:
        return None
    named = tuple(
        Target(f"s{i}, {kind}", phi)
        for i, (kind, phi) in enumerate(zip(kinds, states, strict=True))
    )
    return Targets(vertex, named, stiffness=(0.01, 1.0), preload=bool(seed // 25 % 2))
