"""What it takes to leave a stable state of a sheet: exact along curves, else never below the true pass."""

import json
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.kkt import BOUND, TRACED
from origami_nlp.sheets import SheetResult, find_states
from tests.sheets.relabelled import relabelled

PASS = 0.372454
"""Lowest pass of yoshimura:2x2, by the least energy with its vertex flat, from which descents reach both states."""


def flat_energy(pattern) -> float:
    return float(pattern.energy(np.zeros(pattern.creases)))


def test_one_freedom_passes_at_the_flat_state() -> None:
    """Both states of a metasheet are on curves that meet at the flat state alone, which is the pass."""
    pattern = o.examples.pattern("metasheet", 3, 3)
    found = find_states(pattern, starts=4)
    assert len(found.minima) == 2
    for state in found.minima:
        assert state.escape is not None and state.escape.method == TRACED
        assert state.energy + state.escape.barrier == pytest.approx(flat_energy(pattern), rel=1e-9)
        assert state.softest == pytest.approx(state.eigenvalue * pattern.stiffness.mean())


def test_a_square_twist_is_left_through_the_flat_state() -> None:
    """Vertices of degree 4 change sides in the flat state only: no bound may be below it."""
    pattern = o.examples.pattern("squaretwist")
    found = find_states(pattern, starts=4)
    signs = [
        [np.sign(round(s.fold_angles[list(v.creases)].sum(), 9)) for v in pattern.vertices]
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


@pytest.fixture(scope="module")
def yoshimura() -> SheetResult:
    return find_states(o.examples.pattern("yoshimura", 2, 2), starts=20)


def test_a_bound_is_above_the_exact_pass_and_near_it(yoshimura: SheetResult) -> None:
    assert len(yoshimura.minima) == 2
    for state in yoshimura.minima:
        assert state.escape is not None and state.escape.method == BOUND
        assert PASS - 1e-6 <= state.energy + state.escape.barrier <= 1.2 * PASS
        assert not state.shallow


def test_words_and_files_keep_barriers(yoshimura: SheetResult) -> None:
    data = json.loads(json.dumps(yoshimura.to_dict(), allow_nan=False))
    again = SheetResult.from_dict(data)
    for one, other in zip(yoshimura.minima, again.minima, strict=True):
        assert (one.softest, one.escape) == (other.softest, other.escape)
    assert "barrier" in yoshimura.table().heads and "softest" in yoshimura.table().heads
    told = " ".join(str(piece) for piece in yoshimura.told())
    assert "escape barrier at most" in told


def test_shallow_states_are_counted_apart(yoshimura: SheetResult) -> None:
    low, high = yoshimura.minima
    assert high.escape is not None
    shallow = replace(high, escape=replace(high.escape, barrier=1e-6, shallow=True))
    found = replace(yoshimura, states=(low, shallow))
    assert "1 stable state, and 1 shallow one (barrier below 1e-4" in str(found.table().title)


def test_no_time_is_left_for_barriers() -> None:
    found = find_states(o.examples.pattern("metasheet", 3, 3), starts=4, seconds=0.0)
    assert "escape barriers" in found.search.left_out
    assert all(s.escape is None for s in found.minima)


def test_labels_change_no_barrier(yoshimura: SheetResult) -> None:
    copy, _, _ = relabelled(yoshimura.pattern, 3, mirror=True)
    found = find_states(copy, starts=20)
    for one, other in zip(yoshimura.minima, found.minima, strict=True):
        assert one.escape is not None and other.escape is not None
        assert one.softest == pytest.approx(other.softest, rel=1e-6)
        assert one.escape.words() == other.escape.words()
