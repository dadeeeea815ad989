"""Waitukaitis' metasheets: every vertex is stable, and of the sheet's states those are left that do not cross.

A second way throughout: fold angles of one vertex by spherical trigonometry, repeated over the sheet; crossings by the
Flexible Collision Library on facets placed by rotation matrices; the state that is none in 50 digits.
"""

import mpmath
import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import find_states, judge
from tests.independent.trigonometry import sectors
from tests.patterns import QUAD, metasheet

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


class FiftyDigits:
    """The vertex by products of rotation matrices, sides from the corners of the quadrilateral."""

    def __init__(self):
        x = [[mpmath.mpf(str(c)) for c in corner] for corner in QUAD]
        side = [[b - a for a, b in zip(x[i], x[(i + 1) % 4], strict=True)] for i in range(4)]
        outward = [side[2], [-c for c in side[1]], side[0], [-c for c in side[3]]]
        self.axes = [[c / mpmath.hypot(*s) for c in s] for s in outward]
        self.k = [mpmath.mpf(str(STIFFNESS[c])) for c in AROUND]
        self.rest = [mpmath.mpf(str(REST[c])) for c in AROUND]

    def turns(self, folds):
        """Rotations up to each crease."""
        out = [mpmath.eye(3)]
        for (x, y), f in zip(self.axes, folds, strict=True):
            c, s = mpmath.cos(f), mpmath.sin(f)
            turn = [
                [c + (1 - c) * x * x, (1 - c) * x * y, s * y],
                [(1 - c) * x * y, c + (1 - c) * y * y, -s * x],
                [-s * y, s * x, c],
            ]
            out.append(out[-1] * mpmath.matrix(turn))
        return out

    def open(self, *folds):
        r = self.turns(folds)[-1]
        return [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]

    def slopes(self, folds):
        """Of the rotation vector that is left over, at a closed state: axes where turns have brought them."""
        turns = self.turns(folds)
        on = [turns[i] * mpmath.matrix([*self.axes[i], 0]) for i in range(4)]
        return [[on[i][r] for i in range(4)] for r in range(3)]

    def stationary(self, *x):
        """Closure and the balance of torques, of four fold angles and three multipliers."""
        folds, lam = x[:4], mpmath.matrix([x[4:]])
        pull = lam * mpmath.matrix(self.slopes(folds))
        spring = zip(self.k, folds, self.rest, pull, strict=True)
        return [*self.open(*folds), *(k * (f - r) - p for k, f, r, p in spring)]

    def solve(self, start):
        """Stationary fold angles near a start."""
        torque = [k * (f - r) for k, f, r in zip(self.k, start, self.rest, strict=True)]
        lam = mpmath.lu_solve(mpmath.matrix(self.slopes(start)).T, mpmath.matrix(torque))
        return list(mpmath.findroot(self.stationary, [*start, *lam], tol=1e-90))[:4]

    def half(self, folds):
        """Real part of the product of quaternions: 1 or -1 where the vertex closes."""
        q, v = mpmath.mpf(1), mpmath.matrix([0, 0, 0])
        for (x, y), f in zip(self.axes, folds, strict=True):
            c, s = mpmath.cos(f / 2), mpmath.sin(f / 2)
            a = mpmath.matrix([s * x, s * y, 0])
            q, v = (
                q * c - (v.T * a)[0],
                q * a + c * v + mpmath.matrix(self.cross(v, a)),
            )
        return q

    @staticmethod
    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    def passing(self, folds):
        """Facets opposite to each other whose arcs on a sphere round the vertex cross."""
        turns = self.turns(folds)
        on = [turns[i] * mpmath.matrix([*self.axes[i], 0]) for i in range(4)]

        def side(a, b, c):
            return mpmath.sign((mpmath.matrix(self.cross(a, b)).T * c)[0])

        found = []
        for i in (0, 1):
            a, b, c, d = on[i], on[i + 1], on[i + 2], on[(i + 3) % 4]
            apart = side(a, b, c) != side(a, b, d) and side(c, d, a) != side(c, d, b)
            # arcs shorter than pi meet where their great circles do, on this side of the sphere
            if apart and side(a, b, c) == side(c, d, b):
                found.append(i)
        return found


@pytest.mark.parametrize(
    ("start", "energy", "problem"),
    [
        ((1.719, -0.133, 1.686, 0.126), "2.8338871869", 1),
        ((-3.088, 1.067, -2.798, -1.008), "7.0589350612", 1),
        ((-0.329, 1.410, 0.325, 1.327), "2.0598859732", 1),
        ((2.980, 1.688, -2.766, -1.578), "0.1563274441", -1),
    ],
)
def test_three_of_four_closed_stationary_vertices_are_paper(start, energy, problem):
    """In 50 digits: the one of least energy closes with q = -1, and two of its facets intersect."""
    with mpmath.workdps(50):
        vertex = FiftyDigits()
        folds = vertex.solve(start)
        assert max(abs(x) for x in vertex.open(*folds)) < mpmath.mpf("1e-45")
        assert max(abs(f - s) for f, s in zip(folds, start, strict=True)) < 1e-3
        total = sum(
            k * (f - r) ** 2 / 2 for k, f, r in zip(vertex.k, folds, vertex.rest, strict=True)
        )
        assert abs(3 * total - mpmath.mpf(energy)) < mpmath.mpf("6e-11")
        assert abs(vertex.half(folds) - problem) < mpmath.mpf("1e-45")
        assert bool(vertex.passing(folds)) == (problem < 0)
    pattern, classes = sprung(3)
    state = judge(
        PatternProblem(pattern), np.array([float(folds[AROUND.index(c)]) for c in classes]), False
    )
    assert state.verdict == ("minimum" if problem > 0 else "not admissible")
