"""The closed forms close the full loop of all N creases: 10,000 random points per family."""

import numpy as np
import pytest

from origami_nlp.closed_forms import cone_fold_angles, degree6, wedge3
from tests.symbolic.closed_forms_reference import loop_quaternion

POINTS = 10_000
CLOSURE = 1e-13
PAPER = np.array([1.0, 0.0, 0.0, 0.0])  # q = +1


def _gap(azimuths, folds):
    return np.abs(loop_quaternion(azimuths, folds) - PAPER).max()


def test_degree6_closes_for_any_sector_angles():
    rng = np.random.default_rng(11)
    alpha = rng.dirichlet([1.2, 1.2, 1.2], 4 * POINTS) * np.pi
    two, three = rng.uniform(-np.pi, np.pi, (2, 4 * POINTS))
    point = degree6(alpha[:, 0], alpha[:, 1], two, three)
    one, four = point.value[:, 0], point.value[:, 1]
    b2, b3 = alpha[:, 0], alpha[:, 0] + alpha[:, 1]
    zero = np.zeros_like(b2)
    azimuths = np.stack([zero, b2, b3, zero + np.pi, -b3, -b2], axis=-1)
    folds = np.stack([one, two, three, four, three, two], axis=-1)
    assert point.ok.sum() >= POINTS
    assert _gap(azimuths[point.ok], folds[point.ok]) <= CLOSURE
    assert np.abs(point.value[point.ok]).max() <= np.pi
    for sign in (-1, 1):  # both signs of the first mirror crease really occur
        assert np.sum(sign * one[point.ok] > 0.1) > 1000


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_wedge3_closes_on_both_branches_and_beyond_the_papers_range(n, branch):
    rng = np.random.default_rng(14 + n)
    count = 6 * POINTS
    alpha = rng.uniform(0.01, np.pi / n - 0.01, count)
    v = rng.uniform(-np.pi, np.pi, count)  # the paper stops at pi/2
    two = rng.uniform(-np.pi, np.pi, count)
    point = wedge3(n, alpha, v, two, branch)
    one, three = point.value[:, 0], point.value[:, 1]
    wedge = np.stack([0 * alpha, alpha, 0 * alpha + np.pi / n, 2 * np.pi / n - alpha], axis=-1)
    azimuths = np.concatenate([wedge + 2 * np.pi * j / n for j in range(n)], axis=-1)
    folds = np.concatenate([np.stack([one, two, three, two], axis=-1)] * n, axis=-1)
    ok = point.ok
    assert ok.sum() >= POINTS
    assert _gap(azimuths[ok], folds[ok]) <= CLOSURE
    assert np.sum(ok & (v > 0)) > 1000
    assert np.sum(ok & (v < 0)) > 1000


def test_wedge3_own_side_at_degree8_is_one_branch_per_sign_of_elevation():
    rng = np.random.default_rng(16)
    v, two = rng.uniform(-1.5, 1.5, (2, 4000))
    for branch in (1, -1):
        point = wedge3(2, 0.6, v, two, branch)
        assert np.array_equal(point.own_side[point.ok], (branch * v < 0)[point.ok])


@pytest.mark.parametrize("degree", [6, 8, 10, 12, 40])
def test_cone_closes_for_every_assignment(degree):
    rng = np.random.default_rng(17)
    azimuths = 2 * np.pi / degree * np.arange(degree)
    done = 0
    while done < POINTS:
        flaps = rng.choice([-1, 1], degree // 2)
        v = rng.uniform(-np.pi, np.pi, 500)
        folds = cone_fold_angles(degree, v, flaps).value
        # beyond contact |phi| passes pi; loop closure does not mind
        assert _gap(np.broadcast_to(azimuths, folds.shape), folds) <= CLOSURE
        done += v.size
