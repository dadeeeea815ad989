"""`origami-nlp minima`: find, classify and show the energy minima of a scene."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from origami_nlp.cli.progress import progress
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Scene, read_scene

SceneFile = Annotated[
    str, typer.Argument(metavar="SCENE", help="Scene file (TOML), or - for stdin.")
]
SceneOrFold = Annotated[
    str,
    typer.Argument(metavar="SCENE", help="Scene file (TOML), FOLD file, or - for TOML on stdin."),
]
Seed = Annotated[int, typer.Option(help="Seed of the random starts.")]
JsonFile = Annotated[
    str | None, typer.Option("--json", metavar="FILE", help="Write JSON to FILE, or - for stdout.")
]
FigureFile = Annotated[
    Path | None,
    typer.Option("--figure", metavar="FILE", help="Write a figure (.png, .pdf or .svg)."),
]
FIGURE_SUFFIXES = (".png", ".pdf", ".svg")


def minima(
    scene: SceneOrFold,
    seed: Seed = 0,
    json: JsonFile = None,
    figure: FigureFile = None,
    fold: Annotated[
        str | None, typer.Option("--fold", metavar="FILE", help="Write the states as a FOLD file.")
    ] = None,
    mesh: Annotated[
        str | None,
        typer.Option(
            "--mesh", metavar="FILE", help="Write the states as .obj, .stl or .glb (extra mesh)."
        ),
    ] = None,
    max_starts: Annotated[int, typer.Option(help="Cap on random starts.")] = 1000,
    full: Annotated[
        bool, typer.Option("--full", help="Decide which are stable when the symmetry may break.")
    ] = False,
    vertex: Annotated[
        int | None, typer.Option(help="FOLD file: the vertex, numbered from 0 as in the file.")
    ] = None,
    frame: Annotated[int | None, typer.Option(help="FOLD file: the frame, from 0.")] = None,
    symmetry: Annotated[
        str | None, typer.Option(help="FOLD file: none, auto, C<n> or D<n> (default auto).")
    ] = None,
    contact: Annotated[
        str | None, typer.Option(help="FOLD file: full, fold-limits or none (default full).")
    ] = None,
    stiffness: Annotated[
        float | None, typer.Option(help="FOLD file: of creases without one [N m/rad] (default 1).")
    ] = None,
    rest_angle: Annotated[
        float | None,
        typer.Option(
            help="FOLD file: size for M and V creases without an angle [deg] (default 180)."
        ),
    ] = None,
    rest_angles: Annotated[
        str | None,
        typer.Option(
            metavar="file|measured",
            help="FOLD file: a folded form rests at the angles that the file states, or at those it is folded at "
            "(default: file where it states them).",
        ),
    ] = None,
) -> None:
    """Find the energy minima of SCENE that have its symmetry; --full says which are stable states."""
    check_figure(figure)
    options = {
        "vertex": vertex,
        "frame": frame,
        "symmetry": symmetry,
        "contact": contact,
        "stiffness": stiffness,
        "rest_angle": rest_angle,
        "rest_angles": rest_angles,
    }
    stated = _read(scene, {key: value for key, value in options.items() if value is not None})
    from origami_nlp.files import check_outputs, screen, write_json
    from origami_nlp.minima import check_options, find_minima, print_result, result_to_dict

    check_options(seed, max_starts)
    check_outputs(("--json", json), ("--figure", figure), ("--fold", fold), ("--mesh", mesh))
    if mesh:
        from origami_nlp.minima import check_mesh

        check_mesh(mesh)
    console = screen(json, fold)
    with progress_bar(stated.label or scene) as report:
        result = find_minima(stated, seed=seed, max_starts=max_starts, full=full, progress=report)
    print_result(result, console)
    if json:
        write_json(result_to_dict(result), json)
    if figure:
        from origami_nlp.minima import draw_minima

        draw_minima(result, figure)
        console.print(f"figure written to {figure}")
    if fold or mesh:
        from origami_nlp.minima import write_fold, write_mesh

        for target, write in ((fold, write_fold), (mesh, write_mesh)):
            if target:
                write(result, target)
                console.print(f"states written to {target}")


def _read(source: str, options: dict[str, Any]) -> Scene:
    """Read a scene file, or one vertex of a FOLD file with its options."""
    if not source.lower().endswith((".fold", ".json")):
        if options:
            raise OptionError(
                f"--{next(iter(options)).replace('_', '-')} is for FOLD files (.fold); "
                "a scene file states it itself"
            )
        return read_scene(source)
    from origami_nlp.cli.vertices import read_fold_scene

    if "rest_angle" in options:
        options["rest_angle"] = math.radians(options["rest_angle"])
        if not 0 <= options["rest_angle"] <= math.pi:
            raise OptionError(
                f"--rest-angle = {math.degrees(options['rest_angle']):g} must be 0 to 180"
            )
    if not options.get("stiffness", 1.0) > 0 or not math.isfinite(options.get("stiffness", 1.0)):
        raise OptionError(f"--stiffness = {options['stiffness']:g} must be positive and finite")
    return read_fold_scene(
        source, options.pop("vertex", None), options.pop("frame", None), **options
    )


def check_figure(figure: Path | None) -> None:
    """Complain about a figure format that we do not write."""
    if figure is not None and figure.suffix.lower() not in FIGURE_SUFFIXES:
        raise OptionError(
            f"--figure = {str(figure)!r}: the name must end in {', '.join(FIGURE_SUFFIXES)}"
        )


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[[int, int, float], None]]:
    """Show starts, minima and expected undiscovered answers while a search runs (on stderr)."""
    with progress(title) as tell:

        def report(starts: int, found: int, missing: float) -> None:
            shown = "-" if math.isinf(missing) else f"{missing:.2f}"
            tell(text=f"{starts} starts, {found} minima, expected undiscovered {shown}")

        yield report
