"""Load margins against independent solves."""

from __future__ import annotations

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.contact.force_cone import distance_to_boundary
from origami_nlp.contact.margin import LoadMargin, load_margin, moments_of, under_load
from origami_nlp.kkt import (
    State,
    classify,
    find_multipliers,
    newton,
)
from origami_nlp.minima import JudgedState, MinimaResult
from origami_nlp.numerics import null_space
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import Contact
from tests.computed_once import panel_result, shared, thinned

PINNED = {
    "creases on each other": ("degree6", "pi/3", 1.0, "creases 1 and 4"),
    "fold limit": ("degree6", "5*pi/12", 100.0, "+pi at creases 2, 6"),
    "fold limit, degree 8": ("degree8", "pi/12", 0.01, "-pi at creases 1, 5"),
    "axis": ("degree8", "pi/12", 100.0, "creases 3 and 7 on each other"),
}
"""Pinned states of the paper's panels: family, alpha_1, r_k, and words of their contact."""


def search(name: str) -> MinimaResult:
    family, alpha, ratio, _ = PINNED[name]
    return panel_result(getattr(o.examples, family)(alpha, ratio))


def minimum_of(name: str) -> JudgedState:
    (minimum,) = [
        m
        for m in search(name).minima
        if m.kind == "contact-pinned" and PINNED[name][3] in m.contacts[0].text
    ]
    return minimum


def state_of(name: str) -> tuple[PatternProblem, np.ndarray]:
    model = search(name).model
    return model, model.reduce(np.array(minimum_of(name).fold_angles))


def pinned(result: MinimaResult) -> list[np.ndarray]:
    return [
        result.model.reduce(np.array(m.fold_angles))
        for m in result.minima
        if m.kind == "contact-pinned"
    ]


def held(model: PatternProblem, x: np.ndarray) -> tuple[Contact, ...]:
    choices = State(model, x).pieces
    assert choices
    return choices[0]


@shared
def margin_of(name: str) -> LoadMargin:
    return load_margin(State(*state_of(name)))


def random_scene(n: int, symmetry: str, seed: int) -> o.Scene:
    """A random vertex with random springs, without symmetry or with a mirror (degree 6)."""
    rng = np.random.default_rng(seed)
    mirror = [0, 1, 2, 3, 2, 1] if symmetry == "D1" else list(range(n))
    half = rng.dirichlet(np.full(3, 4.0)) * math.pi
    sectors = rng.dirichlet(np.full(n, 4.0)) * 2 * math.pi
    if symmetry == "D1":
        sectors = np.r_[half, half[::-1]]
    rest = rng.uniform(-3.1, 3.1, n)[mirror]
    stiffness = np.exp(rng.normal(size=n))[mirror]
    return o.Scene(o.Vertex(tuple(sectors)), tuple(stiffness), tuple(rest), symmetry)


RANDOM = thinned([(4, "none", 6), (5, "none", 2), (6, "D1", 7), (6, "none", 1)], 4)
"""Degree, symmetry and seed of random scenes that have a pinned state."""


def test_loads_and_moments_are_inverse_and_keep_the_norm() -> None:
    model = search("axis").model
    load = np.random.default_rng(1).normal(size=model.size)
    moments = moments_of(model, load)
    root = np.sqrt(model.multiplicity)
    assert model.reduce(moments) * root / model.scale == pytest.approx(load)
    assert np.linalg.norm(moments) == pytest.approx(model.scale * np.linalg.norm(load))
    # energy U - m . phi, up to a constant
    rng = np.random.default_rng(2)
    x, y = rng.normal(size=(2, model.size))
    change = model.energy_change(x, y) - moments @ (model.expand(y) - model.expand(x))
    assert under_load(model, load).energy_change(x, y) == pytest.approx(change)


# ---------------------------------------------------------------- margins


@pytest.mark.slow  # seconds of curves or searches
@pytest.mark.parametrize("name", thinned(list(PINNED), 4))
def test_panel_margins_are_confirmed_beside_the_critical_load(name: str) -> None:
    margin = margin_of(name)
    assert margin.status == "exact" and margin.ends == "opens" and margin.checked
    assert margin.below is not None and margin.above is not None
    assert margin.below.closed and margin.below.multiplier > 0
    assert not margin.above.closed and margin.above.gap > 1e-5
    assert np.linalg.norm(margin.moments) == pytest.approx(margin.norm)
    for crease in margin.creases:  # no load on one orbit alone can be weaker than the worst load
        root = math.sqrt(len(crease.creases))
        for value, end in zip((crease.positive, crease.negative), crease.ends, strict=True):
            if end == "opens":
                assert value * root >= margin.norm * (1 - 1e-6)


@pytest.mark.parametrize(("n", "symmetry", "seed"), RANDOM)
def test_random_pinned_scenes_are_confirmed(n: int, symmetry: str, seed: int) -> None:
    result = o.find_minima(
        random_scene(n, symmetry, seed), max_starts=96, prove=False, escape=False
    )
    states = pinned(result)
    assert states
    margin = load_margin(State(result.model, states[0]))
    assert margin.status == "exact"
    if margin.ends == "opens":
        assert margin.checked, margin
        assert margin.symmetry == symmetry
    else:  # the load path ends before: the margin is a lower bound, and says so
        assert margin.ends in margin.reason and not margin.checked


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", thinned(["axis, pi/6", "creases on each other, stiff mountains"], 2)
)
def test_every_load_in_the_ball_is_borne(name: str) -> None:
    margin = margin_of(name)
    model, x = state_of(name)
    rows = held(model, x)
    rng = np.random.default_rng(5)
    for _ in range(6):
        d = rng.normal(size=model.size)
        d *= 0.98 * margin.norm / model.scale / np.linalg.norm(d)
        y = x
        for part in np.linspace(0.1, 1.0, 10):
            solved, mu = newton(under_load(model, part * d), y, rows)
            assert solved is not None and solved.converged and mu.min() > 0
            y = solved.x
        what = classify(State(under_load(model, d), y))
        assert what.verdict == "minimum" and what.kind == "contact-pinned"


@pytest.mark.slow  # seconds of curves or searches
def test_a_touching_state_bears_nothing_and_a_handle_everything() -> None:
    result = search("creases on each other")
    model = result.model
    rng = np.random.default_rng(6)
    kinds = []
    for m in result.minima:
        x = model.reduce(np.array(m.fold_angles))
        margin = load_margin(State(model, x), check=False)
        kinds.append((m.kind, margin.status))
        if margin.status == "unbounded":
            rows = held(model, x)
            local = model.local(x)
            root = np.sqrt(model.multiplicity)
            _, a = local.openings(rows)
            z = null_space(local.closure_jacobian / root)
            b = (a / root @ z).T
            span = b @ np.linalg.pinv(b)
            for _ in range(20):  # loads normal to the handle, far beyond any spring's moment
                c = z.T @ (local.gradient / root) + span @ rng.normal(size=z.shape[1]) * 100
                assert find_multipliers(b, span @ c).residual < 1e-8
    assert ("contact-touching", "zero") in kinds
    assert kinds.count(("degenerate", "unbounded")) == 2


@pytest.mark.slow  # a second look at what other tests of the room say
def test_margins_scale_with_the_stiffness() -> None:
    scene = search("fold limit").scene
    scaled = o.Scene(
        scene.vertex, tuple(1000 * k for k in scene.stiffness), scene.rest_angles, "D1", mirror=1
    )
    margin = load_margin(State(pose(scaled), state_of("fold limit")[1]), check=False)
    assert margin.norm == pytest.approx(1000 * margin_of("fold limit").norm, rel=1e-6)


# ---------------------------------------------------------------- cones of contact forces


def test_distance_to_the_boundary_of_a_cone() -> None:
    wedge = np.array([[1.0, 0.0], [0.0, 1.0]])
    found = distance_to_boundary(wedge, np.array([2.0, 3.0]))
    assert found is not None and found[0] == pytest.approx(2.0)
    assert found[1] == pytest.approx([1.0, 0.0])
    # redundant generators change nothing; a ray in one dimension
    more = np.column_stack([wedge, [1.0, 1.0], [3.0, 1.0]])
    again = distance_to_boundary(more, np.array([2.0, 3.0]))
    assert again is not None and again[0] == pytest.approx(2.0)
    ray = distance_to_boundary(np.array([[0.0, 0.0], [2.0, 4.0]]), np.array([0.0, 5.0]))
    assert ray is not None and ray[0] == pytest.approx(5.0)
    # generators that span everything positively: nothing opens
    assert distance_to_boundary(np.array([[1.0, -1.0]]), np.array([0.3])) is None
    star = np.array([[1.0, -0.5, -0.5], [0.0, 1.0, -1.0]])
    assert distance_to_boundary(star, np.array([0.1, 0.1])) is None


def test_distance_in_a_cone_agrees_with_the_set_of_multipliers() -> None:
    rng = np.random.default_rng(7)
    for _ in range(10):
        b = np.abs(rng.normal(size=(3, 5)))
        c = b @ rng.uniform(0.2, 1.0, 5)
        found = distance_to_boundary(b, c)
        assert found is not None
        distance, normal = found
        assert find_multipliers(b, c - 0.999 * distance * normal).residual < 1e-9
        assert find_multipliers(b, c - 1.001 * distance * normal).residual > 1e-9
        for d in rng.normal(size=(20, 3)):  # no other direction leaves the cone earlier
            assert find_multipliers(b, c + 0.99 * distance * d / np.linalg.norm(d)).residual < 1e-9


@pytest.mark.slow  # a second look at what other tests of the room say
def test_a_margin_names_the_symmetry_that_its_loads_keep() -> None:
    """Loads that break it are more: of all loads the margin is smaller, so that it must not be said of them."""
    kept = margin_of("fold limit")
    problem, x = state_of("fold limit")
    scene = o.examples.degree6("5*pi/12", 100.0, symmetry="none")
    free = load_margin(State(o.pose(scene), problem.expand(x)), check=False)
    assert (kept.symmetry, free.symmetry) == ("D1", "none")
    assert kept.status == free.status == "exact" and free.norm < 0.9 * kept.norm
