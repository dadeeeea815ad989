"""`origami-nlp cone fractions`: the numbers that section 5 of the paper prints, and what occurs."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress


def fractions(
    size: Annotated[int, typer.Option(help="Points of each region along each coordinate.")] = 40,
    markdown: o.MarkdownFile = None,
    json: o.JsonFile = None,
) -> None:
    """Go through every number of stable states printed in section 5, under nine readings."""
    from origami_nlp.cone import check_size
    from origami_nlp.paper import (
        STATEMENTS,
        check_statements,
        findings_to_dict,
        section5_table as table,
    )
    from origami_nlp.show import folding_table, rows_markdown

    check_size(size)
    out = Output(markdown=markdown, json=json)
    with progress("printed numbers", len(STATEMENTS)) as report:
        findings = check_statements(size, progress=report)
    title = "numbers printed in section 5; what occurs there (share of the printed one)"
    short = [table.short_row(f) for f in findings]
    out.say(folding_table(table.SHORT_HEADS, short, title, (1, 3)))
    rows = [table.finding_row(f) for f in findings]
    out.write("markdown", rows_markdown, table.FINDING_HEADS, rows)
    out.write("json", findings_to_dict, findings)
