"""Files for lasers and for the bench: layers by name and colour, hairlines, true size in mm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

from origami_nlp.drawings.dxf import dxf_text
from origami_nlp.drawings.laser import LAYERS, Stroke
from origami_nlp.drawings.sheet import Drawing

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
