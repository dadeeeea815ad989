"""How commands end: one table of exit codes, one clock for all that can be long, and what there is is written."""

import json
import os
import time
from dataclasses import replace

import pytest

from origami_nlp import design, examples, format_scene
from origami_nlp.cli import Ended
from tests.cli.test_design import TWO
from tests.cli.test_seconds import slow_vertex
from tests.command_line import run

SWEEP = """
[scene]
example = "degree6"
[[axes]]
set = "ratio"
from = 1
to = 2
count = 40
"""
CODES = {
    "inspect miura:2x2": Ended.DONE,
    "minima miura.toml --no-prove": Ended.DONE,
    "check flat.fold": Ended.DONE,
    "check miura:2x2": Ended.NO,
    "check nowhere.fold": Ended.WRONG,
    "design two.toml": Ended.NO,
    "paper verify --only s2.loop-closure": Ended.DONE,
    "minima nowhere.toml": Ended.WRONG,
    "minima": Ended.WRONG,
    "nothing": Ended.WRONG,
    "minima miura.toml --seconds -1": Ended.WRONG,
    "check flat.fold --seconds nan": Ended.WRONG,
    "sweep sweep.toml --folder swept --seconds inf": Ended.WRONG,
}
LONG = (
    "minima slow.toml",
    "minima miura:3x3",
    "inspect miura:40x40",
    "inspect miura:2x2 --path",
    "contacts slow.toml",
    "contacts miura:3x3",
    "load slow.toml --crease 1",
    "load miura:2x2 --crease 1",
    "follow miura.toml --parameter creases.stiffness[1]=0.5:1.5",
    "boundary six.toml --event ratio=1:10 --parameter alpha=74deg:75deg",
    "barriers six.toml",
    "barriers yoshimura:2x1",
    "landscape six.toml",
    "landscape six.toml --space",
    "landscape six.toml --critical",
    "design waitukaitis-five",
    "check miura:24x24",
    "check miura:24x24 --orders",
    "sweep sweep.toml --folder swept",
    "paper panels",
    "paper verify",
    "paper transitions degree6",
    "paper cone phase --degree 30",
)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with scenes, a sheet and a sweep."""
    monkeypatch.chdir(tmp_path)
    for name, scene in (
        ("miura", examples.miura()),
        ("six", examples.degree6("pi/3", 1)),
        ("slow", slow_vertex()),
    ):
        (tmp_path / f"{name}.toml").write_text(format_scene(scene))
    flat = examples.crease_pattern("miura", 3, 3)
    del flat["edges_foldAngle"]
    (tmp_path / "flat.fold").write_text(json.dumps(flat))
    (tmp_path / "sweep.toml").write_text(SWEEP)
    (tmp_path / "two.toml").write_text(TWO)
    return tmp_path


@pytest.mark.parametrize("line", CODES)
def test_how_a_command_ends(here, line):
    done = run(*line.split())
    assert done.code == CODES[line], done
    assert done.code != Ended.WRONG or done.err.count("\n") <= 1
    assert not (here / "swept").exists()


@pytest.mark.parametrize(
    "line",
    [
        "minima miura.toml --no-prove",
        "inspect miura:2x2 --path",
        "design two.toml",
        "check flat.fold",
        "check flat.fold --orders",
        "paper cone foldings --degree 8",
    ],
)
def test_json_in_a_pipe_is_only_json(here, line):
    done = run(*line.split(), "-o", "-")
    assert done.code in (Ended.DONE, Ended.NO) and done.err
    json.loads(done.out, parse_constant=pytest.fail)


def test_a_design_that_fails_its_check_is_open(here, monkeypatch):
    def neither(*given, **options):
        return replace(design(*given, **options), refuted=False)

    monkeypatch.setattr("origami_nlp.inverse_design.design", neither)
    assert run("design", "two.toml").code == Ended.OPEN


# the time may be over between the opening of a file and the statement that closes it
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("line", LONG)
def test_a_command_whose_time_is_over_ends_soon_with_one_code(here, line):
    begin = time.process_time()
    done = run(*line.split(), "--seconds", 0.01)
    assert time.process_time() - begin < 2.0, done
    assert done.code == Ended.OUT_OF_TIME, done
    assert "Traceback" not in done.out + done.err and "internal" not in done.err
    assert "time limit" in " ".join(done.out.split()), done
    assert not any(name.startswith("origami-nlp-error") for name in os.listdir(here))


def test_what_was_found_is_kept_by_ctrl_c(here, monkeypatch):
    from origami_nlp.errors import Interrupted
    from origami_nlp.verbs import find_minima as find

    def late(*given, **options):
        raise Interrupted(find(*given, **options))

    monkeypatch.setattr("origami_nlp.verbs.find_minima", late)
    done = run("minima", "miura.toml", "--no-prove", "-o", "out.json")
    assert done.code == Ended.INTERRUPTED
    assert json.loads((here / "out.json").read_text())["minima"]


def test_codes_are_those_of_the_page():
    """`docs/how_to/troubleshooting.md` lists them."""
    from tests.documentation.pages import ROOT

    page = (ROOT / "docs" / "how_to" / "troubleshooting.md").read_text()
    listed = page.split("| exit code |")[1].split("\n\n")[0]
    shown = {int(row.split("|")[1]) for row in listed.splitlines()[2:]}
    assert shown == {int(code) for code in Ended}
