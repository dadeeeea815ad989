"""Where the results of a command go: to the files that it was asked for, and to people."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

from origami_nlp.cli import options as o
from origami_nlp.cli.timed import end_of
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from origami_nlp.display import Table, Viewable
    from origami_nlp.io import Screen

LONG = 24
"""Letters of a cell from which it is words, and may be folded."""
Target = str | os.PathLike[str]
ENDINGS = {
    "figure": (".png", ".pdf", ".svg"),
    "npz": (".npz",),
    "html": (".html", ".htm"),
    "animate": (".gif", ".mp4"),
}
"""What the names of these files end in."""
SEARCH = {
    "full": (o.FullOrNot, None),
    "seed": (o.Seed, 0),
    "effort": (o.Effort, "normal"),
    "max_starts": (o.MaxStarts, None),
    "starts": (o.Starts, None),
    "workers": (o.Workers, None),
    "seconds": (o.Seconds, None),
}
"""Options of searches, with what they are where nothing is said."""
FILES = {
    "figure": o.FigureFile,
    "json": o.JsonFile,
    "markdown": o.MarkdownFile,
    "fold": o.PathsFold,
    "html": o.HtmlFile,
    "mesh": o.StatesMesh,
}
"""What a result may be written to without more ado."""


class Output:
    """The files of a command, checked before its work, and the console for people.

    People are informed on standard error where one of the files is standard output.  Each file is written whole or not
    at all, and named when it is there.

    Parameters
    ----------
    more
        Pairs of an option and a file that are checked as well; the command writes them itself.
    targets
        File of each option by its name (``json`` for ``--json``), or None where it was not given.

    Raises
    ------
    OptionError
        If a file cannot be written, has the wrong ending, or is the file of another option too; if what writes it is
        not installed.
    """

    def __init__(self, *more: tuple[str, Target], **targets: Target | None) -> None:
        from origami_nlp.io import check_outputs, screen

        named = [*((f"--{name}", target) for name, target in targets.items()), *more]
        for option, target in named:
            endings = ENDINGS.get(option[2:], ())
            if target is not None and endings and Path(target).suffix.lower() not in endings:
                raise OptionError(
                    f"{option} = {str(target)!r}: the name must end in {', '.join(endings)}"
                )
        check_outputs(*named)
        if mesh := targets.get("mesh"):
            from origami_nlp.minima import check_mesh

            check_mesh(Path(mesh))
        if film := targets.get("animate"):
            from origami_nlp.display import check_animation

            check_animation(film)
        self._targets = targets
        self.console: Screen = screen(*targets.values())

    def say(self, *things: Any, **options: Any) -> None:
        """Print for people, as `rich.console.Console.print` does; a result prints itself."""
        for thing in things or ("",):
            if hasattr(thing, "print_to"):
                thing.print_to(self.console)
            else:
                self.console.print(thing, **options)

    def page(self, markdown: str) -> None:
        """Print Markdown for people, its tables as all others."""
        from itertools import groupby

        from rich.markdown import Markdown

        for tabular, lines in groupby(markdown.splitlines(), lambda line: line.startswith("|")):
            if tabular:
                self.say(_table(list(lines)))
            elif text := "\n".join(lines).strip():
                self.say(Markdown(text), width=self.console.page)

    def write(self, option: str, make: Callable[..., Any], *arguments: Any) -> None:
        """Write what ``make(*arguments)`` returns to the file of `option`, if there is one.

        Text and bytes are written as they are, a matplotlib Figure as a picture, anything else as JSON.
        """
        self.save(option, _write, lambda: make(*arguments))

    def save(self, option: str, save: Callable[..., Any], *arguments: Any) -> None:
        """Let ``save(*arguments, file)`` write the file of `option`, if there is one."""
        target = self._targets.get(option)
        if target is not None:
            save(*arguments, target)
            self.written(target)

    def turn(self, *results: Viewable) -> None:
        """Write ``--html``, a page on all `results`, and ``--animate``, the states of the first, where asked for."""
        from origami_nlp.display import InteractivePage, write_animation

        if not any(self._targets.get(option) for option in ("html", "animate")):
            return
        contents = [result.view_content() for result in results]
        if self._targets.get("html"):
            self.save("html", lambda file: InteractivePage(*contents).save(file))
        if self._targets.get("animate"):
            self.save("animate", lambda file: write_animation(contents[0], file))

    def written(self, *targets: Target) -> None:
        """Say which files are there now."""
        from origami_nlp.io import is_stdout, printable

        if files := [str(target) for target in targets if not is_stdout(target)]:
            for file in files:  # whole, to be copied
                self.console.out(f"written: {printable(file)}", highlight=False)


def answers(*files: str, search: Sequence[str] = ()) -> Callable[..., Callable[..., None]]:
    """Give a command that returns a result the options of these files, to which it goes, and of searches.

    search: of `SEARCH`; the command gets those that are given by their names.
    """
    own = {name: SEARCH[name] for name in search} | {name: (FILES[name], None) for name in files}

    def decorate(command: Callable[..., Any]) -> Callable[..., None]:
        @wraps(command)
        def run(**given: Any) -> None:
            from origami_nlp.results import draw
            from origami_nlp.verbs import write_mesh

            out = Output(**{name: given.pop(name) for name in files})
            said = {k: v for k, v in given.items() if k not in search or v is not None}
            found = command(**said)
            found.print_to(out.console)
            out.write("json", lambda: found.to_dict())
            out.write("markdown", lambda: found.to_markdown())
            out.write("figure", draw, found)
            out.save("fold", _save_frames, found)
            out.save("mesh", write_mesh, found)
            out.turn(found)
            end_of(found)

        return o.extended(run, command, own)

    return decorate


def _save_frames(found: Any, file: Any) -> None:
    from origami_nlp.bifurcation import write_frames

    write_frames(found, file)


def _table(lines: list[str]) -> Table:
    """Return a table of Markdown; its first column is of words, as are all that hold long texts."""
    from origami_nlp.display import Table

    heads, _, *rows = [
        [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        for line in lines
    ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    letters = ["L" if k == 0 or w > LONG else "r" for k, w in enumerate(widths)]
    return Table(heads, rows, columns="".join(letters), framed=False, narrow=True)


def _write(make: Callable[[], Any], target: Target) -> None:
    from origami_nlp.io import save_figure, write_json, write_whole

    content = make()
    if isinstance(content, str | bytes):
        write_whole(target, content if isinstance(content, bytes) else content.encode())
    elif hasattr(content, "savefig"):
        save_figure(content, target, 200)
    else:
        write_json(content, Path(target))
