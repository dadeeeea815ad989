"""Vertices of five creases and more: motions of the flat state are a cone, whole or cut by stops."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

import origami_nlp as o
from tests.actuation.test_actuate import ends_of
from tests.computed_once import thinned

CONES = {
    "5, one side": ((70, 80, 65, 75, 70), {1: 0.006, 2: 0.005, 3: 0.006, 4: 0.004, 5: 0.005}),
    "5, both sides": ((70, 80, 65, 75, 70), {2: 0.004, 3: -0.006}),
    "6, one crease": ((50, 70, 60, 80, 40, 60), {1: 0.006}),
    "6, few creases": ((50, 70, 60, 80, 40, 60), None),
    "6, waterbomb, the axis": ((45, 90, 45, 45, 90, 45), "axis"),
    "7, all": ((40, 60, 45, 70, 50, 55, 40), {k: 0.004 - 0.0015 * k for k in range(1, 8)}),
}


def cone_case(case):
    """A vertex with springs at rest when flat, torques on it, its flat velocities [n, n - 2] and their form."""
    degrees, torques = CONES[case]
    n = len(degrees)
    scene = o.Scene(o.Vertex.from_degrees(degrees), (0.02,) * n, (0.0,) * n, symmetry="none")
    at = np.radians(np.cumsum((0, *degrees[:-1])))
    u = np.array([np.cos(at), np.sin(at)])
    null = np.linalg.svd(u)[2][2:].T
    form = np.sin(np.abs(at[:, None] - at)) * np.sign(np.abs(at[:, None] - at))
    form = null.T @ form @ null  # area of the closed polygon with sides v_i along the creases
    if torques == "axis":
        axis = null @ np.linalg.eigh(form)[1][:, -1]
        torques = dict(enumerate(0.005 * axis * np.sign(axis.sum()), start=1))
    if torques is None:
        driven = o.actuate(scene).driven[0]
        torques = {c: 0.005 * t for c, t in zip(driven.creases, driven.torques, strict=True)}
    return scene, torques, null, form


@pytest.mark.parametrize("case", thinned(list(CONES), 2))
def test_random_pushes_of_a_vertex_of_higher_degree_end_where_it_says(case):
    scene, torques, null, form = cone_case(case)
    seen = o.actuate(scene, torques)
    sides = np.linalg.eigvalsh(form)
    assert (sides > 0).sum() == 1 and (sides < 0).sum() == len(sides) - 1
    # one side alone where the inverse form is positive at the torques
    force = null.T @ seen.loads[0]
    assert len(seen.started) == (1 if force @ np.linalg.solve(form, force) > 0 else 2)
    ways = [w for b in seen.branches for w in b.ways]
    for way in ways:
        y = null.T @ way.velocity
        assert abs(y @ form @ y) < 1e-9 and np.linalg.norm(y) == pytest.approx(1, abs=1e-9)
    ends = ends_of(seen.pattern, seen.loads[0], 12)
    assert len(ends) == len(seen.reached) == len(ways) and seen.unique is (len(ends) == 1)
    for state in seen.reached:
        assert state.verdict == "minimum"
        assert min(np.abs(state.phi - end).max() for end in ends) < 1e-4


@pytest.mark.parametrize("case", ["5, one side", "6, few creases", "7, all"])
def test_directions_of_most_work_are_those_of_samples_of_the_cone(case):
    """Climbs of the work over unit directions of the cone, from random ones, end in the ways and nowhere else."""
    scene, torques, null, form = cone_case(case)
    seen = o.actuate(scene, torques)
    force, rng = null.T @ seen.loads[0], np.random.default_rng(2)
    size, axes = np.linalg.eigh(form)
    g = axes.T @ force / np.linalg.norm(force)
    ways = np.array([w.velocity for b in seen.branches for w in b.ways])
    met = set()
    for _ in range(20):
        z = rng.normal(size=len(g) - 1)
        side = rng.choice((-1.0, 1.0))

        def point(z, side=side):
            y = np.append(z / np.sqrt(-size[:-1]), side * np.linalg.norm(z) / np.sqrt(size[-1]))
            return y / np.linalg.norm(y)

        step = 0.3
        while step > 1e-9:
            z = z / np.linalg.norm(z)
            trial = z + step * rng.normal(size=len(z))
            if g @ point(trial) > g @ point(z):
                z, step = trial, 1.5 * step
            else:
                step *= 0.9
        if g @ point(z) > 1e-5:
            near = np.abs(ways - null @ (axes @ point(z))).max(axis=1)
            assert near.min() < 1e-3
            met.add(int(near.argmin()))
    assert met == set(range(len(ways)))


def cut_case(case, held):
    """A case with stops at the flat state: signs of the stops, what `actuate` says, the ways, velocities and form."""
    scene, torques, null, form = cone_case(case)
    stops = np.zeros(len(null))
    limits = [(-3.0, 3.0)] * len(null)
    for crease in held:
        stops[abs(crease) - 1] = np.sign(crease)
        limits[abs(crease) - 1] = (-3.0, 0.0) if crease > 0 else (0.0, 3.0)
    seen = o.actuate(replace(scene, limits=limits), torques)
    ways = [w.velocity for b in seen.branches for w in b.ways]
    return stops, seen, ways, null, form


CUTS = [
    ("5, both sides", (1, -3)),
    ("7, all", (1, 2, 3)),
    ("5, one side", (-1, -2, -4)),
    ("5, both sides", (1, 2)),
    ("6, one crease", (-2,)),
    ("6, one crease", (-1, -2, -4)),  # without 1 and 2 creases 3 and 6 are in line
]


@pytest.mark.parametrize("case, held", thinned(CUTS, 2))
def test_directions_of_most_work_on_a_cone_that_stops_cut(case, held):
    """SciPy's SLSQP from random directions ends in the ways; creases > 0 may not valley-fold, < 0 not mountain-fold."""
    stops, seen, ways, null, form = cut_case(case, held)
    assert ways and all((way * stops <= 1e-9).all() for way in ways)
    assert seen.unique is (len(ways) == 1)
    g = null.T @ seen.loads[0] / np.linalg.norm(seen.loads[0])
    axis = np.linalg.eigh(form)[1][:, -1]
    room = -(stops[:, None] * null)[stops != 0]
    rng, met = np.random.default_rng(1), set()
    for k in range(16):
        rows = np.vstack([room, (-1) ** k * axis])
        y = rng.normal(size=len(g))
        for _ in range(3):
            found = minimize(
                lambda y: -g @ y,
                y + 1e-3 * rng.normal(size=len(g)),
                jac=lambda _: -g,
                method="SLSQP",
                options={"maxiter": 300, "ftol": 1e-15},
                constraints=[
                    {"type": "eq", "fun": lambda y: [y @ form @ y, y @ y - 1]},
                    {"type": "ineq", "fun": lambda y, rows=rows: rows @ y},
                ],
            )
            y = found.x
        closed = abs(y @ form @ y) + abs(y @ y - 1) < 1e-7 and (rows @ y > -1e-7).all()
        if found.success and closed and g @ y > 1e-4:
            near = [np.abs(null @ y - way).max() for way in ways]
            assert min(near) < 1e-3
            met.add(int(np.argmin(near)))
    assert met
    for state in seen.reached:
        assert state.verdict == "minimum" and (state.phi * stops <= 1e-9).all()


@pytest.mark.parametrize("case", ["5, one side", "5, both sides"])
@pytest.mark.parametrize("held", [(), (1,), (-2,), (1, -3), (1, 2), (1, 2, 3), (-1, -2, -4)])
def test_directions_of_five_creases_are_those_of_a_scan_of_their_cone(case, held):
    """Each side of the cone of five creases is one circle of unit directions: all of it in 100,000 steps."""
    stops, seen, ways, null, form = cut_case(case, held)
    size, axes = np.linalg.eigh(form)
    g = seen.loads[0] / np.linalg.norm(seen.loads[0])
    t = np.linspace(0, 2 * np.pi, 100_000, endpoint=False)
    found = []
    for side in (-1.0, 1.0):
        y = np.array([np.cos(t), np.sin(t), np.full(len(t), side)]) / np.sqrt(np.abs(size))[:, None]
        velocity = (null @ axes @ (y / np.linalg.norm(y, axis=0))).T
        free = (velocity * stops <= 1e-12).all(axis=1)
        work = np.where(free, velocity @ g, -9.0)
        top = free & (work > 1e-4) & (work >= np.roll(work, 1)) & (work >= np.roll(work, -1))
        found += list(velocity[top])
    assert len(found) == len(ways)
    for way in ways:
        assert min(np.abs(one - way).max() for one in found) < 1e-3


def test_fewer_creases_start_no_side_of_a_vertex_alone():
    scene, _, null, form = cone_case("6, few creases")
    seen = o.actuate(scene)
    assert [d.branch for d in seen.driven] == [1, 2] and seen.can_be_unique and seen.unique is None
    assert seen.driven[0].fewest and len(seen.driven[0].creases) == 2
    inverse = null @ np.linalg.solve(form, null.T)
    assert (np.diag(inverse) < 0).all()  # of one crease, whatever the torque
    for crease in range(1, 7):
        assert o.actuate(scene, {crease: 0.005}).started == (1, 2)
    for driven in seen.driven:
        torques = {c: 0.01 * t for c, t in zip(driven.creases, driven.torques, strict=True)}
        one = o.actuate(scene, torques)
        assert one.unique and one.started == (driven.branch,) and len(one.reached) == 1
        work = one.branches[driven.branch - 1].work
        assert work == pytest.approx(0.01 * driven.work, rel=1e-6)
        assert np.sign(one.reached[0].phi.sum()) == (1, -1)[driven.branch - 1]


def test_equal_torques_on_equal_creases_single_out_no_direction():
    scene = o.Scene(o.Vertex.from_degrees((60,) * 6), (0.02,) * 6, (0.0,) * 6, symmetry="none")
    seen = o.actuate(scene, dict.fromkeys(range(1, 7), 0.005))
    assert seen.started == (1,) and seen.unique is None and not seen.reached
    assert "continuum" in seen.verdict
    # what the first order leaves open later ones decide: descents end in several states
    assert len(ends_of(seen.pattern, seen.loads[0], 3)) > 1
