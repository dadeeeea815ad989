"""What a file says as FOLD data, whichever format it has: JSON, or a drawing (SVG, .cp, .opx, DXF)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from origami_nlp.drawings import DrawingOptions
from origami_nlp.errors import FoldFileError
from origami_nlp.io import parse_json

MOST_ELEMENTS = 2_000_000
"""Vertices and edges of all frames together, those that they inherit included, where all are read."""
STDIN = "standard input"


@dataclass(frozen=True)
class FoldSource:
    """FOLD data, and what there is besides.

    Attributes
    ----------
    data
        Keys of FOLD.
    notes
        Of a drawing: what was repaired, taken and left out.
    y_down
        Whether the file's own y points down.
    """

    data: Mapping[str, Any]
    notes: tuple[str, ...] = ()
    y_down: bool = False


def decode_source(
    text: str | bytes, source: str = "", drawing: DrawingOptions | None = None
) -> FoldSource:
    """Return what a file says.

    Parameters
    ----------
    text
        All of it.
    source
        Where it is from: the ending of its name is its format; first letters are, where there is none.
    drawing
        What a person says of a drawing.

    Returns
    -------
    FoldSource
        Its data.

    Raises
    ------
    FoldFileError
        If it is not of its format.

    Examples
    --------
    >>> decode_source('{"file_spec": 1.1}').data
    {'file_spec': 1.1}
    >>> len(decode_source("1 0 0 1 0", "line.cp").data["edges_vertices"])
    1
    """
    from origami_nlp.drawings import drawing_kind, drawing_to_fold, read_drawing

    raw = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
    kind = drawing_kind("-" if source in ("", STDIN) else source, raw)
    if kind is None:
        if drawing is not None:
            raise FoldFileError(
                f"{source!r} is a FOLD file: the options of drawings are not for it"
            )
        name = f"FOLD file {source!r}" if source else "FOLD file"
        data = parse_json(text, name, FoldFileError)
        if not isinstance(data, Mapping):
            raise FoldFileError(
                f"{name} must be a JSON object: vertices_coords, edges_vertices, ..."
            )
        return FoldSource(data)
    made = read_drawing(raw, kind, repr(source) if source else "the drawing", drawing)
    return FoldSource(drawing_to_fold(made), made.notes, made.y_down)


def is_drawing(source: str, raw: bytes = b"") -> bool:
    """Return whether a file is a drawing that is read as FOLD data.

    Parameters
    ----------
    source
        Its name, ``"-"`` for standard input.
    raw
        What it holds, or nothing to go by the name.

    Returns
    -------
    bool
        Whether it is SVG, .cp, .opx or DXF.

    Examples
    --------
    >>> is_drawing("crane.opx"), is_drawing("crane.fold")
    (True, False)
    """
    from origami_nlp.drawings import drawing_kind

    return drawing_kind("-" if source in ("", STDIN) else source, raw) is not None


def check_total(frames: list[dict[str, Any]]) -> None:
    """Refuse frames that inherit so much that a small file becomes a day of work."""
    total = sum(
        len(keys[key])
        for keys in frames
        for key in ("vertices_coords", "edges_vertices")
        if isinstance(keys.get(key), list)
    )
    if len(frames) > 1 and total > MOST_ELEMENTS:
        raise FoldFileError(
            f"file_frames: {len(frames)} frames with geometry have {total} vertices and edges in all, more than "
            f"{MOST_ELEMENTS}: choose one with --frame"
        )
