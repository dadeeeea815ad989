"""`origami-nlp cone count`: how many branches of a cone hold a minimum."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli.minima import JsonFile

Degree = Annotated[int, typer.Option(help="Number N of creases: even, at least 6.")]
RestRule = Annotated[
    str,
    typer.Option(help="waterbomb: a state of the cone; paper: as printed in section 5."),
]
EndRule = Annotated[
    str,
    typer.Option(
        help="contract: branches with a steep flap end at pi/2 - 2 pi/N, where a single one touches nothing "
        "(cut); contact: a single steep flap goes on until it touches."
    ),
]


def count(
    degree: Degree,
    ratio: Annotated[float, typer.Option(help="Stiffness ratio r_k = k_even/k_odd.")],
    elevation: Annotated[
        str, typer.Option(help='Elevation nu_0 of the rest state, signed: 0.3 or "-pi/6".')
    ],
    depth: Annotated[
        float,
        typer.Option(help="Count wells deeper than this share of U_flat; 0 counts all minima."),
    ] = 0.0,
    rest: RestRule = "waterbomb",
    end: EndRule = "contract",
    json: JsonFile = None,
) -> None:
    """Count the minima on all 2^(N/2 + 1) branches exactly: interior, pinned by contact, falling at a cut."""
    from origami_nlp.cone import (
        Cone,
        count as count_minima,
        count_to_dict,
        print_count,
        write_lines,
    )
    from origami_nlp.files import check_writable, is_stdout, screen
    from origami_nlp.pattern import parse_angle

    check_writable(json, "--json")
    at = parse_angle(elevation, "--elevation")
    found = count_minima(Cone(degree, rest, end), ratio, at, depth=depth)
    if not is_stdout(json):
        print_count(found, screen())
    if json:
        write_lines(count_to_dict(found), json)
