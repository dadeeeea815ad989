"""The sum of the fold angles round a vertex has a sign: at least 2 pi less the area of the convex hull of its link."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

import origami_nlp as o
from origami_nlp.pattern_problem import PatternProblem, PopSigns
from tests.independent.links import closed, corners, crosses
from tests.patterns import downhill, wheel


def link(sectors, phi) -> np.ndarray:
    """Directions of the creases of a folded vertex, by matrices of scipy, [d, 3]."""
    turn, out = Rotation.identity(), []
    for sector, fold in zip(sectors, phi, strict=True):
        turn = turn * Rotation.from_rotvec([fold, 0.0, 0.0])
        out.append(turn.apply([1.0, 0.0, 0.0]))
        turn = turn * Rotation.from_rotvec([0.0, 0.0, sector])
    assert turn.magnitude() < 1e-7  # it closes
    return np.array(out)


def hull_area(points: np.ndarray) -> float:
    """Area of the convex hull of points in an open hemisphere: seen from its middle, hulls in the plane are hulls."""
    rows = np.column_stack([-points, np.ones(len(points))])
    found = linprog([0, 0, 0, -1], rows, np.zeros(len(points)), bounds=[(-1, 1)] * 3 + [(None, 1)])
    assert found.x[3] > 1e-6  # in an open hemisphere
    middle = found.x[:3] / np.linalg.norm(found.x[:3])
    frame = np.linalg.svd(middle[None])[2][1:]
    plane = (points @ frame.T) / (points @ middle)[:, None]
    try:
        ring = points[ConvexHull(plane).vertices]
    except QhullError:
        return 0.0  # all on one great circle
    angles = 0.0
    for before, at, after in zip(np.roll(ring, 1, 0), ring, np.roll(ring, -1, 0), strict=True):
        u, v = (x - (x @ at) * at for x in (before, after))
        angles += math.acos(np.clip(u @ v / np.linalg.norm(u) / np.linalg.norm(v), -1, 1))
    return angles - (len(ring) - 2) * math.pi


@pytest.mark.parametrize("degree", [4, pytest.param(6, marks=pytest.mark.slow)])
def test_the_sum_of_folds_is_bounded_by_the_hull_of_the_link(degree):
    """Random states that do not cross, and minima that touching facets hold: on both sides of the flat state."""
    rng = np.random.default_rng(degree)
    sides, touching = set(), 0
    for _ in range(5):
        sectors = rng.dirichlet(np.full(degree, 4.0)) * 2 * math.pi
        pattern = wheel(sectors)
        pattern = pattern.with_springs(
            rng.uniform(0.2, 2, degree).tolist(), rng.uniform(-3, 3, degree).tolist()
        )
        problem = PatternProblem(pattern)
        for _ in range(4):
            phi, residual = problem.project(rng.uniform(-1.5, 1.5, degree))
            inside = (
                residual < 1e-12
                and np.abs(phi).max() <= math.pi
                and problem.closure.lifts_to_one(phi)
            )
            if not inside or problem.crossings.find(phi) or np.abs(phi).max() < 1e-3:
                continue
            held = downhill(problem, phi).phi
            touching += bool(np.abs(held).max() > math.pi - 1e-9)
            for state in (phi, held):
                if np.abs(state).max() < 1e-3:
                    continue
                around = list(pattern.vertices[0].creases)
                # azimuths of creases follow the sectors: sector k lies after crease k
                bound = 2 * math.pi - hull_area(link(np.roll(sectors, -around[0]), state[around]))
                assert bound > 0
                assert abs(state.sum()) >= bound - 1e-7
                sides.add(math.copysign(1.0, state.sum()))
    assert sides == {1.0, -1.0} and (touching or degree == 4)


def _embedded(rng, degree, paper=2 * math.pi):
    """A random closed state of a random vertex whose link does not cross itself."""
    for _ in range(200):
        sectors = rng.dirichlet(np.full(degree, rng.uniform(0.8, 6.0))) * paper
        if (
            sectors.max() >= math.pi - 0.01
        ):  # the link is seen from the middle of an open hemisphere
            continue
        phi = closed(sectors, rng.uniform(-1, 1, degree) * rng.uniform(0.05, 3.0))
        if phi is not None and np.abs(phi).max() > 1e-4 and not crosses(corners(sectors, phi)[0]):
            return sectors, phi
    raise AssertionError("no embedded state")


@pytest.mark.parametrize("many", [300, pytest.param(10_000, marks=pytest.mark.slow)])
def test_random_embedded_vertices_have_a_sign(many):
    """Degree 4 to 9, closed and looked at by code of its own: the sum is above 2 pi less the area of the hull."""
    rng, least, sides = np.random.default_rng(many), math.inf, set()
    for k in range(many):
        sectors, phi = _embedded(rng, 4 + k % 6)
        bound = 2 * math.pi - hull_area(corners(sectors, phi)[0])
        assert bound > 0
        assert abs(phi.sum()) >= bound - 1e-9
        least = min(least, abs(phi.sum()) / np.abs(phi).max())
        sides.add(math.copysign(1.0, phi.sum()))
    assert sides == {1.0, -1.0} and least > 0


def test_with_less_paper_a_vertex_never_pops():
    """On a cone the sum is at least sqrt(4 pi^2 - L^2): it has one sign for the convex side."""
    rng = np.random.default_rng(0)
    for k in range(60):
        sectors, phi = _embedded(rng, 4 + k % 4, paper=5.5)
        assert abs(phi.sum()) >= math.sqrt(4 * math.pi**2 - sectors.sum() ** 2) - 1e-9


def test_hypotheses_are_needed():
    """More paper: a saddle whose folds sum to 0; facets that cross: with 360 degrees sums come as near to 0."""
    sectors = np.full(4, math.radians(103.3))
    phi = closed(sectors, np.array([-0.9, 0.9, -0.9, 0.9]))
    assert phi is not None and abs(phi.sum()) < 1e-9 and np.abs(phi).min() > 0.5
    assert not crosses(corners(sectors, phi)[0])
    rng, sums = np.random.default_rng(1), []
    for _ in range(700):
        sectors = rng.dirichlet(np.full(6, 4.0)) * 2 * math.pi
        phi = closed(sectors, rng.uniform(-3, 3, 6))
        if phi is not None and np.abs(phi).max() > 1 and crosses(corners(sectors, phi)[0]):
            sums.append(phi.sum())
    assert min(map(abs, sums)) < 0.05


def test_a_path_through_crossing_states_raises_an_alarm():
    """From one side of a vertex to the other past a state that is not flat; through the flat state there is none."""
    pattern = wheel(np.full(6, math.pi / 3))
    signs = PopSigns(pattern)
    up = np.array([1.0, -0.5, 1.0, -0.5, 1.0, -0.5])
    through = np.linspace(-1, 1, 12)[:, None] * up
    assert not signs.crossed(through)
    aside = through + np.array([0.5, -0.5, 0, 0, 0, 0])
    assert [vertex for vertex, _ in signs.crossed(aside)] == [signs.vertices[0]]
    assert not signs.alarms(through)


def test_load_paths_are_looked_at(monkeypatch):
    sheet = o.examples.pattern("miura", 2, 2).with_springs(0.01, 1.2)
    (leg,) = o.load_path(sheet, 2, to=0.002).legs
    states = [np.array(p.fold_angles) for p in leg.points]
    looked = []
    monkeypatch.setattr(PopSigns, "alarms", lambda _, path: looked.append(path) or ["crosses"])
    assert o.load_path(sheet, 2, to=0.002).alarms == ("leg 1: crosses",)
    assert np.array_equal(looked[0], states)
