"""The program in a terminal of its own: what stays on the screen when it ends, and when it is interrupted."""

import os
import re
import signal
import subprocess
import sys
import time

import pytest

from origami_nlp import examples
from origami_nlp.cli import main
from tests.command_line import run, scene_file

pty = pytest.importorskip("pty")

SLOW = """
import signal
import time
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background of a shell
from origami_nlp.cli import main, search
def wait(*_, **__):
    print("searching", flush=True)
    time.sleep(60)
import origami_nlp.minima
origami_nlp.minima.find_minima = wait
main()
"""


class Terminal:
    """A program whose output, or only its errors, is a terminal."""

    def __init__(self, code, *arguments, width=70, stdout=True):
        self.mine, other = pty.openpty()
        root = os.path.dirname(os.path.dirname(os.path.dirname(__file__)))
        settings = {"COLUMNS": str(width), "PYTHONPATH": root, "TERM": "xterm"}
        self.process = subprocess.Popen(
            [sys.executable, "-c", code, *map(str, arguments)],
            stdin=other,
            stdout=other if stdout else subprocess.DEVNULL,
            stderr=other,
            env={**os.environ, **settings},
        )
        os.close(other)

    def read(self, until=b""):
        """Return what is shown until a word, or the end."""
        reported = b""
        while not until or until not in reported:
            try:
                part = os.read(self.mine, 65536)
            except OSError:  # nobody writes any more
                break
            reported += part
            if not part:
                break
        if not until:
            self.code = self.process.wait(300)
            os.close(self.mine)
        return reported.decode().replace("\r\n", "\n")


@pytest.mark.skipif(not hasattr(signal, "SIGINT") or os.name == "nt", reason="needs signals")
def test_an_interrupted_search_leaves_a_clean_line(tmp_path):
    scene = scene_file(tmp_path, examples.degree6("pi/3", 1))
    terminal = Terminal(SLOW, "minima", scene)
    shown = terminal.read(b"searching")
    time.sleep(0.3)
    terminal.process.send_signal(signal.SIGINT)
    shown += terminal.read()
    assert terminal.code == 130
    assert shown.endswith("\norigami-nlp: interrupted\n") and "Traceback" not in shown
    assert shown.rindex("\x1b[?25h") > shown.rindex("\x1b[?25l")  # the cursor is seen again


@pytest.mark.slow
def test_who_asks_for_no_file_is_told_which_could_be_written_on_a_terminal_only(tmp_path):
    program = "from origami_nlp.cli import main; main()"
    line = ["paper", "cone", "count", "--degree", 6, "--rest-elevation", 0.3]
    shown = Terminal(program, *line).read()
    assert shown.rstrip("\x1b[0m\n").endswith("-o FILE writes this to a file")
    shown = Terminal(program, *line, "-o", tmp_path / "a.json").read()
    assert "writes this" not in shown and shown.endswith(f"written: {tmp_path / 'a.json'}\n")
    shown = Terminal(program, *line, stdout=False).read()
    assert shown == ""
    assert "writes this" not in "".join(run(*line)[1:])


def test_what_is_written_is_told_last(tmp_path):
    scene = scene_file(tmp_path, examples.degree6("pi/3", 1))
    for command, options in (
        (["minima", scene, "--max-starts", 16], ["json", "fold"]),
        (["paper", "cone", "count", "--degree", 6, "--rest-elevation", 0.3], ["json"]),
        (["paper", "cone", "phase", "--degree", 6, "--size", 12], ["csv", "json"]),
    ):
        files = {name: tmp_path / f"{command[0]}.{name}" for name in options}
        asked = (word for name, file in files.items() for word in ("-o", file))
        code, out, _ = run(*command, *asked)
        assert code == 0
        reported = out.splitlines()[-len(options) :]
        assert set(reported) == {f"written: {file}" for file in files.values()}
        assert out.count("written: ") == len(options)


@pytest.mark.slow
def test_a_result_prints_no_shorter_in_a_narrow_terminal(tmp_path, monkeypatch):
    """Every word of the table and the lines stands there at 60 columns as in a pipe, but for the time."""
    scene = scene_file(tmp_path, examples.degree6("pi/4", 1))
    plain = run("minima", scene, "--max-starts", 16, "--seed", 1).out
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setenv("FORCE_COLOR", "1")  # rich: a terminal
    monkeypatch.setenv("NO_COLOR", "1")
    narrow = run("minima", scene, "--max-starts", 16, "--seed", 1).out
    for text in (plain, narrow):
        assert max(len(line) for line in text.splitlines()) <= 100
    lost = {w for w in plain.split() if w not in narrow and not w[0].isdigit()}
    assert {w for w in lost if w.isalpha()} <= {"s"}, lost
    numbers = [re.findall(r"0\.\d{6,}", text) for text in (plain, narrow)]
    assert numbers[0] == numbers[1] and len(numbers[0]) > 3


def test_interrupted_before_a_command_has_begun_ends_with_the_same_line(monkeypatch, capsys):
    def begun():
        raise KeyboardInterrupt

    monkeypatch.setattr("origami_nlp.cli.entry.app", begun)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 130
    assert capsys.readouterr().err == "origami-nlp: interrupted\n"
