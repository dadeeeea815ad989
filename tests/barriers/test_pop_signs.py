"""The sum of the fold angles round a vertex has a sign: at least 2 pi less the area of the convex hull of its link."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

from tests.independent.links import closed, corners, crosses


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


@pytest.mark.parametrize("many", [100, pytest.param(10_000, marks=pytest.mark.slow)])
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
