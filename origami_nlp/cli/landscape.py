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
    _tell(console, exact)
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


def _tell(console: Console, exact: ExactLandscape) -> None:
    """Print the minima with their places and verdicts, and the boundary."""
    from rich.table import Table
    from rich.text import Text

    names = [name.split(" (")[0] for name in exact.chart.coordinates]
    table = Table(title=exact.result.scene.label, title_justify="left")
    for head in ("#", "energy [J]", *names, "kind", "full space"):
        left = head in ("kind", "full space")
        table.add_column(Text(head), justify="left" if left else "right", no_wrap=True)
    for number, (m, place) in enumerate(zip(exact.result.minima, exact.places, strict=True), 1):
        table.add_row(
            str(number),
            f"{m.energy:.9g}",
            *(f"{v:.6f}" for v in place.point),
            m.kind,
            m.full_space.verdict if m.full_space else "-",
        )
    console.print(table)
    text = " -> ".join("?" if n is None else str(n) for n in exact.counts)
    console.print(f"N_sym -> N_not-ruled-out -> N_full: {text}", highlight=False)
    if exact.boundary is None:
        console.print("boundary not traced: contact is not 'full'")
        return
    lines = exact.boundary.lines
    handles, missed = sum(line.thin for line in lines), sum(map(len, exact.boundary.missed))
    console.print(
        f"{len(lines)} contact boundaries, {sum(line.length for line in lines):.2f} rad; "
        f"{handles} of them 1-handles; boundary points of the grid on no line: {missed}",
        highlight=False,
    )
    for part in exact.metastable:
        where = "on one chart point, " if part.hidden else ""
        console.print(
            f"metastable: {part.length:.2f} rad, {where}{'; '.join(part.contacts)}", highlight=False
        )


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
