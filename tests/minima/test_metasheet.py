"""Waitukaitis' metasheets: every vertex is stable, and of the sheet's states those are left that do not cross.

A second way throughout: fold angles of one vertex by spherical trigonometry, repeated over the sheet; crossings by the
Flexible Collision Library on facets placed by rotation matrices; the state that is none in 50 digits.
"""

import itertools
import math

import mpmath
import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import find_states, judge
from tests.independent.trigonometry import quadrilateral, sectors
from tests.patterns import QUAD, metasheet

STIFFNESS, REST = (0.005, 0.4627, 0.1299, 0.0321), (-2.163, 1.77, 2.755, 0.121)
"""Of creases along each side of the quadrilateral."""
AROUND = (2, 1, 0, 3)
"""Sides round a vertex, counter-clockwise."""
SAMPLES = 120
"""Of fold angles of a side, to either side of flat."""
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


class Curves:
    """States of a metasheet over the fold angle of one side, by spherical trigonometry alone."""

    def __init__(self, size):
        from tests.independent.rigid import Rigid

        self.pattern, self.classes = sprung(size)
        self.sectors = vertex_sectors(self.pattern, self.classes)
        self.body = Rigid(self.pattern)

    def at(self, fold, dart):
        """Fold angles [n] at a fold angle of the first of the sides; None where there are none."""
        folds = quadrilateral(self.sectors, fold, dart)
        if folds is None:
            return None
        of_side = dict(zip(AROUND, (fold, *folds), strict=True))
        return np.array([of_side[int(c)] for c in self.classes])

    def energy(self, phi):
        return float(0.5 * self.pattern.stiffness @ (phi - self.pattern.rest) ** 2)

    def open(self, fold, dart):
        phi = self.at(fold, dart)
        return phi is not None and not self.body.collide(phi)

    def survivors(self, samples):
        """Lowest states of every stretch without crossings, flat excepted: fold angle, dart, touching or not."""
        found = []
        for dart, sense in itertools.product((False, True), (1.0, -1.0)):
            folds = sense * np.linspace(0.0, math.pi, samples)[1:-1]
            here = [(t, self.at(t, dart)) for t in folds]
            here = [(t, phi, not self.body.collide(phi)) for t, phi in here if phi is not None]
            energy = [self.energy(phi) for _, phi, _ in here]
            for i in range(1, len(here) - 1):
                if not here[i][2]:
                    continue
                for j, k in ((i - 1, i + 1), (i + 1, i - 1)):
                    if not here[j][2] and energy[j] < energy[i] < energy[k]:
                        found.append((self.touch(here[i][0], here[j][0], dart), dart, True))
                if (
                    here[i - 1][2]
                    and here[i + 1][2]
                    and energy[i] < min(energy[i - 1], energy[i + 1])
                ):
                    found.append((here[i][0], dart, False))
        return found

    def touch(self, free, crossed, dart):
        """By halves."""
        for _ in range(50):
            middle = 0.5 * (free + crossed)
            free, crossed = (middle, crossed) if self.open(middle, dart) else (free, middle)
        return free


@slow
@pytest.mark.parametrize(
    ("size", "kinds"),
    [
        (3, ("interior", "interior")),
        (4, ("interior", "contact-pinned")),
        (8, ("contact-pinned", "contact-pinned")),
    ],
)
def test_with_contact_those_survive_that_a_scan_finds(size, kinds):
    """On the curves of the vertex, scanned for crossings by another library: the same states, free or touching."""
    pytest.importorskip("fcl", reason="python-fcl, of the extra test")
    curves = Curves(size)
    expected = sorted(
        (
            (curves.energy(curves.at(t, dart)), t, dart, held)
            for t, dart, held in curves.survivors(SAMPLES)
        )
    )
    found = find_states(curves.pattern, starts=2, escape=False).minima
    assert tuple(s.kind for s in found) == kinds
    assert len(expected) == len(found)
    for state, (energy, fold, dart, held) in zip(found, expected, strict=True):
        driven = curves.classes == AROUND[0]
        assert held == (state.kind == "contact-pinned")
        if not held:
            assert state.phi[driven] == pytest.approx(fold, abs=math.pi / SAMPLES)
            continue
        assert state.phi == pytest.approx(curves.at(fold, dart), abs=1e-6)
        assert state.energy == pytest.approx(energy, abs=1e-5)
        # what contacts carry: forces times the opening of their gaps are what the springs lose
        step, t = 1e-4, float(state.phi[driven][0])
        outward = -step * np.sign(t)  # back to where facets part
        ways = [curves.at(t + k * outward, dart) for k in (1, 2)]
        lost = (curves.energy(ways[1]) - curves.energy(ways[0])) / step
        opening = [
            (distance(curves, ways[1], c) - distance(curves, ways[0], c)) / step
            for c in state.contacts
        ]
        assert lost > 0 and min(opening) > 0
        work = sum(c.force * d for c, d in zip(state.contacts, opening, strict=True))
        assert work == pytest.approx(lost, rel=1e-3)


def distance(curves, phi, contact):
    """Of the two facets that touch: the least over their sides, brute force."""
    x = curves.body.polygons(phi)
    one, other = (x[f - 1] for f in contact.facets)
    best = math.inf
    for p, q in zip(one, np.roll(one, -1, axis=0), strict=True):
        for r, s in zip(other, np.roll(other, -1, axis=0), strict=True):
            m = np.column_stack([q - p, r - s])
            a, b = np.clip(np.linalg.lstsq(m, r - p, rcond=None)[0], 0, 1)
            best = min(best, float(np.linalg.norm(p + a * (q - p) - r - b * (s - r))))
    return best


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
