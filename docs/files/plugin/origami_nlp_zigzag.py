"""An example of a plug-in: parallel creases that alternate, a vertex, a hinge material, and angles as a text file."""

import math
from typing import Any

from origami_nlp import Scene, Vertex
from origami_nlp.pattern import Material


def zigzag(columns: int = 4) -> dict[str, Any]:
    """Make a strip of square facets between parallel creases, mountain and valley in turn.

    columns: facets, at least 2; one centimetre each.
    """
    points = [[float(x), y] for x in range(columns + 1) for y in (0.0, 1.0)]
    creases = range(columns + 1)
    across = [[2 * x, 2 * x + 1] for x in creases]
    border = [[2 * x + y, 2 * x + y + 2] for x in range(columns) for y in (0, 1)]
    inner = ["M" if x % 2 else "V" for x in creases]
    return {
        "file_spec": 1.1,
        "frame_unit": "cm",
        "frame_title": f"zigzag of {columns} facets",
        "vertices_coords": points,
        "edges_vertices": across + border,
        "edges_assignment": ["B", *inner[1:-1], "B"] + ["B"] * len(border),
        "faces_vertices": [[2 * x, 2 * x + 2, 2 * x + 3, 2 * x + 1] for x in range(columns)],
    }


def book_vertex(stiffness: float = 0.02) -> Scene:
    """Make a vertex of four right angles, two creases of which rest half open."""
    rest = (math.pi / 2, 0.0, math.pi / 2, 0.0)
    return Scene(Vertex(("pi/2",) * 4), (stiffness,) * 4, rest, name="book")


SOFT_HINGE = Material(0.05, "an example, not measured")


def to_xyz(result: Any) -> str:
    """Write the fold angles of minima, a line each: energy, then angles in degrees."""
    lines = [
        " ".join(f"{v:.6g}" for v in (state.energy, *map(math.degrees, state.fold_angles)))
        for state in result.minima
    ]
    return "\n".join(lines) + "\n"
