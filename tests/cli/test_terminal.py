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


def shown(mine, until=b""):
    """Return what a terminal shows until a word, or the end."""
    reported = b""
    while not until or until not in reported:
        try:
            part = os.read(mine, 65536)
        except OSError:  # nobody writes any more
            break
        reported += part
        if not part:
            break
    return reported.decode().replace("\r\n", "\n")


@pytest.mark.skipif(not hasattr(signal, "SIGINT") or os.name == "nt", reason="needs signals")
def test_an_interrupted_search_leaves_a_clean_line(tmp_path):
    scene = scene_file(tmp_path, examples.degree6("pi/3", 1))
    mine, other = pty.openpty()
    root = os.path.dirname(os.path.dirname(os.path.dirname(__file__)))
    env = {**os.environ, "COLUMNS": "70", "PYTHONPATH": root, "TERM": "xterm"}
    words = [sys.executable, "-c", SLOW, "minima", str(scene)]
    process = subprocess.Popen(words, stdin=other, stdout=other, stderr=other, env=env)
    os.close(other)
    said = shown(mine, b"searching")
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    said += shown(mine)
    assert process.wait(300) == 130
    os.close(mine)
    assert said.endswith("\norigami-nlp: interrupted\n") and "Traceback" not in said
    assert said.rindex("\x1b[?25h") > said.rindex("\x1b[?25l")  # the cursor is seen again
