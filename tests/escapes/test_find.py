"""What it takes to leave a stable state of a sheet: exact along curves, else never below the true pass."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.escapes import BOUND, TRACED, EscapePath
from origami_nlp.escapes.find import images_of, with_images
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern_problem import pose
from origami_nlp.pattern_states import find_states
from tests.computed_once import states
from tests.relabelled import relabelled

PASS = 0.372454
"""Lowest pass of yoshimura:2x2, by the least energy with its vertex flat, from which descents reach both states."""


def flat_energy(pattern) -> float:
    return float(pattern.energy(np.zeros(pattern.creases)))


def test_one_dof_passes_at_the_flat_state() -> None:
    """Both states of a metasheet are on curves that meet at the flat state alone, which is the pass."""
    found = states("metasheet:3x3")
    pattern = found.pattern
    assert len(found.minima) == 2
    for state in found.minima:
        assert state.escape is not None and state.escape.method == TRACED
        assert state.energy + state.escape.barrier == pytest.approx(flat_energy(pattern), rel=1e-9)
        assert 0 < state.softest == state.hessian_eigenvalues[0]


def test_a_square_twist_is_left_through_the_flat_state() -> None:
    """Vertices of degree 4 change sides in the flat state only: no bound may be below it."""
    found = states("squaretwist")
    pattern = found.pattern
    signs = [
        [np.sign(round(s.phi[list(v.creases)].sum(), 9)) for v in pattern.vertices]
        for s in found.minima
    ]
    known = 0
    for state, mine in zip(found.minima, signs, strict=True):
        assert state.escape is not None
        if state.escape.known and state.escape.to and signs[state.escape.to - 1] != mine:
            known += 1
            assert state.energy + state.escape.barrier >= flat_energy(pattern) - 1e-9
            assert state.energy + state.escape.barrier <= flat_energy(pattern) * 1.01
    assert known >= 2

    equal = {}
    for state in found.minima:
        equal.setdefault(round(state.energy, 9), []).append(state.escape)
    images = max(equal.values(), key=len)
    assert len(images) == 4 and {e.words() for e in images} == {images[0].words()} != {"?"}
    tops = {tuple(np.round(np.abs(e.top), 6)) for e in images if e.top}
    assert all(len(e.top) in (0, pattern.creases) for e in images) and tops


def test_a_way_goes_to_an_image() -> None:
    """The end goes where the symmetry takes it."""
    pattern = o.examples.pattern("squaretwist")
    moves = pose(pattern).moves
    x, seen = np.random.default_rng(0).normal(size=pattern.creases), 0
    way = EscapePath(0.5, np.arange(1.0, pattern.creases + 1), 1)
    for move in moves:
        at = np.array([x, move(x)])
        ways = with_images({0: way}, at, [move])
        # a quarter turn takes the image elsewhere: only half turns and mirrors lead to a listed state
        if (to := images_of(at, [move])[0].tolist()) == [1, 0]:
            assert ways[1].to == 0 and np.allclose(move(ways[1].top), way.top)
            seen += 1
        else:
            assert to[1] == -1 or to == [0, 0]
    assert seen


@pytest.fixture(scope="module")
def yoshimura() -> MinimaResult:
    return states("yoshimura:2x2")


def test_a_bound_is_above_the_exact_pass_and_near_it(yoshimura: MinimaResult) -> None:
    assert len(yoshimura.minima) == 2
    for state in yoshimura.minima:
        assert state.escape is not None and state.escape.method == BOUND
        assert PASS - 1e-6 <= state.energy + state.escape.barrier <= 1.2 * PASS
        assert not state.shallow


def test_no_time_is_left_for_barriers() -> None:
    found = find_states(o.examples.pattern("metasheet", 3, 3), starts=4, seconds=0.0)
    assert "escape barriers" in found.search.left_out
    assert all(s.escape is None for s in found.minima)


def test_labels_change_no_barrier(yoshimura: MinimaResult) -> None:
    copy, _, _ = relabelled(yoshimura.pattern, 3, mirror=True)
    found = find_states(copy, starts=10)
    for one, other in zip(yoshimura.minima, found.minima, strict=True):
        assert one.escape is not None and other.escape is not None
        assert one.softest == pytest.approx(other.softest, rel=1e-6)
        assert one.escape.words() == other.escape.words()
