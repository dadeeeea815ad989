"""`origami-nlp landscape`: the energy landscape of a scene with two symmetric freedoms, exact."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.search import search
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.cli.timed import bounded
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from origami_nlp.landscape import ExactLandscape

SMALLEST, LARGEST = 16, 4097


@bounded
@takes_scene(o.SceneFile)
def landscape(
    scene: Source,
    figure: o.FigureFile = None,
    npz: o.NpzFile = None,
    json: o.JsonFile = None,
    html: o.HtmlFile = None,
    size: o.Size = 401,
    passes: Annotated[
        bool, typer.Option("--passes", help="Find the passes between minima and draw the paths.")
    ] = False,
    seed: o.Seed = 0,
) -> None:
    """Map the energy landscape of SCENE: exact boundaries, minima, space, critical points and passes."""
    from origami_nlp.barriers import find_barriers
    from origami_nlp.chart import chart_of, landscape as coordinates
    from origami_nlp.critical import find_critical_points
    from origami_nlp.landscape import (
        draw_landscape,
        find_landscape,
        landscape_to_dict,
    )
    from origami_nlp.show import TurnedPage
    from origami_nlp.space import find_space

    out = Output(figure=figure, npz=npz, json=json, html=html)
    stated = scene.read()
    if not SMALLEST <= size <= LARGEST:
        raise OptionError(f"--size = {size} must lie between {SMALLEST} and {LARGEST}")
    if chart_of(stated) is None:
        why = coordinates(stated, 8).reason or "it has one symmetric freedom only"
        raise OptionError(f"scene has no landscape over two coordinates: {why}")
    if json and stated.contact != "full":
        raise OptionError(
            f"--json: the admissible space needs contact = 'full', not {stated.contact!r}"
        )
    result = search(stated, scene.name, seed=seed, full=True, escape=False)
    with progress("boundary"):
        exact = find_landscape(result, size)
    exact.tell(out.console)
    barriers = None
    if json or passes:
        with progress("passes between minima"):
            barriers = find_barriers(stated, result, seed=seed)
        for step in barriers.passes:
            kind = f"{step.pass_kind}, {step.energy:.9g} J"
            out.say(f"pass {step.from_state} - {step.to_state}: {kind}", highlight=False)
    if json:
        with progress("space and critical points"):
            space = find_space(stated)
            critical = find_critical_points(stated, result, seed=seed)
        out.say(critical.verdict(space.euler_characteristic).text, highlight=False)
        out.write("json", landscape_to_dict, exact, space, critical, barriers)
    out.write("npz", _npz, exact)
    out.write("figure", draw_landscape, exact, barriers)
    out.save("html", lambda file: TurnedPage(exact.turned(barriers)).save(file))


def _npz(exact: ExactLandscape) -> bytes:
    import numpy as np

    from origami_nlp.landscape import to_arrays

    content = io.BytesIO()
    np.savez_compressed(content, **to_arrays(exact))
    return content.getvalue()
