"""States that facets in contact hold, where several degrees of freedom are left."""

import math
from functools import cache

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.display import contact_places, draw_states
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import find_states, judge, list_branches
from tests.patterns import downhill, metasheet
from tests.relabelled import relabelled


def sprung(name, size, seed, reach=3.1):
    """A pattern with random springs, and a start beside flat at which no facets cross."""
    pattern = o.examples.pattern(name, *size)
    rng = np.random.default_rng(seed)
    k, rest = rng.uniform(0.5, 2, pattern.creases), rng.uniform(-reach, reach, pattern.creases)
    problem = PatternProblem(pattern.with_springs(list(k), list(rest)))
    start, residual = problem.project(rng.uniform(-0.3, 0.3, problem.size))
    assert residual < 1e-12 and not problem.crossings.find(start)
    return problem, start


def closed(problem, phi):
    """The state with all its contacts held closed."""
    state = o.State(problem, phi)
    return state.on(state.contacts.base)


@cache
def held(name="yoshimura", size=(4, 4), seed=8):
    """A state that several contacts hold."""
    problem, start = sprung(name, size, seed)
    end = downhill(problem, start)
    assert end.arrived
    return problem, judge(problem, end.phi)


def test_a_state_held_by_several_contacts_balances_to_rounding():
    problem, state = held()
    assert (state.verdict, state.kind) == ("minimum", "contact-pinned")
    touches = [c for c in state.contacts if c.type != "fold-limit"]
    assert len(touches) > 1
    assert state.closure_residual < 1e-12 and state.kkt_residual < 1e-11
    rows = closed(problem, state.phi)
    assert np.abs(rows.openings).max() < 1e-14
    # the torque of the springs along free motions is that of the contacts, put together here
    z = problem.kernel(state.phi)
    size = problem.crossings.size
    units = np.where([c.is_limit for c in rows.contacts], 1.0, size)
    forces = np.array([c.force for c in state.contacts]) * units
    springs = problem.pattern.stiffness * (state.phi - problem.pattern.rest)
    assert (forces >= 0).all() and forces.max() > 0.1
    assert z.T @ springs == pytest.approx(z.T @ rows.slopes.T @ forces, abs=1e-11)


def test_places_of_touch_are_on_both_facets():
    for name, size, seed in (("yoshimura", (4, 4), 8), ("waterbomb", (2, 2), 12)):
        problem, state = held(name, size, seed)
        places = contact_places(problem.pattern, state.phi, state.contacts)
        touches = [c for c in state.contacts if c.corners]
        assert len(places) == len(touches) > 1
        x = problem.crossings.poses.polygons(state.phi)
        for place, contact in zip(places, touches, strict=True):
            for facet in (f - 1 for f in contact.facets):
                corners = x[facet]
                normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
                normal /= np.linalg.norm(normal)
                assert abs((place - corners[0]) @ normal) < 1e-12
                inward = np.cross(normal, np.roll(corners, -1, axis=0) - corners)
                assert np.einsum("qi,qi->q", inward, place - corners).min() > -1e-12
        figure = draw_states(problem.pattern, [("", state.phi)], "", contacts=[state.contacts])
        labels = {t.get_text() for t in figure.axes[0].texts}
        assert labels == {"|".join(map(str, c.facets)) for c in touches}


def test_lower_states_beside_it_cross_by_another_library():
    """Random closed states beside it, by matrices of rotations: what is lower, FCL finds crossing."""
    pytest.importorskip("fcl", reason="python-fcl, of the extra test")
    from tests.independent.rigid import Rigid

    problem, state = held()
    assert state.verdict == "minimum" and any(c.force > 1e-3 for c in state.contacts)
    body = Rigid(problem.pattern)
    rng = np.random.default_rng(8)
    z = problem.kernel(state.phi)
    energy, lower = float(problem.pattern.energy(state.phi)), 0
    down = -z.T @ problem.torque(state.phi)
    down /= np.linalg.norm(down)
    inverse, many = body.slopes(state.phi), 0
    for k in range(400):
        if many == 30:
            break
        way = rng.normal(size=z.shape[1])
        way = way / np.linalg.norm(way) + (k % 3) * 0.5 * down
        size = 10 ** rng.uniform(-3, -1.5)
        phi = body.closed(state.phi + size * z @ way, inverse)
        if phi is None or np.abs(phi).max() > math.pi:
            continue
        many += 1
        change = float(problem.pattern.energy(phi)) - energy
        crosses = bool(body.collide(phi))
        assert crosses or change > 0, (k, change)
        lower += change < 0
    assert many == 30 and lower > 7


def test_labels_and_place_do_not_matter():
    """Corners and facets renumbered, the sheet turned in space: the same state, contacts and forces."""
    problem, state = held()
    other, at, _ = relabelled(problem.pattern, 5)
    again = judge(PatternProblem(other), state.phi[at])
    assert (again.verdict, again.kind) == (state.verdict, state.kind)
    assert again.softest == pytest.approx(state.softest, rel=1e-9)
    both = [sorted(c.force for c in s.contacts) for s in (state, again)]
    assert both[0] == pytest.approx(both[1], abs=1e-9)


@cache
def driven():
    """A metasheet at rest beyond its first touch: the sheet, the creases that are driven, a state before the touch."""
    pattern, classes = metasheet(3)
    problem, driven = PatternProblem(pattern), classes == 2
    line = max(
        (s * d for d in list_branches(PatternProblem(pattern)).lines for s in (1, -1)),
        key=lambda d: -d[driven].mean(),
    )
    phi, _ = problem.project(0.2 * line / np.abs(line).max())
    start = phi
    for angle in np.linspace(phi[driven][0], -2.8, 60):
        free, residual = problem.project(np.where(driven, angle, phi), driven)
        assert residual < 1e-13
        start, phi = (free if angle > -1.5 else start), free
    return PatternProblem(pattern.with_springs(1.0, list(phi))), driven, start


def test_a_search_finds_the_state_that_touching_facets_hold():
    """Where the crossing test says that they touch, with the energy over their distance as force, by differences."""
    problem, driven_ones, _ = driven()
    pattern = problem.pattern
    state = find_states(pattern, starts=0, escape=False).minima[0]
    assert state.kind == "contact-pinned"

    def at(angle):
        return problem.project(np.where(driven_ones, angle, state.fold_angles), driven_ones)[0]

    low, high = -2.8, -1.0
    for _ in range(45):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if problem.crossings.find(at(middle)) else (low, middle)
    assert state.phi[driven_ones] == pytest.approx(high, abs=1e-8)
    assert high == pytest.approx(-2.0762838873, abs=1e-8)
    assert state.energy == pytest.approx(1.7453290610, abs=1e-9)
    step = 1e-5
    a, b = (at(state.phi[driven_ones][0] + s) for s in (step, 2 * step))
    facets = [f - 1 for f in state.contacts[0].facets]
    gap = [distance(problem, x, facets) for x in (a, b)]
    rise = pattern.energy(b) - pattern.energy(a)
    assert state.contacts[0].force == pytest.approx(rise / (gap[1] - gap[0]), rel=1e-4)
    assert rise / step == pytest.approx(4.395, abs=1e-3)


def distance(problem, phi, pair):
    """Distance of two facets: the least over their edges, brute force."""
    x = problem.crossings.placed(phi)
    a, b = (x[problem.crossings.facet == f][0] for f in pair)
    best = math.inf
    for p, q in zip(a, np.roll(a, -1, axis=0), strict=True):
        for r, s in zip(b, np.roll(b, -1, axis=0), strict=True):
            m = np.column_stack([q - p, r - s])
            t = np.clip(np.linalg.lstsq(m, r - p, rcond=None)[0], 0, 1)
            best = min(best, float(np.linalg.norm(p + t[0] * (q - p) - r - t[1] * (s - r))))
    return best
