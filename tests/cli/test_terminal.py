"""The program in a terminal of its own: what stays on the screen when it ends, and when it is interrupted."""

import os
import signal
import subprocess
import sys
import time

import pytest

from origami_nlp import examples
from tests.command_line import scene_file

pty = pytest.importorskip("pty")

SLOW = """
import signal
import time
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background of a shell
from origami_nlp.cli import main, states
def wait(*_, **__):
    print("searching", flush=True)
    time.sleep(60)
import origami_nlp.verbs
origami_nlp.verbs.find_minima = wait
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
