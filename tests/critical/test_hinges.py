"""Critical points with hinge laws: the Morse identity does not know the law, and the minima are those of the search."""

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import examples
from origami_nlp.critical import compare_minima, find_critical_points
from origami_nlp.pattern import double_well
from origami_nlp.problem import Model


@pytest.mark.slow  # a thorough search
def test_points_of_wells_are_counted_and_their_minima_are_those_of_the_search():
    """With one random law for the creases that each variable of the model stands for."""
    scene, rng = examples.panels()[15], np.random.default_rng(15)
    model = Model(scene)
    draws = [
        (math.exp(x), e, s)
        for x, e, s in rng.uniform((-1, 0.4, -0.3), (1, 1.5, 0.3), (model.size, 3))
    ]
    which = model.expand(np.arange(model.size, dtype=float)).round().astype(int)
    scene = replace(scene, laws=tuple(double_well(*draws[k]) for k in which))
    found = find_critical_points(scene)
    search = o.find_minima(scene, effort="thorough", escape=False, prove=False)
    assert found.morse_sum == 1 and found.doubts == ()  # the space is a disc, whatever the law
    assert max(p.residual for p in found.points) < 1e-12
    assert compare_minima(found, search).comparison.agree and len(found.minima) > 4
