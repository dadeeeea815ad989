"""Answers that are kept in a file, and what the comparison of two such files sees."""

import json

import pytest

from tests.kernels import frozen

ANSWER = {
    "kind": "interior",
    "fold_angles": [3.0, 2e-9, -1.0],
    "energy": 0.25,
    "why": "closes to 2e-16",
    "starts": 4,
    "seconds": 1.0,
    "none": None,
    "states": [{"x": 1.0}, {"x": 2.0}],
}


def test_answers_that_differ_by_rounding_time_and_residuals_are_the_same():
    other = ANSWER | {
        "fold_angles": [3.0 + 2e-10, 2e-9 + 2e-10, -1.0],  # relative to the largest of the list
        "energy": 0.25 * (1 + 5e-11),
        "why": "closes to 7e-17",
        "seconds": 9.0,
    }
    assert not list(frozen.differences(frozen.plain(ANSWER), frozen.plain(other)))


@pytest.mark.parametrize(
    "wrong",
    [
        {"kind": "degenerate"},
        {"fold_angles": [3.0, 2e-9, -1.0 + 4e-10]},
        {"fold_angles": [3.0, 2e-9]},
        {"energy": 0.25 * (1 + 2e-10)},
        {"energy": float("nan")},
        {"energy": None},
        {"why": "does not close"},
        {"starts": 5},
        {"starts": True},
        {"none": 0.0},
        {"new": 1},
        {"states": [{"x": 1.0}, {"y": 2.0}]},
    ],
)
def test_each_difference_is_one_line(wrong):
    lines = list(frozen.differences(ANSWER, ANSWER | wrong))
    assert len(lines) == (2 if wrong.get("states") else 1) and "\n" not in "".join(lines)
    (key,) = wrong
    assert all(key in line for line in lines)


def test_keys_may_be_renamed():
    old, new = {"a": [{"phi": 1.0, "cost": 3}]}, {"a": [{"angles": 1.0}]}
    assert frozen.plain(old, renamed={"phi": "angles"}) == new


def test_a_file_is_written_by_groups_and_compared(tmp_path, capsys):
    one, two = tmp_path / "one.json", tmp_path / "two.json"
    assert frozen.main([str(one), "sweeps"]) == 0
    kept = json.loads(one.read_text())
    states = kept["sweeps"]["twelve scenes"]["data"]
    assert len({s["scene"] for s in states}) == 12 and len(states) > 24
    two.write_text(one.read_text())
    assert frozen.main(["--compare", str(one), str(two)]) == 0
    states[3]["energy_J"] += 1e-6
    two.write_text(json.dumps(kept | {"cones": {}}))
    capsys.readouterr()
    assert frozen.main(["--compare", str(one), str(two)]) == 1
    line, total, left = capsys.readouterr().out.splitlines()
    assert line.startswith("sweeps: twelve scenes.data[3].energy_J: ")
    assert "1 answers, 1 differ" in total and left == "# only in one file: cones"


def test_all_groups_ask_questions_of_different_names():
    for ask in frozen.GROUPS.values():
        names = [name for name, _ in ask()]
        assert names and len(set(names)) == len(names), names
