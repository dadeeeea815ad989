"""States where closure loses rank, strict minima to first order or alone: against trigonometry, and ratios of modes."""

import math
from itertools import product

import numpy as np
import pytest

from origami_nlp import Scene, State, Vertex, classify
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.pattern_states import find_states, judge, list_branches
from tests.independent.rigid import Rigid
from tests.independent.trigonometry import quadrilateral
from tests.patterns import grid, metasheet, wheel


@pytest.mark.parametrize("seed", range(6))
def test_folded_flat_is_a_minimum_where_energy_rises_along_its_curves(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.uniform(0.5, 1.4), rng.uniform(1.5, 2.6)
    sectors = a, b, math.pi - a, math.pi - b
    at_limit = [np.array(s) * math.pi for s in product((-1.0, 1.0), repeat=4)]
    pattern = wheel(sectors)
    k, rest = rng.uniform(0.5, 2, 4), at_limit[rng.integers(16)] + rng.uniform(-2.5, 2.5, 4)
    pattern = pattern.with_springs(list(k), list(np.clip(rest, -3.0, 3.0)))
    problem = PatternProblem(pattern)
    vertex = pose(Scene(Vertex(sectors), tuple(k), tuple(pattern.rest), "none", "fold-limits"))
    beside_shut = [(s * (math.pi - 1e-3), dart) for s in (1, -1) for dart in (False, True)]
    curves = [np.array([x, *quadrilateral(sectors, x, dart)]) for x, dart in beside_shut]
    assert max(problem.residual(x) for x in curves) < 1e-9
    verdicts = []
    for phi in at_limit:
        beside = [x for x in curves if np.abs(x - phi).max() < 0.1]
        state = judge(problem.with_contact(False), phi)
        if state.verdict == "not admissible":
            assert not beside
            continue
        one = classify(State(vertex, phi))  # the same vertex as a scene
        assert (one.verdict, one.kind or "") == (state.verdict, state.kind)
        rises = all(pattern.energy(x) > pattern.energy(phi) for x in beside)
        assert state.verdict == ("minimum" if rises else "not stationary"), (phi, state.certificate)
        verdicts.append(state.verdict)
    assert len(verdicts) == 8
    assert len(set(verdicts)) == 2


def _ratios(axes):
    """Of a flat vertex with creases along axes [4, 2] counter-clockwise: d_1/d_0 and so on, in its two modes."""
    x = np.linalg.solve(axes[2:].T, -axes[:2].T).T  # d_2, d_3 of (1, 0) and (0, 1)

    def form(y):
        z = np.array([*y, *(y @ x)])
        pairs = [(i, j) for i in range(4) for j in range(i + 1, 4)]
        return sum(z[i] * z[j] * np.linalg.det(axes[[i, j]]) for i, j in pairs)

    p, q = form(np.array([1.0, 0.0])), form(np.array([0.0, 1.0]))
    r = form(np.array([1.0, 1.0])) - p - q
    return [np.array([1.0, t, *(np.array([1.0, t]) @ x)]) for t in np.roots([q, r, p])]


def test_a_flat_sheet_that_no_way_leads_out_of_is_stable():
    """Sheets of 3 x 3 general quadrilaterals do not move: no choice of modes agrees round the facet in the middle."""
    rng = np.random.default_rng(3)
    i, j = np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    points = np.stack([i, j], axis=2) + rng.uniform(-0.2, 0.2, (4, 4, 2))
    round_ = [(1, 1), (2, 1), (2, 2), (1, 2)]
    modes = []
    for n, (p, q) in enumerate(round_):
        to = [(p + 1, q), (p, q + 1), (p - 1, q), (p, q - 1)]
        out, back = (to.index(round_[(n + s) % 4]) for s in (1, -1))
        ratios = _ratios(np.array([points[t] - points[p, q] for t in to]))
        modes.append([z[out] / z[back] for z in ratios])
    assert min(abs(math.prod(choice) - 1) for choice in product(*modes)) > 1e-3
    pattern = grid(points).with_springs(1.0, list(rng.uniform(-1, 1, 12)))
    flat = judge(PatternProblem(pattern), np.zeros(12))
    assert (flat.verdict, flat.kind) == ("minimum", "degenerate")
    found = find_states(pattern, starts=1, escape=False)
    (only,) = found.minima
    assert not only.phi.any()
    assert only.kkt_residual > 1e-3 and "are unique" not in str(found)  # nothing balances it


def level_sheet(seed):
    """A metasheet, flat, with torques orthogonal to both branch directions, though closure does not balance them."""
    rng = np.random.default_rng(seed)
    pattern, _ = metasheet(3)
    k = rng.uniform(0.5, 2.0, pattern.creases)
    lines = list_branches(PatternProblem(pattern)).lines
    z = PatternProblem(pattern).kernel(np.zeros(pattern.creases))
    torque = z @ (z.T @ rng.normal(size=pattern.creases))
    torque -= lines.T @ np.linalg.lstsq(lines.T, torque, rcond=None)[0]
    assert len(lines) == 2 and np.linalg.norm(torque) > 0.1
    return pattern, k, torque / np.abs(torque).max(), lines


@pytest.mark.parametrize("seed", range(3))
def test_flat_is_a_minimum_where_the_energy_is_level_along_every_way_out(seed):
    pattern, k, torque, lines = level_sheet(seed)
    sprung = pattern.with_springs(list(k), list(-torque / k))
    state = judge(PatternProblem(sprung), np.zeros(pattern.creases))
    assert (state.verdict, state.kind) == ("minimum", "degenerate") and state.kkt_residual > 1e-3
    body = Rigid(sprung)
    flat = sprung.energy(np.zeros(pattern.creases))
    for d in lines:
        for h in (-0.1, -0.03, 0.03, 0.1):  # closed by code of its own, one crease driven
            phi = body.closed(h * d, body.slopes(h * d), within=1e-12)
            assert phi is not None and np.abs(phi - h * d).max() < 0.1 * abs(h)
            rise = sprung.energy(phi) - flat
            assert rise > 0 and rise == pytest.approx(0.5 * h**2 * (k @ d**2), rel=0.3)
    # and none where it is not level, however little
    tilted = pattern.with_springs(list(k), list(-(torque + 1e-4 * lines[0]) / k))
    assert judge(PatternProblem(tilted), np.zeros(pattern.creases)).verdict != "minimum"
