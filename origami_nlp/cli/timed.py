"""A limit of wall time for a command: what was found until then is reported, and that the limit ended it, by name."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any, NoReturn

import typer

from origami_nlp.cli import options as o
from origami_nlp.errors import OUT_OF_TIME

SHORTEST = 1e-6
"""Seconds of a timer that is over at once: 0 would stop it."""

AGAIN = 0.2
"""Seconds after which a command that goes on is ended once more: libraries that try one conversion of their arguments
after another (CasADi) can take what ends it for an argument of another kind."""

ENDED = 124
"""Exit code, that of `timeout`."""


class CommandOutOfTime(BaseException):
    """The time is over; no error, so that nothing takes it for an answer that failed."""


_end: list[float] = []
"""When the time is over (`time.monotonic`), for a command with a limit."""
_rung: list[bool] = []
"""Whether the command was asked to end."""
_kept: list[Any] = []
"""What the command has found, and not yet reported."""


def keep(result: Any) -> None:
    """Keep a result, to be reported if the time is over before the command reports more."""
    _kept[:] = [result]


@contextmanager
def paused(again: bool = True) -> Iterator[float | None]:
    """Let something keep to the limit itself; gives the seconds that are left, None without a limit.

    again: whether the command is bound by it afterwards; one that only reports and writes what was found is not.
    """
    if not _end:
        yield None
        return
    _arm(0.0)
    yield max(_end[0] - time.monotonic(), 0.0)
    if not again:
        return
    if time.monotonic() >= _end[0]:
        raise CommandOutOfTime
    _arm(_end[0] - time.monotonic())


def end_of(found: Any) -> None:
    """End a command whose result is written, with the exit code of one whose time was over where it was."""
    if getattr(found, "interrupted", False):
        raise typer.Exit(ENDED)


def bounded(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the option ``--seconds``."""

    @wraps(command)
    def run(seconds: float | None = None, **given: Any) -> None:
        try:
            with _limited(seconds):
                command(**given)
        except Exception as error:
            if not _rung or isinstance(error, typer.Exit):
                raise
            _out_of_time(seconds, given)
        except CommandOutOfTime:
            _out_of_time(seconds, given)

    return o.extended(run, command, {"seconds": (o.Seconds, None)})


def _out_of_time(seconds: float | None, given: dict[str, Any]) -> NoReturn:
    from origami_nlp.io import screen

    console = screen(*map(o.place, given.get("out") or ()))
    for result in _kept:
        result.print_to(console)
    console.print(
        f"{OUT_OF_TIME} (--seconds {seconds:g}): "
        + ("what stands above was found; the rest of the command" if _kept else "the command")
        + " did not come to its end, and files that it had not written are not written"
    )
    raise typer.Exit(ENDED) from None


@contextmanager
def _limited(seconds: float | None) -> Iterator[None]:
    _kept.clear()
    _rung.clear()
    if seconds is None:
        yield
        return
    _end[:] = [time.monotonic() + seconds]
    able = hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread()
    former = signal.signal(signal.SIGALRM, _over) if able else None
    try:
        _arm(max(seconds, SHORTEST))
        yield
    finally:
        _end.clear()
        _arm(0.0)
        if able:
            signal.signal(signal.SIGALRM, former)


def _over(*_: object) -> None:
    if _end:
        _rung[:] = [True]
        raise CommandOutOfTime


def _arm(seconds: float) -> None:
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN if seconds else 0.0)
