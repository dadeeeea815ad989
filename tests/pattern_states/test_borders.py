"""States at which facets meet at borders: a minimum on every piece, or left for lower ones."""

import math
from functools import cache

import numpy as np
import pytest

from origami_nlp.kkt import newton
from origami_nlp.pattern_problem import FoldedGeometry, PatternProblem, choices
from origami_nlp.pattern_states import judge
from origami_nlp.problem import Contact
from tests.patterns import wheel
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
