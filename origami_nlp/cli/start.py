"""What happens before a command is loaded: an early Ctrl-C, streams that are closed, settings that are not ours."""

from __future__ import annotations

import os
import sys

from origami_nlp.cli.interruption import ending_at_once


def main() -> None:
    """Run the command line; bad input, and output that nobody takes, end with one line and exit code 2."""
    with ending_at_once():
        _occupy_streams()
        # commands draw into files; matplotlib would end over a display that does not exist
        os.environ.pop("MPLBACKEND", None)
        from origami_nlp.cli.entry import run  # takes most of a second

        run()


def _occupy_streams() -> None:
    """Let no file that we open get the number of a closed standard stream: what is printed would go there."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(number, True)
    os.close(number)
    if sys.stderr is None:  # print would take standard output instead
        sys.stderr = open(2, "w", closefd=False)
