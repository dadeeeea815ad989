"""`origami-nlp panels`: the tables over all 18 panels of the paper."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli.demo import search_panels
from origami_nlp.cli.minima import JsonFile, Seed


def panels(
    full: Annotated[
        bool, typer.Option("--full", help="Decide each state in the full space.")
    ] = False,
    seed: Seed = 0,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the table as Markdown.")
    ] = None,
    json: JsonFile = None,
) -> None:
    """Find the symmetric minima of the paper's 18 panels; with --full, decide each in the full space."""
    from origami_nlp.files import check_outputs, screen, write_json, write_whole
    from origami_nlp.minima import result_to_dict, table
    from origami_nlp.show import rows_markdown, rows_table

    check_outputs(("--markdown", markdown), ("--json", json))
    results = search_panels(seed, full)
    heads = table.FULL_HEADS if full else table.SUMMARY_HEADS
    rows = [table.full_space_row(r) if full else table.summary_row(r) for r in results]
    if full:
        totals = [str(sum(int(row[k]) for row in rows)) for k in range(1, 5)]
        rows.append(("total", *totals, ""))
    title = f"all panels of the paper, {sum(r.search.seconds for r in results):.1f} s in total"
    screen(json, markdown).print(rows_table(heads, rows, title))
    if markdown:
        write_whole(markdown, rows_markdown(heads, rows).encode())
    if json:
        write_json([result_to_dict(r) for r in results], json)
