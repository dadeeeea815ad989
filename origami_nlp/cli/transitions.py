"""`origami-nlp paper transitions`: sector angles at which the admissible space of a family changes."""

from __future__ import annotations

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.timed import bounded


@bounded
def transitions(
    family: o.Family,
    samples: o.Samples = 25,
    rings: o.Rings = 16,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
) -> None:
    """Sweep alpha_1 over a FAMILY of the paper and locate every transition of its admissible space.

    The sweep starts from so many --samples of alpha_1.
    """
    from origami_nlp.paper import find_transitions

    out = Output(json=json)
    with progress(family, 1.0) as tell:
        sweep = find_transitions(
            family,
            samples=samples,
            size=rings,
            seed=seed,
            report=lambda what, done: tell(done, text=what),
        )
    sweep.tell(out.console)
    out.write("json", sweep.to_dict)
