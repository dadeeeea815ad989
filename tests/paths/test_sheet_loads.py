"""Load paths of sheets: against one vertex, the law of Miura, spherical trigonometry, and the work of the load."""

import math

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.optimize import minimize_scalar

import origami_nlp as o
from origami_nlp.pattern_problem import DeadForce, PatternProblem, Pull, Torque
from origami_nlp.pattern_states import judge
from origami_nlp.search import descend_by_newton
from tests.patterns import miura, miura_angles, wheel

GAMMA, REST = math.radians(70), 1.2


SNAPPING = (0.2, 1.0), (2.0, 2.6), 2.9
"""Springs of zigzags and rows with which a sheet snaps, and where it stands."""


def work_of(points):
    """Integral of the load over what it works on, by splines over the length of the curve."""
    t, way = (np.array([getattr(p, name) for p in points]) for name in ("t", "angle"))
    length = np.hypot(np.diff(t) / max(np.ptp(t), 1e-9), np.diff(way) / max(np.ptp(way), 1e-9))
    keep = np.concatenate([[True], length > 1e-9])
    u = np.cumsum(np.concatenate([[0.0], length]))[keep]
    fine = np.linspace(0.0, u[-1], 20_001)
    load, moved = (PchipInterpolator(u, v[keep])(fine) for v in (t, way))
    return np.trapezoid(load, moved)


def settled(pattern, phi):
    problem = PatternProblem(pattern)
    return judge(
        problem, descend_by_newton(problem, problem.project(np.asarray(phi, float))[0]).phi
    )


def folded_miura(m, n, k=(1.0, 1.0), rest=(REST, REST), near=0.8):
    """A Miura sheet with springs and rest angles of its zigzags and its rows."""
    pattern = miura(m, n, GAMMA)
    straight = np.abs(pattern.directions[:, 1]) < 1e-9
    signs = np.sign(miura_angles(pattern, n, 1.0, GAMMA))
    stiffness = np.where(straight, k[1], k[0])
    pattern = pattern.with_springs(
        list(stiffness), list(signs * np.where(straight, rest[1], rest[0]))
    )
    return pattern, settled(pattern, miura_angles(pattern, n, near, GAMMA))


# ---------------------------------------------------------------- one vertex


def test_a_vertex_as_a_pattern_snaps_where_the_vertex_does():
    scene = o.examples.degree6("5*pi/12", ratio=1)
    quick = {"full": False, "effort": "quick", "max_starts": 24}
    pattern = wheel(scene.vertex.sector_angles)
    pattern = pattern.with_springs(list(scene.stiffness), list(scene.rest_angles))
    one = o.load_path(scene, 1, to=-0.15, **quick)
    start = settled(pattern, one.legs[0].points[0].fold_angles)
    path = o.load_path(pattern, 1, to=-0.15, state=start)
    assert not path.alarms and len(path.snaps) == len(one.snaps) == 1
    for ours, theirs in zip(path.snaps, one.snaps, strict=True):
        assert ours.type == theirs.type
        assert ours.t == pytest.approx(theirs.t, abs=1e-11)
        assert ours.before == pytest.approx(theirs.before, abs=1e-9)
        assert ours.after == pytest.approx(theirs.after, abs=1e-9)
        assert ours.released == pytest.approx(theirs.released, abs=1e-11)
    closing = sorted(e.t for e in one.events if e.type == "closes")
    mine = sorted(e.t for e in path.events if e.type == "closes")
    assert all(min(abs(t - u) for u in mine) < 1e-11 for t in closing if t > 0)
    # found by another program, with other steps
    assert path.snaps[0].t == pytest.approx(-0.138149523101, abs=1e-11)


# ---------------------------------------------------------------- one degree of freedom, in closed form


def law(pattern, n, i, z):
    """Fold angles of a Miura sheet, and the torque on crease i that holds it there."""
    phi = miura_angles(pattern, n, z, GAMMA)
    straight = np.abs(pattern.directions[:, 1]) < 1e-9
    c, t = math.cos(GAMMA), math.tan(z / 2)
    slope = np.where(straight, c * (1 + t * t) / (1 + c * c * t * t), 1.0)
    d = np.sign(phi / math.copysign(1.0, z)) * slope
    return phi, float((pattern.stiffness * (phi - pattern.rest)) @ d / d[i])


@pytest.mark.parametrize("size", [4, pytest.param(8, marks=pytest.mark.slow)])
def test_miura_follows_its_law_to_its_snap(size):
    pattern, start = folded_miura(size, size, *SNAPPING)
    i = int(np.flatnonzero(np.abs(pattern.directions[:, 1]) > 1e-9)[0])
    assert start.verdict == "minimum"
    path = o.load_path(pattern, i + 1, state=start)
    for leg in path.legs:
        for p in leg.points:
            if not 0.05 < abs(p.fold_angles[i]) < math.pi - 0.05:
                continue  # beside flat and flat-folded states multipliers are large, and rounding with them
            phi, t = law(pattern, size, i, abs(p.fold_angles[i]))
            assert np.abs(phi - p.fold_angles).max() < 1e-9
            assert t == pytest.approx(p.t, abs=1e-9 * size**2)
    snap = path.snaps[0]
    sense = math.copysign(1.0, -snap.t)
    end = minimize_scalar(
        lambda z: sense * law(pattern, size, i, z)[1],
        bounds=(1.5, abs(start.phi[i])), method="bounded", options={"xatol": 1e-12},
    )  # fmt: skip
    assert snap.t == pytest.approx(law(pattern, size, i, float(end.x))[1], rel=1e-12)
    assert snap.type == "fold" and snap.released > 0
    beyond = [b for b in path.branches if b.kind == "saddle"]
    for p in beyond[0].points if beyond else pytest.fail("no saddle was followed"):
        assert law(pattern, size, i, abs(p.fold_angles[i]))[1] == pytest.approx(
            p.t, abs=1e-9 * size**2
        )


def test_a_path_stops_where_the_sheet_is_flat():
    """It would go on through the flat state, where other ways are open that lead down."""
    pattern, start = folded_miura(3, 3)
    i = int(np.flatnonzero(np.abs(pattern.directions[:, 1]) > 1e-9)[0])
    path = o.load_path(pattern, i + 1, to=60.0, state=start)
    (leg,) = path.legs
    assert "the flat state" in leg.why and np.abs(leg.points[-1].fold_angles).max() < 1e-2
    found = judge(PatternProblem(pattern).under(path.driver.work, leg.points[-1].t), np.zeros(12))
    assert found.refuted


def test_springs_take_up_the_work_of_the_load():
    pattern, start = folded_miura(3, 4)
    for work in (
        Pull(pattern, (0, 19)),
        DeadForce(pattern, 19, (0.1, 0.5, 1.0), 1),
        Torque(pattern, (2, 5)),
    ):
        path = o.load_path(pattern, work, to=2.0, state=start)
        (leg,) = path.legs
        assert leg.why == "range" and len(leg.points) > 4
        gained = leg.points[-1].energy - leg.points[0].energy
        assert gained == pytest.approx(work_of(leg.points), rel=2e-3)


def test_the_load_falls_back_to_zero_and_no_further():
    pattern, start = folded_miura(2, 2)
    path = o.load_path(pattern, Pull(pattern, (0, 8)), state=start, unload=True)
    assert [leg.toward for leg in path.legs] == [-1, 1, 1, -1]
    assert {leg.why for leg in path.legs} == {"range"} and not path.alarms
    for leg in path.legs[1::2]:
        assert leg.points[-1].t == 0.0
        assert leg.points[-1].fold_angles == pytest.approx(start.phi, abs=1e-9)
        assert all(p.t * leg.points[0].t >= 0 for p in leg.points)


# ---------------------------------------------------------------- what a load works on


@pytest.mark.parametrize(
    "make",
    [
        lambda p: Pull(p, (0, 15)),
        lambda p: DeadForce(p, 15, (0.3, -0.2, 1.0), 1),
        lambda p: Torque(p, (1, 3)),
    ],
)
def test_derivatives_against_differences(make):
    rng = np.random.default_rng(3)
    pattern = miura(3, 3)
    work, phi, h = make(pattern), 0.5 * rng.normal(size=pattern.creases), 1e-6
    steps = h * np.eye(pattern.creases)
    slope = [(work.conjugate(phi + d) - work.conjugate(phi - d)) / (2 * h) for d in steps]
    bend = [(work.gradient(phi + d) - work.gradient(phi - d)) / (2 * h) for d in steps]
    assert np.abs(slope - work.gradient(phi)).max() < 1e-8
    exact = work.hessian(phi)
    assert np.abs(np.array(bend) - (0.0 if exact is None else exact)).max() < 1e-8


def folded_cross():
    """One vertex with creases 90 degrees apart but one pair 60 and 120, folded flat, its springs at rest there."""
    angles = np.radians([0.0, 60.0, 180.0, 300.0])
    pattern = wheel(np.diff(np.r_[angles, 2 * math.pi]))
    flat = math.pi * np.array([-1.0, 1.0, -1.0, -1.0])
    pattern = pattern.with_springs(1.0, list(flat))
    return pattern, judge(PatternProblem(pattern), flat)


@pytest.mark.slow
def test_a_state_whose_contacts_carry_nothing_is_followed_as_far_as_it_is_stable():
    """A pull that does no work to first order: the state stays one, and is no certified minimum from 8/3 on."""
    pattern, start = folded_cross()
    assert start.verdict == "minimum"
    pull = Pull(pattern, (1, 3))
    path = o.load_path(pattern, pull, state=start)
    event = path.events[0]  # what branches off there is not followed, and that is said
    assert event.t == pytest.approx(8 / 3, abs=1e-10) and "on the verdict" in event.note
    assert event.type == "branching" and path.legs[-1].why == "snap" and not path.snaps
    assert "the load does no work" in str(path) and "not followed" in path.alarms[0]
    for share, good in ((0.999, True), (1.001, False)):
        under = PatternProblem(pattern).under(pull, event.t * share)
        assert (judge(under, start.phi).verdict == "minimum") == good


# ---------------------------------------------------------------- whoever states it, however


# ---------------------------------------------------------------- files


def test_a_path_comes_back_from_its_file(tmp_path):
    pattern, start = folded_miura(3, 3)
    path = o.load_path(pattern, [1, 2], to=1.0, state=start)
    o.save(path, tmp_path / "load.json")
    back = o.read_result(tmp_path / "load.json")
    assert isinstance(back, o.LoadPath)
    assert back.to_dict() == path.to_dict() and back.legs == path.legs
    assert len(o.to_frame(back)) == sum(len(leg.points) for leg in path.legs)
    assert not path.events and "leg 1" in path.view()._repr_html_()  # pages of what is empty


# ---------------------------------------------------------------- sheets without vertices
