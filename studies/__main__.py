"""Studies of the source paper: `python -m studies COMMAND`, from a checkout."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli import (
    Group,
    Output,
    Source,
    main,
    options as o,
    progress,
    search,
    takes_scene,
    writes,
)
from origami_nlp.errors import OptionError
from origami_nlp.pattern import parse_angle
from studies import FIGURES


@writes("figure")
def reproduce(
    out: Output,
    name: Annotated[
        str,
        typer.Argument(
            metavar="FIGURE",
            autocompletion=lambda: list(FIGURES),
            help=f"One of {', '.join(FIGURES)}.",
        ),
    ],
    folder: Annotated[Path | None, o.OutFolder] = None,
    seed: o.Seed = 0,
) -> None:
    """Draw a figure of the paper anew, from exact states and boundaries.

    FIGURE.png and FIGURE.pdf go to --folder, without it and -o to the folder you are in.
    """
    from origami_nlp.io import make_folder, save_figure

    if name not in FIGURES:
        raise OptionError(f"FIGURE = {name!r} must be one of {', '.join(FIGURES)}")
    made: list[Path] = []
    if folder is not None or not out.files("figure"):
        folder = make_folder(folder or Path("."), "--folder")
        made = [folder / f"{name}.{ending}" for ending in ("png", "pdf")]
    out.check(*(("--folder", one) for one in made))
    targets = [*map(Path, out.files("figure")), *made]
    with progress.progress(name) as report:
        drawn = FIGURES[name](name, seed, report)
    drawn.print_to(out.console)
    for target in targets:
        # what is an image in a vector file is smooth: the figure's own dots are enough
        save_figure(drawn.figure, target, "figure" if str(target).endswith(".pdf") else 200)
    out.written(*targets)


@writes("json", "markdown")
def audit(
    out: Output,
    file: o.Candidates,
    seed: o.Seed = 0,
) -> None:
    """Say of each published candidate in FILE which exact minimum it is, or which artefact."""
    from studies import (
        as_markdown,
        audit_candidates,
        audit_to_dict,
        read_candidates,
        summary_table,
    )

    candidates = read_candidates(file)
    with progress.progress("audit", len(candidates)) as report:
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
    from studies import follow_grid_minima, grid_minima_table

    stated = scene.read()
    if not 9 <= size <= 4097:
        raise OptionError(f"--size = {size} must lie between 9 and 4097")
    chart = landscape(stated, 9)
    if chart.kind != "area":
        why = chart.reason or "it has one symmetric degree of freedom only"
        raise OptionError(f"scene has no two-dimensional chart: {why}")
    out = Output()
    result = search.search(stated, scene.name, seed=seed)
    out.say(result.table())
    out.say(grid_minima_table(follow_grid_minima(result, size), size, chart.coordinates))


@writes("json", "markdown")
def fractions(
    out: Output,
    size: o.Size = 40,
) -> None:
    """Go through every number of stable states printed in section 5, under nine readings."""
    from origami_nlp.display import folding_table, rows_markdown
    from origami_nlp.paper.cone import check_size
    from studies import (
        STATEMENTS,
        check_statements,
        findings_to_dict,
        section5_table as table,
    )

    check_size(size)
    with progress.progress("printed numbers", len(STATEMENTS)) as report:
        findings = check_statements(size, progress=report)
    title = "numbers printed in section 5; what occurs there (share of the printed one)"
    short = [table.short_row(f) for f in findings]
    out.say(folding_table(table.SHORT_HEADS, short, title, (1, 3)))
    rows = [table.finding_row(f) for f in findings]
    out.write("markdown", rows_markdown, table.FINDING_HEADS, rows)
    out.write("json", findings_to_dict, findings)


@writes("json")
def limits(
    out: Output,
    elevation: o.Elevation = "0.6",
    ratio: o.Ratio = 1.0,
) -> None:
    """Measure how fast the cone approaches the continuum cone as N grows, against its series."""
    from origami_nlp.display import folding_table
    from studies import LIMIT_HEADS, limit_row, limits as measure, limits_to_dict

    found = measure(parse_angle(elevation, "--elevation"), ratio)
    out.say(folding_table(LIMIT_HEADS, [limit_row(q) for q in found], "errors ~ c (2 pi/N)^p"))
    out.write("json", limits_to_dict, found)


@writes("json", "figure")
def counts(
    out: Output,
    largest: Annotated[
        int, typer.Option(metavar="N", help="Sheets up to N x N, of facets or of square twists.")
    ] = 3,
    seconds: Annotated[float, typer.Option(metavar="S", help="Wall time for each search.")] = 60.0,
) -> None:
    """Count the stable states of sheets as they grow, with contact and without."""
    from dataclasses import asdict

    from studies import count_all, draw_counts

    if not 1 <= largest <= 8:
        raise OptionError(f"--largest = {largest} must lie between 1 and 8")
    found = []
    for one in count_all(largest, seconds):
        out.say(
            f"{one.family} {one.size} x {one.size}, contact {one.contact}: {one.states} states, {one.complete}"
            f"{', cut by the time' * bool(one.left_out)}"
        )
        found.append(one)
    out.write("json", lambda: {"seconds": seconds, "counts": [asdict(one) for one in found]})
    out.write("figure", draw_counts, found)


@writes("json")
def maxima(
    out: Output,
    sectors: Annotated[
        str,
        typer.Argument(metavar="A,B,C,D", help="Sectors of a generic vertex of degree 4 [deg]."),
    ],
    seconds: Annotated[
        float,
        typer.Option(
            metavar="S", help="Processor time for pairs of places, and for triples, of a branch."
        ),
    ] = 600.0,
    depth: Annotated[
        int, typer.Option(metavar="N", help="Places are told apart to 2/2^N of a branch.")
    ] = 12,
    within: Annotated[
        str,
        typer.Option(metavar="D", help="All vertices with A, B and C off by D at most [deg]."),
    ] = "0",
) -> None:
    """Prove that no springs give the energy of a vertex three maxima on a branch, so that it has six states at most.

    Rest angles within 180 degrees, states within fold limits. What the proof rests on goes to -o FILE.json, for
    the check in tests/independent/at_most_six.
    """
    from studies import prove_branch

    try:
        values = [Decimal(part) for part in sectors.split(",")]
    except ArithmeticError:
        values = []
    if len(values) != 4 or sum(values) != 360:
        raise OptionError(f"A,B,C,D = {sectors} must be four numbers [deg] that add up to 360")
    try:
        room = Decimal(within)
    except ArithmeticError:
        room = Decimal(-1)
    if not 0 <= room <= 1:
        raise OptionError(f"--within = {within} must be a number [deg] from 0 to 1")
    found = []
    for mode in (1, 2):
        one = prove_branch(
            sectors.split(","),
            mode,
            tolerance=within,
            pair_depth=depth,
            depth=depth,
            seconds=seconds,
        )
        pairs, triples = one["open"]
        verdict = (
            "at most two maxima"
            if not triples
            else f"not decided, {100 * one['excluded']:.3f} % of the triples of places excluded"
        )
        out.say(
            f"branch on which crease {one['leader']} reaches 180 degrees: {verdict}"
            f" ({one['leaves'][0]} boxes of pairs, {pairs} open; {one['leaves'][1]} of triples, {triples} open)"
        )
        found.append(one)
    if not any(one["open"][1] for one in found):
        out.say(
            "at most 6 stable states within fold limits, for all springs with rest angles within 180 degrees"
            + (
                f"; so for all vertices within {within} degrees, if the check agrees"
                if room
                else ""
            )
        )
    out.write("json", lambda: {"branches": found})


@writes("json", "figure")
def one_maximum(
    out: Output,
    width: Annotated[
        int, typer.Option(metavar="N", help="Boxes of sectors of 1/N degree.", min=1, max=8)
    ] = 1,
) -> None:
    """List boxes of vertices of degree 4 likely to have one maximum a branch, whatever the springs: four states.

    In double precision, at the middle of each box; the check in tests/independent/one_maximum proves boxes.
    """
    from fractions import Fraction

    from studies import candidates, draw_boxes

    found = list(candidates(Fraction(1, width)))
    out.say(f"{len(found)} boxes of 1/{width} degree, mirror images not counted")
    out.write("json", lambda: {"width": f"1/{width}", "boxes": found})
    out.write("figure", draw_boxes, found, Fraction(1, width))


def archive(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Where to; made if it is missing.")],
) -> None:
    """Write states, counts, certificates and curves behind the published results: JSON, CSV, dictionary, checksums."""
    from origami_nlp.io import make_folder
    from studies import write_archive

    out = Output()
    written = write_archive(make_folder(folder, "DIR"))
    out.say(f"{len(written)} files in {folder}; checksums: SHA256SUMS")


app = Group(
    "What only readers of the source paper need: its figures, candidates, grids and numbers."
)
app.add(reproduce, audit, grid, fractions, limits, counts, maxima, one_maximum, archive)

if __name__ == "__main__":
    main(app)
