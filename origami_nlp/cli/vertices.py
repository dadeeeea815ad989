"""`origami-nlp vertices`: the interior vertices of a FOLD file, and what can be analysed."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from origami_nlp.cli.minima import JsonFile
from origami_nlp.errors import OptionError
from origami_nlp.folding import folds_flat
from origami_nlp.pattern import FoldVertex, Frame, Scene, fold_vertices, read_fold, scene_at

SCHEMA = "origami-nlp/vertices/1"
HEADS = (
    "vertex",
    "degree",
    "assignment",
    "sector angles [deg]",
    "Kawasaki [deg]",
    "Maekawa",
    "folds flat",
    "analysis",
)
WORDS = ("assignment", "sector angles [deg]", "analysis")
FrameNumber = Annotated[
    int | None, typer.Option("--frame", help="Frame of a FOLD file, from 0; default: the first.")
]


def vertices(
    fold: Annotated[str, typer.Argument(metavar="FOLD", help="FOLD file, or - for stdin.")],
    frame: FrameNumber = None,
    json: JsonFile = None,
) -> None:
    """List the interior vertices of a FOLD file: degree, angles, flat-foldability, diagnosis."""
    from origami_nlp.files import check_writable, screen, write_json

    check_writable(json, "--json")
    frames = read_fold(fold, frame)
    console = screen(json)
    everything = []
    for one in frames:
        found, notes = fold_vertices(one)
        flat = [folds_flat(v) for v in found]
        everything.append(_to_dict(one, found, flat, notes))
        kind = "folded form" if one.folded else "crease pattern"
        title = f"frame {one.number} ({kind}){': ' + one.title if one.title else ''}"
        title += f": {len(found)} interior vertices with creases"
        rows = [_row(v, folds) for v, folds in zip(found, flat, strict=True)]
        console.print_rows(title, HEADS, rows, left=WORDS, tables=len(frames))
        said = [f"note: {note}" for note in (*one.notes, *notes)]
        said += [f"vertex {v.number}: {note}" for v in found for note in v.notes]
        if said:
            console.print("\n".join(said), highlight=False)
    if json:
        write_json({"schema": SCHEMA, "frames": everything}, json)


def read_fold_scene(
    source: str | Path, vertex: int | None, frame: int | None, **options: Any
) -> Scene:
    """Read one vertex of a FOLD file as a scene; its only vertex that can be analysed by default.

    What is odd in the file, and what was assumed, goes to standard error.  options: as `scene_at` takes them.
    """
    (chosen,) = read_fold(source, "first" if frame is None else frame)
    found, notes = fold_vertices(chosen)
    if vertex is None:
        good = [v.number for v in found if not v.reason]
        if len(good) != 1:
            some = (
                f" ({', '.join(map(str, good[:12]))}{', ...' if len(good) > 12 else ''})"
                if good
                else ""
            )
            why = "".join(f"; {note}" for note in notes) if not found else ""
            raise OptionError(
                f"--vertex is needed: {len(good)} interior vertices can be analysed{some}; "
                f"origami-nlp vertices lists them{why}"
            )
        vertex = good[0]
    scene = scene_at(chosen, vertex, **options)
    here = next(v for v in found if v.number == vertex)
    for note in (*chosen.notes, *notes, *(f"vertex {vertex}: {note}" for note in here.notes)):
        print(f"note: {note}", file=sys.stderr)
    return scene


def _row(v: FoldVertex, folds: bool | None) -> tuple[str, ...]:
    angles = " ".join(f"{math.degrees(a):.5g}" for a in v.sector_angles)
    kawasaki = "-" if v.kawasaki is None else f"{math.degrees(v.kawasaki):.2g}"
    maekawa = "-" if v.maekawa is None else f"{v.maekawa:+d}"
    flat = {True: "yes", False: "no", None: "-"}[folds]
    first = (str(v.number), str(v.degree), v.assignment, angles)
    return (*first, kawasaki, maekawa, flat, v.reason or "yes")


def _to_dict(
    frame: Frame, found: tuple[FoldVertex, ...], flat: list[bool | None], notes: tuple[str, ...]
) -> dict[str, Any]:
    return {
        "frame": frame.number,
        "title": frame.title,
        "folded": frame.folded,
        "notes": [*frame.notes, *notes],
        "vertices": [
            {
                "vertex": v.number,
                "degree": v.degree,
                "edges": list(v.edges),
                "assignment": v.assignment,
                "sector_angles": [None if math.isnan(a) else a for a in v.sector_angles],
                "fold_angles": [None if math.isnan(a) else a for a in v.fold_angles],
                "file_angles": [None if math.isnan(a) else a for a in v.file_angles],
                "kawasaki": v.kawasaki if v.kawasaki is None or math.isfinite(v.kawasaki) else None,
                "maekawa": v.maekawa,
                "folds_flat": folds,
                "can_be_analysed": not v.reason,
                "reason": v.reason,
                "notes": list(v.notes),
            }
            for v, folds in zip(found, flat, strict=True)
        ],
    }
