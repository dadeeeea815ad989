"""Where the results of a command go: to the files that it was asked for, and to people."""

from __future__ import annotations

import json
import os
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from rich.console import Console

Target = str | os.PathLike[str]
KINDS = {
    "json": ((".json",), "all numbers"),
    "scene": ((".toml",), "scene file"),
    "csv": ((".csv",), "table"),
    "fold": ((".fold",), "FOLD"),
    "figure": ((".png", ".pdf", ".svg"), "figure"),
    "html": ((".html", ".htm"), "page with states to turn"),
    "mesh": ((".obj", ".stl", ".glb"), "meshes (extra mesh)"),
    "latex": ((".tex",), "snippets"),
}
"""What files may hold: endings of their names, and what help calls it."""
TEXTS = ("json", "scene", "csv", "fold", "latex")
"""Kinds of files that may go to standard output."""


class Output:
    """The files of a command, checked before its work, and the console for people.

    People are informed on standard error where one of the files is standard output.  Each file is written whole or not
    at all, and named when it is there.

    Parameters
    ----------
    files
        Names; the ending says what is written.  ``-`` is standard output and the first of `kinds`, ``-.csv`` standard
        output and a table; a device or a pipe without an ending gets the first of `kinds`.
    kinds
        Of `KINDS`: what the command can write.
    verbose
        Whether people want details.

    Attributes
    ----------
    gone
        Whether nobody reads what is printed any more.

    Raises
    ------
    OptionError
        If a file cannot be written, has the wrong ending, or is given twice; if what writes it is not installed.
    """

    def __init__(self, files: Any = None, kinds: Sequence[str] = (), verbose: bool = False) -> None:
        self._given = [(_kind(file, kinds), _place(file)) for file in files or ()]
        self.verbose, self.gone = verbose, False
        self.check()
        for file in self.files("mesh"):
            from origami_nlp.minima import check_mesh

            check_mesh(file)

    def check(self, *more: tuple[str, Target | None]) -> None:
        """Check that all files can be written, and those of more options (pairs of option and file) too."""
        from origami_nlp.io import check_outputs, screen

        named = [*(("-o", file) for _, file in self._given), *more]
        check_outputs(*named, read=_read())
        self.console: Console = screen(*(file for _, file in named))

    def files(self, *kinds: str) -> list[str]:
        """Return the files of these kinds that were asked for."""
        return [file for kind, file in self._given if kind in kinds]

    def or_stdout(self, kind: str) -> Output:
        """Return what writes a file of this kind: itself where one was asked for, else to standard output."""
        return self if self.files(kind) else Output(["-"], [kind])

    def refuse(self, why: str, *kinds: str) -> None:
        """Raise an error if a file of these kinds was asked for."""
        if files := self.files(*kinds):
            raise OptionError(f"-o = {files[0]!r}: {why}")

    def say(self, *things: Any) -> None:
        """Print for people: lines, which stay one to be copied, tables, results, or what prints to a console."""
        from origami_nlp.io import printable

        try:
            for thing in things:
                if hasattr(thing, "print_to"):
                    thing.print_to(self.console, self.verbose)
                elif callable(thing):
                    thing(self.console)
                else:
                    line = printable(thing, lines=True) if isinstance(thing, str) else thing
                    self.console.print(line)
        except (BrokenPipeError, SystemExit):  # rich ends so; files are written all the same
            self.gone = self.console.quiet = True

    def report(self, found: Any) -> None:
        """Print a result, and write it to all files."""
        from origami_nlp.minima import write_parts

        self.say(found)
        self.write("json", lambda: found.to_dict())
        self.write("csv", lambda: found.to_csv())
        self.write("figure", lambda: found.draw())
        self.write("fold", lambda: found.to_fold())
        self.save("mesh", lambda file: write_parts(found.mesh_parts(), file))
        self.page(found)

    def page(self, found: Any) -> None:
        """Write a page with the states of a result, where one is asked for."""
        from origami_nlp.results import view

        self.save("html", lambda file: view(found, file))

    def save(self, kind: str, save: Callable[..., Any], *arguments: Any) -> None:
        """Let ``save(*arguments, file)`` write each file of `kind`."""
        for file in self.files(kind):
            save(*arguments, file)
            self.written(file)

    def write(self, kind: str, make: Callable[..., Any], *arguments: Any) -> None:
        """Write what ``make(*arguments)`` returns to the files of `kind`, if there are any.

        Text and bytes are written as they are, a matplotlib Figure as a picture, anything else as JSON.
        """
        if files := self.files(kind):
            content = make(*arguments)
            for file in files:
                _write(content, file, 1 if kind == "fold" else 2)
                self.written(file)

    def written(self, *targets: Target) -> None:
        """Say which files are there now."""
        from origami_nlp.io import is_stdout, printable

        for target in targets:
            if not is_stdout(target):
                self.say(f"written: {printable(str(target))}")


def endings(kinds: Sequence[str]) -> str:
    """Say which files a command writes, for its help."""
    text = [KINDS[kind][0][0] for kind in kinds if kind in TEXTS]
    said = "; ".join(f"{' '.join(KINDS[kind][0])}: {KINDS[kind][1]}" for kind in kinds)
    stdout = ", ".join([f"- ({text[0]})", *(f"-{e}" for e in text[1:])]) if text else "none"
    return f"Write a file, by its ending; repeat for more.  {said}.  Standard output: {stdout}."


def _read() -> list[str]:
    """Return the files that the command line names twice: what is written would be what is read."""
    words = [w if os.path.isfile(w) else w.partition("=")[2] for w in sys.argv[1:]]  # --folder=x
    named = Counter(os.path.realpath(word) for word in words if os.path.isfile(word))
    return [file for file, many in named.items() if many > 1]


def _place(file: str) -> str:
    """Return where a file goes: ``-`` for standard output, which ``-.fold`` is too, else the file."""
    return "-" if Path(file).name == file and Path(file).stem == "-" else file


def _kind(file: str, kinds: Sequence[str]) -> str:
    """Return what a file is to hold."""
    from origami_nlp.io import is_stdout

    ending, place = Path(file).suffix.lower(), _place(file)
    for kind in kinds:
        if ending in KINDS[kind][0]:
            if kind not in TEXTS and place == "-":
                raise OptionError(f"-o = {file!r}: only text goes to standard output: name a file")
            return kind
    if not ending and kinds[0] in TEXTS:
        special = os.path.exists(place) and not (os.path.isfile(place) or os.path.isdir(place))
        if special or is_stdout(place):
            return kinds[0]
    if os.path.isdir(place):
        raise OptionError(f"-o = {file!r} is a folder: give a file name")
    known = ", ".join(ending for kind in kinds for ending in KINDS[kind][0])
    raise OptionError(f"-o = {file!r} must end in one of {known}")


def _write(content: Any, target: Target, indent: int) -> None:
    from origami_nlp.io import save_figure, write_whole

    if hasattr(content, "savefig"):
        save_figure(content, target, 200)
        return
    if not isinstance(content, str | bytes):
        content = json.dumps(content, indent=indent, allow_nan=False) + "\n"
    write_whole(target, content if isinstance(content, bytes) else content.encode())
