"""`origami-nlp transitions`: sector angles at which the admissible space of a family changes."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli.minima import JsonFile, Seed
from origami_nlp.cli.progress import progress


def transitions(
    family: Annotated[str, typer.Argument(metavar="FAMILY", help="degree6 or degree8.")],
    samples: Annotated[int, typer.Option(help="Sector angles of the sweep.")] = 25,
    size: Annotated[int, typer.Option(help="Rings of each mesh.")] = 16,
    seed: Seed = 0,
    json: JsonFile = None,
) -> None:
    """Sweep alpha_1 over a FAMILY of the paper and locate every transition of its admissible space."""
    from origami_nlp.files import check_writable, screen, write_json
    from origami_nlp.space import find_transitions, print_transitions

    check_writable(json, "--json")
    with progress(family, 1.0) as tell:
        sweep = find_transitions(
            family,
            samples=samples,
            size=size,
            seed=seed,
            report=lambda what, done: tell(done, text=what),
        )
    print_transitions(sweep, screen(json))
    if json:
        write_json(sweep.to_dict(), json)
