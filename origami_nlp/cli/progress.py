"""How far a long job is: a bar on standard error, where that is a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from origami_nlp.io import printable


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
        given = {"done": done, "total": total, "text": text}
        vars(self).update({name: value for name, value in given.items() if value is not None})
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
    if _running:
        report = ProgressReport(title, lambda r: _running[0](text=r.line), total)
        report()
        yield report
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from rich.table import Column

    from origami_nlp.io import screen

    console = screen("-")
    text = TextColumn("{task.description}", markup=False, table_column=Column(no_wrap=True))
    # rich would send what is printed meanwhile to standard error
    aside: Any = {"redirect_stdout": False, "redirect_stderr": False, "transient": True}
    aside |= {"console": console, "disable": not console.is_terminal}
    with Progress(TimeElapsedColumn(), BarColumn(16), text, **aside) as bar:
        task = bar.add_task(printable(title), total=total)

        def show(r: ProgressReport) -> None:
            bar.update(task, description=printable(r.line), total=r.total, completed=r.done)

        _running.append(ProgressReport(title, show, total))
        try:
            yield _running[0]
        finally:
            _running.pop()
