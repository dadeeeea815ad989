"""`origami-nlp paper cone`: uniform vertices of any even degree."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.group import Group
from origami_nlp.cli.output import Output, writes
from origami_nlp.cli.progress import progress
from origami_nlp.errors import OptionError

MOST_DIGITS = 28_000
"""Largest degree whose numbers are written out: Python converts integers of up to 4,300 digits."""


@writes("json")
def count(
    out: Output,
    degree: o.Degree,
    rest_elevation: o.RestElevation,
    ratio: o.Ratio = 1.0,
    depth: o.Depth = 0.0,
    rest: o.RestRule = "waterbomb",
    end: o.EndRule = "contract",
) -> None:
    """Count the minima on all 2^(N/2 + 1) branches exactly: interior, pinned by contact, falling at a cut."""
    from origami_nlp.paper import cone as cones
    from origami_nlp.pattern import parse_angle

    nu = parse_angle(rest_elevation, "--rest-elevation")
    found = cones.count(cones.Cone(degree, rest, end), ratio, nu, depth=depth)
    cones.print_count(found, out.console)
    out.save("json", cones.write_lines, cones.count_to_dict(found))


@writes("json")
def foldings(
    out: Output,
    degree: o.Degree,
    listed: Annotated[
        bool | None,
        typer.Option("--list/--no-list", help="List them (up to degree 32; default: up to 16)."),
    ] = None,
) -> None:
    """Count foldings up to rotation (necklaces) and up to rotation and reflection (bracelets)."""
    from origami_nlp.paper import cone as cones

    cones.check_degree(degree, cones.LARGEST_LISTED if listed else MOST_DIGITS)
    shown = degree <= 16 if listed is None else listed
    cones.print_foldings(degree, out.console, shown)
    out.save("json", cones.write_lines, cones.foldings_to_dict(degree, shown))


@writes("json")
def branch(
    out: Output, flaps: o.Flaps, elevation: o.Elevation, end: o.EndRule = "contract"
) -> None:
    """Print the fold angles of a folded cone, in radians and (as in FOLD files) in degrees."""
    from origami_nlp.paper import cone as cones
    from origami_nlp.pattern import parse_angle

    nu = parse_angle(elevation, "--elevation")
    state = cones.branch(flaps, -1 if nu < 0 else 1, end=end)
    data = cones.branch_to_dict(state, nu)  # an error past the end, before anything is written
    cones.print_branch(state, nu, out.console)
    out.save("json", cones.write_lines, data)


@writes("figure")
def draw(
    out: Output,
    degree: o.DegreeWanted = None,
    flaps: o.FlapsWanted = None,
    elevation: o.Elevations = None,
    end: o.EndRule = "contract",
) -> None:
    """Draw all different foldings of a --degree up to 16, or one cone by its --flaps.

    A cone by its flaps is drawn at every --elevation that is given.
    """
    from origami_nlp.paper import cone as cones
    from origami_nlp.pattern import parse_angle

    if not out.files("figure"):
        raise OptionError("-o is missing: name the file of the figure, such as -o cone.pdf")
    angles = [parse_angle(text, "--elevation") for text in elevation or []]
    if flaps is not None:
        word = cones.parse_flaps(flaps, degree)
        branch = cones.ConeBranch(word, -1 if any(v < 0 for v in angles) else 1, end)
        steps = [share * branch.end * branch.direction for share in (0.25, 0.5, 0.75, 1.0)]
        out.write("figure", cones.draw_branch, branch, angles or steps)
    elif degree is None:
        raise OptionError("--degree is missing: give a degree, or an assignment with --flaps")
    elif len(angles) > 1:
        raise OptionError("--elevation is given twice: all foldings are drawn at one elevation")
    else:
        out.write(
            "figure", cones.draw_foldings, cones.check_degree(degree), angles[0] if angles else 0.45
        )


@writes("json", "csv", "figure")
def phase(
    out: Output,
    degree: o.Degree,
    depth: o.Depth = 0.0,
    rest: o.RestRule = "waterbomb",
    end: o.EndRule = "contract",
    size: o.Size = 200,
    without_contact: Annotated[
        bool, typer.Option("--without-contact", help="Do not count minima at the end of a branch.")
    ] = False,
) -> None:
    """Map the number of branch minima over (nu_0, r_k), with its exact boundaries."""
    from origami_nlp.paper import cone as cones

    cones.check_size(size)
    with progress(f"cone of degree {degree}", size) as report:
        diagram = cones.phase_diagram(
            cones.Cone(degree, rest, end),
            size=size,
            depth=depth,
            contact=not without_contact,
            progress=report,
        )
    cones.print_diagram(diagram, out.console)
    out.write("csv", cones.map_as_csv, diagram)
    out.write("json", cones.diagram_to_dict, diagram)
    out.write("figure", cones.draw_phase, diagram)


@writes("json")
def full(
    out: Output,
    degree: o.Degree,
    rest_elevation: o.RestElevation,
    ratio: o.Ratio = 1.0,
    rest: o.RestRule = "waterbomb",
    end: o.EndRule = "contract",
) -> None:
    """Judge every branch minimum in the full contact-admissible space (degrees up to 16)."""
    from origami_nlp.paper import cone as cones
    from origami_nlp.pattern import parse_angle

    nu = parse_angle(rest_elevation, "--rest-elevation")
    with progress("branch minima") as report:
        found = cones.full_space(cones.Cone(degree, rest, end), ratio, nu, progress=report)
    cones.print_full_space(found, out.console)
    out.write("json", cones.full_space_to_dict, found)


cone = Group("Cones (uniform vertices of even degree): branches, their minima, different foldings.")
cone.add(count, phase, full, foldings, branch, draw)
