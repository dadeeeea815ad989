"""Load paths through contact of facets: against spherical trigonometry, rotation matrices, and the work of the load."""

import math
import re
from functools import cache
from itertools import combinations, pairwise, product

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import origami_nlp as o
from origami_nlp.numerics import STATIONARY
from origami_nlp.pattern_problem import PatternProblem, Torque
from origami_nlp.pattern_states import judge
from tests.independent.rigid import Rigid, collide
from tests.independent.trigonometry import quadrilateral
from tests.paths.test_sheet_loads import work_of
from tests.patterns import QUAD, downhill, metasheet

FIRST_TOUCH = -2.0762838873
"""Angle of class 2 at which facets of the metasheet of 3 x 3 meet: a prototype's bisection, ten digits."""


class Turned(Rigid):
    """Facets by rotation matrices, closed where every crease is folded by its angle, those off the tree too."""

    def open(self, phi):
        p, motions = self.p, self.place(phi)
        miss = []
        for c, (left, right) in enumerate(zip(p.left, p.right, strict=True)):
            a, b = p.corners[p.ends[c]]
            axis = (b - a) / np.linalg.norm(b - a)
            turn = Rotation.from_rotvec((phi[c] - p.reference[c]) * axis).as_matrix()
            step = np.vstack([np.column_stack([turn, a - turn @ a]), [0, 0, 0, 1]])
            miss.append((motions[left] - motions[right] @ step)[:3])
        return np.array(miss).ravel()

    def crossing(self, phi):
        """Pairs of facets that the collision library finds in each other when all are a little smaller.

        Not those on both sides of a crease folded by a half turn: they lie on each other, and rounding decides.
        """
        x = [q + 1e-6 * (q.mean(axis=0) - q) for q in self.polygons(phi)]
        p, at_limit = self.p, np.abs(phi) == math.pi
        stacked = {
            tuple(sorted(pair)) for pair in zip(p.left[at_limit], p.right[at_limit], strict=True)
        }
        pairs = (pair for pair in combinations(range(len(x)), 2) if pair not in stacked)
        return [pair for pair in pairs if collide(*(x[k] for k in pair))]


# ---------------------------------------------------------------- one degree of freedom, in closed form


def classes_at(driven):
    """Fold angles of the classes of the metasheet, [4], over that of class 2."""
    q = np.array(QUAD)
    inner = []
    for i in range(4):
        u, v = q[i - 1] - q[i], q[(i + 1) % 4] - q[i]
        inner.append(math.acos(u @ v / np.linalg.norm(u) / np.linalg.norm(v)))
    # a vertex has all corners of the quadrilateral: its creases are of classes 2, 1, 0, 3
    others = quadrilateral((inner[2], inner[1], inner[0], inner[3]), driven, dart=False)
    return np.array([others[1], others[0], driven, others[2]])


@cache
def driven_sheet():
    """A metasheet whose springs are at rest at -1.5, a class for each crease, and the state there."""
    pattern, classes = metasheet(3)
    rest = classes_at(-1.5)[classes]
    pattern = pattern.with_springs(1.0, list(rest))
    problem = PatternProblem(pattern)
    phi, residual = problem.project(rest)
    assert residual < 1e-13 and np.abs(phi - rest).max() < 1e-12  # trigonometry closes the sheet
    return pattern, classes, judge(problem, phi)


def over_driven(pattern, classes, driven, h=1e-4):
    """Fold angles, and their derivative by the driven angle: differences of fourth order."""
    a, b, c, d = (classes_at(driven + k * h)[classes] for k in (-2, -1, 1, 2))
    return classes_at(driven)[classes], (a - 8 * b + 8 * c - d) / (12 * h)


def meetings(rigid, phi, pairs, room=0.0):
    """Signed distances of features of facets that face each other inside: two sides, a corner and a face."""
    x, found = rigid.polygons(phi), {}
    for i, j in pairs:
        for a, b in product(range(len(x[i])), range(len(x[j]))):
            p, q, r, s = x[i][a - 1], x[i][a], x[j][b - 1], x[j][b]
            n = np.cross(q - p, s - r)
            share = np.linalg.lstsq(np.column_stack([q - p, r - s]), r - p, rcond=None)[0]
            if ((share > room) & (share < 1 - room)).all():
                found["edge-edge", i, j, a, b] = float((r - p) @ n / np.linalg.norm(n))
        for one, other in ((i, j), (j, i)):
            ring = x[other]
            n = np.cross(ring[1] - ring[0], ring[2] - ring[0])
            n /= np.linalg.norm(n)
            sides = ring - np.roll(ring, 1, axis=0)
            for a, corner in enumerate(x[one]):
                inward = np.cross(n, sides) @ corner - np.einsum(
                    "ki,ki->k", np.cross(n, sides), ring
                )
                if inward.min() > room or inward.max() < -room:
                    found["vertex-face", one, other, a] = float((corner - ring[0]) @ n)
    return found


def apart(pattern):
    """Pairs of facets that share no corner."""
    rings = [set(q) for q in pattern.polygons]
    return [(i, j) for j in range(len(rings)) for i in range(j) if not rings[i] & rings[j]]


def first_meeting(rigid, classes):
    """Where features of two facets meet first as the driven angle grows in size, and which, by brute force."""
    pairs = apart(rigid.p)

    def distance(driven, key):
        phi = classes_at(driven)[classes]
        return meetings(rigid, phi, [tuple(sorted(key[1:3]))], -math.inf)[key]

    grid = np.linspace(-1.9, -2.2, 7)
    known = [meetings(rigid, classes_at(t)[classes], pairs, 0.01) for t in grid]
    met = [
        (brentq(distance, grid[k], grid[k + 1], args=(key,), xtol=1e-14), key)
        for k in range(len(grid) - 1)
        for key in known[k].keys() & known[k + 1].keys()
        if known[k][key] * known[k + 1][key] < 0
    ]
    return max(met)


def named(pattern, key):
    """Sides that meet, with their facets, in words."""
    out = []
    for facet, end in ((key[1], key[3]), (key[2], key[4])):
        (ring,) = [q for q, f in zip(pattern.polygons, pattern.facet_of, strict=True) if f == facet]
        out.append(f"side {ring[end - 1] + 1}-{ring[end] + 1} of facet {facet + 1}")
    return " on ".join(out)


def sides_of(words):
    """Ends and facet of either side, whichever comes first."""
    sides = re.findall(r"side (\d+)-(\d+) of facet (\d+)", words)
    return {(frozenset(ends), facet) for *ends, facet in sides}


@cache
def pressed_path(steps=None):
    """The metasheet under a torque on a crease of class 2, until facets push, and back."""
    pattern, classes, start = driven_sheet()
    i = int(np.flatnonzero(classes == 2)[0])
    return i, o.load_path(pattern, i + 1, state=start, to=-30.0, unload=True, options=steps)


def test_a_metasheet_touches_under_a_torque_where_trigonometry_says():
    pattern, classes, _ = driven_sheet()
    rigid = Turned(pattern)
    touch, key = first_meeting(rigid, classes)
    facets = tuple(sorted(key[1:3]))
    assert touch == pytest.approx(FIRST_TOUCH, abs=2e-10)
    i, path = pressed_path()
    (event,) = path.events  # met twice, and one
    assert event.type == "leaves" and not path.alarms  # as the load grows, from -30 on
    phi, slope = over_driven(pattern, classes, touch)
    load = float((phi - pattern.rest) @ slope / slope[i])  # all stiffnesses are 1
    assert event.located and abs(event.residuals.event) <= STATIONARY
    assert event.residuals.kkt <= STATIONARY
    assert sides_of(event.contact) == sides_of(named(pattern, key))
    assert event.t == pytest.approx(load, abs=1e-9)
    assert np.array(event.fold_angles) == pytest.approx(phi, abs=1e-10)
    # beyond it nothing moves, and the force takes what the load adds: F gap' = dE - t dphi_i
    h = 1e-4
    gap = [abs(meetings(rigid, classes_at(touch + k * h)[classes], [facets])[key]) for k in (1, 2)]
    gap_slope = (4 * gap[0] - gap[1]) / (2 * h)  # on the open side, where the distance is the gap
    pushed = 0
    for branch in path.branches:
        for p in branch.points:
            if p.multipliers:
                (force,) = p.multipliers
                want = (load - p.t) * slope[i] / gap_slope
                assert force.multiplier == pytest.approx(want, rel=1e-6, abs=1e-9)
                assert np.array(p.fold_angles) == pytest.approx(phi, abs=1e-10)
                pushed += 1
    assert pushed > 4
    assert [leg.why for leg in path.legs] == ["range", "range"]
    assert path.legs[1].points[-1].fold_angles == pytest.approx(pattern.rest, abs=1e-9)


# ---------------------------------------------------------------- several degrees of freedom


BEGUN = {
    3: "2.1 0.2 -0.3 1.1 0.4 0.2 0.6 -0.7 1.4 0.9 -1.1 0.1 -0.1 -0.8 0.9 -1.3 1.6 0.8 -0.2 0.2 0.7",
    6: "-1.7 -0.2 0.6 0.5 0.2 -0.1 0.4 -0.3 0.0 1.1 0.3 0.2 0.2 -0.0 0.3 1.0 -0.2 1.3 0.8 -0.4 1.1",
    12: "2.0 0.9 -0.0 -0.3 -0.0 0.7 2.1 -1.4 0.1 0.6 -0.6 0.9 0.5 0.5 0.9 -1.2 0.8 -0.0 0.0 1.5 -0.8",
    39: "-1.0 -0.5 2.0 0.6 0.8 0.5 0.3 -0.3 -0.1 1.0 -0.2 -0.3 0.4 0.2 1.3 0.7 0.1 0.8 0.0 0.2 0.5",
    41: "0.4 0.5 0.2 -0.0 -0.9 0.1 0.6 -1.6 -0.1 0.1 -2.0 -0.6 0.6 -1.8 -0.1 -0.9 0.0 -0.0 -0.2 -0.1 -1.0",
}
"""Fold angles [rad] from which descents lead to the states to load, of seeds whose random starts may lead to others."""


@cache
def sprung(seed, name="yoshimura", size=(3, 3)):
    """A pattern with random springs, a stable state of it, and a crease to load."""
    rng = np.random.default_rng(seed)
    pattern = o.examples.pattern(name, *size)
    k, rest = rng.uniform(0.3, 2, pattern.creases), rng.uniform(-2.5, 2.5, pattern.creases)
    pattern = pattern.with_springs(list(k), list(rest))
    problem = PatternProblem(pattern)
    start = 0.3 * rng.normal(size=pattern.creases)
    if seed in BEGUN:
        start = np.array(BEGUN[seed].split(), float)
    phi, _ = problem.project(start)
    return (
        pattern,
        judge(problem, downhill(problem, phi).phi),
        int(rng.integers(pattern.creases)) + 1,
    )


@cache
def loaded(seed, to, unload=False, **more):
    pattern, start, crease = sprung(seed)
    return o.load_path(pattern, crease, state=start, to=to, unload=unload, **more)


def pushes(point):
    return [m for m in point.multipliers if "facet" in m.text]


def test_springs_take_up_the_work_of_the_load_in_contact():
    path = loaded(35, 1.2)
    (leg,) = path.legs
    events = [e.t for e in path.events]
    for a, b in pairwise((leg.points[0].t, *events, leg.points[-1].t)):
        part = [p for p in leg.points if a - 1e-12 <= p.t <= b + 1e-12]
        assert len({p.t for p in part}) > 2
        gained = part[-1].energy - part[0].energy
        assert gained == pytest.approx(work_of(part), rel=1e-2, abs=1e-4)


def test_a_snap_lands_in_contact_and_goes_on():
    pattern, start, _ = sprung(3)
    assert [c.type for c in start.contacts] == ["vertex-face"]
    path = loaded(3, 3.6)
    (snap,) = path.snaps
    assert snap.type == "fold" and snap.kind == "contact-pinned" and not path.alarms
    assert [leg.why for leg in path.legs] == ["snap", "range"]
    rigid = Turned(pattern)
    beyond = [p for p in path.legs[1].points if p.t > snap.t]
    assert beyond and all(pushes(p)[0].multiplier > 0 for p in beyond)
    for phi in (snap.before, snap.after, beyond[-1].fold_angles):
        assert not rigid.crossing(np.array(phi))


def by_small_steps(seed, to, count=60):
    """The state at a load, by descents at loads that grow little by little."""
    pattern, start, crease = sprung(seed)
    problem, phi = PatternProblem(pattern), start.phi
    for t in np.linspace(0.0, to, count)[1:]:
        end = downhill(problem.under(Torque(pattern, (crease,)), t), phi)
        assert end.arrived
        phi = end.phi
    return phi


def test_a_corner_slips_off_a_facet_where_it_comes_to_the_border():
    pattern, _, _ = sprung(46)
    path = loaded(46, 2.0)
    (event,), (snap,) = path.events, path.snaps
    assert event.type == snap.type == "slides" and event.located and not path.alarms
    assert [leg.why for leg in path.legs] == ["snap", "range"] and snap.released > 0
    # the corner lies on a side of the facet, by rotation matrices, and is pressed onto it
    rigid, phi = Turned(pattern), np.array(event.fold_angles)
    corner, facet = (
        int(x) - 1 for x in re.match(r"corner (\d+) .* on facet (\d+)", event.contact).groups()
    )
    x = rigid.polygons(phi)
    at = next(x[f][list(q).index(corner)] for f, q in enumerate(pattern.polygons) if corner in q)
    n = np.cross(x[facet][1] - x[facet][0], x[facet][2] - x[facet][0])
    n /= np.linalg.norm(n)
    assert abs(n @ (at - x[facet][0])) < 1e-11
    sides = x[facet] - np.roll(x[facet], 1, axis=0)
    depth = [
        np.cross(n, u / np.linalg.norm(u)) @ (at - end)
        for u, end in zip(sides, x[facet], strict=True)
    ]
    assert min(depth, key=abs) == pytest.approx(0.0, abs=1e-11)
    assert all(d * np.sign(sum(depth)) > -1e-11 for d in depth)
    # the force is there up to the border, and facets do not cross on either side
    pushed = pushes(path.branches[0].points[-1])
    assert len(pushed) == 1 and pushed[0].multiplier > 0.1
    for p in (*path.legs[0].points, *path.legs[1].points):
        assert not rigid.crossing(np.array(p.fold_angles))
    assert by_small_steps(46, 2.0, 20) == pytest.approx(
        np.array(path.legs[-1].points[-1].fold_angles), abs=1e-9
    )
