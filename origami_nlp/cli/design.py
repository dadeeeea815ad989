"""`origami-nlp design`: springs that hold given states, or the proof that there are none."""

from __future__ import annotations

from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.pattern import format_scene


def design(
    targets: Annotated[
        str, typer.Argument(metavar="TARGETS", help="What is asked for (TOML), or - for stdin.")
    ],
    out: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Write the scene (TOML) to FILE, or - for stdout."),
    ] = None,
    json: o.JsonFile = None,
    seed: o.Seed = 0,
    effort: o.Effort = "normal",
) -> None:
    """Find the springs that hold the states of TARGETS; exit code 1 where it is proved that there are none."""
    from origami_nlp.springs import design as find, read_targets

    files = Output(out=out, json=json)
    question, _, name = read_targets(targets)
    answer = find(question, name=name, seed=seed, effort=effort)
    files.say(answer)
    files.write("json", answer.to_dict)
    if answer.scene is not None:
        files.write("out", format_scene, answer.scene)
    raise typer.Exit(0 if answer.verified else 1)
