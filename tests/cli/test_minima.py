"""The command line does what the README and the contract say."""

import csv
import json

import numpy as np
import pytest

import origami_nlp
from origami_nlp import MinimaResult
from tests.command_line import run, scene_file
from tests.computed_once import panel_result


@pytest.fixture
def scene(tmp_path):
    return scene_file(tmp_path, origami_nlp.examples.degree6("pi/4", 1))


@pytest.mark.slow  # eleven seconds: all states without the symmetry
def test_the_symmetry_of_a_scene_file_is_set_aside(tmp_path):
    """Six equal sectors: 4 minima keep the symmetry; without it there are 21 stable states, the stable 3 among them."""
    scene = scene_file(tmp_path, origami_nlp.examples.degree6("pi/3", 1))
    out = tmp_path / "out.json"
    code, table, _ = run("minima", scene, "--symmetry", "none", "-o", out)
    assert code == 0 and "21 stable states" in table and "not listed" not in table
    every = np.array([m["fold_angles"] for m in json.loads(out.read_text())["minima"]])
    kept = panel_result(origami_nlp.examples.degree6("pi/3", 1), full=True)
    assert [m.full_space.verdict for m in kept.minima].count("stable") == 3
    for m in kept.minima:
        near = np.abs(every - m.phi).max(axis=1).min() < 1e-6
        assert near == (m.full_space.verdict == "stable")


def test_minima_writes_the_contract(scene, tmp_path):
    out = tmp_path / "out.json"
    code, table, _ = run("minima", scene, "-o", out)
    assert code == 0 and "IPOPT" not in table
    data = json.loads(out.read_text())
    assert data["schema"] == "origami-nlp/minima/3"
    assert set(data) == {
        "schema",
        "origami",
        "minima",
        "search",
        "completeness",
        "relations",
        "model",
        "flags",
        "closure_stress",
        "lattices",
    }
    assert data["lattices"] == []
    assert set(data["model"]) == {"variables", "equalities", "left_out"}
    assert {"starts", "solves", "statuses", "quiet", "effort", "seconds", "seed"} <= set(
        data["search"]
    )
    assert sum(data["search"]["statuses"].values()) == data["search"]["solves"]
    for m in data["minima"]:
        assert len(m["fold_angles"]) == 6
        assert m["kind"] in ("interior", "contact-pinned", "contact-touching", "degenerate")
        assert m["local_dimension"] in (0, 1, 2)
        assert m["closure_residual"] <= 1e-14 and m["kkt_residual"] <= 1e-12
        for c in m["contacts"]:
            assert c["type"] in ("fold-limit", "facet-pair")
            assert ("creases" in c) != ("facets" in c)
            low, high = c["multiplier_range"]
            assert low <= c["multiplier"] + 1e-12 and (
                high is None or c["multiplier"] <= high + 1e-12
            )
    result = MinimaResult.from_dict(data)
    assert result.to_dict() == data


def test_the_table_as_csv_has_the_numbers_of_the_json(tmp_path):
    scene = scene_file(tmp_path, origami_nlp.examples.miura())
    json_file, csv_file = tmp_path / "a.json", tmp_path / "a.csv"
    assert run("minima", scene, "--effort", "quick", "-o", json_file, "-o", csv_file).code == 0
    rows = [*csv.DictReader(csv_file.read_text().splitlines())]
    minima = json.loads(json_file.read_text())["minima"]
    assert [float(row["energy_J"]) for row in rows] == [m["energy"] for m in minima]
    assert [float(row["phi_1_rad"]) for row in rows] == [m["fold_angles"][0] for m in minima]


def test_the_same_seed_gives_the_same_answer(tmp_path):
    scene = scene_file(tmp_path, origami_nlp.examples.degree6("pi/4", 0.01, contact="fold-limits"))
    answers = []
    for name in ("a", "b"):
        out = tmp_path / f"{name}.json"
        run("minima", scene, "-o", out, "--seed", 3, "--max-starts", 24, "--no-full", "--prove", 0)
        data = json.loads(out.read_text())
        data["search"].pop("seconds")
        answers.append(data)
    assert answers[0] == answers[1]


def test_stability_in_full_space_is_judged_unless_declined(scene):
    verdicts = [
        json.loads(run("minima", scene, "--max-starts", 8, "--prove", 0, *more, "-o", "-").out)
        for more in ((), ("--no-full",))
    ]
    assert all(m["full_space"] for m in verdicts[0]["minima"])
    assert all(m.get("full_space") is None for m in verdicts[1]["minima"])
