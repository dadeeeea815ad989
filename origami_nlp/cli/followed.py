"""What the commands that follow states share: how they search, and the files that they write."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.timed import end_of

SEARCH = {
    "full": (o.FullOrNot, None),
    "effort": (o.Effort, "normal"),
    "seed": (o.Seed, 0),
    "max_starts": (o.MaxStarts, None),
    "seconds": (o.Seconds, None),
}
"""Options of the searches, with what they are where nothing is said."""
FILES = {"figure": o.FigureFile, "json": o.JsonFile, "fold": o.PathsFold, "html": o.HtmlFile}


def follows(command: Callable[..., Any]) -> Callable[..., None]:
    """Give a command that returns what it followed the options of searches, as ``**search``, and its files."""
    stated = inspect.signature(command, eval_str=True)
    own = [p for p in stated.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
    shared = [*SEARCH.items(), *((name, (kind, None)) for name, kind in FILES.items())]
    more = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=usual, annotation=kind)
        for name, (kind, usual) in shared
    ]

    @wraps(command)
    def run(**given: Any) -> None:
        from origami_nlp.atlas import write_frames
        from origami_nlp.results import draw

        out = Output(**{name: given.pop(name) for name in FILES})
        said = {k: v for k, v in given.items() if k not in SEARCH or v is not None}
        found = command(**said)
        found.tell(out.console)
        out.write("json", found.to_dict)
        out.write("figure", draw, found)
        out.save("fold", write_frames, found)
        out.turn(found)
        end_of(found)

    run.__signature__ = stated.replace(parameters=[*own, *more])  # type: ignore[attr-defined]
    return run
