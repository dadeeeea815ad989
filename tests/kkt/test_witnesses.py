"""Fully folded states of resch:1x2: facets that cross by less than is resolved beside them are no way down."""

import numpy as np
import pytest

from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import judge
from tests.computed_once import thinned

STATES = (
    (180, 60, -180, -90, -60, -90, -180, -180, 180, -90, -180, 180, 0, 180, 0, -90),
    (180, -60, 180, -90, -60, -90, 180, -60, 180, -90, -180, 180, 180, 180, -180, -90),
)


@pytest.mark.parametrize("degrees", thinned([(s,) for s in STATES], 2))
def test_verdict_does_not_hang_on_rounding(degrees):
    exact = np.radians(np.array(degrees, dtype=float))
    for seed in range(2):
        noise = 1e-15 * seed * np.random.default_rng(seed).standard_normal(len(exact))
        phi = np.clip(exact + noise, -np.pi, np.pi)
        assert judge(PatternProblem(as_pattern("resch:1x2")), phi).verdict == "minimum"
