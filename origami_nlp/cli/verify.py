"""`origami-nlp verify`: prove or refute the statements of the paper that are in the catalogue."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from origami_nlp.cli.progress import progress

if TYPE_CHECKING:
    from rich.console import Console

    from symbolic.catalogue import Result
    from symbolic.claim import Claim

COLOURS = {"proved": "green", "refuted": "red", "convention": "yellow", "unproved": "bold red"}


def verify(
    json: Annotated[Path | None, typer.Option(help="Write the JSON report here.")] = None,
    markdown: Annotated[Path | None, typer.Option(help="Write the Markdown report here.")] = None,
    latex: Annotated[Path | None, typer.Option(help="Write LaTeX snippets here.")] = None,
    only: Annotated[
        list[str] | None, typer.Option(help="Decide this claim only (repeatable).", metavar="ID")
    ] = None,
) -> None:
    """Prove or refute the equations and statements of the source paper that are in the catalogue.

    Prints one line per claim, and what the catalogue leaves out (figures, searches, remarks without a
    number).  Exit code 0: every claim is decided (proved, or its corrected
    statement proved); 1: some claim is not; 2: an option has a value it cannot take.
    """
    from origami_nlp.files import check_outputs, screen, write_whole
    from symbolic import report
    from symbolic.catalogue import claim_by_id, claims

    check_outputs(("--json", json), ("--markdown", markdown), ("--latex", latex))
    chosen = [claim_by_id(i) for i in dict.fromkeys(only)] if only else list(claims())
    results = _run(chosen)
    _print(results, screen(json, markdown, latex))
    for path, text in (
        (json, report.as_json),
        (markdown, report.as_markdown),
        (latex, report.as_latex),
    ):
        if path is not None:
            write_whole(path, text(results).encode("utf-8"))
    if not all(r.verdict.decided for r in results):
        raise typer.Exit(1)


def _run(chosen: Sequence[Claim]) -> list[Result]:
    from symbolic.catalogue import decide_all

    done: list[str] = []
    with progress("deciding", len(chosen)) as report:

        def tell(claim: Claim) -> None:
            done.append(claim.id)
            report(len(done), text=claim.id)

        return decide_all(chosen, progress=tell)


def _print(results: Sequence[Result], console: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    from symbolic.left_out import LEFT_OUT
    from symbolic.report import summary, tally_text

    table = Table(box=None, pad_edge=False)
    for name in ("claim", "verdict", "what", "method", "s"):
        # the two texts share what the id, the verdict and the time leave, and wrap
        table.add_column(
            name,
            no_wrap=name not in ("what", "method"),
            justify="right" if name == "s" else "left",
        )
    for r in results:
        colour = COLOURS[r.verdict.verdict]
        table.add_row(
            _cell(r, "claim"),
            Text(_cell(r, "verdict"), style=colour),
            r.claim.title,
            r.verdict.method,
            _cell(r, "s"),
        )
    console.print(table)
    count = summary(results)
    console.print(
        f"{count['total']} claims: {count['proved']} proved, {count['refuted']} refuted, "
        f"{count['convention']} convention, {count['unproved']} unproved; "
        f"{count['decided']} decided"
    )
    if any(r.claim.origin == "paper" for r in results):
        console.print(tally_text(results), markup=False)
    if len(results) > 3:
        console.print(f"Not decided, {len(LEFT_OUT)} kinds of statements (why: --markdown):")
        for entry in LEFT_OUT:
            console.print(f"  {entry.where}: {entry.what}", markup=False)
    for r in results if len(results) <= 3 else ():
        console.print(f"\n{r.claim.id} ({r.claim.where})", markup=False)
        console.print(f"  printed    {r.claim.statement_latex}", markup=False)
        console.print(f"  evidence   {r.verdict.evidence}", markup=False)
        if r.verdict.remark:
            console.print(f"  remark     {r.verdict.remark}", markup=False)
        if r.verdict.corrected_latex is not None:
            console.print(f"  corrected  {r.verdict.corrected_latex}", markup=False)


def _cell(r: Result, column: str) -> str:
    """Text of one of the columns that are shown in full."""
    if column == "claim":
        return r.claim.id
    if column == "s":
        return f"{r.verdict.seconds:.2f}"
    if r.verdict.decided or r.verdict.verdict == "unproved":
        return r.verdict.verdict
    return f"{r.verdict.verdict} (correction unproved)"
