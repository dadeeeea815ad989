"""Designs measured: counts, times against CVXPY, successes of penalties."""

import json

import numpy as np
import pytest

from benchmarks import measure_design
from benchmarks.__main__ import app
from benchmarks.penalty import Cost, by_penalties, distance
from benchmarks.prescribed import (
    Prescribed,
    count_prescribed,
    prescribed_rows,
    random_question,
)
from origami_nlp.inverse_design import scene_of, solve, springs_of
from tests.command_line import run

pytest.importorskip("clarabel")


def test_more_states_are_not_easier_to_hold():
    counts = count_prescribed(2, (5,))
    for wound in (False, True):
        held = [c.held for c in counts if c.wound == wound]
        assert held == sorted(held, reverse=True) and held[0] == 2
    assert all(c.held + c.refuted == c.questions for c in counts)
    assert prescribed_rows(counts)[1][0][1] == "4"  # 2 * 5 / (5 - 3) = 5, fewer than that
    assert all(isinstance(c, Prescribed) for c in counts)


def test_the_slope_of_a_penalty_is_that_of_differences():
    cost = Cost(random_question(6, 0, 2, True))
    p = np.random.default_rng(0).uniform(cost.low, cost.high)
    _, slope = cost.residuals(p)
    step = 1e-6 * np.eye(len(p))
    by_steps = np.array(
        [(cost.residuals(p + h)[0] - cost.residuals(p - h)[0]) / 2e-6 for h in step]
    )
    assert slope == pytest.approx(by_steps.T, abs=1e-6)


@pytest.mark.slow
def test_the_programme_finds_what_a_penalty_finds():
    for number in range(3):
        targets = random_question(4, number, 2, True)
        posed = solve(targets)
        if by_penalties(targets, "L-BFGS").found:
            assert posed.feasible
        if posed.feasible:
            assert distance(targets, scene_of(targets, springs_of(posed))) < 1e-9


@pytest.mark.slow
def test_the_command_measures(tmp_path):
    found = measure_design(4, (4, 7))
    for one in found.compared:
        assert one.found["ours"] == one.held and one.held + one.refuted == 4
        assert one.differs is None or one.differs < 1e-6
    out = tmp_path / "design.json"
    code, table, _ = run("design", 1, "-o", out, commands=app)
    assert code == 0 and "2 N/(N - 3)" in table
    assert len(json.loads(out.read_text())["compared"]) == 5
    code, _, err = run("design", 0, commands=app)
    assert code == 2 and "VERTICES = 0" in err
