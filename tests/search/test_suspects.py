"""Two minima of yoshimura:3x3 whose neighbours are lower: there facets have swung through each other about a line."""

import json
from pathlib import Path

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.kkt import State, classify

SCENES = Path(__file__).parents[3] / "shared" / "scenes" / "suspects_yoshimura_3x3.json"


@pytest.mark.skipif(not SCENES.exists(), reason=f"{SCENES} is not there")
def test_lower_neighbours_of_two_minima_reach_through_a_facet():
    problem, rng = o.pose("yoshimura:3x3"), np.random.default_rng(0)
    for given in json.loads(SCENES.read_text("utf-8")):
        x = np.array(given)
        x = np.where(
            np.pi - np.abs(x) < 1e-9, np.copysign(np.pi, x), np.where(np.abs(x) < 1e-12, 0.0, x)
        )
        x, _ = problem.project(x, (np.abs(x) == np.pi) | (x == 0))
        assert classify(State(problem, x)).verdict == "minimum"
        base = [c for c in State(problem, x).contacts.base if not c.is_limit]
        lower = 0
        for _ in range(1500):
            if lower == 3:
                break
            aside = 10 ** rng.uniform(-4.3, -3.3) * rng.normal(size=problem.size)
            held = (np.abs(x) == np.pi) & (rng.random(problem.size) < 0.85)
            start = problem.fold_limits.clip(x + np.where(held, 0.0, aside))
            y, residual = problem.project(start, held)
            if residual > 1e-12 or problem.refuses(y) or not problem.fold_limits.inside(y).all():
                continue
            if problem.energy_change(x, y) < -1e-8 * problem.scale:
                lower += 1
                # seen by the depth to which facets reach into each other, and by a gap that is shut at the minimum
                assert problem.doubt(y) and problem.local(y).openings(base)[0].min() < -1e-9
        assert lower
