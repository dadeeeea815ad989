"""What people see: no letter of it lost to markup, a narrow terminal or a pipe, and a job that lives says so."""

import io
import json
import re
import sys

import origami_nlp
from origami_nlp.cli import progress
from origami_nlp.cli.output import Output
from origami_nlp.display import Table
from origami_nlp.io import printable
from tests.command_line import run
from tests.fold_files import disc

HOSTILE = "a\x1b[31mred\x07\x9b1m\r\u202e[bold]b[/x]\ttail"


def bare(text):
    """Text without spaces and the lines of tables: what must not be lost."""
    return re.sub(r"[\s\u2500-\u257f]", "", text)


# ---------------------------------------------------------------- tables


# ---------------------------------------------------------------- names


def test_printable_text():
    assert (
        printable("\x1b\x00\x7f\x9b\ud800\u202e\n") == "\u241b\u2400\u2421\ufffd\ufffd\ufffd\u240a"
    )
    assert printable("a\n\tb\r", lines=True) == "a\n\tb\u240d"
    assert printable("\u03c0 [rad] \u00e9 \U0001f600") == "\u03c0 [rad] \u00e9 \U0001f600"


def test_tables_and_lines_show_names_as_they_are(capsys):
    Output().say(Table((HOSTILE,), [(HOSTILE,)], HOSTILE))
    Output().say(HOSTILE)
    out = capsys.readouterr().out
    assert not set(out) & set("\x1b\x07\x9b\r\u202e") and bare(out).count("[bold]b[/x]") == 4


def test_hostile_names_reach_no_terminal(tmp_path):
    """A title of a FOLD file, a name in a scene file, keys, options and paths."""
    fold = tmp_path / "a.fold"
    data = disc([60, 100, 120, 80], "MVVV", angles=[-40, 60, 70, 80])
    fold.write_text(json.dumps({**data, "frame_title": HOSTILE}))
    scene = tmp_path / "s.toml"
    named = origami_nlp.Scene(
        origami_nlp.Vertex.from_degrees([60, 100, 120, 80]), [1] * 4, [0.1] * 4, name=HOSTILE
    )
    scene.write_text(origami_nlp.format_scene(named))
    assert origami_nlp.read_scene(scene) == named  # nothing of it is lost
    bad = tmp_path / "bad.toml"
    bad.write_text('["a\\u001b[31m"]\nx = 1\n')
    few = ("--max-starts", "5")
    for args in (
        ["inspect", fold],
        ["inspect", scene],
        ["minima", scene, *few],
        ["minima", fold, *few],
        ["inspect", bad],
        ["inspect", tmp_path / "a\x1b[31m"],
    ):
        done = run(*args)
        assert not set(done.out + done.err) & set("\x1b\x07\x9b\r\u202e"), (args, done)
    assert not set(repr(named)) & set("\x1b\x07\x9b\r\u202e")


# ---------------------------------------------------------------- progress


def test_terminals_have_a_bar(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(sys, "stderr", Terminal())
    with progress.progress("[rad]", 3) as report:
        report(2)
        with progress.progress("inner") as inner:
            inner(text="[x]")
    plain = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", sys.stderr.getvalue())
    assert "[rad]" in plain and "2 of 3, inner: [x]" in plain
