"""Waitukaitis' metasheets: every vertex is stable, and of the sheet's states those are left that do not cross.

A second way throughout: fold angles of one vertex by spherical trigonometry, repeated over the sheet; crossings by the
Flexible Collision Library on facets placed by rotation matrices; the state that is none in 50 digits.
"""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import find_states, judge
from tests.independent.trigonometry import sectors
from tests.patterns import metasheet

STIFFNESS, REST = (0.005, 0.4627, 0.1299, 0.0321), (-2.163, 1.77, 2.755, 0.121)
"""Of creases along each side of the quadrilateral."""
AROUND = (2, 1, 0, 3)
"""Sides round a vertex, counter-clockwise."""
slow = pytest.mark.slow


def sprung(size):
    pattern, classes = metasheet(size)
    k, rest = np.array(STIFFNESS), np.array(REST)
    return pattern.with_springs(list(k[classes]), list(rest[classes])), classes


def vertex_sectors(pattern, classes):
    loop = pattern.vertices[0]
    ring = {
        int(classes[c]): next(int(x) for x in pattern.ends[c] if x != loop.vertex)
        for c in loop.creases
    }
    return sectors(pattern.corners[:, :2], loop.vertex, [ring[c] for c in AROUND])


def vertex_energy(folds):
    """Of one crease a side, folds in the order of sides."""
    return 0.5 * float(np.array(STIFFNESS) @ (np.array(folds) - np.array(REST)) ** 2)


@pytest.mark.slow  # a second look at what other tests of the room say
@pytest.mark.parametrize("size", [3, pytest.param(4, marks=slow), pytest.param(8, marks=slow)])
def test_without_contact_a_sheet_has_the_states_of_its_vertex(size):
    """All of them and no others; there are as many creases of each side: energies are multiples of the vertex's."""
    pytest.importorskip("fcl", reason="python-fcl, of the extra test")
    from tests.independent.rigid import Rigid

    pattern, classes = sprung(size)
    many = size * (size - 1) // 2
    assert (np.bincount(classes) == many).all()
    found = find_states(pattern, starts=2, contact=False, escape=False).minima
    scene = Scene(
        o.Vertex(vertex_sectors(pattern, classes)),
        symmetry="C1",
        contact="fold-limits",
        stiffness=[STIFFNESS[c] for c in AROUND],
        rest_angles=[REST[c] for c in AROUND],
    )
    vertex = o.find_minima(scene, escape=False).minima
    assert len(found) == len(vertex) == 3
    body, problem = Rigid(pattern), PatternProblem(pattern)
    for state, one in zip(found, vertex, strict=True):
        folds = np.array(one.fold_angles)[[AROUND.index(c) for c in range(4)]]
        assert state.energy == pytest.approx(many * vertex_energy(folds), rel=1e-12)
        assert state.phi == pytest.approx(folds[classes], abs=1e-9)
        assert (state.kind, state.dof) == ("interior", 1)
        # with contact facets must not cross: as many pairs do as another library finds
        crossed = judge(problem, state.phi)
        assert crossed.verdict == ("not admissible" if crossed.crossings else "minimum")
        collide = sorted((a + 1, b + 1) for a, b in body.collide(state.phi))
        assert sorted(crossed.crossings) == collide  # a judged state counts facets from 1
