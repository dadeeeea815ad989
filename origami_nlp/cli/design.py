"""`origami-nlp design`: springs that hold given states, or the proof that there are none."""

from __future__ import annotations

import json as js
from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.timed import bounded
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Pattern, format_scene

REFUTED, OPEN = 1, 3


@bounded
def design(
    targets: Annotated[
        str | None,
        typer.Argument(metavar="TARGETS", help="What is asked for (TOML), or - for stdin."),
    ] = None,
    example: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Targets by name instead: waitukaitis-five, three-equal, switch, flat-and-one, monostable8.",
        ),
    ] = None,
    write: Annotated[
        str | None,
        typer.Option(
            "--targets",
            metavar="FILE",
            help="Write the targets of --example to FILE, or - for stdout.",
        ),
    ] = None,
    scene: o.SceneOut = None,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    seed: o.Seed = 0,
    effort: o.Effort = "normal",
) -> None:
    """Find the springs that hold the states of TARGETS, with the largest margin; the main job checks them.

    Exit code 0: a design that does all that is asked.  1: proved that no springs do.  3: neither; the last lines say
    why.
    """
    from origami_nlp.facets import sheet_to_fold
    from origami_nlp.springs import (
        design as find,
        draw_design,
        example_targets,
        parse_targets,
        read_targets,
    )

    files = Output(scene=scene, json=json, figure=figure, targets=write)
    if (targets is None) == (example is None):
        raise OptionError("give TARGETS, or --example NAME")
    if write is not None and example is None:
        raise OptionError("--targets writes the targets of --example NAME")
    if example is not None:
        text = example_targets(example)
        question, ask, name = parse_targets(text)
        files.write("targets", lambda: text)
    else:
        question, ask, name = read_targets(str(targets))
    answer = find(question, ask, name=name, seed=seed, effort=effort)
    answer.tell(files.console)
    files.write("json", answer.to_dict)
    if answer.scene is not None:
        made = answer.scene
        if isinstance(made, Pattern):
            files.write("scene", lambda: js.dumps(sheet_to_fold(made, []), indent=1) + "\n")
        else:
            files.write("scene", format_scene, made)
        files.write("figure", draw_design, answer)
    if not answer.verified:
        raise typer.Exit(REFUTED if answer.refuted else OPEN)
