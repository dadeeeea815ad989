"""`origami-nlp landscape`: the energy landscape of a scene with two symmetric freedoms, exact."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from origami_nlp.cli.minima import FigureFile, JsonFile, SceneFile, Seed, check_figure, progress_bar
from origami_nlp.cli.progress import progress
from origami_nlp.errors import OptionError
from origami_nlp.pattern import read_scene

if TYPE_CHECKING:
    from rich.console import Console

    from origami_nlp.barriers import Barriers
    from origami_nlp.landscape import ExactLandscape

SMALLEST, LARGEST = 16, 4097


def landscape(
    scene: SceneFile,
    figure: FigureFile = None,
    npz: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write grids, boundary and minima as NumPy .npz."),
    ] = None,
    json: JsonFile = None,
    size: Annotated[int, typer.Option(help="Cells of the energy along each coordinate.")] = 401,
    passes: Annotated[
        bool, typer.Option("--passes", help="Find the passes between minima and draw the paths.")
    ] = False,
    seed: Seed = 0,
) -> None:
    """Map the energy landscape of SCENE: exact boundaries, minima, space, critical points and passes."""
    from origami_nlp.files import check_outputs, save_figure, screen, write_json
    from origami_nlp.minima import check_options, find_minima

    check_figure(figure)
    check_npz(npz)
    stated = read_scene(scene)
    check_options(seed, 1)
    if not SMALLEST <= size <= LARGEST:
        raise OptionError(f"--size = {size} must lie between {SMALLEST} and {LARGEST}")
    check_outputs(("--figure", figure), ("--npz", npz), ("--json", json))
    from origami_nlp.chart import chart_of
    from origami_nlp.landscape import exact_landscape

    if chart_of(stated) is None:
        from origami_nlp.chart import landscape as coordinates

        why = coordinates(stated, 8).reason or "it has one symmetric freedom only"
        raise OptionError(f"scene has no landscape over two coordinates: {why}")
    if json and stated.contact != "full":
        raise OptionError(
            f"--json: the admissible space needs contact = 'full', not {stated.contact!r}"
        )
    console = screen(json)
    with progress_bar(stated.label or scene) as report:
        result = find_minima(stated, seed=seed, full=True, progress=report)
    with progress("boundary"):
        exact = exact_landscape(result, size)
    exact.tell(console)
    barriers = None
    if json or passes:
        barriers = _barriers(console, exact, seed)
    if json:
        from origami_nlp.critical import find_critical_points
        from origami_nlp.landscape import landscape_to_dict
        from origami_nlp.space import analyse_space

        with progress("space and critical points"):
            space = analyse_space(stated)
            critical = find_critical_points(stated, result, seed=seed)
        console.print(critical.verdict(space.euler_characteristic).text, highlight=False)
        assert barriers is not None
        write_json(landscape_to_dict(exact, space, critical, barriers), json)
    if npz:
        _write_npz(exact, npz)
        console.print(f"arrays written to {npz}")
    if figure:
        from origami_nlp.landscape import draw_landscape

        save_figure(draw_landscape(exact, barriers), figure, 200)
        console.print(f"figure written to {figure}")


def check_npz(npz: Path | None) -> None:
    """Complain about another ending than .npz."""
    if npz is not None and npz.suffix.lower() != ".npz":
        raise OptionError(f"--npz = {str(npz)!r}: the name must end in .npz")


def _write_npz(exact: ExactLandscape, npz: Path) -> None:
    import io

    import numpy as np

    from origami_nlp.files import write_whole
    from origami_nlp.landscape import to_arrays

    content = io.BytesIO()
    np.savez_compressed(content, **to_arrays(exact))
    write_whole(npz, content.getvalue())


def _barriers(console: Console, exact: ExactLandscape, seed: int) -> Barriers:
    from origami_nlp.barriers import find_barriers

    with progress("passes between minima"):
        barriers = find_barriers(exact.result.scene, exact.result, seed=seed)
    for step in barriers.passes:
        console.print(
            f"pass {step.from_state} - {step.to_state}: {step.pass_kind}, {step.energy:.9g} J",
            highlight=False,
        )
    return barriers
