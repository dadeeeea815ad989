"""Searches are measured on the package's own problem, and the page of speed has the numbers of the record."""

import json
import math

import numpy as np
import pytest

from benchmarks import draw_search, family_scene, measure_search, patterns, search, search_tables
from benchmarks.rivals import Program, rivals
from benchmarks.search import OURS, Known, rows, scenes_of, share_at
from origami_nlp import examples, find_minima
from origami_nlp.pattern_problem import pose
from tests.documentation.pages import ROOT

PAGE = (ROOT / "docs" / "validation" / "speed.md").read_text()


@pytest.mark.parametrize("index", [4, 17])
def test_rivals_get_the_problem_of_the_package_and_right_gradients(index):
    problem = pose(examples.panels()[index])
    x, _ = problem.project(np.sin(1.0 + np.arange(problem.size)))
    program = Program(problem, x, ())
    at = program.at(x)
    assert np.abs(at.g[program.equal]).max() < 1e-12
    assert float(at.f[0]) * problem.scale == pytest.approx(problem.energy(x), rel=1e-12)
    assert program.equal.sum() == problem.size - problem.dof == len(at.g)
    jacobian, gradient, h = at.jacobian.copy(), at.gradient.copy(), 1e-6
    for k, step in enumerate(h * np.eye(problem.size)):
        up = program.at(x + step)
        f, g = up.f[0], up.g.copy()
        down = program.at(x - step)
        assert (f - down.f[0]) / (2 * h) == pytest.approx(gradient[k], abs=1e-7)
        assert (g - down.g) / (2 * h) == pytest.approx(jacobian[:, k], abs=1e-7)


@pytest.mark.slow  # rivals of the benchmark, in turn
def test_what_is_measured():
    data = measure_search([("fold-limits", 1)], 0.3)
    ((one,),) = scenes_of(json.loads(json.dumps(data, default=str))).values()
    proved = find_minima(family_scene("fold-limits", 1), prove=True)
    assert one.minima == len(proved.minima) and proved.completeness.status == "proved"
    assert set(one.runs) == {OURS, *(r.name for r in rivals())}
    for run in one.runs[OURS]:
        assert len(run.found) == one.minima and run.error < 1e-13 and not run.false
    (slsqp,) = one.runs["SLSQP"]
    assert slsqp.attempts > 3 and slsqp.exact <= len(slsqp.found) <= one.minima


def test_known_minima_are_told_apart():
    known = Known(pose(family_scene("fold-limits", 0)))
    assert known.nearest(np.zeros(4)) == (-1, math.inf)
    assert known.add([np.zeros(4), np.full(4, 1e-9), np.ones(4)]) == (0, 1)


def test_the_page_has_the_numbers_of_the_record(tmp_path):
    data = json.loads(search.RECORD.read_text())
    assert f"`{data['stamp']}`" in PAGE
    table = search_tables(data)[0].markdown().splitlines()[2:]
    assert len(table) == 8 and all(line in PAGE for line in table)
    draw_search(data, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000
    scenes = [c for of in scenes_of(data).values() for c in of]
    (slsqp,) = (row for row in rows(scenes) if row[0] == "SLSQP")
    readme = " ".join((ROOT / "README.md").read_text().split())
    ours, theirs = (100 * share_at(scenes, name, 1.0) for name in (OURS, "SLSQP"))
    for number in (f"{ours:.0f} % of 167", f"{theirs:.0f} % and {slsqp[9]} states", slsqp[10]):
        assert number in readme
    recorded = json.loads(patterns.RECORD.read_text())
    assert f"`{recorded['stamp']}`" in PAGE
    assert all(
        line in PAGE for line in patterns.patterns_table(recorded).markdown().splitlines()[2:]
    )
