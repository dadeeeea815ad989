"""Stiffness against motions that break a symmetry: by null spaces of all rows at once."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.contact import breaking_stiffnesses
from origami_nlp.minima import hessian_spectra, permutations
from origami_nlp.pattern_problem import pose

SCENE = o.examples.degree6("5*pi/12", ratio=1)
OPTIONS = {"max_starts": 32, "prove": False, "escape": False}


def test_without_loaded_contacts_it_is_the_breaking_block_of_the_spectrum():
    for minimum in o.find_minima(SCENE, **OPTIONS).minima:
        problem = pose(SCENE)
        state = o.State(problem.whole, np.array(minimum.fold_angles))
        wanted = hessian_spectra(state, permutations(problem))[1]
        assert wanted and breaking_stiffnesses(state, problem) == pytest.approx(wanted, rel=1e-12)
