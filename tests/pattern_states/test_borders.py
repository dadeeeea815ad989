"""States at which facets meet at borders: a minimum on every piece, or left for lower ones."""

import itertools
import math
from functools import cache

import numpy as np
import pytest
from scipy.optimize import linprog

import origami_nlp as o
from origami_nlp import find_minima
from origami_nlp.kkt import newton
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import FoldedGeometry, PatternProblem, choices, order_layers
from origami_nlp.pattern_states import judge
from origami_nlp.problem import Contact
from tests.patterns import downhill, wheel
from tests.relabelled import relabelled

SIXTH = np.full(6, math.pi / 3)
SHUT = np.arange(6) == 5


@cache
def pressed():
    """Six equal sectors with a crease fully folded, its neighbours on each other, otherwise at rest: judged."""
    signs, out = math.pi * np.array([-1, 0.5, 0.5, -1, 0.5, 0.5]), []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        rest = np.clip(signs + 0.3 * rng.normal(size=6), -math.pi, math.pi)
        problem = PatternProblem(
            wheel(SIXTH).with_springs(list(rng.uniform(0.5, 1.5, 6)), list(rest))
        )
        start = 0.5 * signs + 0.2 * rng.normal(size=6)
        start[5] = math.pi
        for _ in range(30):
            start, _ = problem.project(start, SHUT)
            z = problem.kernel(start, [5])
            start = start - 0.5 * z @ (z.T @ problem.torque(start))
        done, _ = newton(problem, start, (Contact("limit", 5, 1),))
        if done is None or np.abs((phi := done.x) - start).max() > 0.1:
            continue
        if np.abs(phi).max() <= math.pi and (np.abs(phi[:5]) < math.pi - 1e-6).all():
            if not problem.crossings.find(phi):
                out.append((problem, judge(problem, phi)))
    return out


def closed_choices(problem, phi):
    """What keeps facets apart that meet at borders: of each choice one gap at least stays open."""
    return choices(problem.features, FoldedGeometry(problem.crossings.poses, phi))


@cache
def meeting():
    """States with that crease fully folded whose others may open either way: (sheet at random rest, fold angles)."""
    out = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        rest = rng.uniform(-math.pi, math.pi, 6)
        problem = PatternProblem(
            wheel(SIXTH).with_springs(list(rng.uniform(0.5, 1.5, 6)), list(rest))
        )
        phi, residual = problem.project(np.where(SHUT, math.pi, rng.uniform(-1.5, 1.5, 6)), SHUT)
        if residual <= 1e-12 and np.abs(phi).max() <= math.pi and problem.closure.lifts_to_one(phi):
            if not problem.crossings.find(phi):
                out.append((problem, phi))
    return out


def test_of_each_choice_one_gap_stays_open_exactly_where_another_library_finds_no_crossing():
    pytest.importorskip("fcl", reason="python-fcl, of the extra test")
    from tests.independent.rigid import Rigid

    both = [0, 0]
    pushed = [(problem, state.phi) for problem, state in pressed()[:3]]
    for seed, (problem, phi) in enumerate([*pushed, *meeting()[:3]]):
        body, rng = Rigid(problem.pattern), np.random.default_rng(seed)
        inverse, z = body.slopes(phi), problem.kernel(phi)
        meet = closed_choices(problem, phi)
        for _ in range(25):
            new = body.closed(phi + 1e-3 * z @ rng.normal(size=z.shape[1]), inverse)
            if new is None or np.abs(new).max() > math.pi:
                continue
            at = FoldedGeometry(problem.crossings.poses, new)
            room = min(max(t.gap(at) for t in choice) for choice in meet)
            if abs(room) > 1e-6:  # corners that facets share are cut by 1e-7 there
                crosses = bool(body.collide(new))
                assert crosses == (room < 0)
                both[crosses] += 1
    assert min(both) > 20


def test_energy_rises_on_what_is_left_beside_a_minimum():
    """The fully folded crease stays so there, as opening it crosses on either side of those that lie on each other."""
    crossed = 0
    for seed, (problem, state) in enumerate(pressed()[:6]):
        assert state.verdict == "minimum"
        assert state.kkt_residual < 1e-10
        rng, phi = np.random.default_rng(seed), state.phi
        energy = problem.scaled_energy(phi)
        for k in range(40):
            start = phi + 10.0 ** -(1 + k % 4) * rng.normal(size=6)
            held = SHUT if k % 2 else ~np.ones(6, bool)
            start[5] = math.pi if k % 2 else min(start[5], math.pi)
            new, residual = problem.project(start, held)
            if residual > 1e-12 or np.abs(new).max() > math.pi or np.abs(new - phi).max() > 0.3:
                continue
            crosses = bool(problem.crossings.find(new))
            assert crosses or problem.scaled_energy(new) > energy
            crossed += crosses and problem.scaled_energy(new) < energy
    assert crossed > 20


def steepest(problem, phi):
    """Least torque . d over all pieces, |d| <= 1: HiGHS on differences of gaps, and on all products of choices."""
    meet = closed_choices(problem, phi)
    touches = list(dict.fromkeys(t for choice in meet for t in choice))
    poses, h = problem.crossings.poses, 1e-6

    def differences(f):
        return np.array([(f(phi + e) - f(phi - e)) / (2 * h) for e in h * np.eye(len(phi))]).T

    slopes = differences(lambda x: np.array([t.gap(FoldedGeometry(poses, x)) for t in touches]))
    closure = differences(problem.closure.values)
    low, high = -(phi > -math.pi).astype(float), (phi < math.pi).astype(float)
    least = 0.0
    same = np.abs(slopes[:, None] - slopes[None]).max(axis=2) < 1e-6
    numbers = [[int(same[touches.index(t)].argmax()) for t in choice] for choice in meet]
    for product in {frozenset(p) for p in itertools.product(*numbers)}:
        rows = slopes[list(product)]
        least = min(least, linprog(
            problem.torque(phi), A_ub=-rows, b_ub=np.zeros(len(rows)),
            A_eq=closure, b_eq=np.zeros(len(closure)), bounds=np.column_stack([low, high]),
        ).fun)  # fmt: skip
    return least


def test_labels_and_place_do_not_matter():
    for seed, (problem, state) in enumerate(pressed()[:2]):
        other, at, _ = relabelled(problem.pattern, seed)
        again = judge(PatternProblem(other), state.phi[at])
        assert (again.verdict, again.kind) == (state.verdict, state.kind)
        assert again.softest == pytest.approx(state.softest, rel=1e-9)
        both = [
            # two sides on each other are a corner on a facet too: which of both is named follows labels
            sorted((c.is_limit, c.force, *c.multiplier_range) for c in s.contacts)
            for s in (state, again)
        ]
        for one, two in zip(*both, strict=True):
            assert one == pytest.approx(two, rel=1e-6)


@pytest.mark.slow
def test_products_of_choices_have_a_way_down_exactly_where_it_is_no_minimum():
    problem, state = pressed()[0]
    assert steepest(problem, state.phi) > -1e-8
    other, phi = meeting()[0]
    assert judge(other, phi).refuted
    assert steepest(other, phi) < -0.1


def test_a_descent_on_what_is_left_comes_back():
    for problem, state in pressed()[:2]:
        rng, back = np.random.default_rng(0), 0
        for _ in range(4):
            start = np.where(SHUT, math.pi, state.phi + 0.02 * rng.normal(size=6))
            start, residual = problem.project(start, SHUT)
            if residual > 1e-12 or np.abs(start).max() > math.pi or problem.crossings.find(start):
                continue
            end = downhill(problem, start)
            assert end.arrived
            back += np.abs(end.phi - state.phi).max() < 1e-9
        assert back


@pytest.mark.slow
@pytest.mark.filterwarnings(
    "ignore:divide by zero:RuntimeWarning"
)  # of the other search, at its poles
def test_degenerate_minima_of_one_vertex_are_minima_of_its_sheet():
    """Creases on each other: by the search for single vertices, and and by this way; not those of many layers."""
    scene = o.examples.degree6("pi/3", ratio=1)
    scene = Scene(scene.vertex, scene.stiffness, scene.rest_angles, "C1", "full")
    problem = PatternProblem(
        wheel(SIXTH).with_springs(list(scene.stiffness), list(scene.rest_angles))
    )
    many = 0
    for found in find_minima(scene, prove=False, escape=False).minima:
        phi = np.clip(found.phi, -math.pi, math.pi)
        verdict = judge(problem, phi).verdict
        # facets lie on each other that no crease joins
        layered = order_layers(problem, phi).pairs > (np.abs(phi) == math.pi).sum()
        assert verdict == "minimum" or (layered and verdict == "undecided")
        many += verdict == "minimum" and found.kind == "degenerate"
    assert many > 5


@pytest.mark.slow
def test_lower_states_beside_those_of_a_pattern_cross():
    """Resch's pattern: in some of its states facets lie on each other, three of them in a few."""
    found = o.find_minima("resch", starts=4, escape=False)
    problem, rng, lower, many = PatternProblem(found.pattern), np.random.default_rng(0), 0, 0
    for state in found.minima:
        phi, at_limit = state.phi, np.abs(state.phi) == math.pi
        if state.kind == "interior" or not at_limit.any():
            continue
        energy, z = problem.scaled_energy(phi), problem.kernel(phi)
        down = -z @ (z.T @ problem.torque(phi))
        for k in range(20):
            held = at_limit & (rng.uniform(size=len(phi)) < 0.7)
            way = z @ rng.normal(size=z.shape[1])
            way = way / np.linalg.norm(way) + 0.4 * (k % 3) * down / np.linalg.norm(down)
            start = np.clip(phi + 10.0 ** -(2 + k % 3) * way, -math.pi, math.pi)
            new, residual = problem.project(np.where(held, phi, start), held)
            if (
                residual <= 1e-12
                and np.abs(new).max() <= math.pi
                and problem.scaled_energy(new) < energy
            ):
                assert problem.crossings.find(new)
                lower += 1
        many += 1
    assert many > 3 and lower > 10
