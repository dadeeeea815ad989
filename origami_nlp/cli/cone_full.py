"""`origami-nlp cone full`: which branch minima are stable when the cone may move in any way."""

from __future__ import annotations

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.pattern import parse_angle


def full(
    degree: o.Degree,
    ratio: o.Ratio,
    elevation: o.RestElevation,
    rest: o.RestRule = "waterbomb",
    end: o.EndRule = "contract",
    json: o.JsonFile = None,
) -> None:
    """Judge every branch minimum in the full contact-admissible space (degrees up to 16)."""
    from origami_nlp.cone import cone_full_space, full_space_to_dict, print_full_space

    out = Output(json=json)
    nu = parse_angle(elevation, "--elevation")
    with progress("branch minima") as report:
        found = cone_full_space(degree, ratio, nu, rest=rest, end=end, progress=report)
    print_full_space(found, out.console)
    out.write("json", full_space_to_dict, found)
