"""`origami-nlp cone speed`: time against the number of creases, beside brute force."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress

DEGREES = (6, 8, 10, 12, 14, 16, 18, 30, 50, 100, 200, 500, 1000, 2000)
QUICK = (6, 8, 10, 12, 100, 1000)


def speed(
    quick: Annotated[bool, typer.Option("--quick", help="Fewer degrees, one map.")] = False,
    points: Annotated[int, typer.Option(min=1, help="Random points a degree.")] = 10,
    seed: o.Seed = 0,
    markdown: o.MarkdownFile = None,
) -> None:
    """Measure the time of an exact count against N, beside brute force, each with its error."""
    from rich.markdown import Markdown

    from origami_nlp.bench import MAP_DEGREES, as_markdown, measure
    from origami_nlp.files import PAGE

    out = Output(markdown=markdown)
    with progress("measuring") as report:
        rows = measure(
            QUICK if quick else DEGREES,
            points,
            seed,
            maps=(12,) if quick else MAP_DEGREES,
            progress=lambda degree: report(text=f"degree {degree} done"),
        )
    out.say(Markdown(as_markdown(rows)), width=PAGE)
    out.write("markdown", as_markdown, rows)
