"""One crease pattern from format to format: FOLD, SVG, .cp, DXF."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.drawings import (
    WRITTEN,
    Drawing,
    DrawingOptions,
    drawing_to_fold,
    write_drawing,
)
from origami_nlp.errors import DrawingError, FoldFileError
from origami_nlp.io import write_whole
from origami_nlp.pattern import examples
from origami_nlp.pattern.fold_file import Frame, parse_fold, read_fold
from origami_nlp.pattern.fold_notes import listed

FOLD = ".fold"


def convert(
    source: str | PathLike[str],
    out: str | PathLike[str],
    *,
    frame: int | None = None,
    drawing: DrawingOptions | None = None,
    size: float | None = None,
) -> Drawing:
    """Write the crease pattern of a file in another format.

    Parameters
    ----------
    source
        FOLD, SVG, .cp, .opx or DXF; ``"-"`` for standard input; or an example by name, such as ``"miura:4x4"``.
    out
        The ending says which format is written.
    frame
        Of a FOLD file, from 0; a folded form is drawn flat, with its fold angles.
    drawing
        What is known of a drawing beside it.
    size
        Longest side of a drawing that is written [mm].

    Returns
    -------
    Drawing
        What was written, its `notes` with what was repaired, and what the format does not hold.

    Raises
    ------
    FoldFileError
        If the file cannot be read, or is not written so.

    Examples
    --------
    >>> import json, os, tempfile, origami_nlp as o
    >>> folder = tempfile.mkdtemp()
    >>> path = os.path.join(folder, "miura.fold")
    >>> with open(path, "w") as file:
    ...     json.dump(o.examples.crease_pattern("miura", 4, 4), file)
    >>> written = o.convert(path, os.path.join(folder, "miura.svg"))
    >>> len(o.read_pattern(os.path.join(folder, "miura.svg")).polygons)
    16
    """
    kind = Path(out).suffix.lower()
    if kind != FOLD and kind not in WRITTEN:
        known = ", ".join((FOLD, *WRITTEN))
        raise DrawingError(f"OUT = {str(out)!r} must end in one of {known}")
    frames = frames_of(source, drawing)
    found = [one for one in frames if frame in (None, one.number)]
    if not found:
        some = listed([one.number for one in frames], 12)
        raise FoldFileError(f"--frame {frame} is no frame with geometry: there is {some}")
    chosen = found[0]
    made = frame_drawing(_flat(frames, chosen), chosen)
    if kind == FOLD:
        if size is not None:
            raise DrawingError("size is for drawings, not for FOLD")
        text, notes = json.dumps(drawing_to_fold(made), indent=1) + "\n", _lost(chosen)
    else:
        text, notes = write_drawing(made, kind, size)
    write_whole(out, text.encode())
    return replace(made, notes=(*made.notes, *notes))


def frames_of(
    source: str | PathLike[str] | Mapping[str, Any], drawing: DrawingOptions | None = None
) -> tuple[Frame, ...]:
    """Return the frames of a file, of FOLD data, or of an example by its name."""
    if isinstance(source, Mapping):
        return parse_fold(source)
    if not Path(source).exists() and examples.is_example(str(source)):
        data = examples.crease_pattern(str(source))
        return parse_fold(data, source=f"{source}.fold")
    return read_fold(str(source), drawing=drawing)


def _lost(frame: Frame) -> tuple[str, ...]:
    """Note what a file states that a drawing does not."""
    stated = "stiffness rest_angles preload limits lattice".split()
    arrays = {key.replace("_", " "): getattr(frame, key) for key in stated}
    given = [key for key, v in arrays.items() if v is not None and not np.isnan(v).all()]
    given += ["hinge laws"] * bool(frame.laws)
    kept = f"{', '.join(given)} of the file: left out; inspect -o FILE.fold keeps them"
    return (kept,) if given else ()


def _flat(frames: tuple[Frame, ...], chosen: Frame) -> Frame:
    """Return the crease pattern of a frame: itself, or the flat one of the file with the same edges."""
    for one in (chosen, *frames):
        alike = len(one.coords) == len(chosen.coords) and np.array_equal(one.edges, chosen.edges)
        if alike and not one.folded:
            return one
    raise FoldFileError(f"frame {chosen.number} is folded, and no crease pattern has its edges")


def frame_drawing(flat: Frame, state: Frame | None = None) -> Drawing:
    """Return a flat frame as a drawing.

    Parameters
    ----------
    flat
        The crease pattern.
    state
        Another frame with the same edges, whose letters and fold angles are drawn.

    Returns
    -------
    Drawing
        Edges that are joined (J) as flat ones.
    """
    said = state or flat
    letters = tuple({"J": "F", "?": "U"}.get(letter, letter) for letter in said.assignment)
    drawn = flat.coords[:, :2], flat.edges, letters, np.degrees(said.fold_angles)
    return Drawing(*drawn, 0.0, 0.0, said.title, flat.length_unit, flat.y_down, said.notes)
