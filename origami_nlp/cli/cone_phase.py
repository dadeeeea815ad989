"""`origami-nlp cone phase, fractions, full, limits`: phase diagrams of cones and what is behind them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli.cone_count import Degree, EndRule, RestRule
from origami_nlp.cli.minima import FigureFile, JsonFile, check_figure
from origami_nlp.cli.progress import progress

CsvFile = Annotated[
    Path | None, typer.Option("--csv", metavar="FILE", help="Write the map as CSV.")
]
Ratio = Annotated[float, typer.Option(help="Stiffness ratio r_k = k_even/k_odd.")]


def phase(
    degree: Degree,
    figure: FigureFile = None,
    csv: CsvFile = None,
    json: JsonFile = None,
    depth: Annotated[
        float, typer.Option(help="Count minima deeper than this share of U_flat; 0 counts all.")
    ] = 0.0,
    rest: RestRule = "waterbomb",
    end: EndRule = "contract",
    size: Annotated[int, typer.Option(help="Points of the map along each coordinate.")] = 200,
    without_contact: Annotated[
        bool, typer.Option("--without-contact", help="Do not count minima at the end of a branch.")
    ] = False,
) -> None:
    """Map the number of branch minima over (nu_0, r_k), with its exact boundaries."""
    from origami_nlp.cone import (
        Cone,
        check_size,
        diagram_to_dict,
        map_as_csv,
        phase_diagram,
        print_diagram,
    )
    from origami_nlp.files import check_outputs, is_stdout, screen, write_json, write_whole

    check_figure(figure)
    check_size(size)
    check_outputs(("--figure", figure), ("--csv", csv), ("--json", json))
    with progress(f"cone of degree {degree}", size) as report:
        diagram = phase_diagram(
            Cone(degree, rest, end),
            size=size,
            depth=depth,
            contact=not without_contact,
            progress=report,
        )
    if not is_stdout(json):
        print_diagram(diagram, screen())
    if csv:
        write_whole(csv, map_as_csv(diagram).encode())
    if json:
        write_json(diagram_to_dict(diagram), json)
    if figure:
        from origami_nlp.cone import draw_phase

        draw_phase(diagram, figure)


def fractions(
    size: Annotated[int, typer.Option(help="Points of each region along each coordinate.")] = 40,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the table as Markdown.")
    ] = None,
    json: JsonFile = None,
) -> None:
    """Go through every number of stable states printed in section 5, under nine readings."""
    from origami_nlp.cone import check_size
    from origami_nlp.files import check_outputs, is_stdout, screen, write_json, write_whole
    from origami_nlp.paper import (
        STATEMENTS,
        check_statements,
        findings_to_dict,
        section5_table as table,
    )
    from origami_nlp.show import folding_table, rows_markdown

    check_size(size)
    check_outputs(("--markdown", markdown), ("--json", json))
    with progress("printed numbers", len(STATEMENTS)) as report:
        findings = check_statements(size, progress=report)
    rows = [table.finding_row(f) for f in findings]
    if not is_stdout(json):
        title = "numbers printed in section 5; what occurs there (share of the printed one)"
        short = [table.short_row(f) for f in findings]
        screen().print(folding_table(table.SHORT_HEADS, short, title, (1, 3)))
    if markdown:
        write_whole(markdown, rows_markdown(table.FINDING_HEADS, rows).encode())
    if json:
        write_json(findings_to_dict(findings), json)


def full(
    degree: Degree,
    ratio: Ratio,
    elevation: Annotated[
        str, typer.Option(help='Elevation nu_0 of the rest state, signed: 0.3 or "-pi/6".')
    ],
    rest: RestRule = "waterbomb",
    end: EndRule = "contract",
    json: JsonFile = None,
) -> None:
    """Judge every branch minimum in the full contact-admissible space (degrees up to 16)."""
    from origami_nlp.cone import Cone, full_space, full_space_to_dict, print_full_space
    from origami_nlp.files import check_writable, is_stdout, screen, write_json
    from origami_nlp.pattern import parse_angle

    check_writable(json, "--json")
    at = parse_angle(elevation, "--elevation")
    with progress("branch minima") as report:
        found = full_space(Cone(degree, rest, end), ratio, at, progress=report)
    if not is_stdout(json):
        print_full_space(found, screen())
    if json:
        write_json(full_space_to_dict(found), json)


def limits(
    elevation: Annotated[str, typer.Option(help="Elevation in (0, pi/4).")] = "0.6",
    ratio: Ratio = 1.0,
    json: JsonFile = None,
) -> None:
    """Measure how fast the cone approaches the continuum cone as N grows, against its series."""
    from origami_nlp.files import check_writable, is_stdout, screen, write_json
    from origami_nlp.paper import LIMIT_HEADS, limit_row, limits as measure, limits_to_dict
    from origami_nlp.pattern import parse_angle
    from origami_nlp.show import folding_table

    check_writable(json, "--json")
    found = measure(parse_angle(elevation, "--elevation"), ratio)
    if not is_stdout(json):
        screen().print(
            folding_table(LIMIT_HEADS, [limit_row(q) for q in found], "errors ~ c (2 pi/N)^p")
        )
    if json:
        write_json(limits_to_dict(found), json)
