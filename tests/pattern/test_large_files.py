"""Large and hostile files: time grows with their size, or a stated limit says no in one line."""

import json
import time

import pytest
from typer.testing import CliRunner

from origami_nlp import OrigamiError
from origami_nlp.cli import app
from origami_nlp.errors import SceneFileError
from origami_nlp.pattern import fold_file, parse_fold, parse_scene
from tests.fold_files import disc

RUN = CliRunner()
SLOWER = 5
"""Than the machine where bounds on time were measured; what is not linear takes far longer."""


def chain(n):
    frames = [{"frame_inherit": True, "frame_parent": k, "frame_title": f"{k}"} for k in range(n)]
    return json.dumps({**disc([60, 100, 120, 80], "MVVV"), "file_frames": frames})


def test_three_thousand_frames_that_inherit():
    start = time.process_time()
    frames = parse_fold(chain(3_000))
    assert time.process_time() - start < 5 * SLOWER
    assert len(frames) == 3_001 and frames[-1].title == "2999" and frames[-1].number == 3_000


def test_frames_that_inherit_too_much_are_refused_and_one_can_be_chosen(tmp_path, monkeypatch):
    monkeypatch.setattr(fold_file, "MOST_ELEMENTS", 500)
    file = tmp_path / "a.fold"
    file.write_text(chain(100))
    done = RUN.invoke(app, ["inspect", str(file)])
    assert isinstance(done.exception, OrigamiError)
    assert "500 vertices" in str(done.exception) and "--frame" in str(done.exception)
    done = RUN.invoke(app, ["inspect", str(file), "--frame", "57"])
    assert done.exit_code == 0 and "frame 57" in done.output and "frame 56" not in done.output
    assert [f.number for f in parse_fold(chain(100), "first")] == [0]
    with pytest.raises(OrigamiError, match="--frame -1 has no geometry"):
        parse_fold(chain(100), -1)


@pytest.mark.parametrize("parents", [{1: 2, 2: 1}, {1: 1}, {1: 2, 2: 3, 3: 2}])
def test_frames_that_inherit_from_themselves(parents):
    frames = [{"frame_inherit": True, "frame_parent": parents[k]} for k in sorted(parents)]
    with pytest.raises(OrigamiError, match="frame_parent"):
        parse_fold(json.dumps({**disc([60, 100, 120, 80]), "file_frames": frames}))


def test_inherited_keys_do_not_depend_on_the_order_of_frames():
    data = disc([60, 100, 120, 80], "MVVV")
    frames = [
        {"frame_inherit": True, "frame_parent": 2, "frame_title": "child"},
        {"frame_inherit": True, "frame_parent": 0, "edges_assignment": list("VMMMBBBB")},
        {"frame_inherit": True, "frame_parent": 1},
    ]
    read = parse_fold(json.dumps({**data, "frame_title": "root", "file_frames": frames}))
    assert [f.title for f in read] == ["root", "child", "root", "child"]
    assert [f.assignment[:4] for f in read] == [tuple("MVVV"), *[tuple("VMMM")] * 3]


# ---------------------------------------------------------------- scenes


@pytest.mark.parametrize("part", ["a", '"a"', "'a'", "a \t"])
@pytest.mark.parametrize("form", ["{} = 1", "[{}]", "x = {{{} = 1}}", "[[{}]]"])
def test_keys_of_very_many_parts(part, form):
    text = form.format(".".join([part] * 50_000))
    start = time.process_time()
    with pytest.raises(SceneFileError, match="parts") as caught:
        parse_scene(text)
    assert time.process_time() - start < 2 * SLOWER and len(str(caught.value)) < 200


@pytest.mark.parametrize(
    "count, contact", [(30_000, "fold-limits"), (30_000, "full"), (500, "full")]
)
def test_scenes_of_very_many_creases(tmp_path, count, contact):
    file = tmp_path / "a.toml"
    ones = ", ".join(["1"] * count)
    sectors = ", ".join([f'"2*pi/{count}"'] * count)
    file.write_text(
        f"[vertex]\nsector_angles = [{sectors}]\n[creases]\nstiffness = [{ones}]\nrest_angles = [{ones}]\n"
        f'[model]\nsymmetry = "none"\ncontact = "{contact}"\n'
    )
    start = time.process_time()
    done = RUN.invoke(app, ["inspect", str(file)])
    assert time.process_time() - start < 5 * SLOWER
    assert isinstance(done.exception, OrigamiError) and str(count) in str(done.exception)
