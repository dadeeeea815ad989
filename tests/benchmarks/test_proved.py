"""Proved numbers of minima over random springs, against searches with all their effort."""

import json

import numpy as np
import pytest

from benchmarks import count_proved, proved_scene
from benchmarks.__main__ import app
from origami_nlp import find_minima
from tests.command_line import run


def states(result):
    return np.array([m.fold_angles for m in result.minima])


def check_proved_and_equal(family, number):
    """Proved; and a thorough search with another seed finds nothing else.  What that misses, the proof says."""
    scene = proved_scene(family, number)
    result = find_minima(scene, prove=True, escape=False)
    assert result.completeness.status == "proved", list(result.completeness.lines())
    other = find_minima(scene, seed=number + 1, effort="thorough", prove=True, escape=False)
    assert other.completeness.status == "proved"
    assert len(other.minima) == len(result.minima)
    assert np.abs(states(other) - states(result)).max() <= 1e-8


@pytest.mark.slow
@pytest.mark.parametrize("family", ["degree 4", "degree 5"])
def test_a_random_scene_is_proved_complete(family):
    check_proved_and_equal(family, 0)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(1, 101))
@pytest.mark.parametrize("family", ["degree 4", "degree 5"])
def test_two_hundred_random_scenes_are_proved_complete(family, number):
    check_proved_and_equal(family, number)


@pytest.mark.slow
def test_the_cross_has_six():
    """Four right angles: pairs of creases on one line are book folds, and flat foldings are singular."""
    found = count_proved(2, ("cross of 90 degrees",)).families[0]
    assert found.statuses.get("not-proved", 0) == 0
    assert {**found.minima, **found.except_singular} == {6: 2}


def test_the_command_counts(tmp_path):
    out = tmp_path / "proved.json"
    code, table, _ = run("proved", 1, "-o", out, commands=app)
    assert code == 0 and "degree 5" in table
    families = json.loads(out.read_text())["families"]
    assert [f["scenes"] for f in families] == [1, 1, 1]
    code, _, err = run("proved", 0, commands=app)
    assert code == 2 and "SCENES = 0" in err
