"""Ctrl-C: what it does before a command has begun, and while it runs."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

INTERRUPTED = b"origami-nlp: interrupted\n"


@contextmanager
def ending_at_once() -> Iterator[None]:
    """Let Ctrl-C end the process, with a line that says so."""
    with _taken(signal.default_int_handler, _leave):
        yield


@contextmanager
def interruptible() -> Iterator[None]:
    """Let Ctrl-C raise KeyboardInterrupt, as long as there is something to bring to an end in order.

    Modules that a command loads may make an ImportError of it: after Ctrl-C that is the interruption still.
    """
    asked: list[bool] = []

    def interrupt(number: int, frame: FrameType | None) -> NoReturn:
        asked.append(True)
        signal.default_int_handler(number, frame)

    with _taken(_leave, interrupt):
        try:
            yield
        except ImportError:
            if asked:
                raise KeyboardInterrupt from None
            raise


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
