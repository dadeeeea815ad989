"""Unions of patterns: each minimum once, kept in a file, runs are not repeated; shares are counted by hand."""

import json

import numpy as np

from benchmarks.pattern_union import PatternUnion, Run, main, read, run


def test_each_minimum_is_kept_once():
    union = PatternUnion("any")
    assert [union.number(np.full(2, x), x) for x in (1.0, 2.0, 1.0 + 1e-9)] == [0, 1, 0]
    union.runs = [
        Run("now", "quick", 0, 1.0, "rule", [0, 1]),
        Run("now", "quick", 1, 3.0, "rule", [1]),
        Run("before", "quick", 0, 1.0, "rule", [0]),
    ]
    assert union.table().splitlines() == [
        "| any | now | quick | 2 1 | 2 of 2 | 50.0% | 2.0 |",
        "| any | before | quick | 1 | 1 of 2 | 50.0% | 1.0 |",
    ]


def test_runs_are_done_once(tmp_path, capsys):
    given = dict(names=["metasheet:2x2"], effort="quick", seeds=2)
    main(tmp_path, **given)
    union = read(tmp_path, "metasheet:2x2")
    assert [r.seed for r in union.runs] == [0, 1] and union.energies
    assert all(r.found == sorted(set(r.found)) for r in union.runs)
    before = (tmp_path / "metasheet-2x2.json").read_text()
    main(tmp_path, **given)
    assert (tmp_path / "metasheet-2x2.json").read_text() == before
    assert json.loads(before)["pattern"] == "metasheet:2x2"
    assert "100.0%" in capsys.readouterr().out
    assert run(union, "again", "quick", 0, 60.0).found == union.runs[0].found
