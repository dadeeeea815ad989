"""Commands that make and read scenes: `design`, `example`, `vertices` and `model`."""

from __future__ import annotations

import inspect
import json as js
import textwrap
from collections.abc import Callable
from typing import Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.source import Source, note_normalized, takes_scene
from origami_nlp.cli.timed import bounded
from origami_nlp.errors import OptionError

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
    from origami_nlp.inverse_design import (
        design as find,
        draw_design,
        example_targets,
        parse_targets,
        read_targets,
    )
    from origami_nlp.pattern import Pattern, Vertex, format_scene
    from origami_nlp.pattern_problem import pattern_to_fold

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
    if isinstance(question.origami, Vertex):
        note_normalized(question.origami)
    answer = find(question, ask, name=name, seed=seed, effort=effort)
    answer.print_to(files.console)
    files.write("json", answer.to_dict)
    if answer.scene is not None:
        made = answer.scene
        if isinstance(made, Pattern):
            files.write("scene", lambda: js.dumps(pattern_to_fold(made, []), indent=1) + "\n")
        else:
            files.write("scene", format_scene, made)
        files.write("figure", draw_design, answer)
    if not answer.verified:
        raise typer.Exit(REFUTED if answer.refuted else OPEN)


def example(
    name: o.ExampleName,
    alpha: Annotated[
        str | None,
        typer.Option(
            metavar="ANGLE",
            help='The sector angle alpha [rad] of those that have one, a number or e.g. "pi/4".',
        ),
    ] = None,
    ratio: o.RatioWanted = None,
    mountain: Annotated[
        str | None,
        typer.Option(metavar="ANGLE", help='Rest angle of mountains [rad], e.g. "-pi/2".'),
    ] = None,
    valley: Annotated[
        str | None,
        typer.Option(metavar="ANGLE", help='Rest angle of valleys [rad], e.g. "pi/2".'),
    ] = None,
    symmetry: Annotated[
        str | None, typer.Option(metavar="GROUP", help="none, auto, C<n> or D<n>.")
    ] = None,
    contact: Annotated[
        str | None,
        typer.Option(metavar="full|fold-limits|none", help="full, fold-limits or none."),
    ] = None,
    scene: o.SceneOut = None,
    fold: Annotated[
        str | None,
        typer.Option(
            "--fold",
            metavar="FILE",
            help="Write the crease pattern as a FOLD file; the scene then goes to --scene alone.",
        ),
    ] = None,
) -> None:
    """Print a vertex of a known pattern as a scene file; --fold writes the crease pattern as a FOLD file.

    NAME:ROWSxCOLUMNS, such as miura:4x6, is the size of the crease pattern that --fold writes.
    """
    from origami_nlp.pattern import examples, format_scene

    word, cells = examples.split_size(name)
    if ":" in name and fold is None:
        raise OptionError(f"NAME = {name!r}: a size is that of a crease pattern: give --fold FILE")
    options = {
        "alpha": alpha,
        "ratio": ratio,
        "mountain": mountain,
        "valley": valley,
        "symmetry": symmetry,
        "contact": contact,
    }
    given: dict[str, Any] = {key: value for key, value in options.items() if value is not None}
    out = Output(scene=scene if scene or fold else "-", fold=fold)
    if word not in examples.WITH_SPRINGS or scene or not fold:
        stated = examples.by_name(word, **given)
    out.write("fold", lambda: examples.crease_pattern(word, *cells, **given))
    out.write("scene", lambda: _about(examples.BY_NAME[word]) + format_scene(stated))


def _about(make: Callable[..., Any]) -> str:
    """Return what an example is as the first lines of its file."""
    said = (inspect.getdoc(make) or "").split("\nParameters\n")[0]
    said = said.removeprefix("Make ")
    lines = textwrap.wrap(" ".join((said[:1].upper() + said[1:]).split()), 98)
    return "".join(f"# {line}\n" for line in lines)


@takes_scene(o.FoldFile)
def vertices(
    scene: Source,
    json: o.JsonFile = None,
    toml: o.SceneOut = None,
    figure: o.FigureFile = None,
) -> None:
    """List the interior vertices of a FOLD file: degree, angles, flat-foldability, diagnosis.

    With --scene, write the one of --vertex as a scene file; --figure draws the pattern with the numbers of vertices.
    """
    from origami_nlp.display import draw_pattern
    from origami_nlp.folding import list_vertices, print_vertices, vertices_to_dict
    from origami_nlp.pattern import format_scene

    out = Output(json=json, scene=toml, figure=figure)
    others = {name: value for name, value in scene.given.items() if name != "frame"}
    if toml is None and others:
        raise OptionError(
            f"--{next(iter(others)).replace('_', '-')}: the list has every vertex as it is in the file; "
            "give --scene FILE, to write one as a scene"
        )
    lists = [list_vertices(one) for one in scene.frames()]
    flat = [one.frame for one in lists if not one.frame.folded]
    if figure and not flat:
        raise OptionError(f"--figure = {str(figure)!r}: there is no crease pattern to draw")
    print_vertices(lists, out.console)
    out.write("json", vertices_to_dict, lists)
    out.write("scene", lambda: format_scene(scene.read()))
    out.write("figure", lambda: draw_pattern(flat[0]))


@takes_scene(o.SceneFile)
def model(scene: Source) -> None:
    """Print variables, equalities, inequalities, facet pairs in and out of the model of SCENE."""
    from origami_nlp.problem import Model

    stated = scene.read()
    Output().say(f"{stated}\n{Model(stated)}", highlight=False, soft_wrap=True)
