"""An exception that no command expects: one line, a report with all that mending it takes, exit code 70."""

import errno
import os

import pytest

from origami_nlp import examples, format_scene
from tests.command_line import run, scene_file


def failing(monkeypatch, error):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr("origami_nlp.pattern_problem.PatternProblem.__str__", fail)


def test_an_unexpected_error_is_one_line_and_a_report_with_the_scene(tmp_path, monkeypatch):
    scene = scene_file(tmp_path, examples.degree6("pi/3", 1))
    failing(monkeypatch, ZeroDivisionError("division\nby \x1b zero"))
    monkeypatch.chdir(tmp_path)
    for number in (1, 2):  # no report is written over
        code, out, err = run("inspect", scene)
        assert (code, out) == (70, "") and err.count("\n") == 1 and "Traceback" not in err
        assert err.startswith(
            "origami-nlp: internal error, please report: ZeroDivisionError: division by"
        )
        file = tmp_path / f"origami-nlp-error-{number}.txt"
        assert file.name in err and "\x1b" not in err
        report = file.read_text()
        assert f"command: origami-nlp inspect {scene}" in report
        assert format_scene(examples.degree6("pi/3", 1)) in report
        assert "Traceback" in report and "test_fault.py" in report


def test_where_nothing_can_be_written_the_line_says_so(tmp_path, monkeypatch):
    scene = scene_file(tmp_path, examples.degree6("pi/3", 1))
    failing(monkeypatch, TypeError("x" * 10_000))
    monkeypatch.setattr(os, "access", lambda *_: False)
    code, _, err = run("inspect", scene)
    assert code == 70 and "no report could be written" in err and len(err) < 400


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (BrokenPipeError(), 141, ""),
        (OSError(errno.ENOSPC, "No space left on device"), 2, "No space left on device"),
    ],
)
def test_what_is_no_fault_of_ours_ends_as_before(error, code, words, tmp_path, monkeypatch):
    scene = scene_file(tmp_path, examples.degree6("pi/3", 1))
    failing(monkeypatch, error)
    monkeypatch.chdir(tmp_path)
    found = run("inspect", scene)
    assert found.code == code and words in found.err and "internal" not in found.err
    assert [one.name for one in tmp_path.iterdir()] == [scene.name]
