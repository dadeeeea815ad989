"""Drawings written for simulators and drawing programs, as they stand or at true size."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.drawings.dxf import dxf_text
from origami_nlp.drawings.sheet import Drawing
from origami_nlp.errors import DrawingError

LOOKS = {
    "M": ("mountains", "#ff0000", 2, "MountainLine", 1),
    "V": ("valleys", "#0000ff", 3, "ValleyLine", 5),
    "U": ("unassigned", "#ff00ff", 4, "UnassignedLine", 8),
    "F": ("flat", "#ffff00", 4, "AuxiliaryLine", 4),
    "C": ("cuts", "#00ff00", 1, "SlitLine", 6),
    "B": ("border", "#000000", 1, "CutLine", 3),
}
"""Group and colour of each letter in SVG (of Origami Simulator), code of .cp, layer and colour in DXF (of ORIPA)."""


def write_drawing(
    drawing: Drawing, kind: str, size: float | None = None
) -> tuple[str, tuple[str, ...]]:
    """Return a drawing as the text of a file.

    Parameters
    ----------
    drawing
        Of `read_drawing`, or made of a frame.
    kind
        Of `WRITTEN`.
    size
        Longest side [mm]; by default the drawing's own, in its unit.

    Returns
    -------
    str
        The file.
    tuple of str
        What the format does not hold, one line each.

    Raises
    ------
    DrawingError
        If the format is not written.
    OptionError
        If the size is not positive.

    Examples
    --------
    >>> from origami_nlp.drawings import read_drawing
    >>> square = read_drawing(b"1 0 0 2 0\\n1 2 0 2 2\\n1 2 2 0 2\\n1 0 2 0 0\\n2 0 0 2 2", ".cp")
    >>> print(write_drawing(square, ".cp")[0].splitlines()[-1])
    2 0.0 0.0 2.0 2.0
    """
    if kind not in WRITTEN:
        raise DrawingError(f"{kind!r} is not written: end the name in {', '.join(WRITTEN)}, .fold")
    if size is not None:
        factor = check_number("size [mm]", size, math.ulp(0.0))
        factor /= float(np.ptp(drawing.points, axis=0).max())
        points, error = factor * drawing.points, factor * drawing.error
        drawing = replace(drawing, points=points, error=error, length_unit="mm")
    notes: list[str] = []
    text = WRITTEN[kind](drawing, notes)
    return text, tuple(notes)


def _down(drawing: Drawing) -> np.ndarray:
    """Return both ends of each edge with y downwards, [E, 4]."""
    found: np.ndarray = (drawing.points * [1.0, -1.0] + 0.0)[drawing.edges].reshape(-1, 4)
    return found


def _lost(drawing: Drawing, notes: list[str], format_: str, letters: str = "") -> None:
    """Note the fold angles and letters that a format has no way to write."""
    if not np.isnan(drawing.angles).all():
        notes.append(f"{format_} holds no fold angles: they are left out")
    if lost := sum(a in letters for a in drawing.letters):
        notes.append(f"{format_} has no {letters}: {lost} edges are auxiliary lines or border")


def simulator_svg(drawing: Drawing, notes: list[str]) -> str:
    """Return SVG in the colours of Origami Simulator, with opacity for the fold angle."""
    low, high = drawing.points.min(axis=0), drawing.points.max(axis=0)
    size = float((high - low).max())
    room = size / 50
    box = [low[0] - room, -high[1] - room, *(high - low + 2 * room)]
    wide, tall, shown = (f"{v:.10g}" for v in box[2:]), "", " ".join(f"{v:.10g}" for v in box)
    if drawing.length_unit == "mm":
        tall = ' width="{}mm" height="{}mm"'.format(*wide)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" version="1.1"{tall} viewBox="{shown}">']
    if drawing.title:
        out.append(f"<title>{escape(drawing.title)}</title>")
    lines = [*zip(drawing.letters, _down(drawing).tolist(), drawing.angles.tolist(), strict=True)]
    for letter, (group, colour, *_) in LOOKS.items():
        look = f'stroke="{colour}" stroke-width="{size / 400:.4g}" fill="none"'
        here = [(row, angle) for own, row, angle in lines if own == letter]
        out += [f'<g id="{group}" {look}>'] if here else []
        for (x1, y1, x2, y2), angle in here:
            fold = ""
            if letter in "MV" and not math.isnan(angle):
                fold = f' opacity="{abs(angle) / 180!r}" data-foldAngle="{angle!r}"'
            ends = f'x1="{x1!r}" y1="{y1!r}" x2="{x2!r}" y2="{y2!r}"'
            out.append(f'<line {ends} data-assignment="{letter}"{fold}/>')
        out += ["</g>"] if here else []
    others = sum(a not in "MV" and not math.isnan(angle) and angle != 0 for a, _, angle in lines)
    if others:
        notes.append(f"{others} fold angles of edges that are neither M nor V are left out")
    return "\n".join([*out, "</svg>", ""])


def cp(drawing: Drawing, notes: list[str]) -> str:
    """Return the text of a ``.cp`` file."""
    _lost(drawing, notes, ".cp", "UC")
    return "".join(
        f"{LOOKS[letter][2]} {' '.join(map(repr, row))}\n"
        for letter, row in zip(drawing.letters, _down(drawing).tolist(), strict=True)
    )


def oripa_dxf(drawing: Drawing, notes: list[str]) -> str:
    """Return DXF with the layers of ORIPA and Oriedita."""
    _lost(drawing, notes, "DXF")

    def draw(space: Any) -> None:
        ends = drawing.points[drawing.edges].tolist()
        for letter, (a, b) in zip(drawing.letters, ends, strict=True):
            space.add_line(a, b, dxfattribs={"layer": LOOKS[letter][3]})

    return dxf_text(
        {layer: colour for *_, layer, colour in LOOKS.values()}, drawing.length_unit, draw
    )


WRITTEN = {".svg": simulator_svg, ".dxf": oripa_dxf, ".cp": cp}
"""What writes each format."""
