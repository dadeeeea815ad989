"""States that laws balance at the tops of their wells: what is called a minimum has no lower closed state beside it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, State, Vertex
from origami_nlp.pattern import detent, double_well, linear, polynomial, sum_of, well
from origami_nlp.pattern_problem import pose
from tests.computed_once import thinned
from tests.independent import scan_four

NEAR, LOWER = 0.06, 1e-7
"""Distance [rad] within which all closed states are looked at, and by how much [J] one is lower."""


def balanced(rng, c, hills):
    """A law without torque at c: the top of a hill (with a probability), or the bottom of a well; and its energy."""
    e, w, k = rng.uniform(0.1, 3), rng.uniform(0.4, 2.5), rng.uniform(0.2, 3)
    kind = rng.integers(4) if rng.random() < hills else rng.integers(4, 6)
    if kind == 0:
        return double_well(e, w, c), lambda x: e * (((x - c) / w) ** 2 - 1) ** 2
    if kind == 1:
        return well(-e, c, w), lambda x: e * np.exp(-0.5 * ((x - c) / w) ** 2)
    if kind == 2:
        n = int(rng.integers(2, 6))
        top = c + math.pi / n
        return detent(e, n, top), lambda x: 0.5 * e * (1 - np.cos(n * (x - top)))
    if kind == 3:
        return sum_of(
            [linear(k, c), well(-e, c, w)]
        ), lambda x: 0.5 * k * (x - c) ** 2 + e * np.exp(-0.5 * ((x - c) / w) ** 2)
    if kind == 4:  # flat to the fourth order
        return polynomial([0.0, 0.0, k], c), lambda x: k * (x - c) ** 4 / 4
    return linear(k, c), lambda x: 0.5 * k * (x - c) ** 2


def some_state(rng, where, a, states):
    """A closed state of those sampled that is a sheet of paper."""
    if where == "flat":
        return np.zeros(4)
    if where == "inside":
        size = np.abs(states)
        some = states[(size < 2.9).all(axis=1) & (size > 0.2).all(axis=1)]
    else:
        folded = np.abs(np.abs(states) - math.pi) < 1e-9
        some = np.sign(states[folded.all(axis=1)]) * math.pi
    springs = Scene(Vertex(tuple(a.tolist())), (1,) * 4, (0,) * 4, "none", "fold-limits")
    good = [x for x in rng.permutation(some)[:50] if not pose(springs).refuses(x)]
    return good[0] if good else np.zeros(4)


def wrongly_called_minima(rng, where, count):
    """Draw scenes balanced at a state; count those called minima that have lower neighbours, and all minima."""
    wrong = minima = 0
    for _ in range(count):
        if where == "flat-folded":
            first = rng.uniform(0.5, 1.4, 2)
            a = np.array([first[0], first[1], math.pi - first[0], math.pi - first[1]])
        else:
            a = rng.dirichlet([4] * 4) * 2 * math.pi
            while a.max() > 3.0:
                a = rng.dirichlet([4] * 4) * 2 * math.pi
        states = scan_four.closed_states(a, 2_501)
        x = some_state(rng, where, a, states)
        hills = rng.uniform()
        laws, energies = zip(*(balanced(rng, c, hills) for c in x), strict=True)
        vertex = Vertex(tuple(a.tolist()))
        scene = Scene(vertex, (1,) * 4, (0,) * 4, "none", "fold-limits", laws=laws)
        verdict = o.classify(State(pose(scene), x)).verdict

        def energy(y, energies=energies):
            return sum(f(y[..., i]) for i, f in enumerate(energies))

        around = states[np.abs(states - x).max(axis=1) < NEAR]
        lower = bool((energy(around) < energy(x) - LOWER).any())
        minima += verdict == "minimum"
        wrong += verdict == "minimum" and lower
    return wrong, minima


@pytest.mark.parametrize("where", thinned(["flat", "inside", "flat-folded"], 3))
def test_no_top_of_a_well_is_called_a_minimum(where):
    wrong, minima = wrongly_called_minima(np.random.default_rng(1), where, 6)
    assert not wrong and minima < 6
