"""Closure, poses and crossings of patterns, against differences, trees of creases, and a library of collisions."""

import numpy as np
import pytest

from origami_nlp.sheets import Closure, Crossings, Sheet, list_branches
from tests.sheets.patterns import metasheet, miura, miura_angles, strip

HOLE = ((1, 2), (1, 3), (2, 2), (2, 3))


@pytest.mark.parametrize("pattern", [miura(3, 3), miura(5, 5, without=HOLE), strip(1)], ids=repr)
def test_derivatives_against_differences(pattern):
    closure, rng = Closure(pattern), np.random.default_rng(1)
    phi = rng.uniform(-1, 1, pattern.creases)
    multipliers = rng.normal(size=closure.count)
    hessian = closure.hessian(phi, multipliers)
    j = closure.jacobian(phi)
    step = 1e-6
    for i in rng.integers(0, pattern.creases, 6):
        e = np.zeros(pattern.creases)
        e[i] = step
        slope = (closure.values(phi + e) - closure.values(phi - e)) / (2 * step)
        assert j[:, [i]] @ np.ones(1) == pytest.approx(slope, abs=1e-9)
        bent = (closure.jacobian(phi + e) - closure.jacobian(phi - e)).T @ multipliers / (2 * step)
        assert hessian[:, [i]] @ np.ones(1) == pytest.approx(bent, abs=1e-8)


@pytest.mark.parametrize("size", [2, 4, 8, 16])
def test_miura_folds_by_its_law(size):
    """tan(h/2) = cos gamma tan(z/2) closes every vertex, and facets meet at creases outside the tree of poses."""
    pattern = miura(size, size)
    for zigzag in (0.4, -1.2, 2.9):
        phi = miura_angles(pattern, size, zigzag)
        assert np.abs(Closure(pattern).values(phi)).max() < 1e-14
        assert Crossings(pattern).poses.apart(phi) < 1e-12
        assert Crossings(pattern).find(phi) == []


@pytest.mark.parametrize("size", [2, 4, 8, 16])
def test_ranks_and_redundant_rows(size):
    """Two conditions a vertex at the flat state; (m - 2)(n - 2) redundant rows at a folded one."""
    pattern = miura(size, size)
    sheet, rows = Sheet(pattern), 3 * (size - 1) ** 2
    assert (pattern.creases, sheet.closure.count) == (2 * size * (size - 1), rows)
    assert sheet.rank(np.zeros(pattern.creases)) == 2 * (size - 1) ** 2
    rank = sheet.rank(miura_angles(pattern, size, 1.2))
    assert pattern.creases - rank == 1
    assert rows - rank == (size - 2) ** 2


def test_a_hole_needs_equations_of_its_own():
    """Miura 5 x 5 less 2 x 2 facets: seven freedoms at vertices alone, two with the hole."""
    pattern = miura(5, 5, without=HOLE)
    sheet = Sheet(pattern)
    phi = miura_angles(pattern, 5, 1.2)
    assert sheet.residual(phi) < 1e-13
    at_vertices = 3 * len(pattern.vertices)
    j = sheet.closure.jacobian(phi)[:at_vertices]
    j = j if isinstance(j, np.ndarray) else j.toarray()
    assert pattern.creases - np.linalg.matrix_rank(j, 1e-7) == 7
    assert pattern.creases - sheet.rank(phi) == 2


def test_metasheet_has_one_freedom():
    for size, redundant in ((3, 1), (4, 4)):
        pattern, _ = metasheet(size)
        sheet = Sheet(pattern)
        line = list_branches(pattern).lines[0]
        phi, residual = sheet.project(line / np.abs(line).max())
        assert residual < 1e-12
        assert sheet.rank(np.zeros(pattern.creases)) == 2 * len(pattern.vertices)
        assert pattern.creases - sheet.rank(phi) == 1
        assert sheet.closure.count - sheet.rank(phi) == redundant


def _triangles(corners: np.ndarray) -> np.ndarray:
    return np.array([[0, i, i + 1] for i in range(1, len(corners) - 1)])


@pytest.mark.parametrize("states", [48, pytest.param(1000, marks=pytest.mark.slow)])
def test_crossings_against_a_collision_library(states):
    """States of six patterns: the same pairs as FCL, but for those that only touch."""
    fcl = pytest.importorskip("fcl")
    patterns = [
        miura(3, 3),
        miura(4, 4),
        strip(2, 4, 4),
        metasheet(3)[0],
        metasheet(4)[0],
        strip(5),
    ]
    rng, crossed = np.random.default_rng(0), 0
    for k in range(states):
        pattern = patterns[k % 6]
        sheet = Sheet(pattern)
        crossings = sheet.crossings
        phi, residual = sheet.project(rng.uniform(-2, 2, pattern.creases))
        if residual > 1e-12:
            phi = rng.uniform(-2, 2, pattern.creases)  # poses along the tree: facets all the same
        ours = set(crossings.find(phi))
        x = crossings.placed(phi)
        shared = {
            frozenset(p) for p in zip(pattern.left.tolist(), pattern.right.tolist(), strict=True)
        }
        bodies = []
        for corners in x:
            # shrunk a little: facets that share a corner do not collide there
            inside = corners.mean(axis=0) + (1 - 1e-6) * (corners - corners.mean(axis=0))
            mesh = fcl.BVHModel()
            mesh.beginModel(len(inside), len(inside) - 2)
            mesh.addSubModel(inside, _triangles(inside))
            mesh.endModel()
            bodies.append(fcl.CollisionObject(mesh))
        theirs = set()
        for i in range(len(bodies)):
            for j in range(i + 1, len(bodies)):
                if frozenset((i, j)) in shared:
                    continue
                if fcl.collide(bodies[i], bodies[j], fcl.CollisionRequest(), fcl.CollisionResult()):
                    theirs.add((i, j))
        assert all(_depth(x[i], x[j]) < 1e-8 for i, j in theirs - ours)  # they touch
        assert all(
            _depth(x[i], x[j]) < 1e-4 for i, j in ours - theirs
        )  # shallow: shrinking parts them
        crossed += len(theirs)
    assert crossed > states // 2


def _depth(a: np.ndarray, b: np.ndarray) -> float:
    """How far two plane polygons reach through each other's planes, at most."""
    depth = np.inf
    for one, other in ((a, b), (b, a)):
        normal = np.cross(other[1] - other[0], other[2] - other[0])
        h = (one - other[0]) @ (normal / np.linalg.norm(normal))
        depth = min(depth, max(h.max(), 0), max(-h.min(), 0))
    return depth
