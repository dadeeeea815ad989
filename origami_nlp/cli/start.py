"""What happens before a command is loaded: an early Ctrl-C, streams that are closed, settings that are not ours."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn

INTERRUPTED = b"origami-nlp: interrupted\n"


def main() -> None:
    """Run the command line; bad input, and output that nobody takes, end with one line and exit code 2."""
    with _taken(signal.default_int_handler, _leave):
        _occupy_streams()
        # commands draw into files; matplotlib would end over a display that does not exist
        os.environ.pop("MPLBACKEND", None)
        from origami_nlp.cli.entry import run  # takes most of a second

        run()


@contextmanager
def interruptible() -> Iterator[None]:
    """Let Ctrl-C raise KeyboardInterrupt, as long as there is something to bring to an end in order."""
    with _taken(_leave, signal.default_int_handler):
        yield


@contextmanager
def _taken(former: object, now: object) -> Iterator[None]:
    """Let Ctrl-C do something else, where it does `former`: who started us may have said that it does nothing."""
    taken = (
        threading.current_thread() is threading.main_thread()
        and signal.getsignal(signal.SIGINT) == former
    )
    if taken:
        signal.signal(signal.SIGINT, now)  # type: ignore[arg-type]
    try:
        yield
    finally:
        if taken:
            signal.signal(signal.SIGINT, former)  # type: ignore[arg-type]


def _leave(*_: object) -> NoReturn:
    """End at once: modules that are half loaded cannot be relied on to let an exception through."""
    try:
        os.write(2, INTERRUPTED)
    finally:
        os._exit(130)


def _occupy_streams() -> None:
    """Let no file that we open get the number of a closed standard stream: what is printed would go there."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(number, True)
    os.close(number)
    if sys.stderr is None:  # print would take standard output instead
        sys.stderr = open(2, "w", closefd=False)
