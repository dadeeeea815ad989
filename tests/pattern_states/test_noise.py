"""How many random errors states of sheets survive: against the single vertex, other labels, and geometry by itself."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.minima import MinimaResult, displacements
from origami_nlp.pattern_problem import PatternProblem, angle_sums, find_labels
from origami_nlp.pattern_states import find_states
from tests.relabelled import relabelled


def sectors(pattern) -> np.ndarray:
    """Angles of all corners of polygons at interior vertices, by numpy alone."""
    inner = {loop.vertex for loop in pattern.vertices}
    out = []
    for polygon in pattern.polygons:
        x = pattern.corners[list(polygon)]
        for i, v in enumerate(polygon):
            if v in inner:
                a, b = x[i - 1] - x[i], x[(i + 1) % len(x)] - x[i]
                out.append(math.acos(a @ b / np.linalg.norm(a) / np.linalg.norm(b)))
    return np.array(out)


def moved(pattern, seed: int, size: float):
    """The pattern with vertices moved by what is drawn with a seed."""
    draws = np.random.default_rng(seed).normal(size=(2, pattern.creases))
    by = displacements(pattern, find_labels(pattern), *draws)
    return replace(pattern, corners=pattern.corners + size * by)


@pytest.mark.parametrize("name", ["squaretwist", "waterbomb:2x2", "miura:3x3"])
def test_moved_vertices_leave_a_flat_sheet_with_sectors_wrong_by_the_size_asked_for(name) -> None:
    pattern = o.examples.pattern(name)
    for seed in range(3):
        other = moved(pattern, seed, 1e-4)
        change = sectors(other) - sectors(pattern)
        assert np.sqrt(np.mean(change**2)) == pytest.approx(1e-4, rel=1e-2)
        assert np.ptp(other.corners[:, 2]) == 0 and np.abs(change).min() > 0
        assert all(s == pytest.approx(2 * math.pi, abs=1e-12) for s in angle_sums(other).values())
        assert PatternProblem(other).residual(np.zeros(pattern.creases)) < 1e-15


@pytest.mark.parametrize(("mirror", "over"), [(False, False), (True, False), (False, True)])
def test_errors_are_the_same_under_other_labels(mirror, over) -> None:
    """Sectors of the copy, sorted, are those of the sheet: numbers, place, mirror and side change nothing."""
    rng = np.random.default_rng(0)
    pattern = o.examples.pattern("waterbomb", 1, 2)
    pattern = pattern.with_springs(
        rng.uniform(1, 2, pattern.creases), rng.uniform(-1, 1, pattern.creases)
    )
    copy, _, _ = relabelled(pattern, 5, mirror, over)
    ours, theirs = (np.sort(sectors(moved(p, 1, 0.01))) for p in (pattern, copy))
    assert np.abs(ours - theirs).max() < 1e-9


DRAWS = 5
"""Of random errors, in place of 20: those that follow repeat what these say."""


@pytest.fixture(scope="module", autouse=True)
def _few_draws():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("origami_nlp.minima.noise.TRIALS", DRAWS)
        yield


@pytest.fixture(scope="module")
def yoshimura() -> MinimaResult:
    return find_states(o.examples.pattern("yoshimura", 2, 2), starts=4, escape=False, noise=0.5)


def test_survivals_are_told_and_kept(yoshimura: MinimaResult) -> None:
    low, high = yoshimura.minima
    assert low.survival is not None and high.survival is not None
    assert low.survival.kept == high.survival.kept == DRAWS and low.survival.springs is None
    again = MinimaResult.from_dict(json.loads(json.dumps(yoshimura.to_dict(), allow_nan=False)))
    assert [s.survival for s in again.minima] == [s.survival for s in yoshimura.minima]


def test_rigid_quadrilaterals_do_not_fold_with_errors_of_positions() -> None:
    """As many equations as creases: no folded state is beside the exact one; errors of the springs it survives."""
    found = find_states(o.examples.pattern("metasheet", 3, 3), starts=2, escape=False, noise=0.1)
    assert len(found.minima) == 2
    for state in found.minima:
        assert state.survival is not None
        assert (state.survival.kept, state.survival.springs) == (0, DRAWS)


def test_no_time_is_left_for_errors_and_it_is_named() -> None:
    found = find_states(o.examples.pattern("metasheet", 3, 3), starts=4, seconds=0.0, noise=0.1)
    assert "random errors that states survive" in found.search.left_out
