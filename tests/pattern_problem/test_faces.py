"""Facets that lie face to face: gaps against matrices and shapely, verdicts against the search for single vertices."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from origami_nlp import Scene, State, Vertex, check_admissible, classify
from origami_nlp.kkt import contact_forces, singular_beside
from origami_nlp.pattern_problem import (
    CoplanarContact,
    Faces,
    FoldedGeometry,
    PatternProblem,
    pose,
)
from origami_nlp.pattern_states import judge, list_flat_folded
from tests.patterns import grid, miura, miura_angles, wheel


def stacked(seed):
    """Go through states of a random vertex in which facets lie face to face: (its sectors, a sheet, fold angles)."""
    rng = np.random.default_rng(seed)
    n, unit = int(rng.integers(4, 8)), int(rng.choice([8, 10, 12]))
    parts = np.array([unit])
    while 2 * parts.max() >= unit:
        cuts = np.sort(rng.choice(np.arange(1, unit), n - 1, replace=False))
        parts = np.diff([0, *cuts, unit])
    sectors = parts * 2 * math.pi / unit
    problem, vertex = PatternProblem(wheel(sectors)), Vertex(tuple(sectors.tolist()))
    scene = Scene(vertex, (1.0,) * n, (0.0,) * n, "none", "full")
    states = list(list_flat_folded(pose(scene)).states)
    for _ in range(40):  # some of them with creases that are open
        phi, held = rng.uniform(-2.5, 2.5, n), rng.random(n) < 0.45
        phi[held] = rng.choice([-math.pi, math.pi, 0.0], held.sum(), p=[0.4, 0.4, 0.2])
        states.append(problem.project(phi, held)[0])
    for k in rng.permutation(len(states)):
        phi = states[k]
        good = problem.residual(phi) <= 1e-13 and problem.closure.lifts_to_one(phi) and phi.any()
        if not good or np.abs(phi).max() > math.pi or not check_admissible(vertex, phi).admissible:
            continue
        if (faces := Faces(problem, phi)).known or faces.open:
            yield sectors, problem, phi


def springs(problem, phi, rng):
    """Stiffnesses, and rest angles: any, or beside the state, or balanced by what pushes."""
    n, faces = problem.size, Faces(problem, phi)
    k, way = rng.uniform(0.3, 2, n), int(rng.integers(3))
    rest = np.where(np.abs(phi) > 3.1, rng.uniform(-math.pi, math.pi, n), phi)
    if way == 0:
        rest = phi + 0.5 * rng.normal(size=n)
    elif way == 1:
        at = FoldedGeometry(problem.crossings.poses, phi)
        rows = [t.row(at) for pair, above in faces.known for t in faces.touches(pair, above)]
        free = State(problem.with_contact(False), phi)
        limits = free.on(free.contacts.base).slopes
        torque = sum(rng.uniform() * (rng.random() < 0.7) * r for r in [*rows, *limits])
        rest = phi - torque / k
    return k, np.clip(rest, -math.pi, math.pi)


def compare(seed, many=8):
    """Judge states of a vertex by the search for single vertices and as states of a sheet: both verdicts."""
    rng, reported = np.random.default_rng(seed), []
    for sectors, bare, phi in itertools.islice(stacked(seed), many):
        k, rest = springs(bare, phi, rng)
        scene = Scene(
            Vertex(tuple(sectors.tolist())), tuple(k.tolist()), tuple(rest.tolist()), "none", "full"
        )
        one = classify(State(pose(scene), phi))
        problem = PatternProblem(bare.pattern.with_springs(list(k), list(rest)))
        two = judge(problem, phi)
        what = seed, sectors, phi, one.reason, two.certificate
        if one.verdict == "minimum":
            assert two.verdict in ("minimum", "undecided"), what
        elif one.verdict in ("saddle", "not stationary"):
            assert two.refuted or two.verdict == "undecided", what
        reported.append((one.verdict, two.verdict))
    return reported


def test_stacked_vertices_are_judged_as_their_own_search_says():
    reported = [both for seed in (1, 5, 10, 11) for both in compare(seed, 4)]
    assert {("minimum", "minimum"), ("not stationary", "not stationary")} <= set(reported)


def _miura():
    pattern = miura(3, 3)
    return pattern, math.pi * np.sign(miura_angles(pattern, 3, 1.0))


def _gap(problem, touch, angles):
    """The gap over the fold angles of its walk: matrices of rotations one after the other carry the second facet."""
    p = problem.pattern
    walk = problem.crossings.poses.path(*touch.facets)

    def carried(x):
        for (crease, sense), angle in reversed(list(zip(walk, angles, strict=True))):
            start, end = p.corners[p.ends[crease]]
            axis = (end - start) / np.linalg.norm(end - start)
            turn = Rotation.from_rotvec(sense * (angle - p.reference[crease]) * axis)
            x = start + turn.apply(x - start)
        return x

    a, b, c, d = touch.corners
    if touch.type == "edge-edge":
        r, s = carried(p.corners[c]), carried(p.corners[d])
        normal, off = np.cross(p.corners[b] - p.corners[a], s - r), r - p.corners[a]
    else:
        q = [p.corners[k] for k in (b, c, d)]
        x = np.array(touch.place) if isinstance(touch, CoplanarContact) else p.corners[a]
        normal, off = np.cross(q[1] - q[0], q[2] - q[0]), carried(x) - q[0]
    return touch.sign * float(off @ normal) / float(np.linalg.norm(normal))


@pytest.mark.parametrize("at_limit", ["flat", "partly"])
def test_gaps_at_corners_of_overlaps_by_matrices_and_shapely(at_limit):
    """Where they are, what they are beside the state, and their derivatives by differences along closed motions."""
    pytest.importorskip("fcl", reason="python-fcl, of the extra test: matrices are with it")
    from shapely import MultiPoint, Polygon

    from tests.independent.rigid import Rigid

    pattern, phi = _miura()
    if at_limit == "partly":
        _, bare, phi = next(s for s in stacked(7) if np.abs(s[2]).min() > 0.1)
        pattern = bare.pattern
    problem, body = PatternProblem(pattern), Rigid(pattern)
    faces, at = Faces(problem, phi), FoldedGeometry(problem.crossings.poses, phi)
    x, types = body.polygons(phi), set()
    rng = np.random.default_rng(0)
    assert faces.known
    for pair, above in faces.known:
        touches = faces.touches(pair, above)
        (g, f) = touches[0].facets
        normal = np.cross(x[g][1] - x[g][0], x[g][2] - x[g][0])
        u = (x[g][1] - x[g][0]) / np.linalg.norm(x[g][1] - x[g][0])
        v = np.cross(normal / np.linalg.norm(normal), u)
        flat = [np.column_stack([x[k] @ u, x[k] @ v]) for k in (g, f)]
        both = Polygon(flat[0]).intersection(Polygon(flat[1]))
        assert both.area > 1e-3
        places = []
        for t in touches:
            types.add(t.type)
            assert abs(t.gap(at)) < 1e-12
            q = t.points(at)
            if t.type == "edge-edge":
                sides = np.column_stack([q[1] - q[0], q[2] - q[3]])
                share = np.linalg.lstsq(sides, q[2] - q[0], rcond=None)[0]
                places.append(q[0] + share[0] * (q[1] - q[0]))
            else:
                places.append(q[0])
            creases, slopes = t.slopes(at)
            way, h = rng.normal(size=len(creases)), 1e-4
            gaps = [_gap(problem, t, phi[creases] + s * h * way) for s in (1, 0, -1)]
            assert gaps[1] == pytest.approx(0.0, abs=1e-13)
            assert slopes @ way == pytest.approx((gaps[0] - gaps[2]) / (2 * h), abs=1e-6)
            bent = (gaps[0] + gaps[2]) / h**2
            assert way @ t.bends(at) @ way == pytest.approx(bent, abs=1e-5)
        hull = MultiPoint(
            [(y @ u, y @ v) for y in _moved(problem, body, phi, g, places)]
        ).convex_hull
        assert hull.symmetric_difference(both).area < 1e-9
    assert "face-face" in types


def _moved(problem, body, phi, facet, places):
    """Points in space as the other way to place facets puts them: both agree on one facet."""
    at, motion = FoldedGeometry(problem.crossings.poses, phi), body.place(phi)[facet]
    back = (np.array(places) - at.shift[facet]) @ at.turn[facet]
    return back @ motion[:3, :3].T + motion[:3, 3]


def _rolled(rest):
    """A strip of three facets rolled up, the last and shorter one inside or outside of the first."""
    x = np.array([0.0, 1.0, 2.0, 2.6])
    pattern = grid(np.stack(np.meshgrid(x, [0.0, 1.0], indexing="ij"), axis=2))
    return PatternProblem(pattern.with_springs(1.0, rest))


def test_pairs_that_may_lie_either_way_do_so_on_two_pieces():
    problem = _rolled([3.0, 3.0])
    phi = np.array([math.pi, math.pi])
    faces = Faces(problem, phi)
    assert not faces.known and len(faces.open) == 1
    (pair,) = faces.open
    one, two = (faces.touches(pair, up) for up in (False, True))
    assert [t.sign for t in one] == [-t.sign for t in two] and len(one) == 4
    assert faces.follow({pair: True}) == {pair: True}
    # both springs open: whichever is inside, the other may go
    assert judge(problem, phi).refuted


def test_what_is_beside_a_flat_folded_state_is_not_told_from_it():
    """Anything that obeys closure to first order closes there to the square of its distance: no state to speak of."""
    phi = math.pi * np.array([1.0, -1.0, -1.0, -1.0])
    pattern = wheel([1.0, 1.2, math.pi - 1.0, math.pi - 1.2])
    problem = PatternProblem(pattern)
    assert problem.residual(phi) < 1e-15
    z = problem.kernel(phi)
    inward = -np.sign(phi)
    way = z @ (z.T @ inward)
    near = phi + 1e-8 * way / np.abs(way).max()
    assert problem.residual(near) < 1e-14 and np.abs(near).max() < math.pi
    # at rest nothing beside is lower, whichever of the two it is; where closure carries torques it is not told
    sprung = PatternProblem(pattern.with_springs(1.0, list(near)))
    assert judge(sprung, near).verdict == "minimum"
    carried = 1e-3 * problem.closure(near)[1][1]
    wound = sprung.loaded(carried)
    state = judge(wound, near)
    assert np.abs(wound.along(near, wound.torque(near))).max() < 1e-12 < np.abs(carried).max()
    assert state.verdict == "undecided"
    assert np.array_equal(singular_beside(problem, near), phi)
    assert singular_beside(problem, phi) is None


def test_facets_that_reach_into_each_other_in_a_stack_are_seen():
    """A zigzag of three facets, the last one turned beyond the one in the middle: by how much, at its far corners."""
    problem = _rolled([0.0, 0.0])
    assert Faces(problem, np.array([math.pi, -math.pi])).reach() == pytest.approx(0.0, abs=1e-15)
    beyond = Faces(problem, np.array([math.pi, -math.pi - 1e-7])).reach()
    assert beyond * problem.crossings.size == pytest.approx(-0.6e-7, rel=1e-6)


def test_contacts_face_to_face_are_told_in_the_coordinates_of_the_user():
    """Of a sheet that was moved, as a search does: words and place are those of the sheet as it was given."""
    pattern = _rolled([0.0, 0.0]).pattern
    by, phi = np.array([3.0, -2.0, 0.0]), np.array([math.pi, -math.pi])
    problem, moved = (
        PatternProblem(pattern),
        PatternProblem(replace(pattern, corners=pattern.corners - by)),
    )
    moved.origin = by
    one, two = (
        contact_forces(
            State(s, phi), [s.contact_of(t) for t in Faces(s, phi).touches(0, above=True)]
        )
        for s in (problem, moved)
    )
    assert one and [c.place for c in two] == [pytest.approx(c.place) for c in one]
    assert [c.words() for c in two] == [c.words() for c in one]
