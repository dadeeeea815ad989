"""The main job on the paper's panels and on hard cases: residuals, kinds, verdicts."""

import itertools
import math
import time

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, check_admissible, examples, find_minima
from origami_nlp.minima.stopping import chao1, unseen_share
from origami_nlp.pattern_problem import pose
from tests.computed_once import panel_result, thinned

CLOSURE = 1e-14  # closure of regular states
KKT = 1e-12  # KKT residual, relative to the torques that balance


@pytest.mark.parametrize("scene", thinned(examples.panels()[4:], 9), ids=lambda s: s.name)
def test_every_state_is_polished_admissible_and_certified(scene):
    result = panel_result(scene, full=True)
    assert result.search.stopped_by == "rule" and not result.flags.reached_once
    for m in result.minima:
        assert m.closure_residual <= CLOSURE and m.kkt_residual <= KKT
        assert check_admissible(scene.vertex, np.array(m.fold_angles)).admissible
        assert m.energy == pytest.approx(scene.energy(m.fold_angles), rel=1e-12)
        if m.kind == "interior":
            assert not m.contacts and min(m.hessian_eigenvalues) > 0
        if m.kind == "contact-pinned":
            assert m.contacts and all(c.multiplier > 0 for c in m.contacts)
            assert all(c.multiplier_range == (c.multiplier,) * 2 for c in m.contacts)
        if m.kind == "contact-touching":
            assert any(c.multiplier == 0 for c in m.contacts)


@pytest.mark.parametrize("scene", thinned(examples.panels()[4:], 9), ids=lambda s: s.name)
def test_no_state_is_left_undecided_in_the_full_space(scene):
    for m in panel_result(scene, full=True).minima:
        f = m.full_space
        assert f.verdict in ("stable", "unstable")
        if f.verdict == "stable":
            assert "search" not in f.certificate
            continue
        energies = [e for _, e in f.descent]
        assert f.descent[0][0] == pytest.approx(m.fold_angles, abs=1e-9)
        assert all(b < a for a, b in itertools.pairwise(energies))
        for angles, energy in f.descent:
            state = check_admissible(scene.vertex, np.array(angles))
            assert state.admissible and state.closure_residual <= 1e-12
            assert energy == pytest.approx(scene.energy(angles), rel=1e-12)
        steps = np.abs(np.diff([a for a, _ in f.descent], axis=0)).max()
        assert steps <= 0.11  # a path, not a jump to another basin
        assert f.lands_on.energy < m.energy and f.lands_on.kind is not None


def test_handles_need_one_sign_of_the_closed_creases():
    scene = examples.degree6("pi/3", 1.0)
    handles = [m for m in panel_result(scene).minima if m.local_dimension == 1]
    assert len(handles) == 2
    for m in handles:
        closed = [a for a in m.fold_angles if abs(a) == math.pi]
        assert len(closed) == 3 and len(set(closed)) == 1
        wrong = np.array(m.fold_angles)
        # the same shape with a closed pair turned to its other side has no layer order
        pair = next(i for i in (1, 2) if abs(wrong[i]) == math.pi)
        for i in (pair, 6 - pair):
            wrong[i] = -wrong[i]
        state = check_admissible(scene.vertex, wrong)
        assert state.closure_residual < 1e-12 and not state.admissible and "layer" in state.reason


def test_a_rest_state_that_closes_is_found_with_zero_energy():
    scene = examples.degree8("pi/6", 1.0)
    angles = panel_result(scene).minima[0].fold_angles
    other = Scene(scene.vertex, scene.stiffness, angles, "D2")
    found = find_minima(other, prove=False, escape=False).minima[0]
    assert found.energy <= 1e-28 and found.fold_angles == pytest.approx(angles, abs=1e-12)


def test_a_flat_sheet_at_rest_stays_flat():
    for scene in (
        Scene(Vertex(("pi/3",) * 6), (1.0,) * 6, (0,) * 6, "D1"),
        Scene(Vertex(("pi/2",) * 4), (1.0,) * 4, (0,) * 4, "none"),
        Scene(Vertex(("pi/4",) * 8), (1.0,) * 8, (0,) * 8, "D2"),
    ):
        best = find_minima(scene, max_starts=32, prove=False, escape=False).minima[0]
        assert best.energy <= 1e-20 and np.abs(best.fold_angles).max() <= 1e-9
        assert best.kind == "degenerate"  # closure loses rank at the flat state
        assert best.local_dimension == pose(scene).dof


def test_a_vertex_that_cannot_fold_in_its_symmetry_is_flat():
    # D6: one fold angle, one equation; the only state of the wedge next to the flat one is the flat one
    scene = Scene(Vertex(("pi/3",) * 6), (1.0,) * 6, (0.3,) * 6)
    result = find_minima(scene, prove=False, escape=False)
    assert scene.group.name == "D6" and pose(scene).dof == 0
    assert all(np.abs(m.fold_angles).max() <= 1e-6 for m in result.minima)


def test_what_is_said_of_the_unseen():
    # f1 (f1 - 1) / (2 (f2 + 1)): four seen once, one twice
    assert chao1([1, 1, 1, 1, 2, 9]) == 4 * 3 / 4 and chao1([2, 5]) == 0
    # a share p of the starts is missed N times with probability (1 - p)^N, which is 5 % at the bound
    for quiet in (10, 300, 5000):
        assert (1 - unseen_share(quiet)) ** quiet <= 0.05
    assert unseen_share(0) == 1


def test_the_estimate_is_no_more_than_what_is_missing_in_the_mean():
    """Chao's estimate is a lower bound in expectation, however unequal the chances."""
    rng = np.random.default_rng(5)
    for chances in (np.full(20, 0.05), np.geomspace(1, 1e-3, 20), np.geomspace(1, 1e-5, 40)):
        chances = chances / chances.sum()
        draws = rng.multinomial(200, chances, size=2000)
        missing = (draws == 0).sum(axis=1)
        estimates = np.array([chao1(d[d > 0].tolist()) for d in draws])
        assert estimates.mean() <= missing.mean() * 1.05 + 0.05


def test_a_search_ended_by_time_says_so():
    """A vertex of degree eight in contact takes ten seconds and more."""
    scene = Scene(Vertex.from_degrees([45.0] * 8), [1.0] * 8, [-3.0] * 8, "none", "full")
    begin = time.process_time()
    result = find_minima(scene, prove=False, seconds=0.3)
    assert time.process_time() - begin < 5
    assert result.search.stopped_by == "time" and result.flags.search_stopped_early


def test_minima_are_told_as_they_are_found():
    """Each once, certified, before the search has ended; symmetric ones with all their fold angles."""
    for scene in (examples.degree6("pi/4", 1), examples.miura("pi/3")):
        told, order = [], []
        result = find_minima(
            scene,
            prove=False,
            escape=False,
            found=lambda energy, x, told=told: told.append((energy, *x)),
            progress=lambda *_, told=told, order=order: order.append(len(told)),
        )
        listed = sorted((m.energy, *m.fold_angles) for m in result.minima)
        assert np.allclose(sorted(told), listed, atol=1e-9)
        assert order[-1] == len(told) and order[0] < order[-1]
