"""Commands that say what a file holds: `inspect` of origami, `hinge` of a measured hinge."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output, answers, writes
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from origami_nlp.display import Table
    from origami_nlp.pattern import Scene


@takes_scene(o.OrigamiFile, whole=True)
@writes("json", "scene", "fold", "figure")
def inspect(out: Output, scene: Source) -> None:
    """Print what a file says: vertices of a pattern; creases, springs and optimisation problem of one vertex.

    Of a pattern: degree, angles, flat-foldability and diagnosis of each interior vertex; -o FILE.png draws it with the
    numbers of its vertices, FILE.fold is the pattern with the springs given here.  Of a scene, or with --vertex:
    the springs of each crease, variables and constraints; -o FILE.toml is that vertex as a scene file.
    """
    if scene.is_whole:
        _pattern(scene, out)
    else:
        _vertex(scene, out)


def _vertex(scene: Source, out: Output) -> None:
    from origami_nlp.pattern import format_scene
    from origami_nlp.pattern_problem import pose

    out.refuse("one vertex is written as a scene: end the name in .toml", "json", "fold", "figure")
    stated = scene.read()
    model = str(pose(stated))
    out.say(_springs(stated))
    for law in dict.fromkeys(filter(None, stated.laws)):
        out.say(f"law {law}")
    for load in stated.loads:
        out.say(f"load: {load.words}, facet {stated.fixed_facet} fixed")
    out.say(model)
    out.write("scene", format_scene, stated)


def _springs(stated: Scene) -> Table:
    """Return one row a crease: the sector to the next crease, and its spring."""
    from origami_nlp.display import rows_table

    heads = ["crease", "sector to the next [deg]", "stiffness [N m/rad]", "rest angle [deg]"]
    sectors, rest = (
        map(math.degrees, a) for a in (stated.vertex.sector_angles, stated.rest_angles)
    )
    columns = [[f"{v:.7g}" for v in row] for row in (sectors, stated.stiffness, rest)]
    if stated.preload:
        heads, columns = [*heads, "preload [N m]"], [*columns, [f"{m:.7g}" for m in stated.preload]]
    if stated.limits:
        pairs = [" to ".join(f"{math.degrees(a):.7g}" for a in pair) for pair in stated.limits]
        heads, columns = [*heads, "stops [deg]"], [*columns, pairs]
    if stated.laws:
        none = [law is not None for law in stated.laws]
        for k in (1, 2):  # the numbers of a law are in its line
            columns[k] = ["" if n else v for n, v in zip(none, columns[k], strict=True)]
        heads, columns = (
            [*heads, "law"],
            [*columns, [law.name if law else "" for law in stated.laws]],
        )
    rows = [[str(i), *row] for i, row in enumerate(zip(*columns, strict=True), start=1)]
    kept = f"symmetry {stated.group.name} ({stated.symmetry} asked)"
    title = f"{stated.label or 'vertex'}: degree {stated.degree}, {kept}, contact {stated.contact}"
    return rows_table(heads, rows, title)


def _pattern(scene: Source, out: Output) -> None:
    from origami_nlp.display import draw_pattern
    from origami_nlp.folding import list_vertices, print_vertices, vertices_to_dict
    from origami_nlp.pattern_problem import pattern_to_fold

    out.refuse("name one vertex with --vertex, to write it as a scene", "scene")
    others = [name for name in scene.given if name != "frame"]
    if others and not out.files("fold"):
        raise OptionError(
            f"--{others[0].replace('_', '-')}: the list has every vertex as it is in the file; give "
            "-o FILE.fold to write the pattern with it, or --vertex V -o FILE.toml for one vertex"
        )
    lists = [list_vertices(one) for one in scene.frames()]
    flat = [one.frame for one in lists if not one.frame.folded]
    if not flat:
        out.refuse("there is no crease pattern to draw", "figure")
    sheet: Any = scene.read_pattern() if out.files("fold") else None
    print_vertices(lists, out.console)
    out.write("json", vertices_to_dict, lists)
    out.write("figure", lambda: draw_pattern(flat[0]))
    out.write("fold", lambda: json.dumps(pattern_to_fold(sheet), indent=1) + "\n")


@answers("json", "figure")
def hinge(
    data: Annotated[
        str,
        typer.Argument(
            metavar="DATA",
            help="Table of text, - for stdin: columns angle_deg (or angle_rad), torque_Nm (or torque_Nmm) and, if "
            "wanted, weight, in the order of the measurement; # begins a remark.",
        ),
    ],
    fit: Annotated[
        str,
        typer.Option(
            metavar="spline|pchip",
            help="Least squares, with knots by BIC; or through the points, averaged where there are many.",
        ),
    ] = "spline",
) -> Any:
    """Fit a hinge law to measured torques: its band, wells, where the stiffness is negative, loop, and what to look at.

    Torque is dU/dphi, positive towards valley.  A scene has the law by [laws.NAME] data = "DATA".
    """
    from origami_nlp.hinges import fit_hinge

    return fit_hinge(data, fit=fit)
