"""Random questions: refutations hold in rational numbers, and what is asked of energies is met to rounding."""

import itertools
from dataclasses import replace

import pytest

from origami_nlp.inverse_design import EnergyBounds, scene_of, solve
from tests.inverse_design.exact import proved
from tests.inverse_design.questions import question

pytest.importorskip("clarabel")
AGREES = 1e-6


def test_rational_numbers_agree():
    """What was refuted is, and what is largest is, by sums of rational numbers."""
    kinds = set()
    for seed in range(40):
        asked = question(seed, 4 + seed % 4, 1 + seed % 3, seed % 2, seed // 2 % 2)
        if asked is None:
            continue
        posed = solve(asked)
        if not (posed.every_refuted or posed.feasible):
            continue
        if not all(b.regular for _, b, _ in posed.balances):
            continue
        bound = proved(posed)
        kinds.add((posed.feasible, bound is None))
        assert (bound is None) == posed.answer.infeasible
        assert bound is None or bound <= max(posed.margin, 0.0) + AGREES
    assert {feasible for feasible, _ in kinds} == {True, False}


def test_differences_of_energy_are_exact():
    """Ten random questions of two states, four to six creases, some pinned; gaps asked for from -5 to 20 mJ."""
    done = []
    for seed in itertools.count():
        gap = (0.0, 0.0125, -0.005, 0.02)[seed % 4]
        asked = question(seed, 4 + seed % 3, 2, seed // 3 % 2, 0, preload=True)
        if asked is None:
            continue
        asked = replace(asked, energies=(EnergyBounds("s1", "s0", gap, gap),))
        posed = solve(asked)
        if not posed.feasible:
            continue
        scene = scene_of(posed)
        u = [scene.energy(asked.model.expand(p.state.x)) for p in asked.placed]
        done.append(abs(u[1] - u[0] - gap) / max(u))
        if len(done) == 10:
            break
    assert max(done) <= 1e-12
