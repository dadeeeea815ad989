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


class CommandOutOfTime(BaseException):
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
        self.seconds, self.end = seconds, time.monotonic() + (seconds or 0.0)
        self.found: Any = None
        self.late = self.interrupted = self._polite = False

    def run(self, command: Callable[..., Any], **given: Any) -> Any:
        """Return what a command returns, None where the time, or the user, ended it."""
        main = threading.current_thread() is threading.main_thread()
        self._able = self.seconds is not None and main and hasattr(signal, "setitimer")
        former = signal.signal(signal.SIGALRM, self._ring) if self._able else None
        try:
            self._wait(self.end)
            return command(**given)
        except KeyboardInterrupt:
            self.interrupted = not self.late
        except (CommandOutOfTime, NothingInTime) as error:
            if self.seconds is None:
                raise error
            self.late = True
        except Exception:
            # what comes of an end in the middle of a library is no answer of it
            if not self.late:
                raise
        finally:
            self._able = False
            if former is not None:
                signal.setitimer(signal.ITIMER_REAL, 0.0)
                signal.signal(signal.SIGALRM, former)
        return None

    def within(
        self, verb: Callable[..., Any], *given: Any, last: bool = True, **options: Any
    ) -> Any:
        """Return what a verb finds that keeps to the limit itself, as its ``seconds``; what is None is left to it.

        last: whether the command has nothing more to find.
        """
        options = {k: v for k, v in options.items() if v is not None}
        if self.seconds is not None:
            options["seconds"] = max(self.end - time.monotonic(), 0.0)
        try:
            self._wait(self.end + GRACE, polite=True)
            self.found = verb(*given, **options)
        except Interrupted as early:  # of the user, or since the verb is late
            self.found, self.interrupted = early.result, not self.late
        self._wait(math.inf if last else self.end)
        if self.interrupted or (self.late and not last):
            raise KeyboardInterrupt if self.interrupted else CommandOutOfTime
        self.late |= self.seconds is not None and is_cut(self.found)
        return self.found

    @property
    def over(self) -> bool:
        """Whether the time is over."""
        return self.seconds is not None and time.monotonic() >= self.end

    def rest(self) -> None:
        """Let the command report and write what it found."""
        self.late |= self.over
        self._wait(math.inf)

    def said(self) -> str:
        """Say that the time ended the command."""
        rest = "what stands above was found" if self.found else "nothing was found until then"
        return f"{OUT_OF_TIME} (--seconds {self.seconds:g}): {rest}"

    def _wait(self, until: float, polite: bool = False) -> None:
        self._polite = polite
        if self._able:
            left = 0.0 if until == math.inf else max(until - time.monotonic(), SHORTEST)
            signal.setitimer(signal.ITIMER_REAL, left, AGAIN)

    def _ring(self, *_: object) -> None:
        if not self._able:
            return
        self.late = True
        if self._polite:
            self._wait(time.monotonic() + GRACE)
            raise KeyboardInterrupt
        raise CommandOutOfTime


def is_cut(found: Any) -> bool:
    """Return whether a time limit ended what was to be found."""
    search = getattr(found, "search", None)
    stopped = getattr(search, "stopped_by", "") == "time" or getattr(search, "left_out", ())
    return bool(stopped or getattr(found, "interrupted", False))
