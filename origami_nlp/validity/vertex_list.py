"""The interior vertices of a FOLD frame: which fold flat, what can be analysed, and what is odd.

In JSON vertices, edges and frames are numbered from 0 as in the file, angles in
radians; what does not exist is null.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.display import Report
from origami_nlp.io import printable, to_plain
from origami_nlp.numerics import NOISE
from origami_nlp.pattern import FoldVertex, Frame, fold_vertices
from origami_nlp.validity.flat_fold import explained, folds_flat

HEADS = *"vertex degree M/V Kawasaki Maekawa flat analysis".split(), "sector angles [deg]"
WIDTHS = "{:<7} {:<7} {:<8} {:<9} {:<8} {:<5} {:<9} {}"


@dataclass(frozen=True, eq=False, repr=False)
class VertexList(Report):
    """The interior vertices of frames.

    Attributes
    ----------
    frames
        Of `read_fold`.
    vertices
        With creases, of each frame.
    notes
        What is odd of the file, each frame and its vertices.
    """

    SCHEMA = "origami-nlp/pattern/2"
    frames: tuple[Frame, ...]
    vertices: tuple[tuple[FoldVertex, ...], ...]
    notes: tuple[tuple[str, ...], ...]

    def to_dict(self) -> dict[str, Any]:
        """Return plain data: one entry of ``frames`` for each; whether a vertex folds flat is null where not known."""
        frames = []
        for frame, vertices, notes in zip(self.frames, self.vertices, self.notes, strict=True):
            said = (
                {"folds_flat": folds_flat(v), "can_be_analysed": not v.reason} for v in vertices
            )
            own = [to_plain(v) | more for v, more in zip(vertices, said, strict=True)]
            about = {"frame": frame.number, "title": frame.title, "folded": frame.folded}
            frames.append({**about, "notes": list(notes), "vertices": own})
        return {"schema": self.SCHEMA, "frames": frames}

    def report_sections(self) -> Iterator[str]:
        """Return a table and the notes of every frame."""
        for frame, vertices, notes in zip(self.frames, self.vertices, self.notes, strict=True):
            many, kind = len(vertices), "folded form" if frame.folded else "crease pattern"
            name = Path(frame.source).name or "frame 0"
            name += f", frame {frame.number}" * bool(frame.number)
            title = f"{name} ({kind}){': ' + frame.title if frame.title else ''}"
            # a table of rich takes 20 times as long, of 10,000 vertices
            said = [f"{title}: {many} interior vert{'ex' if many == 1 else 'ices'} with creases"]
            said += [WIDTHS.format(*row) for row in (HEADS, *map(_row, vertices))]
            said += [f"note: {note}" for note in notes]
            said += [f"vertex {v.number}: {note}" for v in vertices for note in v.notes]
            yield printable("\n".join(said), lines=True)


def list_vertices(frames: Sequence[Frame]) -> VertexList:
    """Find the interior vertices of frames, and which of them fold flat.

    Parameters
    ----------
    frames
        Of `read_fold`.

    Returns
    -------
    VertexList
        The vertices with their notes.

    Raises
    ------
    OptionError
        If one is none of `read_fold`.
    """
    vertices, notes = [], []
    for frame in frames:
        found, said = fold_vertices(frame)
        if off := [v.kawasaki or 0.0 for v in found if explained(v)]:
            known = max(
                frame.error or frame.unit, NOISE * float(np.ptp(frame.coords, axis=0).max())
            )
            said += (
                f"{len(off)} vertices miss Kawasaki's condition by up to {math.degrees(max(off)):.2g} degrees, no more "
                f"than coordinates known to {known:.2g} leave open: judged as the nearest that meet it",
            )
        vertices.append(found)
        notes.append((*frame.notes, *said))
    return VertexList(tuple(frames), tuple(vertices), tuple(notes))


def _row(v: FoldVertex) -> tuple[object, ...]:
    angles = " ".join(f"{math.degrees(a):.5g}" for a in v.sector_angles)
    kawasaki = "-" if v.kawasaki is None else f"{math.degrees(v.kawasaki):.2g}"
    maekawa = "-" if v.maekawa is None else f"{v.maekawa:+d}"
    flat = {True: "yes", False: "no", None: "-"}[folds_flat(v)]
    return (v.number, v.degree, v.assignment, kawasaki, maekawa, flat, v.reason or "yes", angles)
