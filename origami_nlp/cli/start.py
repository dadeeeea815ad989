"""What happens before a command is loaded: an early Ctrl-C, streams that are closed, settings that are not ours."""

from __future__ import annotations

import gc
import logging
import os
import signal
import sys
import warnings
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from origami_nlp.cli.group import Group

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Settings by which users ask for a number of threads."""
MANY = 50_000
"""Objects after which Python looks for those that only each other refer to."""


def main(commands: Group | None = None) -> None:
    """Run the command line, or another group of commands.

    Bad input, and output that nobody takes, end with one line and exit code 2; an interruption by the user with a line
    of its own and exit code 130.
    """
    try:
        _occupy_streams()
        # commands draw into files; matplotlib would end over a display that does not exist
        os.environ.pop("MPLBACKEND", None)
        _one_thread()
        if not sys.warnoptions:  # of libraries: people are told what to do, or nothing
            logging.getLogger().addHandler(logging.NullHandler())
            warnings.simplefilter("ignore")
        # most of what there is comes with imports and stays: looking through it again and again took 0.1 s
        gc.set_threshold(MANY)
        from origami_nlp.cli.entry import run  # takes most of a second

        run(commands)
    except KeyboardInterrupt:
        # a terminal shows ^C on the line where it stands
        end = "\n" if sys.stderr is not None and sys.stderr.isatty() else ""
        print(f"{end}origami-nlp: interrupted", file=sys.stderr, flush=True)
        sys.exit(128 + signal.SIGINT)


def _one_thread() -> None:
    """Let linear algebra run in one thread, where the user asks for no other number.

    Matrices are small: threads gain little, and where another process has the processor they wait for each other.
    With two of them on two busy processors a search of 1,000 creases took four times the processor time, and twice the
    wall time, that it takes with one.
    """
    if not any(os.environ.get(name) for name in THREADS):
        os.environ["OMP_NUM_THREADS"] = "1"


def _occupy_streams() -> None:
    """Let no file that we open get the number of a closed standard stream: what is printed would go there."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(number, True)
    os.close(number)
    if sys.stderr is None:  # print would take standard output instead
        sys.stderr = open(2, "w", closefd=False)
