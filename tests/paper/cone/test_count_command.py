"""What a count refuses, and what the command writes."""

import json
import math

import pytest

from origami_nlp.errors import OrigamiError
from origami_nlp.paper import cone
from tests.command_line import run
from tests.independent import cone_branches as brute


@pytest.mark.parametrize(
    "arguments",
    [
        {"degree": 7},
        {"degree": 4},
        {"degree": 4002},
        {"ratio": 0.0},
        {"ratio": -1.0},
        {"ratio": math.nan},
        {"elevation": 1.6},
        {"elevation": -0.6},
        {"elevation": math.nan},
        {"rest": "flat"},
        {"depth": -0.1},
        {"depth": 1.0},
        {"end": "never"},
    ],
)
def test_values_out_of_range_are_named(arguments):
    rules = {"rest": "waterbomb", "end": "contract", "depth": 0.0}
    given = {"degree": 6, "ratio": 1.0, "elevation": 0.1} | rules | arguments
    field = next(iter(arguments))
    with pytest.raises(OrigamiError, match=field) as caught:
        of = cone.Cone(given["degree"], given["rest"], given["end"])
        cone.count(of, given["ratio"], given["elevation"], depth=given["depth"])
    assert "\n" not in str(caught.value)


def test_count_writes_the_contract():
    out = run(*"paper cone count --degree 10 --ratio 0.01 --rest-elevation -0.8 -o -".split())
    assert out.code == 0
    data = json.loads(out.out)
    assert data["schema"] == "origami-nlp/paper/1" and data["branches"] == "64"
    totals = {"interior": 0, "contact": 0, "cut": 0}
    for row in data["classes"]:
        totals[row["kind"]] += row["multiplicity"]
        assert (row["elevation"] > 0) == (row["direction"] == "up")
    keys = ("stable_interior", "stable_contact", "falling_at_cut")
    assert tuple(totals.values()) == tuple(data[k] for k in keys) == brute.count(10, 0.01, -0.8)
    assert all(totals.values())


def test_long_integers_are_strings(tmp_path):
    target = tmp_path / "cone.json"
    asked = "paper cone count --degree 200 --ratio 2 --rest-elevation pi/6 -o"
    assert run(*asked.split(), target).code == 0
    data = json.loads(target.read_text())
    assert data["branches"] == str(2**101)
    keys = ("stable_interior", "stable_contact", "falling_at_cut")
    number = sum(int(data[k]) for k in keys)
    assert number == sum(int(row["multiplicity"]) for row in data["classes"]) > 2**53
    for row in data["classes"]:
        assert isinstance(row["multiplicity"], int if int(row["multiplicity"]) <= 2**53 else str)
