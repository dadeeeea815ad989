"""`origami-nlp transitions`: sector angles at which the admissible space of a family changes."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress


def transitions(
    family: o.Family,
    samples: Annotated[int, typer.Option(help="Sector angles of the sweep.")] = 25,
    size: Annotated[int, typer.Option(help="Rings of each mesh.")] = 16,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
) -> None:
    """Sweep alpha_1 over a FAMILY of the paper and locate every transition of its admissible space."""
    from origami_nlp.space import find_transitions, print_transitions

    out = Output(json=json)
    with progress(family, 1.0) as tell:
        sweep = find_transitions(
            family,
            samples=samples,
            size=size,
            seed=seed,
            report=lambda what, done: tell(done, text=what),
        )
    print_transitions(sweep, out.console)
    out.write("json", sweep.to_dict)
