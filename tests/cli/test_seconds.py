"""``--seconds`` bounds the wall time of every command that searches; what was found until then is told, by name."""

import time

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.cli import app
from origami_nlp.cli.timed import ENDED
from tests.command_line import run, scene_file

SEARCHES = (
    "minima landscape contacts modes load barriers critical space transitions design pattern follow boundary sweep"
).split()


def slow_vertex():
    rng = np.random.default_rng(2)
    sectors = rng.uniform(0.5, 1.5, 12)
    return Scene(
        Vertex(tuple(sectors * 2 * np.pi / sectors.sum())),
        tuple(rng.uniform(0.5, 2, 12)),
        tuple(rng.uniform(-1, 1, 12)),
        "none",
        "fold-limits",
    )


def test_every_command_that_searches_has_a_limit():
    from typer.main import get_command

    commands = get_command(app).commands
    for name in SEARCHES:
        group = commands["paper"].commands if name == "transitions" else commands
        options = [option for p in group[name].params for option in p.opts]
        assert "--seconds" in options, name


def test_a_search_keeps_to_its_limit_of_wall_time_and_says_so():
    begin = time.perf_counter()
    result = find_minima(slow_vertex(), seconds=2.0)
    assert time.perf_counter() - begin < 60  # unbounded: minutes of processor time
    assert result.search.stopped_by == "time" and result.flags.search_stopped_early
    assert "interrupted by the time limit" in str(result)


def test_a_limit_that_is_not_reached_changes_nothing():
    scene = examples.degree6("pi/4", ratio=0.01)
    free, bounded = (find_minima(scene, max_starts=64, seconds=s) for s in (None, 3600.0))
    assert [m.fold_angles for m in free.minima] == [m.fold_angles for m in bounded.minima]
    assert free.search.outcomes == bounded.search.outcomes
    assert free.completeness.status == bounded.completeness.status


def test_what_is_not_judged_in_the_full_space_is_undecided_by_name():
    scene = examples.degree6("pi/4", ratio=0.01)
    result = find_minima(scene, full=True, seconds=0.0)
    assert result.search.stopped_by == "time"
    assert all(m.full_space.verdict == "undecided" for m in result.minima)


@pytest.mark.parametrize(
    "words",
    [("barriers",), ("space",), ("follow", "--over", "creases.stiffness[1]=0.01:0.02")],
)
def test_a_command_whose_time_is_over_tells_what_it_has(tmp_path, words):
    scene = scene_file(tmp_path, examples.degree6("pi/3", 1))
    out = tmp_path / "out.json"
    done = run(words[0], scene, *words[1:], "--seconds", 0.01, "--json", out)
    assert done.code == ENDED and not out.exists()
    assert "interrupted by the time limit (--seconds 0.01)" in " ".join(done.out.split())
    assert "Traceback" not in done.out + done.err


@pytest.mark.parametrize("value", ["-1", "nan", "inf", "soon"])
def test_a_limit_is_a_number_of_seconds(tmp_path, value):
    scene = scene_file(tmp_path, examples.degree6("pi/3", 1))
    code, _, err = run("space", scene, f"--seconds={value}")
    assert code == 2 and "seconds" in err


def test_vertices_of_a_file_are_told_as_they_are_done(tmp_path, monkeypatch):
    """Two classes of vertices: the first is told before the second is begun."""
    from origami_nlp.minima import find_vertexwise

    scenes = {1: examples.degree6("pi/3"), 4: examples.degree6("pi/4")}
    told = []

    def find(scene, **options):
        told.append("begun")
        return find_minima(scene, max_starts=16, prove=False, **options)

    find_vertexwise(scenes, find=find, found=told.append)
    assert [line.split(":")[0] for line in told] == ["begun", "vertex 1", "begun", "vertex 4"]
