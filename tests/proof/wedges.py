"""Symmetric scenes within fold limits, by their group."""

import math

from origami_nlp.pattern import Scene, Vertex, examples

WEDGES = {
    "D1": examples.degree6("pi/4", 1.0, contact="fold-limits"),
    "D2": examples.degree8("pi/4", 1.0, contact="fold-limits"),
    "C2": Scene(
        Vertex((0.8, 1.2, math.pi - 2.0) * 2),
        (1.0, 2.0, 0.7) * 2,
        (0.4, -1.1, 0.9) * 2,
        symmetry="C2",
        contact="fold-limits",
    ),
    "C3": Scene(
        Vertex((0.8, 2 * math.pi / 3 - 0.8) * 3),
        (1.0, 2.0) * 3,
        (0.4, -1.1) * 3,
        symmetry="C3",
        contact="fold-limits",
    ),
}
