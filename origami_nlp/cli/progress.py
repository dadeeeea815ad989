"""How far a long job is, on standard error: a bar on a terminal, elsewhere a line now and then."""

from __future__ import annotations

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

    done, total: parts (None: unknown).  text: what it is at.  listener: called after every change.
    """

    title: str
    listener: Callable[[ProgressReport], object]
    total: float | None = None
    done: float | None = None
    text: str = ""

    def __call__(self, done: Any = None, total: Any = None, text: str | None = None) -> None:
        """Say how far the job is; what is None stays."""
        for name, value in (("done", done), ("total", total), ("text", text)):
            if value is not None:
                setattr(self, name, value)
        self.listener(self)

    def at(self, text: str) -> None:
        """Say what the job is at."""
        self(text=text)

    @property
    def line(self) -> str:
        """Title, count (``3 of 18``) and text."""
        count = "" if self.done is None else f"{self.done:g}"
        count += f" of {self.total:g}" if count and self.total else ""
        return ": ".join(filter(None, (self.title, ", ".join(filter(None, (count, self.text))))))


_running: list[ProgressReport] = []


@contextmanager
def progress(title: str, total: float | None = None) -> Iterator[ProgressReport]:
    """Show a job of `total` parts (None: unknown) while it runs; one inside another is what the outer one is at."""
    from origami_nlp.io import screen

    console, outer = screen("-"), _running[-1:]
    report = ProgressReport(title, lambda r: outer[0](text=r.line), total)
    if outer:
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
        now: Any = lambda r: {"completed": r.done, "total": r.total}  # noqa: E731
        report.listener = lambda r: bar.update(task, description=printable(r.line), **now(r))
        yield


@contextmanager
def _lines(report: ProgressReport, console: Console) -> Iterator[None]:
    heard = [time.monotonic()]

    def show(r: ProgressReport) -> None:
        if time.monotonic() > heard[-1] + INTERVAL:
            heard.append(time.monotonic())
            line = f"{r.line} ({heard[-1] - heard[0]:.0f} s)"
            print(printable(line), file=console.file, flush=True)

    report.listener = show
    yield
