"""Branch minima in the full space: every verdict against a formulation that shares no code with it."""

import numpy as np
import pytest

from origami_nlp.chart import fold_vertex
from origami_nlp.paper import cone
from origami_nlp.paper.cone.stability import cone_scene

POINTS = [(6, 1.0, 0.5), (6, 0.1, -0.4), (8, 0.05, -0.7)]


@pytest.fixture(scope="module", params=POINTS, ids=str)
def judged(request):
    return cone.full_space(*request.param)


def slope_by_differences(scene, x):
    """Gradient of the energy along closed states, with closure differentiated numerically."""
    h = 1e-6
    jacobian = np.stack(
        [
            (fold_vertex(scene.vertex, x + h * e)[1] - fold_vertex(scene.vertex, x - h * e)[1])[1:]
            / (2 * h)
            for e in np.eye(len(x))
        ],
        axis=1,
    )
    gradient = np.array(scene.stiffness) * (x - np.array(scene.rest_angles))
    fit = np.linalg.lstsq(jacobian.T, gradient, rcond=None)[0]
    return float(np.linalg.norm(gradient - jacobian.T @ fit)), jacobian


def test_interior_verdicts_follow_from_slope_and_second_differences(judged):
    """At a regular interior state: a slope off the branch decides, else the energy along closed arcs."""
    scene = cone_scene(judged.cone.degree, judged.ratio, judged.rest)
    rng = np.random.default_rng(0)
    for state in (s for s in judged.states if s.kind == "interior"):
        x = np.array(state.fold_angles)
        slope, jacobian = slope_by_differences(scene, x)
        assert slope == pytest.approx(state.residual, abs=1e-7)
        if slope > 1e-6:
            assert state.verdict == "unstable", state.branch
            continue
        null = np.linalg.svd(jacobian)[2][3:]
        rises = []
        for _ in range(200):
            y = x + 1e-3 * (d := rng.normal(size=len(null)) @ null) / np.linalg.norm(d)
            for _ in range(6):  # back onto closure
                q = fold_vertex(scene.vertex, y)[1][1:]
                y = y - np.linalg.pinv(jacobian) @ q
            assert np.abs(fold_vertex(scene.vertex, y)[1][1:]).max() < 1e-13
            rises.append(scene.energy(y) - scene.energy(x))
        assert (min(rises) > 0) == (state.verdict == "stable")
