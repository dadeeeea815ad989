"""`origami-nlp cone phase`: phase diagrams of cones."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress


def phase(
    degree: o.Degree,
    figure: o.FigureFile = None,
    csv: o.CsvFile = None,
    json: o.JsonFile = None,
    depth: Annotated[
        float, typer.Option(help="Count minima deeper than this share of U_flat; 0 counts all.")
    ] = 0.0,
    rest: o.RestRule = "waterbomb",
    end: o.EndRule = "contract",
    size: Annotated[int, typer.Option(help="Points of the map along each coordinate.")] = 200,
    without_contact: Annotated[
        bool, typer.Option("--without-contact", help="Do not count minima at the end of a branch.")
    ] = False,
) -> None:
    """Map the number of branch minima over (nu_0, r_k), with its exact boundaries."""
    from origami_nlp.cone import (
        check_size,
        diagram_to_dict,
        draw_phase,
        map_as_csv,
        phase_diagram,
        print_diagram,
    )

    check_size(size)
    out = Output(figure=figure, csv=csv, json=json)
    with progress(f"cone of degree {degree}", size) as report:
        diagram = phase_diagram(
            degree,
            size=size,
            depth=depth,
            rest=rest,
            end=end,
            contact=not without_contact,
            progress=report,
        )
    print_diagram(diagram, out.console)
    out.write("csv", map_as_csv, diagram)
    out.write("json", diagram_to_dict, diagram)
    out.save("figure", draw_phase, diagram)
