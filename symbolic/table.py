"""Decided claims on a terminal: one line each, and what the catalogue leaves out."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from .catalogue import Result
from .left_out import LEFT_OUT
from .report import summary, tally_text

COLOURS = {"proved": "green", "refuted": "red", "convention": "yellow", "unproved": "bold red"}
FEW = 3
"""So many claims are shown with their evidence."""


def print_results(results: Sequence[Result], console: Console) -> None:
    """Print one line a claim and the counts; then what is left out or, of a few claims, the evidence."""
    table = Table(box=None, pad_edge=False)
    for name in ("claim", "verdict", "what", "method", "s"):
        # the two texts share what the id, the verdict and the time leave, and wrap
        table.add_column(
            name,
            no_wrap=name not in ("what", "method"),
            justify="right" if name == "s" else "left",
        )
    for r in results:
        decided = r.verdict.decided or r.verdict.verdict == "unproved"
        verdict = f"{r.verdict.verdict}{'' if decided else ' (correction unproved)'}"
        table.add_row(
            r.claim.id,
            Text(verdict, style=COLOURS[r.verdict.verdict]),
            r.claim.title,
            r.verdict.method,
            f"{r.verdict.seconds:.2f}",
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
    if len(results) > FEW:
        console.print(f"Not decided, {len(LEFT_OUT)} kinds of statements:")
        for entry in LEFT_OUT:
            console.print(f"  {entry.where}: {entry.what}", markup=False)
        return
    for r in results:
        console.print(f"\n{r.claim.id} ({r.claim.where})", markup=False)
        console.print(f"  printed    {r.claim.statement_latex}", markup=False)
        console.print(f"  evidence   {r.verdict.evidence}", markup=False)
        if r.verdict.remark:
            console.print(f"  remark     {r.verdict.remark}", markup=False)
        if r.verdict.corrected_latex is not None:
            console.print(f"  corrected  {r.verdict.corrected_latex}", markup=False)
