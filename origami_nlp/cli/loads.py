"""Loads on the command line: what is loaded, and how far."""

from __future__ import annotations

import math
from typing import Annotated, Any, TypeAlias

import typer

from origami_nlp.errors import OptionError

Creases: TypeAlias = Annotated[
    list[int] | None,
    typer.Option(
        metavar="K",
        help="Torque on crease K, from 1; of a pattern, repeated: on each of them; of a vertex on its images too.",
    ),
]
PullOf: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="V,W",
        help="Of a pattern: forces that pull vertices V and W apart, numbered from 0 as in the file.",
    ),
]
ForceOn: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="V,X,Y,Z",
        help="Of a pattern: a force along (X, Y, Z) on vertex V, as seen from the facet --held.",
    ),
]
Held: TypeAlias = Annotated[
    int, typer.Option(metavar="F", help="With --force: the facet that is held, from 1.")
]


def load_number(text: str) -> float:
    """Return the load that ``--to`` says."""
    try:
        return float(text)
    except ValueError:
        raise OptionError(f"--to = {text!r} must be a load, or snap") from None


def work_of(
    sheet: Any, creases: list[int] | None, pull: str | None, force: str | None, held: int
) -> Any:
    """Return what a load on a pattern works on, as options say it."""
    from origami_nlp.facets import DeadForce, Pull, Torque

    if creases:
        return Torque(sheet, tuple(creases))
    if pull:
        a, b = _numbers("--pull", pull, 2)
        return Pull(sheet, (_whole("--pull", a), _whole("--pull", b)))
    v, x, y, z = _numbers("--force", force or "", 4)
    return DeadForce(sheet, _whole("--force", v), (x, y, z), held)


def _numbers(option: str, text: str, count: int) -> list[float]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise OptionError(f"{option} = {text!r} must be {count} numbers with commas between them")
    return values


def _whole(option: str, value: float) -> int:
    if value != int(value):
        raise OptionError(f"{option}: vertex {value:g} must be a whole number, as in the file")
    return int(value)
