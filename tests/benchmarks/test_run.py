"""The benchmark as a whole: its arithmetic, its data, its command."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks import (
    Judge,
    digest,
    draw_bench,
    draw_starts,
    ipopt_alone,
    markdown,
    ours,
    read_bench,
    scaling,
    show,
    write_bench,
)
from benchmarks.__main__ import app
from benchmarks.attempt import Attempt
from benchmarks.digest import Spread, Target, numbers
from benchmarks.interleave import Plan, run_problem
from benchmarks.judging import Outcome
from benchmarks.methods_ours import OURS
from benchmarks.problems import CONTACTS, panel_problems, random_problems
from benchmarks.run import SCHEMA, run_search
from benchmarks.tally import FALSE, Attempts, quantiles, ratios, summary, until_the_rule
from origami_nlp import examples
from origami_nlp.cli import main
from origami_nlp.errors import OptionError
from origami_nlp.minima import Record, run_one
from origami_nlp.problem import Model
from tests.computed_once import thinned

SCENE = examples.degree6("5*pi/12", 1.0)
PLAN = Plan(rounds=2, starts=4, sweep=2, budget=30.0)


def filled(rounds):
    """Attempts from [[(seconds, outcome), ...], ...]."""
    out = Attempts(len(rounds), max(len(r) for r in rounds))
    for r, row in enumerate(rounds):
        for s, (seconds, outcome) in enumerate(row):
            out.record(r, s, seconds, outcome)
    return out


def hit(index, error=1e-12):
    return Outcome(index, "", error, 0.0)


def test_problems_are_those_that_are_promised():
    random = random_problems(0)
    assert len(panel_problems()) == 18 and len(random) == 30
    assert {p.scene.degree for p in random} == set(range(4, 13))
    assert {(p.scene.degree, p.scene.contact) for p in random[:27]} == {
        (n, c) for n in range(4, 13) for c in CONTACTS
    }
    again, other = random_problems(0), random_problems(1)
    assert [p.scene for p in random] == [p.scene for p in again]
    assert random[0].scene != other[0].scene


def test_starts_are_those_of_the_package_and_repeat():
    model = Model(SCENE)
    a, b = draw_starts(model, 3, 5)[0], draw_starts(model, 3, 5)[0]
    assert all((p.x == q.x).all() and (p.raw == q.raw).all() for p, q in zip(a, b, strict=True))
    assert np.abs(model.closure(a[0].x)[0]).max() < 1e-9


def test_ratios_are_seconds_per_distinct_minimum_on_the_same_starts():
    mine = filled([[(1.0, hit(0)), (1.0, hit(0)), (2.0, hit(1))]])
    theirs = filled([[(3.0, hit(0)), (3.0, hit(1, 1e-7)), (6.0, None)]])
    assert ratios(theirs, mine, 1e-6) == [12 / 2 / (4 / 2)]
    assert ratios(theirs, mine, 1e-10) == [12 / 1 / (4 / 2)]
    short = filled([[(3.0, hit(0))]])  # stopped after one start: ours is held to that start too
    short.seconds = np.array([[3.0, math.nan, math.nan]])
    short.minimum = np.array([[0, -4, -4]])
    short.errors = np.full((4, 1, 3), 1e-12)
    assert ratios(short, mine, 1e-10) == [3.0]
    nothing = filled([[(3.0, None), (3.0, Outcome(-1, "facets cross")), (6.0, None)]])
    assert ratios(nothing, mine, 1e-10) == [math.inf]
    assert math.isnan(ratios(nothing, nothing, 1e-10)[0])


def test_a_search_stops_by_the_rule_of_the_package():
    rows = [[(1.0, hit(0))] * 10 + [(1.0, hit(1))] * 10]
    found = until_the_rule(filled(rows), 5)
    assert found["stopped"] and found["starts"] == 5  # the one seen so far was reached twice
    assert list(found["found"]) == ["0"]
    late = until_the_rule(filled(rows), 15)
    assert late["starts"] == 15 and list(late["found"]) == ["0", "1"] and late["seconds"] == 15.0
    once = until_the_rule(filled([[(1.0, hit(0))] * 10 + [(1.0, hit(1))]]), 11)
    assert not once["stopped"]  # the second minimum was reached once


def test_summaries_count_what_happened():
    a = filled([[(1.0, hit(0, 1e-3)), (2.0, None), (3.0, Outcome(-1, "facets cross"))]])
    a.false[0] = "facets cross"
    cell = summary(a, a, 2)
    assert (cell["correct"], cell["failed"], cell["false"], cell["false_states"]) == (1, 1, 1, 1)
    assert cell["false_reasons"] == {"facets cross": 1}
    assert cell["seconds_per_start"] == [2.0] and cell["errors"]["angle"][1] == 1e-3
    assert cell["ratios"]["1e-10"] == [None]
    assert quantiles([1, 2, 3, math.nan]) == [1.5, 2.0, 2.5, 3.0] and quantiles([]) is None


def test_spreads_keep_infinite_numbers_apart_and_leave_out_what_was_not_measured():
    assert Spread.of([3.0, 1.0, math.nan, 2.0, 5.0, 4.0]) == Spread(2.0, 3.0, 4.0, 5)
    s = Spread.of([1.0, math.inf, math.inf, math.inf, 2.0])
    assert s is not None and s.median == math.inf and s.low == 2.0 and s.count == 5
    assert show(s) == "none [2, none]" and show(None) == "-"
    assert Spread.of([math.nan]) is None
    assert numbers(["inf", 2, None])[:2] == [math.inf, 2.0]
    assert Target("t", 10.0, Spread(9.0, 11.0, 12.0, 3)).reached
    assert not Target("t", 10.0, Spread(9.0, 9.9, 12.0, 3)).reached
    assert Target("t", 10.0, None).reached is None


@pytest.fixture(scope="module")
def judge():
    return Judge.of(SCENE, 0)


def test_a_judge_knows_minima_from_what_is_none(judge):
    model = judge.model
    exact = judge.known[0]
    assert exact.reference is not None
    moved = exact.x + 1e-5
    outcome = judge.judge(Attempt(moved, True, ""))
    assert outcome.minimum == 0 and outcome.angle == pytest.approx(1e-5, rel=1e-6)
    wanted = abs(model.energy(moved) - exact.reference.energy)
    size = max(exact.reference.energy, model.scale)
    assert outcome.energy == pytest.approx(wanted / size, rel=1e-4)
    assert judge.judge(Attempt(np.full(model.size, 1.0), True, "")).reason == "does not close"
    start = next(
        s
        for s in draw_starts(model, 1, 40)[0]
        if min(np.abs(s.x - k.x).max() for k in judge.known) > 0.3
    )
    outcome = judge.judge(Attempt(start.x, True, ""))
    assert outcome.minimum == -1 and outcome.reason
    assert judge.judge(Attempt(start.x + 1e-3, True, "")).reason == outcome.reason
    assert judge.false_state(start.x) == judge.false_state(start.x + 1e-3)


def test_a_minimum_that_the_judge_did_not_know_joins_the_list(judge):
    blank = Judge(SCENE, Model(SCENE))
    outcome = blank.judge(Attempt(judge.known[0].x, True, ""))
    assert outcome.minimum == 0 and blank.known[0].source == "an answer" and outcome.angle < 1e-14


def test_methods_run_on_the_same_starts_and_ours_agrees_with_the_search_of_the_package(judge):
    methods = [*ours(), *(m for m in ipopt_alone() if m.accuracy in (1e-4, 1e-8))]
    found = run_problem(methods, PLAN, 0, judge)
    mine = found[OURS]
    assert np.isfinite(mine.seconds).all() and (mine.seconds > 0).all()
    record = Record()
    for start in draw_starts(judge.model, 0, PLAN.starts)[0]:
        run_one(judge.model, start.x, record, pairs=start.pairs)
    reached = {a.polished.x.tobytes() for a in record.answers}
    of_round = mine.minimum[0][mine.minimum[0] >= 0]
    assert {int(i) for i in of_round} <= set(range(len(judge.known)))
    for i in set(of_round.tolist()):  # what the method found is what the search itself files
        assert any(np.abs(np.frombuffer(x) - judge.known[i].x).max() < 1e-12 for x in reached)
    sweep = found["IPOPT alone, tol 1e-04"]
    assert np.isfinite(sweep.seconds).sum() == PLAN.rounds * PLAN.sweep
    assert (mine.minimum != FALSE).all()


@pytest.fixture(scope="module")
def tiny():
    """A run of two problems and three methods, with small parts for the rest."""
    from benchmarks.grids import run_grid
    from benchmarks.hessians import compare_hessians
    from benchmarks.run import machine

    problems = [panel_problems()[5], random_problems(0)[9]]
    methods = [*ours(), *(m for m in ipopt_alone() if m.accuracy in (1e-4, 1e-8))]
    data, judges = run_search(problems, methods, PLAN, 0, lambda text: None, job_rounds=1)
    data |= {
        "schema": SCHEMA,
        "machine": machine(),
        "settings": {"seed": 0, "quick": True, "job_rounds": 1, **vars(PLAN)},
        "left_out": {},
        "closure": {k: data[k] for k in ("problems", "methods", "cells")},
        "wedge": {k: data[k] for k in ("problems", "methods", "cells")},
    }
    judge = judges[problems[0].name]
    data["grid"] = [run_grid(problems[0], judge, 33, 1)]
    states = [judge.model.expand(k.x) for k in judge.known if k.kind == "interior"]
    data["hessian"] = compare_hessians(problems[:1], [states], 1)
    data["scaling"] = {
        "limit": 1.0,
        "solves": 2,
        "degrees": [
            {"degree": 4, "contact": "none", **scaling.measure_degree(4, "none", 0)},
            {"degree": 6, "contact": "full", **scaling.measure_degree(6, "full", 0)},
            {"degree": 8, "contact": "full", "stopped": "took longer than 1 s"},
        ],
        "scenes": [{"scenes": 2, **scaling.measure_scenes(2, 0)}],
    }
    return data


def test_a_run_round_trips_through_json(tiny, tmp_path):
    write_bench(tiny, tmp_path / "run.json")
    back = read_bench(tmp_path / "run.json")
    assert back["schema"] == SCHEMA and len(back["cells"]) == len(tiny["cells"])
    for p in back["problems"]:
        assert p["minima"] and all(len(m["digits"]) == p["variables"] for m in p["minima"])
    for cell in back["cells"]:
        assert cell["correct"] + cell["failed"] + cell["false"] == cell["starts"]
    again = digest.rows(back)
    assert [r.label for r in again] == [r.label for r in digest.rows(tiny)]
    (tmp_path / "other.json").write_text("{}")
    with pytest.raises(OptionError, match="not a benchmark of schema"):
        read_bench(tmp_path / "other.json")
    with pytest.raises(OptionError, match="cannot read"):
        read_bench(tmp_path / "none.json")


def test_the_report_says_what_the_data_say(tiny):
    text = markdown(tiny, "figures/x.png")
    assert "![Work-precision diagrams](figures/x.png)" in text and "took longer than 1 s" in text
    for m in tiny["methods"]:
        assert m["label"] in text
    row = digest.rows(tiny)[0]
    assert row.label == OURS and row.ratio == Spread(1.0, 1.0, 1.0, row.ratio.count)
    assert row.false_states == 0 and row.errors["angle"].median < 1e-13
    job = digest.job_summary(tiny)
    assert job["found"] == sum(len(p["minima"]) for p in tiny["problems"]) - sum(
        job["missed"].values()
    )
    # few starts: the rule asks for more than were made, so whole searches are not compared
    assert digest.whole_job_ratios(tiny, "IPOPT alone, tol 1e-08") is None
    for t in digest.targets(tiny):
        word = "not measured" if t.measured is None else "reached" if t.reached else "NOT reached"
        assert any(line.startswith(f"- {word}: {t.text}") for line in text.splitlines())


def test_whole_searches_are_compared_by_seconds_per_minimum():
    search = {"starts": 128, "stopped": True, "seconds": 6.0, "found": {"0": 1e-12, "1": 1e-7}}
    job = {"problem": "p", "seconds": [2.0, 4.0, 4.0], "found": {"0": 0.0, "1": 0.0}, "missed": 0}
    data = {"job": [job], "cells": [{"problem": "p", "method": "m", "until_the_rule": search}]}
    assert digest.whole_job_ratios(data, "m") == Spread(3.0, 3.0, 6.0, 3)
    assert digest.whole_job_ratios(data, "m", 1e-4) == Spread(1.5, 1.5, 3.0, 3)
    assert digest.whole_job_ratios(data, "m", 1e-15).median == math.inf
    assert digest.whole_job_ratios(data, "another") is None


def test_appendix_a_is_compared_by_its_best_step():
    state = {
        "seconds": {"exact": [1.0, 2.0], "appendix A": [100.0, 100.0]},
        "error_exact": 1e-15,
        "error_appendix": {"0.0003": 1e-9, "0.001": 1e-8, "0.003": None},
    }
    time, error = digest.hessian_ratios({"hessian": [state]})
    assert (time.low, time.high, time.count) == (50.0, 100.0, 2)
    assert error.median == pytest.approx(1e6)


@pytest.mark.parametrize("suffix", thinned([".png", ".pdf", ".svg"], 3))
def test_the_figure_is_written(tiny, tmp_path, suffix):
    draw_bench(tiny, tmp_path / f"x{suffix}")
    assert (tmp_path / f"x{suffix}").stat().st_size > 10_000


def test_a_size_that_takes_too_long_is_stopped_and_said_so():
    assert scaling._child(["degree", "30", "full", "0"], 0.2) == {
        "stopped": "took longer than 0.2 s"
    }
    assert scaling._child(["degree", "four", "none", "0"], 60.0)["stopped"].startswith("ValueError")
    assert scaling.memory() > 10


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["speed", "--seed", "-1"], "seed = -1"),
        (["speed", "-o", "x.txt"], "-o = 'x.txt'"),
        (["speed", "-o", "no_such_folder/x.md"], "-o = 'no_such_folder/x.md'"),
        (["hard", "--quick"], "no such option: --quick"),
    ],
)
def test_bad_options_are_refused_before_any_work(arguments, message, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["benchmarks", *arguments])
    with pytest.raises(SystemExit) as ended:
        main(app)
    assert ended.value.code == 2 and message in capsys.readouterr().err


def test_the_command_writes_what_is_asked(tiny, monkeypatch, tmp_path):
    from typer.testing import CliRunner

    monkeypatch.setattr("benchmarks.run_bench", lambda **options: tiny)
    names = ("a.json", "f/a.png", "a.md")
    (tmp_path / "f").mkdir()
    arguments = [v for n in names for v in ("-o", str(tmp_path / n))]
    result = CliRunner().invoke(app, ["speed", "--quick", *arguments])
    assert result.exit_code == 0, result.output
    assert read_bench(tmp_path / "a.json")["schema"] == SCHEMA
    assert "(f/a.png)" in Path(tmp_path / "a.md").read_text()
    piped = CliRunner().invoke(app, ["speed", "-o", "-"])
    assert json.loads(piped.stdout)["schema"] == SCHEMA


def test_hard_cases_are_run_shown_and_counted(monkeypatch, tmp_path):
    from typer.testing import CliRunner

    from benchmarks import hard, hard_case

    def of(value):
        measured = (hard_case.Measured("angle", value, 1e-10),)
        outcomes = (hard_case.Outcome("one setting", measured, "minimum", True),)
        case = hard_case.HardCase("a case", "hard", "known", "must", lambda: iter(()))
        return lambda progress=None: hard.HardReport((hard.HardResult(case, outcomes),))

    for value, code in ((1e-12, 0), (1e-3, 1)):
        monkeypatch.setattr("benchmarks.run_hard", of(value))
        names = ["-o", str(tmp_path / "h.json"), "-o", str(tmp_path / "h.md")]
        result = CliRunner().invoke(app, ["hard", *names])
        assert result.exit_code == code and "one setting" in result.output
        data = json.loads((tmp_path / "h.json").read_text())
        assert data["cases"][0]["outcomes"][0]["passed"] is (code == 0)
        assert "# Hard cases" in (tmp_path / "h.md").read_text()


@pytest.mark.slow
def test_the_quick_run_has_every_part(tmp_path):
    from benchmarks import run_bench

    said = []
    data = run_bench(quick=True, progress=said.append)
    write_bench(data, tmp_path / "x.json")
    assert said and data["hessian"] and data["grid"] and data["scaling"]["degrees"]
    assert {r.label for r in digest.rows(data)} >= {OURS, "IPOPT alone, tol 1e-08"}
    assert all(m["digits"] for p in data["problems"] for m in p["minima"])
    draw_bench(data, tmp_path / "x.png")
    assert "## In short" in markdown(data)
