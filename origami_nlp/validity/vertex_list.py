"""The interior vertices of a FOLD frame: which fold flat, what can be analysed, and what is odd.

In JSON vertices, edges and frames are numbered from 0 as in the file, angles in
radians; what does not exist is null.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.io import pick, printable, to_plain
from origami_nlp.numerics import NOISE
from origami_nlp.pattern import FoldVertex, Frame, fold_vertices
from origami_nlp.validity.flat_fold import explained, folds_flat

if TYPE_CHECKING:
    from rich.console import Console

SCHEMA = "origami-nlp/pattern/2"
HEADS = *"vertex degree M/V Kawasaki Maekawa flat analysis".split(), "sector angles [deg]"
WIDTHS = "{:<7} {:<7} {:<8} {:<9} {:<8} {:<5} {:<9} {}"


@dataclass(frozen=True)
class VertexList:
    """The interior vertices of one frame.

    Attributes
    ----------
    frame
        Of `read_fold`.
    vertices
        With creases.
    flat
        Whether each folds flat with its mountains and valleys (None where not all are stated).
    notes
        What is odd, of the file, the frame and its vertices.
    """

    frame: Frame
    vertices: tuple[FoldVertex, ...]
    flat: tuple[bool | None, ...]
    notes: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return plain data: one entry of ``frames`` of the schema."""
        each = zip(map(to_plain, self.vertices), self.flat, strict=True)
        own = [v | {"folds_flat": flat, "can_be_analysed": not v["reason"]} for v, flat in each]
        frame = pick(self.frame, "frame=number", "title", "folded")
        return {**frame, "notes": list(self.notes), "vertices": own}


def list_vertices(frame: Frame) -> VertexList:
    """Find the interior vertices of a frame, and which of them fold flat.

    Parameters
    ----------
    frame
        Of `read_fold`.

    Returns
    -------
    VertexList
        The vertices with their verdicts and notes.

    Raises
    ------
    OptionError
        If `frame` is none of `read_fold`.
    """
    found, notes = fold_vertices(frame)
    off = [v.kawasaki or 0.0 for v in found if explained(v)]
    if off:
        known = max(frame.error or frame.unit, NOISE * float(np.ptp(frame.coords, axis=0).max()))
        notes += (
            f"{len(off)} vertices miss Kawasaki's condition by up to {math.degrees(max(off)):.2g} degrees, no more "
            f"than coordinates known to {known:.2g} leave open: judged as the nearest that meet it",
        )
    return VertexList(frame, found, tuple(map(folds_flat, found)), (*frame.notes, *notes))


def vertices_to_dict(lists: Sequence[VertexList]) -> dict[str, Any]:
    """Return the vertices of all frames as plain JSON data.

    Parameters
    ----------
    lists
        Of `list_vertices`.

    Returns
    -------
    dict
        Of the schema that it names.
    """
    return {"schema": SCHEMA, "frames": [one.to_dict() for one in lists]}


def print_vertices(lists: Sequence[VertexList], console: Console) -> None:
    """Print a table and the notes of every frame.

    Parameters
    ----------
    lists
        Of `list_vertices`.
    console
        Where to.
    """
    for one in lists:
        frame, many = one.frame, len(one.vertices)
        kind = "folded form" if frame.folded else "crease pattern"
        name = Path(frame.source).name or "frame 0"
        name += f", frame {frame.number}" * bool(frame.number)
        title = f"{name} ({kind}){': ' + frame.title if frame.title else ''}"
        # a table of rich takes 20 times as long, of 10,000 vertices
        said = [f"{title}: {many} interior vert{'ex' if many == 1 else 'ices'} with creases"]
        said += [WIDTHS.format(*row) for row in (HEADS, *map(_row, one.vertices, one.flat))]
        said += [f"note: {note}" for note in one.notes]
        said += [f"vertex {v.number}: {note}" for v in one.vertices for note in v.notes]
        console.out(printable("\n".join(said), lines=True), highlight=False)


def _row(v: FoldVertex, folds: bool | None) -> tuple[object, ...]:
    angles = " ".join(f"{math.degrees(a):.5g}" for a in v.sector_angles)
    kawasaki = "-" if v.kawasaki is None else f"{math.degrees(v.kawasaki):.2g}"
    maekawa = "-" if v.maekawa is None else f"{v.maekawa:+d}"
    flat = {True: "yes", False: "no", None: "-"}[folds]
    return (v.number, v.degree, v.assignment, kawasaki, maekawa, flat, v.reason or "yes", angles)
