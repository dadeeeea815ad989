"""Which of the formats a file is, and the drawing in it as FOLD data."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

from origami_nlp.drawings.cp import read_cp
from origami_nlp.drawings.dxf import read_dxf
from origami_nlp.drawings.lines import ERROR_KEY, DrawingOptions, Lines
from origami_nlp.drawings.opx import read_opx
from origami_nlp.drawings.sheet import Drawing, make_drawing
from origami_nlp.drawings.svg import read_svg
from origami_nlp.numerics import last_place

READERS = {".svg": read_svg, ".cp": read_cp, ".opx": read_opx, ".dxf": read_dxf}
"""By the ending of the file's name."""


def drawing_kind(name: str, raw: bytes) -> str | None:
    """Return the ending of the format that a file has, by its name, or its first letters where that says nothing.

    Parameters
    ----------
    name
        Of the file; ``"-"`` for standard input.
    raw
        What it holds.

    Returns
    -------
    str or None
        One of `READERS`; None for none of them.

    Examples
    --------
    >>> drawing_kind("bird.CP", b""), drawing_kind("-", b"<svg/>"), drawing_kind("a.fold", b"1 0 0 1 1")
    ('.cp', '.svg', None)
    """
    ending = Path(name).suffix.lower()
    if ending in READERS:
        return ending
    if ending and name != "-":
        return None
    head = raw[:4096].lstrip()
    if re.match(rb"[1-4][ \t]+[-+.\d]", head):
        return ".cp"
    if re.match(rb"0\s+SECTION", head) or head.startswith(b"AutoCAD Binary DXF"):
        return ".dxf"
    if head.startswith(b"<") and b"OriLineProxy" in raw[:65536]:
        return ".opx"
    return ".svg" if head.startswith(b"<") and b"<svg" in raw[:65536] else None


def read_drawing(
    raw: bytes, kind: str, name: str = "the drawing", options: DrawingOptions | None = None
) -> Drawing:
    """Read a drawing as a planar graph.

    Parameters
    ----------
    raw
        The file.
    kind
        Of `READERS`.
    name
        How messages call it.
    options
        What a person says of it.

    Returns
    -------
    Drawing
        Its edges and vertices, and what was done to have them.

    Raises
    ------
    DrawingError
        If it is not of its kind, or there is no crease pattern in it.

    Examples
    --------
    >>> made = read_drawing(b"1 0 0 2 0\\n1 2 0 2 2\\n1 2 2 0 2\\n1 0 2 0 0\\n2 0 0 2 2", ".cp")
    >>> len(made.points), made.letters
    (4, ('B', 'B', 'B', 'B', 'M'))
    """
    options = options or DrawingOptions()
    lines: Lines = READERS[kind](raw, name, options)
    return make_drawing(lines, options, name)


def drawing_to_fold(drawing: Drawing) -> dict[str, Any]:
    """Return a drawing as FOLD data.

    Parameters
    ----------
    drawing
        Of `read_drawing`.

    Returns
    -------
    dict
        For `json.dump`.  Fold angles are there if any line states one; ``origaminlp:coordinateError`` is what joining
        moved.
    """
    angles = [None if math.isnan(a) else a for a in drawing.angles.tolist()]
    error = drawing.error if drawing.error > last_place(drawing.points) else 0.0
    stated = {"file_title": drawing.title, "frame_unit": drawing.length_unit, ERROR_KEY: error}
    stated["edges_foldAngle"] = angles if any(a is not None for a in angles) else []
    return {
        "file_spec": 1.1,
        "file_creator": "origami_nlp",
        "file_classes": ["singleModel"],
        "frame_classes": ["creasePattern"],
        "frame_attributes": ["2D"],
        "vertices_coords": drawing.points.tolist(),
        "edges_vertices": drawing.edges.tolist(),
        "edges_assignment": list(drawing.letters),
        **{key: value for key, value in stated.items() if value},
    }
