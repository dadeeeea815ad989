"""An exception that no command expects: its traceback, one line, exit code 70."""

from origami_nlp import examples
from tests.command_line import run, scene_file


def failing(monkeypatch, error):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr("origami_nlp.pattern_problem.PatternProblem.__str__", fail)


def test_an_unexpected_error_is_a_traceback_and_one_line(tmp_path, monkeypatch):
    scene = scene_file(tmp_path, examples.degree6("pi/3", 1))
    failing(monkeypatch, ZeroDivisionError("division\nby \x1b zero"))
    code, out, err = run("inspect", scene)
    assert (code, out) == (70, "") and "test_fault.py" in err and "\x1b" not in err
    assert err.splitlines()[-1].startswith("origami-nlp: internal error, please report")
