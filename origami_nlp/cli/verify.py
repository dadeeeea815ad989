"""`origami-nlp paper verify`: prove or refute the statements of the paper that are in the catalogue."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress

if TYPE_CHECKING:
    from symbolic.claim import Claim


def verify(
    json: o.JsonFile = None,
    markdown: o.MarkdownFile = None,
    latex: o.LatexFile = None,
    only: Annotated[
        list[str] | None, typer.Option(help="Decide this claim only (repeatable).", metavar="ID")
    ] = None,
) -> None:
    """Prove or refute the equations and statements of the source paper that are in the catalogue.

    Prints one line per claim, and what the catalogue leaves out (figures, searches, remarks without a
    number).  Exit code 0: every claim is decided (proved, or its corrected
    statement proved); 1: some claim is not; 2: an option has a value it cannot take.
    """
    from symbolic import report
    from symbolic.catalogue import claim_by_id, claims, decide_all
    from symbolic.table import print_results

    out = Output(json=json, markdown=markdown, latex=latex)
    chosen = [claim_by_id(i) for i in dict.fromkeys(only)] if only else list(claims())
    with progress("deciding", len(chosen)) as said:

        def tell(claim: Claim) -> None:
            said((said.done or 0) + 1, text=claim.id)

        results = decide_all(chosen, progress=tell)
    print_results(results, out.console)
    out.write("json", report.as_json, results)
    out.write("markdown", report.as_markdown, results)
    out.write("latex", report.as_latex, results)
    if not all(r.verdict.decided for r in results):
        raise typer.Exit(1)
