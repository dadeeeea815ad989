"""States that keep a symmetry: a linear map of variables, and contacts whose images are one."""

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import kkt
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.pattern_problem import PatternProblem, orbits_of, pose

HALF = np.array([0.8797, 0.8892, 0.6410, 0.7317])
C2 = Scene(
    Vertex(tuple(np.tile(HALF * math.pi / HALF.sum(), 2))),
    (0.0375, 10.408, 0.7923, 0.0761) * 2,
    (1.599, 2.457, 2.933, -1.543) * 2,
    "C2",
)
UNIT = np.array([0.0, 0.0, 0.0, 1.0])


def mirrored():
    """A sheet of two rows, and the mirror between them."""
    sheet = o.examples.pattern("miura", 2, 2).with_springs(1.0, 0.7)
    middle = sheet.corners[sheet.vertices[0].vertex]
    to = [
        int(np.linalg.norm(sheet.corners - x * (1, -1, 1) - middle * (0, 2, 0), axis=1).argmin())
        for x in sheet.corners
    ]
    return sheet, to


def test_derivatives_are_those_of_the_whole_vertex():
    scene = o.examples.degree8("pi/4", ratio=0.1)
    reduced, whole = pose(scene), pose(replace(scene, symmetry="none"))
    e = reduced.expand(np.eye(reduced.size)).T
    rng = np.random.default_rng(0)
    for _ in range(5):
        y, lam = rng.normal(size=reduced.size), rng.normal(size=3)
        phi = reduced.expand(y)
        value, slope = reduced.closure(y)
        assert np.allclose(value, whole.closure(phi)[0], atol=1e-15)
        assert np.allclose(slope, whole.closure(phi)[1] @ e, atol=1e-14)
        bent = e.T @ whole.closure.hessian(phi, lam) @ e
        assert np.allclose(reduced.closure.hessian(y, lam), bent, atol=1e-14)
        assert reduced.energy(y) == pytest.approx(whole.energy(phi), rel=1e-14)
        assert np.allclose(reduced.torque(y) * reduced.scale, e.T @ whole.torque(phi) * whole.scale)


def pinned_twice(problem) -> np.ndarray:
    near = problem.reduce(np.array([-2.574547, 3.133815, 2.579476, 0.0] * 2))
    return next(kkt.polished_nearby(problem, near)).x


def test_gaps_and_their_images_are_one():
    problem, whole = pose(C2), pose(replace(C2, symmetry="none"))
    e = problem.expand(np.eye(problem.size)).T
    state = pinned_twice(problem)
    contacts = kkt.State(problem, state).contacts.base
    # two sides that a half turn exchanges are their own image
    assert sorted(problem.weight(c) for c in contacts) == [2.0, 4.0]
    h, z = 1e-6, np.eye(problem.size)
    for k, c in enumerate(contacts):
        beside = [problem.local(state + h * d).openings(contacts) for d in (*z, *-z)]
        values = np.array([b[0][k] for b in beside])
        n = problem.size
        by_steps = (values[:n] - values[n:]) / (2 * h)
        assert np.allclose(problem.local(state).openings([c])[1][0], by_steps, atol=1e-8)
        same = whole.contact_of(problem.touch(c))
        bent = whole.lagrangian_hessian(problem.expand(state), UNIT, [same], 0.0)
        assert np.allclose(problem.lagrangian_hessian(state, UNIT, [c], 0.0), e.T @ bent @ e)


def test_both_contacts_hold_where_facets_of_one_plane_overlap():
    """A minimum that needs both: 13,647 admissible states beside it were looked at, none lower."""
    problem = pose(C2)
    what = kkt.classified(problem, pinned_twice(problem))
    assert (what.verdict, what.kind) == ("minimum", "contact-pinned")
    assert len(what.contacts) == 2 and all(c.multiplier > 0.1 for c in what.contacts)


def test_a_sheet_that_keeps_a_mirror():
    sheet, to = mirrored()
    orbits = orbits_of(sheet, [(range(len(to)), 1), (to, 1)])
    assert orbits.variables < sheet.creases and len(orbits.images) == 1
    reduced, whole = PatternProblem(sheet, orbits=orbits), PatternProblem(sheet)
    y, residual = reduced.project(np.full(reduced.size, 0.3))
    assert residual < 1e-12 and np.abs(whole.closure.values(reduced.expand(y))).max() < 1e-12


def test_a_cone_is_posed_in_a_state_that_closes():
    for sectors in ((0.5, 0.6, 0.7, 0.8), (1.2,) * 8, (1.2, 0.6, 0.2, 2.0), (1.0, 1.1, 1.2)):
        problem = pose(
            Scene(
                Vertex(sectors, flat=False),
                (1,) * len(sectors),
                tuple(0.1 * np.arange(len(sectors))),
            )
        )
        reference = problem.pattern.reference
        assert np.abs(problem.closure.values(reference)).max() < 1e-12
        assert problem.lifts_to_one(reference)
