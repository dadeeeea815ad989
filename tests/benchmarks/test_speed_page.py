"""The page of speed against error: what stands there is made from the recorded measurement, and its numbers count."""

import json
import math

import pytest

from benchmarks import family_scene, read_bench, speed_page
from benchmarks.by_scip import solve
from benchmarks.coverage import NOW, Covered, Searched
from benchmarks.speed_page import ahead_from, best_rival, false_states
from origami_nlp import find_minima


def run(found, curve, **more):
    return Searched(0, curve[-1][0], found, curve, **more)


def scenes():
    one = Covered("f", "f 1", 4, 4)
    one.runs[NOW] = [run((0, 1, 2, 3), ((0.15, 1), (0.25, 4)))]
    one.runs["SLSQP"] = [run((0, 1), ((0.04, 1), (0.4, 2)), attempts=9, false=2)]
    one.runs["IPOPT"] = [run((0,), ((0.9, 1),), attempts=3, false=1)]
    return [one]


def test_who_is_ahead_and_from_when_on():
    some = scenes()
    assert ahead_from(some, "SLSQP") == 0.2, "behind at 0.1 s, level at 0.2 s"
    assert ahead_from(some, "IPOPT") == 0.05
    assert best_rival(some, 0.05) == ("SLSQP", 0.25) and best_rival(some, 1.0) == ("SLSQP", 0.5)
    some[0].runs["SLSQP"] = [run((0, 1, 2, 3), ((0.04, 4),))]
    some[0].minima = 4
    some[0].runs[NOW] = [run((0, 1, 2), ((0.04, 3),))]
    assert math.isinf(ahead_from(some, "SLSQP"))
    assert false_states(scenes(), "SLSQP") == 2


@pytest.fixture(scope="module")
def data():
    return json.loads(speed_page.DATA.read_text())


def test_the_page_is_made_from_the_recorded_measurement(data):
    paper = read_bench(speed_page.PAPER)
    made = speed_page.markdown(data, paper)
    assert speed_page.PAGE.read_text() == made, "run: python -m benchmarks page"
    assert data["stamp"] in made and data["command"] in made


def test_the_readme_says_what_was_measured(data):
    text = speed_page.README.read_text()
    assert speed_page.readme_line(data) in text, "run: python -m benchmarks page"
    assert speed_page.with_line(text, data) == text


def test_scip_ends_at_the_lowest_minimum():
    """Closure by quaternions, posed in SCIP: nothing of ours but the numbers of the scene."""
    pytest.importorskip("pyscipopt")
    scene = family_scene("fold-limits", 0)
    found = solve(scene)
    lowest = find_minima(scene, prove=False, escape=False).minima[0].energy
    assert found.upper == pytest.approx(lowest, rel=1e-4)
    if found.status == "optimal":
        assert found.lower <= lowest * (1 + 1e-4)
