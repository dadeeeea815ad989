"""`origami-nlp paper`: the study of the source paper."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.group import Group
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.search import search, search_panels
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import OptionError
from origami_nlp.paper import FIGURES
from origami_nlp.pattern import examples, parse_angle

if TYPE_CHECKING:
    from symbolic.claim import Claim


def demo(
    out: Annotated[Path, o.OutFolder] = Path("origami_demo"),
    seed: o.Seed = 0,
) -> None:
    """Find the symmetric minima of the paper's degree-6 and degree-8 vertices, and which of them are stable."""
    from origami_nlp.files import make_folder, write_json
    from origami_nlp.minima import DEMO_HEADS, demo_rows, draw_minima
    from origami_nlp.show import rows_table

    out = make_folder(out, "--out")
    files = [out / name for name in ("minima.json", "degree6.png", "degree8.png")]
    output = Output(*(("--out", file) for file in files))
    results = search_panels(seed, full=True)
    shown = [
        results[[r.scene.name for r in results].index(scene.name)]
        for scene in (examples.degree6("pi/3", 1.0), examples.degree8("pi/4", 1.0))
    ]
    for result in shown:
        result.tell(output.console)
        output.say()
    seconds = sum(r.search.seconds for r in results)
    title = f"all panels of the paper: minima stable in the full space, {seconds:.1f} s in total"
    output.say(rows_table(DEMO_HEADS, demo_rows(results), title))
    write_json([r.to_dict() for r in results], files[0])
    for file, result in zip(files[1:], shown, strict=True):
        draw_minima(result, file)
    output.written(*files)


def panels(
    full: o.Full = False,
    seed: o.Seed = 0,
    markdown: o.MarkdownFile = None,
    json: o.JsonFile = None,
) -> None:
    """Find the symmetric minima of the paper's 18 panels; with --full, decide each in the full space."""
    from origami_nlp.minima import table
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
    out.write("json", lambda: [r.to_dict() for r in results])


def reproduce(
    name: Annotated[
        str,
        typer.Argument(
            metavar="FIGURE",
            autocompletion=lambda: list(FIGURES),
            help=f"One of {', '.join(FIGURES)}.",
        ),
    ],
    figure: o.FigureFile = None,
    out: Annotated[Path | None, o.OutFolder] = None,
    seed: o.Seed = 0,
) -> None:
    """Draw a figure of the paper anew, from exact states and boundaries.

    FIGURE.png and FIGURE.pdf go to the folder --out, without --figure to the one you are in.
    """
    from origami_nlp.files import make_folder, save_figure

    if name not in FIGURES:
        raise OptionError(f"FIGURE = {name!r} must be one of {', '.join(FIGURES)}")
    targets = [] if figure is None else [figure]
    if out is not None or figure is None:
        folder = make_folder(out or Path("."), "--out")
        targets += [folder / f"{name}.{ending}" for ending in ("png", "pdf")]
    output = Output(*(("--figure" if t is figure else "--out", t) for t in targets))
    with progress(name) as report:
        drawn = FIGURES[name](name, seed, report)
    drawn.tell(output.console)
    for target in targets:
        # what is an image in a vector file is smooth: the figure's own dots are enough
        save_figure(drawn.figure, target, "figure" if str(target).endswith(".pdf") else 200)
    output.written(*targets)


def _claims() -> list[str]:
    from symbolic.catalogue import claims

    return [claim.id for claim in claims()]


def verify(
    json: o.JsonFile = None,
    markdown: o.MarkdownFile = None,
    latex: o.LatexFile = None,
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


def audit(
    file: o.Candidates,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    markdown: o.MarkdownFile = None,
) -> None:
    """Say of each published candidate in FILE which exact minimum it is, or which artefact."""
    from origami_nlp.paper import (
        as_markdown,
        audit_candidates,
        audit_to_dict,
        read_candidates,
        summary_table,
    )

    out = Output(json=json, markdown=markdown)
    candidates = read_candidates(file)
    with progress("audit", len(candidates)) as report:
        panels = audit_candidates(candidates, seed=seed, progress=report)
    out.say(summary_table(panels))
    out.write("json", audit_to_dict, panels)
    out.write("markdown", as_markdown, panels)


@takes_scene(o.SceneFile)
def grid(
    scene: Source,
    size: o.Size = 65,
    seed: o.Seed = 0,
) -> None:
    """List the grid-local minima of SCENE's landscape and follow each downhill to an exact minimum."""
    from origami_nlp.chart import landscape
    from origami_nlp.paper import follow_grid_minima, grid_minima_table

    stated = scene.read()
    if not 9 <= size <= 4097:
        raise OptionError(f"--size = {size} must lie between 9 and 4097")
    chart = landscape(stated, 9)
    if chart.kind != "area":
        why = chart.reason or "it has one symmetric freedom only"
        raise OptionError(f"scene has no two-dimensional chart: {why}")
    out = Output()
    result = search(stated, scene.name, seed=seed)
    out.say(result.table())
    out.say(grid_minima_table(follow_grid_minima(result, size), size, chart.coordinates))


def fractions(
    size: o.Size = 40,
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


def limits(
    elevation: o.Elevation = "0.6",
    ratio: o.Ratio = 1.0,
    json: o.JsonFile = None,
) -> None:
    """Measure how fast the cone approaches the continuum cone as N grows, against its series."""
    from origami_nlp.paper import LIMIT_HEADS, limit_row, limits as measure, limits_to_dict
    from origami_nlp.show import folding_table

    out = Output(json=json)
    found = measure(parse_angle(elevation, "--elevation"), ratio)
    out.say(folding_table(LIMIT_HEADS, [limit_row(q) for q in found], "errors ~ c (2 pi/N)^p"))
    out.write("json", limits_to_dict, found)


paper = Group("The source paper: its 18 panels, figures, equations and published states.")
paper.add(demo, panels, reproduce, verify, audit, grid, fractions, limits)
