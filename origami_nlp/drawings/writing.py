"""Drawings written: for simulators and drawing programs as they stand, for lasers and the bench at true size."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from origami_nlp.drawings.dxf import dxf_text
from origami_nlp.drawings.laser import LAYERS, Stroke, laser_strokes
from origami_nlp.drawings.oripa_files import CP_CODES, OPX_CODES
from origami_nlp.drawings.sheet import Drawing
from origami_nlp.drawings.style import SIMULATOR_COLOURS
from origami_nlp.errors import DrawingError, OptionError

STYLES = {
    ".svg": ("simulator", "laser", "bench"),
    ".dxf": ("simulator", "laser"),
    ".cp": ("simulator",),
    ".opx": ("simulator",),
}
"""What each format is written for; the first where nothing is said."""
MILLIMETRES = {
    "mm": 1.0,
    "cm": 10.0,
    "m": 1000.0,
    "in": 25.4,
    "um": 1e-3,
    "nm": 1e-6,
    "pt": 25.4 / 72,
}
"""Of FOLD's ``frame_unit``."""
BENCH_SIZE = 180.0
"""Longest side [mm] of what is printed for the bench where no size is known: an A4 page holds it."""
_COLOURS = {letter: colour for colour, letter in reversed(SIMULATOR_COLOURS.items())}
_GROUPS = {
    "M": "mountains",
    "V": "valleys",
    "U": "unassigned",
    "F": "flat",
    "C": "cuts",
    "B": "border",
}


@dataclass(frozen=True)
class WriteOptions:
    """How a drawing is written.

    Attributes
    ----------
    style
        Of `STYLES`; None: the first of the format.
    scale
        Millimetres for one unit of the drawing; None: as its unit says.
    size
        Longest side [mm], instead of a scale.
    dash
        Length of a dash and of a gap [mm], for creases of lasers; None: whole lines.
    holes
        Radius of a hole [mm] at each vertex inside the paper; 0: none.

    Raises
    ------
    OptionError
        If a value is none of these.

    Examples
    --------
    >>> import origami_nlp as o
    >>> o.WriteOptions("laser", size=150, dash=(3, 1), holes=0.5).size
    150
    """

    style: str | None = None
    scale: float | None = None
    size: float | None = None
    dash: tuple[float, float] | None = None
    holes: float = 0.0

    def __post_init__(self) -> None:
        known = STYLES[".svg"]
        if self.style is not None and self.style not in known:
            raise OptionError(f"style = {self.style!r} must be one of {', '.join(known)}")
        for name in ("scale", "size"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise OptionError(f"{name} = {value:g} must be positive [mm]")
        if self.scale is not None and self.size is not None:
            raise OptionError("scale and size: give one of them")
        if self.dash is not None and not all(0 < part < math.inf for part in self.dash):
            raise OptionError(f"dash = {self.dash[0]:g},{self.dash[1]:g} must be two lengths [mm]")
        if not 0 <= self.holes < math.inf:
            raise OptionError(f"holes = {self.holes:g} must be a radius [mm]")


def write_drawing(
    drawing: Drawing, kind: str, options: WriteOptions | None = None, labels: tuple[str, ...] = ()
) -> tuple[str, tuple[str, ...]]:
    """Return a drawing as the text of a file.

    Parameters
    ----------
    drawing
        Of `read_drawing`, or made of a frame.
    kind
        Of `STYLES`.
    options
        How.
    labels
        Of each edge, for the bench; "" for none.

    Returns
    -------
    str
        The file.
    tuple of str
        What the format does not hold or the options changed, one line each.

    Raises
    ------
    DrawingError
        If the format is not written in that style, or true size is asked for where no size is known.

    Examples
    --------
    >>> from origami_nlp.drawings import read_drawing
    >>> square = read_drawing(b"1 0 0 2 0\\n1 2 0 2 2\\n1 2 2 0 2\\n1 0 2 0 0\\n2 0 0 2 2", ".cp")
    >>> print(write_drawing(square, ".cp")[0].splitlines()[-1])
    2 0.0 0.0 2.0 2.0
    """
    options = options or WriteOptions()
    if kind not in STYLES:
        raise DrawingError(f"{kind!r} is not written: end the name in {', '.join(STYLES)} or .fold")
    style = options.style or STYLES[kind][0]
    if style not in STYLES[kind]:
        raise DrawingError(f"style {style!r}: {kind} is written for {', '.join(STYLES[kind])}")
    if (options.dash or options.holes) and style != "laser":
        raise DrawingError("dashes and holes are for lasers: --style laser")
    notes: list[str] = []
    drawing = scaled(drawing, options, style, notes)
    if style == "laser":
        strokes, more = laser_strokes(drawing, options.dash, options.holes)
        text = laser_svg(strokes, drawing) if kind == ".svg" else laser_dxf(strokes, drawing)
        return text, (*notes, *more)
    if style == "bench":
        return bench_svg(drawing, labels), tuple(notes)
    if kind == ".dxf":
        return oripa_dxf(drawing, notes), tuple(notes)
    text = {".svg": simulator_svg, ".cp": cp, ".opx": opx}[kind](drawing, notes)
    return text, tuple(notes)


def scaled(drawing: Drawing, options: WriteOptions, style: str, notes: list[str]) -> Drawing:
    """Return a drawing in the size in which it is written, in mm where that is known."""
    extent = float(np.ptp(drawing.points, axis=0).max())
    known = MILLIMETRES.get(drawing.length_unit)
    if options.size is not None:
        factor = options.size / extent
    elif options.scale is not None:
        factor = options.scale
    elif style == "simulator":
        return drawing
    elif known is not None:
        factor = known
    elif style == "bench":
        factor = BENCH_SIZE / extent
        notes.append(f"no size is known: drawn {BENCH_SIZE:g} mm long, 1 unit is {factor:.6g} mm")
    else:
        raise DrawingError(
            "no unit of length is stated: --scale says how many mm one unit is, or --longest how many the longest side"
        )
    return replace(
        drawing, points=factor * drawing.points, error=factor * drawing.error, length_unit="mm"
    )


def _down(drawing: Drawing) -> np.ndarray:
    """Return both ends of each edge with y downwards, [E, 4]."""
    found: np.ndarray = (drawing.points * [1.0, -1.0] + 0.0)[drawing.edges].reshape(-1, 4)
    return found


def _lost(drawing: Drawing, notes: list[str], format_: str, letters: str = "") -> None:
    """Note what a format does not hold: fold angles, and letters that become others."""
    if not np.isnan(drawing.angles).all():
        notes.append(f"{format_} holds no fold angles: they are left out")
    counts = Counter(a for a in drawing.letters if a in letters)
    for letter, many in sorted(counts.items()):
        notes.append(
            f"{format_} has no {letter}: {many} edges are written as auxiliary lines or border"
        )


def simulator_svg(drawing: Drawing, notes: list[str]) -> str:
    """Return SVG in the colours of Origami Simulator, with opacity for the fold angle."""
    low, high = drawing.points.min(axis=0), drawing.points.max(axis=0)
    size = float((high - low).max())
    room = size / 50
    box = (low[0] - room, -high[1] - room, *(high - low + 2 * room))
    mm = drawing.length_unit == "mm"
    width = f' width="{box[2]:.10g}mm" height="{box[3]:.10g}mm"' if mm else ""
    shown = " ".join(f"{v:.10g}" for v in box)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" version="1.1"{width} viewBox="{shown}">']
    if drawing.title:
        out.append(f"<title>{escape(drawing.title)}</title>")
    rows = _down(drawing).tolist()
    for letter, group in _GROUPS.items():
        here = [k for k, a in enumerate(drawing.letters) if a == letter]
        if not here:
            continue
        look = f'stroke="{_COLOURS[letter]}" stroke-width="{size / 400:.4g}" fill="none"'
        out.append(f'<g id="{group}" {look}>')
        for k in here:
            x1, y1, x2, y2 = rows[k]
            angle = float(drawing.angles[k])
            fold = ""
            if letter in "MV" and not math.isnan(angle):
                fold = f' opacity="{abs(angle) / 180!r}" data-foldAngle="{angle!r}"'
            ends = f'x1="{x1!r}" y1="{y1!r}" x2="{x2!r}" y2="{y2!r}"'
            out.append(f'<line {ends} data-assignment="{letter}"{fold}/>')
        out.append("</g>")
    others = ~np.isin(drawing.letters, ("M", "V")) & (np.nan_to_num(drawing.angles) != 0)
    if others.any():
        notes.append(
            f"{int(others.sum())} fold angles of edges that are neither M nor V are left out"
        )
    return "\n".join([*out, "</svg>", ""])


def cp(drawing: Drawing, notes: list[str]) -> str:
    """Return the text of a ``.cp`` file."""
    _lost(drawing, notes, ".cp", "UC")
    code = {letter: number for number, letter in CP_CODES.items()} | {"U": 4, "C": 1}
    return "".join(
        f"{code[letter]} {' '.join(map(repr, row))}\n"
        for letter, row in zip(drawing.letters, _down(drawing).tolist(), strict=True)
    )


def opx(drawing: Drawing, notes: list[str]) -> str:
    """Return the Java beans of an ``.opx`` file; as in Java, what is 0 is left out."""
    _lost(drawing, notes, ".opx")
    code = {letter: number for number, letter in OPX_CODES.items()}
    beans = []
    for k, (letter, row) in enumerate(zip(drawing.letters, _down(drawing).tolist(), strict=True)):
        own = [("type", "int", str(code[letter]))] if code[letter] else []
        own += [
            (n, "double", repr(v)) for n, v in zip(("x0", "y0", "x1", "y1"), row, strict=True) if v
        ]
        lines = "".join(f'<void property="{n}"><{t}>{v}</{t}></void>' for n, t, v in own)
        beans.append(
            f'<void index="{k}"><object class="oripa.OriLineProxy">{lines}</object></void>'
        )
    title = f'<void property="title"><string>{escape(drawing.title)}</string></void>'
    return "\n".join(
        [
            '<?xml version="1.0" encoding="UTF-8"?>',
            '<java version="1.6.0" class="java.beans.XMLDecoder"><object class="oripa.DataSet">',
            f'<void property="lines"><array class="oripa.OriLineProxy" length={quoteattr(str(len(beans)))}>',
            *beans,
            f"</array></void>{title if drawing.title else ''}</object></java>",
            "",
        ]
    )


def oripa_dxf(drawing: Drawing, notes: list[str]) -> str:
    """Return DXF with the layers of ORIPA and Oriedita."""
    _lost(drawing, notes, "DXF")
    layers = {"M": ("MountainLine", 1), "V": ("ValleyLine", 5), "B": ("CutLine", 3)}  # theirs
    layers |= {"F": ("AuxiliaryLine", 4), "U": ("UnassignedLine", 8), "C": ("SlitLine", 6)}

    def draw(space: Any) -> None:
        ends = drawing.points[drawing.edges].tolist()
        for letter, (a, b) in zip(drawing.letters, ends, strict=True):
            space.add_line(a, b, dxfattribs={"layer": layers[letter][0]})

    return dxf_text(dict(layers.values()), drawing.length_unit, draw)


LASER_COLOURS = {
    "VALLEY": ("#00a000", 3),
    "MOUNTAIN": ("#0000ff", 5),
    "CREASE": ("#00a0a0", 4),
    "HOLES": ("#ff8000", 30),
    "CUT": ("#ff00ff", 6),
    "BORDER": ("#ff0000", 1),
}
"""In SVG and in DXF: red is cut last, blue and green are scored; no two layers alike, so that programs which sort by
colour keep the order."""
HAIRLINE = 0.025
"""Width [mm]: what drivers take for a vector is 0.001 inch or less."""
MARGIN = 5.0
"""Around the sheet [mm]."""
BENCH_COLOURS = {
    "M": "#d00000",
    "V": "#0030d0",
    "U": "#a000a0",
    "F": "#909090",
    "C": "#00a000",
    "B": "#000000",
}
_INKSCAPE = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'


def _page(drawing: Drawing) -> tuple[np.ndarray, np.ndarray]:
    """Return where the upper left corner of the page is, and its size [mm]."""
    low, high = drawing.points.min(axis=0), drawing.points.max(axis=0)
    return np.array([low[0] - MARGIN, high[1] + MARGIN]), high - low + 2 * MARGIN


def _svg(drawing: Drawing, body: Sequence[str]) -> str:
    size = _page(drawing)[1]
    w, h = (f"{v:.6f}" for v in size)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {_INKSCAPE} version="1.1" width="{w}mm" height="{h}mm"'
    title = [f"<title>{escape(drawing.title)}</title>"] if drawing.title else []
    return "\n".join([f'{head} viewBox="0 0 {w} {h}">', *title, *body, "</svg>", ""])


def _layer(name: str, look: str, body: Sequence[str]) -> list[str]:
    return [
        f'<g id="{name}" inkscape:groupmode="layer" inkscape:label="{name}" {look}>',
        *body,
        "</g>",
    ]


def laser_svg(strokes: Sequence[Stroke], drawing: Drawing) -> str:
    """Return SVG of strokes, a layer after the other."""
    corner = _page(drawing)[0]

    def shape(stroke: Stroke) -> str:
        p = [f"{x - corner[0]:.6f} {corner[1] - y:.6f}" for x, y in stroke.points]
        if stroke.radius:
            x, y = p[0].split()
            return f'<circle cx="{x}" cy="{y}" r="{stroke.radius:.6f}"/>'
        return f'<path d="M{" L".join(p)}{"Z" if stroke.closed else ""}"/>'

    body: list[str] = []
    for letter, name in LAYERS.items():
        here = [shape(s) for s in strokes if s.layer == letter]
        if here:
            look = f'fill="none" stroke="{LASER_COLOURS[name][0]}" stroke-width="{HAIRLINE}"'
            body += _layer(name, look, here)
    return _svg(drawing, body)


def laser_dxf(strokes: Sequence[Stroke], drawing: Drawing) -> str:
    """Return DXF of strokes in mm, a layer after the other."""
    corner = _page(drawing)[0]
    low = np.array([corner[0] + MARGIN, drawing.points[:, 1].min()])
    used = {LAYERS[s.layer]: LASER_COLOURS[LAYERS[s.layer]][1] for s in strokes}

    def draw(space: Any) -> None:
        for stroke in strokes:
            points = (np.array(stroke.points) - low).tolist()
            look = {"layer": LAYERS[stroke.layer]}
            if stroke.radius:
                space.add_circle(points[0], stroke.radius, dxfattribs=look)
            elif len(points) == 2:
                space.add_line(*points, dxfattribs=look)
            else:
                space.add_lwpolyline(points, close=stroke.closed, dxfattribs=look)

    return dxf_text(used, "mm", draw)


def bench_svg(drawing: Drawing, labels: Sequence[str]) -> str:
    """Return SVG to print: the pattern at true size, each crease with its label along it."""
    corner = _page(drawing)[0]
    ends = (drawing.points[drawing.edges] - corner) * [1.0, -1.0]
    groups: dict[str, list[str]] = {}
    words = []
    for k, letter in enumerate(drawing.letters):
        (x1, y1), (x2, y2) = ends[k].tolist()
        groups.setdefault(letter, []).append(
            f'<line x1="{x1:.6f}" y1="{y1:.6f}" x2="{x2:.6f}" y2="{y2:.6f}"/>'
        )
        label = labels[k] if labels else ""
        if label:
            turn = math.degrees(math.atan2(y2 - y1, x2 - x1))
            turn -= 180.0 * round(turn / 180.0)  # to be read from below or from the right
            size = min(3.5, math.hypot(x2 - x1, y2 - y1) / (0.62 * len(label) + 1))
            words.append(
                f'<text transform="translate({(x1 + x2) / 2:.4f} {(y1 + y2) / 2:.4f}) rotate({turn:.3f})" '
                f'y="{-0.35 * size:.3f}" font-size="{size:.3f}">{escape(label)}</text>'
            )
    body: list[str] = []
    for letter, lines in groups.items():
        dashes = {"M": ' stroke-dasharray="4 1 0.5 1"', "V": ' stroke-dasharray="2 1"'}.get(
            letter, ""
        )
        look = f'fill="none" stroke="{BENCH_COLOURS[letter]}" stroke-width="0.25"{dashes}'
        body += _layer({"M": "MOUNTAIN", "V": "VALLEY"}.get(letter, letter), look, lines)
    body += _layer("LABELS", 'fill="#202020" font-family="sans-serif" text-anchor="middle"', words)
    return _svg(drawing, body)
