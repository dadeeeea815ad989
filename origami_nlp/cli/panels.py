"""`origami-nlp paper panels`: the tables over all 18 panels of the paper."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.search import search_panels


def panels(
    full: Annotated[
        bool, typer.Option("--full", help="Decide each state in the full space.")
    ] = False,
    seed: o.Seed = 0,
    markdown: o.MarkdownFile = None,
    json: o.JsonFile = None,
) -> None:
    """Find the symmetric minima of the paper's 18 panels; with --full, decide each in the full space."""
    from origami_nlp.minima import result_to_dict, table
    from origami_nlp.show import rows_markdown, rows_table

    out = Output(markdown=markdown, json=json)
    results = search_panels(seed, full)
    heads = table.FULL_HEADS if full else table.SUMMARY_HEADS
    rows = [table.full_space_row(r) if full else table.summary_row(r) for r in results]
    if full:
        totals = [str(sum(int(row[k]) for row in rows)) for k in range(1, 5)]
        rows.append(("total", *totals, ""))
    seconds = sum(r.search.seconds for r in results)
    out.say(rows_table(heads, rows, f"all panels of the paper, {seconds:.1f} s in total"))
    out.write("markdown", rows_markdown, heads, rows)
    out.write("json", lambda: [result_to_dict(r) for r in results])
