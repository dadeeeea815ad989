"""`origami-nlp example`: scenes and crease patterns that people know, by name."""

from __future__ import annotations

import inspect
import textwrap
from typing import Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.errors import OptionError
from origami_nlp.pattern import examples, format_scene


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
    if word not in examples.SHEETS or scene or not fold:
        stated = examples.by_name(word, **given)
    out.write("fold", lambda: examples.crease_pattern(word, *cells, **given))
    out.write("scene", lambda: _about(word) + format_scene(stated))


def _about(name: str) -> str:
    """Return what an example is as the first lines of its file."""
    said = (inspect.getdoc(examples.BY_NAME[name]) or "").split("\nParameters\n")[0]
    said = said.removeprefix("Make ")
    lines = textwrap.wrap(" ".join((said[:1].upper() + said[1:]).split()), 98)
    return "".join(f"# {line}\n" for line in lines)
