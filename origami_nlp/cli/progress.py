"""How far a long job is, on standard error: a bar on a terminal, elsewhere a line now and then."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from origami_nlp.io import printable

if TYPE_CHECKING:
    from rich.console import Console

INTERVAL = 10.0
"""Seconds between two lines where there is no terminal."""
PAUSE = 1.0
"""Jobs that follow each other within so many seconds are one silence."""


@dataclass
class ProgressReport:
    """Where a job is; call it to say so.

    done, total: parts (None: unknown; a total of 1.0: a share).  text: what it is at.
    listener: called after every change.
    """

    title: str
    total: float | None = None
    done: float | None = None
    text: str = ""
    listener: Callable[[ProgressReport], None] | None = None

    def __call__(
        self, done: float | None = None, total: float | None = None, text: str | None = None
    ) -> None:
        """Say how far the job is; what is None stays."""
        self.done = self.done if done is None else done
        self.total = self.total if total is None else total
        self.text = self.text if text is None else text
        if self.listener is not None:
            self.listener(self)

    @property
    def count(self) -> str:
        """``3 of 18``, a share as ``40%``, or what is known of either."""
        if self.total == 1.0:
            return f"{self.done or 0.0:.0%}"
        if self.total is not None:
            return f"{self.done or 0:g} of {self.total:g}"
        return "" if self.done is None else f"{self.done:g}"

    @property
    def state(self) -> str:
        """Count and text."""
        return ", ".join(filter(None, (self.count, self.text)))

    @property
    def line(self) -> str:
        """Title and state."""
        return f"{self.title}: {self.state}" if self.state else self.title


_running: list[ProgressReport] = []
_heard = {"line": 0.0, "end": -PAUSE}
"""When the last line came, and when the last job ended (`time.monotonic`)."""


def wait(now: float) -> float:
    """Return the seconds until the next line may come."""
    return max(0.0, _heard["line"] + INTERVAL - now)


@contextmanager
def progress(title: str, total: float | None = None) -> Iterator[ProgressReport]:
    """Show a job of `total` parts (None: unknown; 1.0: a share) while it runs.

    Without a terminal a line comes every `INTERVAL` seconds, so that a log shows that the job lives.  A job
    started inside another one appears as what the outer one is at.
    """
    from origami_nlp.io import screen

    report = ProgressReport(title, total)
    console = screen("-")
    show = _inside if _running else _bar if console.is_terminal else _lines
    with show(report, console):
        report()
        _running.append(report)
        try:
            yield report
        finally:
            _running.pop()


@contextmanager
def _inside(report: ProgressReport, _: Console) -> Iterator[None]:
    outer = _running[-1]
    report.listener = lambda r: outer(text=r.line)
    yield


@contextmanager
def _bar(report: ProgressReport, console: Console) -> Iterator[None]:
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from rich.table import Column

    with Progress(
        TimeElapsedColumn(),
        BarColumn(16),
        TextColumn("{task.description}", markup=False, table_column=Column(no_wrap=True)),
        console=console,
        transient=True,
        redirect_stdout=False,  # rich would send it to standard error
        redirect_stderr=False,
    ) as bar:
        task = bar.add_task("", total=report.total)
        report.listener = lambda r: bar.update(
            task, completed=r.done, total=r.total, description=printable(r.line)
        )
        yield


@contextmanager
def _lines(report: ProgressReport, console: Console) -> Iterator[None]:
    start, over, stream = time.monotonic(), threading.Event(), console.file
    if start - _heard["end"] >= PAUSE:
        _heard["line"] = start

    def show() -> None:
        while not over.wait(wait(time.monotonic())):
            _heard["line"] = time.monotonic()
            try:
                print(
                    printable(f"{report.line} ({time.monotonic() - start:.0f} s)"),
                    file=stream,
                    flush=True,
                )
            except (OSError, ValueError):  # nobody listens any more
                return

    # a thread, since a single step may take minutes
    thread = threading.Thread(target=show, name="progress", daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
        _heard["end"] = time.monotonic()
