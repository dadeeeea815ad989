"""`origami-nlp paper`: the study of the source paper."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.cone import cone
from origami_nlp.cli.group import Group
from origami_nlp.cli.output import Output, answers, writes
from origami_nlp.cli.progress import progress
from origami_nlp.cli.search import search_panels
from origami_nlp.cli.timed import bounded

if TYPE_CHECKING:
    from origami_nlp.symbolic.claim import Claim


def demo(folder: Annotated[Path, o.OutFolder] = Path("origami_demo"), seed: o.Seed = 0) -> None:
    """Find the symmetric minima of the paper's degree-6 and degree-8 vertices, and which of them are stable."""
    from origami_nlp.display import rows_table
    from origami_nlp.io import make_folder, write_json
    from origami_nlp.minima import DEMO_HEADS, demo_rows, draw_minima
    from origami_nlp.pattern import examples

    folder = make_folder(folder, "--folder")
    files = [folder / name for name in ("minima.json", "degree6.png", "degree8.png")]
    output = Output()
    output.check(*(("--folder", file) for file in files))
    results = search_panels(seed, full=True)
    shown = [
        results[[r.scene.name for r in results].index(scene.name)]
        for scene in (examples.degree6("pi/3", 1.0), examples.degree8("pi/4", 1.0))
    ]
    for result in shown:
        result.print_to(output.console)
        output.say("")
    seconds = sum(r.search.seconds for r in results)
    title = f"all panels of the paper: minima stable in the full space, {seconds:.1f} s in total"
    output.say(rows_table(DEMO_HEADS, demo_rows(results), title))
    write_json([r.to_dict() for r in results], files[0])
    for file, result in zip(files[1:], shown, strict=True):
        draw_minima(result, file)
    output.written(*files)


@writes("json")
def panels(out: Output, full: o.FullOrNot = None, seed: o.Seed = 0) -> None:
    """Find the symmetric minima of the paper's 18 panels; with --full, decide each in the full space."""
    from origami_nlp.display import rows_table
    from origami_nlp.minima import table

    results = search_panels(seed, bool(full))
    heads = table.FULL_HEADS if full else table.SUMMARY_HEADS
    rows = [table.full_space_row(r) if full else table.summary_row(r) for r in results]
    if full:
        totals = [str(sum(int(row[k]) for row in rows)) for k in range(1, 5)]
        rows.append(("total", *totals, ""))
    seconds = sum(r.search.seconds for r in results)
    out.say(rows_table(heads, rows, f"all panels of the paper, {seconds:.1f} s in total"))
    out.write("json", lambda: [r.to_dict() for r in results])


def _claims() -> list[str]:
    from origami_nlp.symbolic.catalogue import claims

    return [claim.id for claim in claims()]


@writes("json", "latex")
def verify(
    out: Output,
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ID", autocompletion=_claims, help="Decide this claim only (repeatable)."
        ),
    ] = None,
) -> None:
    """Prove or refute the equations and statements of the source paper that are in the catalogue.

    Prints one line per claim, and what the catalogue leaves out (figures, searches, remarks without a
    number).  Exit code 0: every claim is decided (proved, or its corrected
    statement proved); 1: some claim is not; 2: an option has a value it cannot take.
    """
    from origami_nlp.symbolic.catalogue import claim_by_id, claims, decide_all
    from origami_nlp.symbolic.report import as_json, as_latex
    from origami_nlp.symbolic.table import print_results

    chosen = [claim_by_id(i) for i in dict.fromkeys(only)] if only else list(claims())
    with progress("deciding", len(chosen)) as said:

        def advance(claim: Claim) -> None:
            said((said.done or 0) + 1, text=claim.id)

        results = decide_all(chosen, progress=advance)
    print_results(results, out.console)
    out.write("json", as_json, results)
    out.write("latex", as_latex, results)
    if not all(r.verdict.decided for r in results):
        raise typer.Exit(1)


@writes("json")
def audit(out: Output, file: o.Candidates, seed: o.Seed = 0) -> None:
    """Say of each published candidate in FILE which exact minimum it is, or which artefact."""
    from origami_nlp.paper import audit_candidates, audit_table, audit_to_dict, read_candidates

    candidates = read_candidates(file)
    with progress("audit", len(candidates)) as report:
        panels = audit_candidates(candidates, seed=seed, progress=report)
    out.say(audit_table(panels))
    out.write("json", audit_to_dict, panels)


@bounded
@answers("json", search=("seed",))
def transitions(
    family: o.Family, samples: o.Samples = 25, rings: o.Rings = 16, **options: Any
) -> Any:
    """Sweep alpha_1 over a FAMILY of the paper and locate every transition of its admissible space.

    The sweep starts from so many --samples of alpha_1.
    """
    from origami_nlp.paper import find_transitions

    with progress(family, 1.0) as show:

        def report(what: str, done: float) -> None:
            show(done, text=what)

        return find_transitions(family, samples=samples, rings=rings, report=report, **options)


paper = Group("The source paper: its 18 panels, its equations, and its families of vertices.")
paper.add(demo, panels, verify, audit, transitions)
paper.add_typer(cone, name="cone")
