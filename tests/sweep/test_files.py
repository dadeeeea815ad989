"""What a file of a sweep may say, of scenes and of patterns."""

import json
import tomllib

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OrigamiError
from origami_nlp.pattern import pattern_from_dict, pattern_to_dict
from origami_nlp.pattern_problem import PatternProblem, order_layers, state_frame, states_to_fold
from origami_nlp.sweep import parse_sweep, read_sweep, run_sweep
from origami_nlp.sweep.run import run_scene
from origami_nlp.sweep.store import read_store
from tests.command_line import run
from tests.sweep.test_sweep import FEW, PATTERNS, SMALL, Inline


def test_orders_of_layers_of_a_file_are_those_of_every_sheet(tmp_path):
    problem = o.examples.pattern("miura:2x2")
    flat = o.find_motion(problem).fold_angles[-1]
    flat = np.copysign(np.pi, flat)
    data = states_to_fold(problem, [state_frame(problem, flat, "flat-folded")])
    (frame,) = data.pop("file_frames")
    own = {k: v for k, v in frame.items() if k not in ("frame_inherit", "frame_parent")}
    (tmp_path / "folded.fold").write_text(json.dumps(data | own))
    read = o.read_pattern(tmp_path / "folded.fold")
    assert read.orders and order_layers(PatternProblem(read), flat).stated
    axes = [{"set": "creases.stiffness", "values": [0.01, 2.0]}]
    tables = {"pattern": {"file": "folded.fold"}, "axes": axes, "search": {"starts": 0}}
    sweep = parse_sweep(tables, tmp_path)
    for k in range(2):
        made = sweep.scene(k)
        again = pattern_from_dict(json.loads(json.dumps(pattern_to_dict(made))))
        for one in (made, again):
            assert one.orders == read.orders and one.stiffness[0] == axes[0]["values"][k]
            assert order_layers(PatternProblem(one), flat).stated
    # orders that contradict how facets lie are refused before a sheet is searched
    f, g, s = own["faceOrders"][0]
    wrong = [[f, g, -s], *own["faceOrders"][1:]]
    (tmp_path / "folded.fold").write_text(json.dumps(data | own | {"faceOrders": wrong}))
    with pytest.raises(OrigamiError, match="faceOrders"):
        parse_sweep(tables, tmp_path)


def test_places_of_a_pattern(tmp_path):
    problem = o.examples.pattern("metasheet:2x2")
    (tmp_path / "sheet.fold").write_text(json.dumps(states_to_fold(problem)))
    (tmp_path / "sweep.toml").write_text(
        '[pattern]\nfile = "sheet.fold"\n'
        '[[axes]]\nset = ["creases.stiffness[2]", "creases.stiffness[4]"]\nvalues = [3, 5]\n'
        '[[axes]]\nset = "creases.rest_angles[1]"\nvalues = ["-pi/3", 1]\n'
        '[search]\nmode = "list"\nstarts = 1\n'
    )
    sweep = read_sweep(tmp_path / "sweep.toml")
    (tmp_path / "sheet.fold").unlink()  # the sweep has it
    made = sweep.scene(1)
    assert sweep.count == 2 and made.stiffness[[1, 3]].tolist() == [5, 5] and made.rest[0] == 1
    assert made.stiffness[[0, 2]] == pytest.approx(problem.stiffness[[0, 2]])
    drawn = parse_sweep(
        {
            "pattern": {"example": "miura:2x2", "rest_angle": 1.0},
            "axes": [{"set": "alpha", "values": [1.0, "pi/3"]}, {"set": "rows", "values": [2, 3]}],
        }
    )
    assert drawn.scene(3).facets == 6
    same = o.examples.pattern("miura", 2, 2, alpha=1.0).with_springs(rest_angles=1.0)
    assert pattern_to_dict(drawn.scene(0)) == pattern_to_dict(same)
    assert pattern_to_dict(pattern_from_dict(pattern_to_dict(made))) == pattern_to_dict(made)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"pattern": {"example": "nothing"}}, "nothing"),
        ({"pattern": {"example": "miura:2x2", "file": "a.fold"}}, "example"),
        ({"pattern": {"example": "miura:2x2", "size": 3}}, "size"),
        ({"axes": []}, "axes"),
        ({"axes": [{"set": "creases.stiffness[9]", "values": [1]}]}, r"\[6\]"),
        ({"axes": [{"set": "creases.stiffness", "values": [-1]}]}, "stiffness"),
        ({"axes": [{"set": "rows", "values": [2]}]}, "rows"),
        (
            {"pattern": {"example": "miura:2x2"}, "axes": [{"set": "rows", "values": [2.5]}]},
            "whole",
        ),
        ({"axes": [{"set": "beta", "values": [2.5]}]}, "beta"),
        ({"search": {"starts": -1}}, "starts"),
        ({"search": {"contact": 1}}, "contact"),
        ({"scene": {}}, "scene"),
    ],
)
def test_what_is_wrong_is_named(change, word):
    with pytest.raises(OrigamiError, match=word):
        parse_sweep(tomllib.loads(PATTERNS) | change)


def test_a_sheet_that_cannot_be_made_is_invalid():
    data = tomllib.loads(PATTERNS)
    data["axes"][0] = {"set": "alpha", "values": [1.0, 4.0]}
    assert run_scene(parse_sweep(data), 2)["status"] == "invalid"


def test_scenes_that_cannot_be_made_are_recorded(tmp_path):
    text = FEW.replace('values = ["pi/4", 1.2]', "values = [1.2, 4.0]")
    report = run_sweep(parse_sweep(tomllib.loads(text)), tmp_path, executor=Inline())
    assert report.counts == {"done": 2, "invalid": 2}
    assert "rest_angles[1]" in read_store(tmp_path)[1][3]["reason"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("[search]", "[serach]"), ["[serach]"]),
        (("starts = 4", "starts = -1"), ["search.starts", "at least 0"]),
        (("starts = 4", "stats = 4"), ["'stats'", "starts"]),
        (('scale = "log"', 'scale = "cubic"'), ["axes[2].scale", "linear or log"]),
        (("from = 0.1", "from = -1"), ["axes[2]", "above 0"]),
        (("count = 6", "count = 0"), ["axes[2].count"]),
        (("count = 6", "count = 100000000"), ["axes[2].count"]),
        (("count = 6\n", "\n"), ["axes[2] needs", "count"]),
        (('"creases.stiffness[2]"', '"creases.stiffness[9]"'), ["stiffness[9]", "to stiffness[6]"]),
        (('"creases.stiffness[2]"', '"__class__.x[1]"'), ["no number"]),
        (('name = "k"', 'name = "rest"'), ["two axes", "'rest'"]),
        (('["pi/4", 1.2]', '["pi/4", "x"]'), ["axes[1].values[2]", "'x'"]),
        (('["pi/4", 1.2]', "[]"), ["axes[1].values"]),
        (('"D3"', '"D7"'), ["D7"]),
        (("[search]", "[search]\nmode = 'list'"), ["equally many", "rest: 2", "k: 6"]),
        (("[[axes]]", "[axes]"), ["TOML"]),
    ],
)
def test_mistakes_get_one_line(tmp_path, change, words):
    spec = tmp_path / "s.toml"
    assert change[0] in SMALL
    spec.write_text(SMALL.replace(*change, 1))
    code, _, err = run("sweep", spec, "--folder", tmp_path / "o")
    assert code == 2 and err.count("\n") == 1
    assert all(word in err for word in words), err
    assert not (tmp_path / "o").exists()


def test_examples_files_and_lists(tmp_path):
    text = """[scene]
        example = "degree6"
        [[axes]]
        set = "alpha"
        values = ["pi/4", "pi/3"]
        [[axes]]
        set = "ratio"
        values = [1, 5]
        """
    sweep = parse_sweep(tomllib.loads(text + '[search]\nmode = "list"\n'))
    assert sweep.count == 2 and sweep.parameters(1) == {"alpha": np.pi / 3, "ratio": 5.0}
    assert sweep.scene(1).vertex.sector_angles[0] == pytest.approx(np.pi / 3)
    (tmp_path / "scene.toml").write_text(
        SMALL.split("[[axes]]")[0].replace("[scene]\n", "").replace("scene.", "")
    )
    (tmp_path / "s.toml").write_text(
        '[scene]\nfile = "scene.toml"\n[[axes]]\nset = "creases.stiffness[1]"\nvalues = [1]\n'
    )
    assert read_sweep(tmp_path / "s.toml").scene(0).degree == 6
    with pytest.raises(OrigamiError, match="cannot read"):
        parse_sweep({"scene": {"file": "no.toml"}, "axes": [{"set": "x", "values": [1]}]}, tmp_path)


def test_places_of_loads():
    scene = {
        "vertex": {"sector_angles_deg": [96, 95, 92, 77]},
        "creases": {"stiffness": [1, 1, 1, 1], "rest_angles": [2.4, 2.4, 0.9, 0.7]},
        "model": {"fixed_facet": 1},
        "loads": [{"crease": 3, "distance": 1, "force": [-1.0, -0.2, -0.15]}],
    }
    axes = [{"set": "loads[1]", "values": [-0.3, 0.1]}]
    (load,) = parse_sweep({"scene": scene, "axes": axes}).scene(1).loads
    assert load.force == pytest.approx((-0.1, -0.02, -0.015))
    for place in ("loads[2]", "loads[0]", "loads[1].nope"):
        with pytest.raises(OrigamiError, match="loads"):
            parse_sweep({"scene": scene, "axes": [{"set": place, "values": [1]}]})


MEASURED = {
    "vertex": {"sector_angles_deg": [99.4, 83.5, 74.1, 102.7], "normalize": True},
    "creases": {"stiffness": [1.0, 2.0, 1.5, 0.7], "rest_angles_deg": [60, 60, -50, 40]},
}


def test_a_sweep_says_by_how_much_it_normalizes():
    axis = {"set": "creases.stiffness[1]", "values": [1.0]}
    assert np.degrees(parse_sweep({"scene": MEASURED, "axes": [axis]}).normalized) == pytest.approx(
        0.075
    )
