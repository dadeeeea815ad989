"""One clock for all commands: what was found in time is told and written, and the exit code is that of `timeout`."""

from __future__ import annotations

import math
import signal
import threading
import time
from collections.abc import Callable
from typing import Any

from origami_nlp.arguments import check_number
from origami_nlp.errors import OUT_OF_TIME, Interrupted, NothingInTime

GRACE = 1.0
"""Seconds for which a verb that keeps to the limit itself may be late; then it is interrupted as by Ctrl-C, so that it
keeps what it found, and after as long again it is ended."""
SHORTEST = 1e-6
"""Seconds of a timer that is over at once: 0 would stop it."""
AGAIN = 0.2
"""Seconds after which a command that goes on is ended once more: libraries that try one conversion of their arguments
after another (CasADi) can take what ends it for an argument of another kind."""


class CommandOutOfTime(KeyboardInterrupt):
    """The time is over; no error, so that nothing takes it for an answer that failed."""


class Clock:
    """The time of a command, and what the command has found in it.

    Parameters
    ----------
    seconds
        Of wall time; None: no limit.

    Attributes
    ----------
    found
        The last result, to be reported where the command does not come to its end.
    late, interrupted
        Whether the time, or the user, ended the command.
    """

    def __init__(self, seconds: float | None) -> None:
        if seconds is not None:
            check_number("--seconds", seconds, 0.0)
        self.seconds = seconds
        self.end = math.inf if seconds is None else time.monotonic() + seconds
        self.found: Any = None
        self.late = self.interrupted = self._able = False

    def run(self, command: Callable[..., Any], **given: Any) -> Any:
        """Return what a command returns, None where the time, or the user, ended it."""
        main = threading.current_thread() is threading.main_thread()
        self._able = self.seconds is not None and main and hasattr(signal, "setitimer")
        former = signal.signal(signal.SIGALRM, self._ring) if self._able else None
        try:
            self._wake(0.0, AGAIN)
            return command(**given)
        except (KeyboardInterrupt, NothingInTime) as error:
            if isinstance(error, NothingInTime) and self.seconds is None:
                raise
            self.late |= not isinstance(error, KeyboardInterrupt)
            self.interrupted = not self.late
        except Exception:
            # what comes of an end in the middle of a library is no answer of it
            if not self.late:
                raise
        finally:
            self.rest()
            if former is not None:
                signal.signal(signal.SIGALRM, former)
        return None

    def within(self, verb: Any, *given: Any, last: bool = True, **options: Any) -> Any:
        """Return what a verb finds that keeps to the limit itself, as its ``seconds``; what is None is left to it.

        last: whether the command has nothing more to find.
        """
        options = {k: v for k, v in options.items() if v is not None}
        if self.seconds is not None:
            options["seconds"] = max(self.end - time.monotonic(), 0.0)
        try:
            self._wake(GRACE, GRACE)
            self.found = verb(*given, **options)
        except Interrupted as early:  # of the user, or since the verb is late
            self.found, self.interrupted = early.result, not self.late
        if last:
            self.rest()
        if self.interrupted or (self.late and not last):
            raise KeyboardInterrupt
        self.late |= self.seconds is not None and is_cut(self.found)
        if not last:
            self._wake(0.0, AGAIN)
        return self.found

    @property
    def over(self) -> bool:
        """Whether the time is over."""
        return time.monotonic() >= self.end

    def rest(self) -> None:
        """Let the command report and write what it found."""
        if self._able:
            self._able = False
            signal.setitimer(signal.ITIMER_REAL, 0.0)

    def said(self) -> str:
        """Say that the time ended the command."""
        return f"{OUT_OF_TIME} (--seconds {self.seconds:g}): what stands above was found"

    def _wake(self, after: float, again: float) -> None:
        """End the command that many seconds after its time, and again."""
        if self._able:
            left = self.end + after - time.monotonic()
            signal.setitimer(signal.ITIMER_REAL, max(left, SHORTEST), again)

    def _ring(self, *_: object) -> None:
        self.late = True
        raise CommandOutOfTime


def is_cut(found: Any) -> bool:
    """Return whether a time limit ended what was to be found."""
    search = getattr(found, "search", None)
    stopped = getattr(search, "stopped_by", "") == "time" or getattr(search, "left_out", ())
    return bool(stopped or getattr(found, "interrupted", False))
