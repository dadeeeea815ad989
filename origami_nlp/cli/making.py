"""Commands that make scenes: `design` and `example`."""

from __future__ import annotations

import inspect
import json as js
import textwrap
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from origami_nlp.arguments import did_you_mean
from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output, writes
from origami_nlp.cli.source import cell_options, note_normalized
from origami_nlp.cli.timed import bounded
from origami_nlp.errors import OptionError

REFUTED, OPEN = 1, 3


@bounded
@writes("json", "scene", "fold", "figure")
def design(
    out: Output,
    targets: Annotated[
        str,
        typer.Argument(
            metavar="TARGETS",
            help="What is asked for (TOML), - for stdin, or an example by name: waitukaitis-five, six-states, "
            "three-equal, switch or flat-and-one (example NAME prints its file).",
        ),
    ],
    seed: o.Seed = 0,
    effort: o.Effort = "normal",
    verbose: o.Verbose = False,
) -> None:
    """Find the springs that hold the states of TARGETS, with the largest margin, and look for its minima.

    Fold angles of the states may be measured: the nearest states that close are taken, and how far they moved is said.
    -o writes a vertex with its springs as .toml, a pattern as .fold.  Exit code 0: a design that does all that is
    asked.  1: proved that no springs do.  3: neither; the last lines say why.
    """
    from origami_nlp.inverse_design import (
        EXAMPLES,
        design as find,
        draw_design,
        parse_targets,
        read_targets,
    )
    from origami_nlp.pattern import Pattern, Vertex, format_scene
    from origami_nlp.pattern_problem import pattern_to_fold

    if targets in EXAMPLES and not Path(targets).exists():
        question, ask, name = parse_targets(EXAMPLES[targets], source=targets)
    else:
        if targets != "-" and not Path(targets).suffix and not Path(targets).exists():
            meant = did_you_mean(targets, EXAMPLES)
            raise OptionError(
                f"TARGETS = {targets!r} is no file, and no example: those are {', '.join(EXAMPLES)}{meant}"
            )
        question, ask, name = read_targets(targets)
    if isinstance(question.origami, Vertex):
        note_normalized(question.origami.normalized)
        out.refuse("a vertex is written as a scene: end the name in .toml", "fold")
    else:
        out.refuse("a pattern is written as FOLD: end the name in .fold", "scene")
    answer = find(question, ask, name=name, seed=seed, effort=effort)
    answer.print_to(out.console, verbose)
    out.write("json", answer.to_dict)
    if (made := answer.scene) is not None:
        if isinstance(made, Pattern):
            content = js.dumps(pattern_to_fold(made, []), indent=1) + "\n"
            out.write("fold", lambda: content)
        else:
            out.write("scene", format_scene, made)
        out.write("figure", lambda: draw_design(answer))
    if not answer.verified:
        raise typer.Exit(REFUTED if answer.refuted else OPEN)


@writes("scene", "fold")
def example(
    out: Output,
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
        str | None, typer.Option(metavar="ANGLE", help='Rest angle of valleys [rad], e.g. "pi/2".')
    ] = None,
    symmetry: Annotated[
        str | None, typer.Option(metavar="GROUP", help="none, auto, C<n> or D<n>.")
    ] = None,
    contact: Annotated[
        str | None, typer.Option(metavar="full|fold-limits|none", help="full, fold-limits or none.")
    ] = None,
    cell: o.Cell = None,
    rolled: o.Rolled = None,
) -> None:
    """Print the scene file of a known vertex, or of a design its targets; -o FILE.fold writes the crease pattern.

    NAME:ROWSxCOLUMNS, such as miura:4x6, is the size of the crease pattern.
    """
    from origami_nlp.hinges import HINGE_EXAMPLES
    from origami_nlp.inverse_design import EXAMPLES
    from origami_nlp.pattern import examples, format_scene

    word, cells = examples.split_size(name)
    if word not in EXAMPLES and word not in HINGE_EXAMPLES and not examples.is_example(word):
        known = (*examples.names(), *HINGE_EXAMPLES, *EXAMPLES)
        listed = ", ".join(dict.fromkeys(known))
        raise OptionError(
            f"NAME = {name!r} is no example: those are {listed}{did_you_mean(word, known)}"
        )
    options = {
        "alpha": alpha,
        "ratio": ratio,
        "mountain": mountain,
        "valley": valley,
        "symmetry": symmetry,
        "contact": contact,
    }
    given: dict[str, Any] = {key: value for key, value in options.items() if value is not None}
    made: Callable[[], str]
    if name in HINGE_EXAMPLES:
        if given or cell or rolled:
            raise OptionError(f"{name!r} has no options: edit the file")
        kind, other, ending = (
            ("fold", "scene", ".fold") if name == "bistable-strip" else ("scene", "fold", ".toml")
        )
        out.refuse(f"{name} is written as {ending}: end the name so", other)
        out = out if out.files(kind) else Output(["-"], [kind])
        out.write(kind, HINGE_EXAMPLES[name])
        return
    if name in EXAMPLES:
        if given:
            raise OptionError(f"--{next(iter(given))}: the targets of {name!r} have no options")
        out.refuse("targets are written as TOML: end the name in .toml", "fold")
        made = partial(EXAMPLES.__getitem__, name)
    elif out.files("fold") and not out.files("scene"):
        repeats = cell_options(cell, rolled)
        given |= repeats
        out.write("fold", lambda: examples.crease_pattern(word, *cells, **given))
        return
    elif cell or rolled:
        raise OptionError("--cell: a cell that repeats is a crease pattern: give -o FILE.fold")
    else:
        if ":" in name and not out.files("fold"):
            raise OptionError(
                f"NAME = {name!r}: a size is that of a crease pattern: give -o FILE.fold"
            )
        stated = examples.by_name(word, **given)
        made = lambda: _about(examples.maker(word)) + format_scene(stated)  # noqa: E731
    if not out.files("scene", "fold"):
        out = Output(["-"], ["scene"])
    out.write("fold", lambda: examples.crease_pattern(word, *cells, **given))
    out.write("scene", made)


def _about(make: Callable[..., Any]) -> str:
    """Return what an example is as the first lines of its file."""
    said = (inspect.getdoc(make) or "").split("\nParameters\n")[0]
    said = said.removeprefix("Make ")
    lines = textwrap.wrap(" ".join((said[:1].upper() + said[1:]).split()), 98)
    lines.append(
        "To make it yours: sector_angles_deg, rest_angles_deg take degrees; stiffness is in N m/rad."
    )
    return "".join(f"# {line}\n" for line in lines)
