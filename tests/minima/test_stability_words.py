"""A minimum is called stable only where its verdict in the full contact-admissible space is known."""

import dataclasses
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.minima import is_affordable, judge_in_full_space
from origami_nlp.minima.stability import verdict
from origami_nlp.pattern_problem import pose
from tests.computed_once import once

SCENE = o.examples.degree6("pi/3", 1)


@pytest.fixture(scope="module")
def free():
    """A vertex without imposed symmetry: what the search finds is a minimum of the whole space."""
    vertex = o.Vertex(("pi/2", "pi/3", "pi/2", "2*pi/3"))
    scene = o.Scene(vertex, (1.0,) * 4, (1.0, -1.0, 1.0, 1.0), "none", "full")
    return once(
        "free",
        lambda: o.find_minima(scene, max_starts=16, prove=False, escape=False),
    )


def test_without_imposed_symmetry_a_minimum_is_a_stable_state(free):
    assert free.minima and free.stable == free.minima and not free.flags.stability_not_asked
    for m in free.minima:
        full = judge_in_full_space(free.model, np.array(m.fold_angles))
        assert verdict(free.scene, m) == full.verdict == "stable"


@pytest.mark.parametrize("contact", ["fold-limits", "none"])
def test_with_less_than_full_contact_a_minimum_is_a_minimum(contact):
    scene = dataclasses.replace(SCENE, symmetry="none", contact=contact)
    result = o.find_minima(scene, max_starts=4, prove=False, escape=False)
    assert result.minima and not result.stable and not result.flags.stability_not_asked


def test_the_full_space_is_asked_where_that_is_affordable():
    """By size alone: not of more states, or creases, than are stated, nor where no symmetry is imposed."""
    small = o.examples.degree6("pi/4", 0.01)
    found = o.find_minima(small, max_starts=8, escape=False, prove=False)
    assert {m.full_space.verdict for m in found.minima} <= {"stable", "unstable", "undecided"}
    asked = o.find_minima(small, max_starts=8, escape=False, prove=False, full=True)
    assert [m.full_space for m in found.minima] == [m.full_space for m in asked.minima]
    n = 14
    wide = o.Scene(o.Vertex((2 * math.pi / n,) * n), (1.0,) * n, (0.5, -0.5) * (n // 2))
    assert not wide.group.is_trivial and not is_affordable(pose(wide), 1)
    assert is_affordable(pose(SCENE), 64) and not is_affordable(pose(SCENE), 65)
    free = o.find_minima(
        dataclasses.replace(small, symmetry="none"), max_starts=4, escape=False, prove=False
    )
    assert all(m.full_space is None for m in free.minima)
