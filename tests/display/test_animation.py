"""Films of states: only stored states are shown, and what cannot be written is named before the search."""

import dataclasses
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import origami_nlp as o
from origami_nlp.display import Content, animation, draw_states, write_animation
from origami_nlp.folding import check_admissible
from origami_nlp.minima import MinimaResult
from tests.command_line import run, scene_file
from tests.computed_once import panel_result


@pytest.fixture(scope="module")
def result() -> MinimaResult:
    return panel_result(o.examples.degree6("pi/3", 1.0), full=True)


@pytest.fixture(scope="module")
def content(result: MinimaResult) -> Content:
    return result.view_content()


def test_every_picture_is_of_a_stored_admissible_state(
    content: Content, result: MinimaResult
) -> None:
    stored = [s.folded for s in content.stations] + [f for t in content.tracks for f in t.states]
    shots = list(animation.film(content))
    assert {id(shot.state) for shot in shots} <= {id(state) for state in stored}
    for state in {id(shot.state): shot.state for shot in shots}.values():
        assert check_admissible(result.scene.vertex, state.fold_angles).admissible
    views = np.array([shot.view for shot in shots])
    assert np.abs(views @ views.transpose(0, 2, 1) - np.eye(3)).max() < 1e-12
    # the unstable state folds down its descent; the others have no path, and it is said
    moved = [shot.caption for shot in shots if "descent" in shot.caption]
    assert len(moved) > 10 and moved[0].startswith("1 →")
    others = {s.caption for s in shots if s.caption.startswith(("state 2", "state 3"))}
    assert len(others) == 2 and all("turned only" in caption for caption in others)


@pytest.fixture
def part(content: Content, monkeypatch: pytest.MonkeyPatch) -> Content:
    """Two states that are turned in three steps."""
    monkeypatch.setattr(animation, "FRAMES", 3)
    monkeypatch.setattr(animation, "HELD", 1)
    return dataclasses.replace(content, stations=content.stations[1:3], tracks=())


@pytest.mark.skipif(not shutil.which("ffprobe"), reason="ffmpeg is not installed")
def test_file_by_ffmpeg_has_all_pictures(part: Content, tmp_path: Path) -> None:
    write_animation(part, tmp_path / "states.mp4")
    ask = "ffprobe -v error -count_frames -select_streams v -of csv=p=0".split()
    what = ["-show_entries", "stream=codec_name,pix_fmt,nb_read_frames"]
    said = subprocess.run([*ask, *what, tmp_path / "states.mp4"], capture_output=True, text=True)
    assert said.stdout.strip() == "h264,yuv420p,8", said  # what every player takes


FFMPEG = """#!{python}
import sys
from pathlib import Path
data = sys.stdin.buffer.read()
Path({record!r}).write_text("\\n".join([*sys.argv[1:], str(len(data))]))
Path(sys.argv[-1]).write_bytes(b"film")
"""
"""Notes how it was called and how much it was given, and writes a file."""


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in is a script")
def test_ffmpeg_is_given_all_pictures_and_a_form_that_players_take(
    part: Content, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program, record = tmp_path / "bin" / "ffmpeg", tmp_path / "record"
    program.parent.mkdir()
    program.write_text(FFMPEG.format(python=sys.executable, record=str(record)))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(program.parent))
    write_animation(part, tmp_path / "states.mp4")
    assert (tmp_path / "states.mp4").read_bytes() == b"film"
    *said, size = record.read_text().splitlines()
    width, height = map(int, said[said.index("-s") + 1].split("x"))
    assert width % 2 == height % 2 == 0  # H.264 with yuv420p needs even sides
    assert "yuv420p" in said and "h264" in said and said[-1].endswith(".mp4")
    assert int(size) == 8 * width * height * 4  # eight pictures of RGBA


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in is a script")
def test_a_failing_ffmpeg_is_named(
    part: Content, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "bin" / "ffmpeg"
    program.parent.mkdir()
    program.write_text(f"#!{sys.executable}\nimport sys\nsys.exit('Unknown encoder h264')\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(program.parent))
    with pytest.raises(
        o.OrigamiError,
        match=r"states\.mp4': ffmpeg failed \((Unknown encoder h264|it ended early)\): use \.gif",
    ):
        write_animation(part, tmp_path / "states.mp4")
    assert not (tmp_path / "states.mp4").exists()


def test_file_has_all_pictures_and_they_differ(part: Content, tmp_path: Path) -> None:
    write_animation(part, tmp_path / "states.gif")
    with Image.open(tmp_path / "states.gif") as film:
        frames = []
        for k in range(film.n_frames):
            film.seek(k)
            frames.append(film.convert("RGB").tobytes())
    assert len(frames) == len(list(animation.film(part))) == 8
    assert len(set(frames)) == 6  # each state stands still once where its turn began


def test_what_cannot_be_written_is_said_before_the_search(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, result: MinimaResult
) -> None:
    scene = scene_file(tmp_path, result.scene)
    monkeypatch.setattr(animation.shutil, "which", lambda name: None)
    for name, word in (("film.mp4", "ffmpeg"), ("film.avi", ".gif")):
        done = run("minima", scene, "-o", tmp_path / name)
        assert done.code == 2 and not done.out and word in done.err
        assert done.err.count("\n") == 1 and not (tmp_path / name).exists()
    done = run("barriers", "panels", "-o", tmp_path / "film.gif")
    assert done.code == 2 and "all panels" in done.err


def test_states_stand_side_by_side(result: MinimaResult) -> None:
    states = [(m.title(k), m.phi) for k, m in enumerate(result.minima, start=1)]
    figure = draw_states(result.scene, states, "")
    titles = [text.get_text() for text in figure.texts]
    assert len(titles) == len(result.minima)
    assert all(m.kind in title for m, title in zip(result.minima, titles, strict=True))
    figure.canvas.draw()
    for axes in figure.axes[: len(titles)]:  # nothing that is painted was cut off
        rows = np.asarray(axes.images[0].get_array())[..., 3].any(axis=1)
        bottom, top = axes.images[0].get_extent()[2:]
        lowest = bottom + (top - bottom) * float(np.argmax(rows)) / len(rows)
        assert axes.get_ylim()[0] <= lowest
