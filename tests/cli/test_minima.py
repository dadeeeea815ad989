"""The command line does what the README and the contract say."""

import csv
import json
import math

import pytest

import origami_nlp
from origami_nlp import MinimaResult
from tests.command_line import run, scene_file


@pytest.fixture
def scene(tmp_path):
    return scene_file(tmp_path, origami_nlp.examples.degree6("pi/4", 1))


def test_minima_writes_the_contract(scene, tmp_path):
    out = tmp_path / "out.json"
    code, table, _ = run("minima", scene, "-o", out)
    assert code == 0 and "IPOPT" not in table
    data = json.loads(out.read_text())
    assert data["schema"] == "origami-nlp/minima/5"
    assert {"origami", "search", "completeness", "model", "flags"} <= set(data)
    assert set(data["model"]) == {"variables", "equalities", "left_out"}
    assert {"starts", "solves", "quiet", "effort", "seconds", "seed"} <= set(data["search"])
    for m in data["minima"]:
        assert len(m["fold_angles"]) == 6
        assert m["kind"] in ("interior", "contact-pinned", "contact-touching", "degenerate")
        assert m["local_dimension"] in (0, 1, 2)
        assert m["closure_residual"] <= 1e-14 and m["kkt_residual"] <= 1e-12
        for c in m["contacts"]:
            assert c["type"] in ("fold-limit", "facet-pair")
            assert ("creases" in c) != ("facets" in c)
            low, high = c["multiplier_range"]
            assert low - 1e-12 <= c["multiplier"] <= (math.inf if high is None else high + 1e-12)
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
