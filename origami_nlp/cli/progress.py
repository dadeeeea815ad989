"""How far a long job is, on standard error: a bar on a terminal, elsewhere a line now and then."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from origami_nlp.io import printable

if TYPE_CHECKING:
    from rich.console import Console

INTERVAL = 10.0
"""Seconds between two lines where there is no terminal."""


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
    listener: Callable[[ProgressReport], object] | None = None

    def __call__(
        self, done: float | None = None, total: float | None = None, text: str | None = None
    ) -> None:
        """Say how far the job is; what is None stays."""
        self.done = self.done if done is None else done
        self.total = self.total if total is None else total
        self.text = self.text if text is None else text
        if self.listener is not None:
            self.listener(self)

    def at(self, text: str, done: float | None = None) -> None:
        """Say what the job is at."""
        self(done, text=text)

    @property
    def line(self) -> str:
        """Title, count (``3 of 18``, a share as ``40%``) and text."""
        count = "" if self.done is None else f"{self.done:g}"
        if self.total is not None:
            share, of = f"{self.done or 0.0:.0%}", f"{self.done or 0:g} of {self.total:g}"
            count = share if self.total == 1.0 else of
        return ": ".join(filter(None, (self.title, ", ".join(filter(None, (count, self.text))))))


_running: list[ProgressReport] = []
_heard: list[float] = []
"""When the last line came, or the first job began (`time.monotonic`)."""


@contextmanager
def progress(title: str, total: float | None = None) -> Iterator[ProgressReport]:
    """Show a job of `total` parts (None: unknown; 1.0: a share) while it runs.

    Without a terminal a line comes every `INTERVAL` seconds, so that a log shows that the job lives.  A job
    started inside another one appears as what the outer one is at.
    """
    from origami_nlp.io import screen

    report, console = ProgressReport(title, total), screen("-")
    if _running:
        outer = _running[-1]
        report.listener = lambda r: outer(text=r.line)
        report()
        yield report
        return
    _running.append(report)
    try:
        with (_bar if console.is_terminal else _lines)(report, console):
            yield report
    finally:
        _running.pop()


@contextmanager
def _bar(report: ProgressReport, console: Console) -> Iterator[None]:
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from rich.table import Column

    text = TextColumn("{task.description}", markup=False, table_column=Column(no_wrap=True))
    # rich would send what is printed meanwhile to standard error
    aside: Any = {"redirect_stdout": False, "redirect_stderr": False, "transient": True}
    with Progress(TimeElapsedColumn(), BarColumn(16), text, console=console, **aside) as bar:
        task = bar.add_task(printable(report.line), total=report.total)

        def show(r: ProgressReport) -> None:
            bar.update(task, completed=r.done, total=r.total, description=printable(r.line))

        report.listener = show
        yield


@contextmanager
def _lines(report: ProgressReport, console: Console) -> Iterator[None]:
    start, over, stream = time.monotonic(), threading.Event(), console.file
    _heard[:] = _heard or [start]

    def show() -> None:
        while not over.wait(max(0.0, _heard[0] + INTERVAL - time.monotonic())):
            _heard[0] = now = time.monotonic()
            try:
                print(printable(f"{report.line} ({now - start:.0f} s)"), file=stream, flush=True)
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
