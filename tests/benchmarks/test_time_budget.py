"""Where the time goes: stages add up, nothing stays wrapped, and the answers are those of a plain search."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from benchmarks import budget_page, time_budget
from benchmarks.__main__ import app
from origami_nlp import examples
from origami_nlp.minima import find as minima, ipopt, record
from tests.computed_once import panel_result

RUN = CliRunner()


@pytest.fixture(scope="module")
def budget():
    return time_budget.measure(examples.degree8("pi/6", 1))


def test_stages_add_up(budget):
    assert set(budget.seconds) == set(time_budget.STAGES)
    assert all(v >= 0 for v in budget.seconds.values())
    assert 0 < budget.seconds["descents"] < budget.total
    plain = panel_result(examples.degree8("pi/6", 1)).search
    assert (budget.starts, budget.solves) == (plain.starts, plain.solves)


def test_nothing_stays_wrapped(budget):
    for function in (record.classify, record.polish, minima.confirm, ipopt.build_warm):
        assert "wrapped" not in getattr(function, "__qualname__", "")


def test_table_and_figure(budget, tmp_path):
    lines = time_budget.markdown([budget, budget]).splitlines()
    assert len(lines) == 5 and lines[-1].startswith("| all |")
    shares = [int(c.split()[0]) for c in lines[2].split("|")[2 : 2 + len(time_budget.STAGES)]]
    assert abs(sum(shares) - 100) <= 5  # rounded numbers
    time_budget.draw([budget], tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 1000


def test_the_command(monkeypatch, tmp_path, budget):
    monkeypatch.setattr(time_budget, "measure", lambda scene, seed: budget)
    out = tmp_path / "a.json"
    done = RUN.invoke(app, ["profile", "-o", str(out)])
    assert done.exit_code == 0, done.output
    data = json.loads(out.read_text())
    assert len(data["panels"]) == 18
    assert np.isclose(data["panels"][0]["total"], budget.total)
    assert data["stamp"] in budget_page.page(data)


def test_the_page_is_made_from_the_record():
    data = json.loads(budget_page.DATA.read_text())
    made = budget_page.page(data)
    assert budget_page.PAGE.read_text() == made, "run: python -m benchmarks page"
    assert set(data["panels"][0]["seconds"]) == set(time_budget.STAGES), "stages are those of now"
