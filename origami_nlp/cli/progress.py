"""How far a long job is: a bar on standard error, where that is a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from origami_nlp.io import printable


class Progress:
    """Where a job is; call it to say so.

    Attributes
    ----------
    title, show
        Of the job, and what is called after every change, with the line and the parts that are done.
    """

    def __init__(self, title: str, total: float | None, show: Callable[..., object]) -> None:
        self.title, self.total, self.show = title, total, show
        self.done: float | None = None
        self.text = ""

    def __call__(self, done: Any = None, total: Any = None, text: str | None = None) -> None:
        """Say how far the job is; what is None stays."""
        self.done = self.done if done is None else done
        self.total = self.total if total is None else total
        self.text = self.text if text is None else text
        count = "" if self.done is None else f"{self.done:g}"
        count += f" of {self.total:g}" if count and self.total else ""
        said = ", ".join(filter(None, (count, self.text)))
        self.show(f"{self.title}: {said}" if said else self.title, self.done, self.total)

    def at(self, text: str) -> None:
        """Say what the job is at."""
        self(text=text)


_running: list[Progress] = []


@contextmanager
def progress(title: str, total: float | None = None) -> Iterator[Progress]:
    """Show a job of `total` parts (None: unknown) while it runs; one inside another is what the outer one is at."""
    if _running:
        yield Progress(title, total, lambda line, *_: _running[0](text=line))
        return
    from rich.progress import BarColumn, Progress as Bar, TextColumn, TimeElapsedColumn
    from rich.table import Column

    from origami_nlp.io import screen

    console = screen("-")
    text = TextColumn("{task.description}", markup=False, table_column=Column(no_wrap=True))
    # rich would send what is printed meanwhile to standard error
    aside: Any = {"redirect_stdout": False, "redirect_stderr": False, "transient": True}
    with Bar(
        TimeElapsedColumn(),
        BarColumn(16),
        text,
        console=console,
        disable=not console.is_terminal,
        **aside,
    ) as bar:
        task = bar.add_task(printable(title), total=total)

        def show(line: str, done: float | None, total: float | None) -> None:
            bar.update(task, description=printable(line), total=total, completed=done)

        _running.append(Progress(title, total, show))
        try:
            yield _running[0]
        finally:
            _running.pop()
