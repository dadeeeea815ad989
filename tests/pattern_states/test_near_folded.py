"""Minima beside a sheet folded in half: predicted to second order, found whatever the seed, and in many digits."""

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern_problem import pose
from origami_nlp.pattern_states import list_flat_folded
from origami_nlp.pattern_states.near_folded import beside_folded


@pytest.fixture(scope="module")
def pair():
    """What a search lists beside foldings, with a seed whose random starts reach none of it."""
    scene = replace(o.examples.degree6(math.radians(63.22), 1.2445), symmetry="none", mirror=None)
    found = o.find_minima(scene, prove=False, seed=2, max_starts=24, escape=False).minima
    half = [m for m in found if beside(m.fold_angles) < 0.1]
    return scene, [np.array(m.fold_angles) for m in half], half


def beside_foldings(scene):
    """Starts beside the foldings of a scene that are not flat."""
    problem = pose(scene)
    states = [x for x in list_flat_folded(problem).states if x.any()]
    return list(beside_folded(problem, states, ()))


def beside(angles):
    """Largest distance of a fold angle from 0 and +-pi."""
    return max(abs(v - math.pi * round(v / math.pi)) for v in angles)


def test_a_search_lists_the_pair_whatever_its_seed(pair):
    _, states, minima = pair
    one, two = states
    assert one == pytest.approx(two[[0, 5, 4, 3, 2, 1]], abs=1e-9)  # about crease 1
    assert all(m.kind == "contact-pinned" and len(m.contacts) == 1 for m in minima)


def test_second_order_is_close_to_it(pair):
    scene, states, _ = pair
    starts = np.array(beside_foldings(scene))
    apart = min(np.abs(starts - state).max(axis=1).min() for state in states)
    assert apart < 2 * beside(states[0]) ** 2


def test_nothing_beside_foldings_of_a_generic_vertex():
    scene = o.Scene(o.Vertex.from_degrees((50, 70, 75, 85, 80)), (1,) * 5, (1, 1, -1, 1, 1))
    assert not beside_foldings(scene)
