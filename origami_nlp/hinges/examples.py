"""Hinges as they are, as files to begin with: what `origami-nlp example NAME` prints."""

from __future__ import annotations

import json
from typing import Any

TAPE_SPRING = """\
# A tape spring across a fold: stiff while it is straight, at its peak it buckles, then bends at a torque that hardly
# changes; bent to the other side (equal sense) it is softer.  The crease opposite it pulls the sheet closed.
# Two stable states: locked straight, and folded.  Torques are made up, in the shape of Seffen and Pellegrino (1999).

[vertex]
sector_angles_deg = [60, 120, 60, 120]

[creases]
stiffness = [0.05, 0.05, 0.05, 0.05]     # N m/rad; that of crease 1 is its law's
rest_angles_deg = [0, 0, 150, 0]
limits_deg = [-150, 150]
law = ["tape", "", "", ""]

[laws.tape]
type = "table"
angle_deg = [-150, -120, -90, -60, -30, -12, -4, 0, 4, 8, 12, 18, 30, 60, 90, 120, 150]
torque = [-0.055, -0.055, -0.055, -0.055, -0.055, -0.06, -0.05, 0, 0.14, 0.24, 0.17, 0.08, 0.06, 0.055, 0.055, 0.055,
    0.055]

[model]
symmetry = "none"
"""
MAGNETS = """\
# Magnets on the facets beside crease 2 of a Miura vertex: they attract where the crease is nearly closed.
# Stable as the springs rest, latched by the magnets, and latched where it is folded in half along creases 1 and 3.

[vertex]
sector_angles_deg = [60, 120, 120, 60]

[creases]
stiffness = [0.02, 0.02, 0.02, 0.02]    # N m/rad; that of crease 2 is its law's
rest_angles_deg = [-30, 60, 30, 60]
law = ["", "magnets", "", ""]

[laws.magnets]
sum = [
    { type = "linear", stiffness = 0.02, rest_deg = 60 },
    { type = "well", energy = 0.12, at_deg = 165, width_deg = 12 },
]

[model]
symmetry = "none"
"""
THICK_PANEL = """\
# A Miura vertex of tapered panels, 6 mm thick, cut back 4 mm from the creases: no crease folds beyond
# 180 - 2 atan(6 / (2 * 4)) = 106.26 degrees.  Springs pull beyond that: the folded state is held by its stops.

[vertex]
sector_angles_deg = [60, 120, 120, 60]

[creases]
stiffness = [0.02, 0.02, 0.02, 0.02]    # N m/rad
rest_angles_deg = [-120, 170, 120, 170]
thickness_mm = 6
taper_mm = 4

[model]
symmetry = "none"
"""
STRIP = 4
"""Creases of the bistable strip."""


def bistable_strip(creases: int = STRIP) -> dict[str, Any]:
    """Return a strip of parallel creases, each with two wells, as data of a FOLD file.

    Parameters
    ----------
    creases
        How many.

    Returns
    -------
    dict
        FOLD 1.1: facets of 1 x 1, wells at +-50 degrees with a hill of 0.2 J between; 2^creases stable states.
    """
    n = creases + 1
    corners = [[float(x), float(y)] for x in range(n + 1) for y in (0, 1)]
    ends = [[2 * k, 2 * k + 1] for k in range(1, n)]
    rim = [[2 * k + s, 2 * k + 2 + s] for k in range(n) for s in (0, 1)] + [
        [0, 1],
        [2 * n, 2 * n + 1],
    ]
    return {
        "file_spec": 1.1,
        "file_classes": ["singleModel"],
        "frame_title": "bistable strip",
        "frame_classes": ["creasePattern"],
        "vertices_coords": corners,
        "edges_vertices": [*ends, *rim],
        "edges_assignment": ["U"] * len(ends) + ["B"] * len(rim),
        "faces_vertices": [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(n)],
        "edges_origaminlp:law": [0] * len(ends) + [None] * len(rim),
        "origaminlp:laws": [
            {"name": "two wells", "type": "double-well", "energy": 0.2, "at_deg": 50}
        ],
    }


HINGE_EXAMPLES = {
    "tape-spring": lambda: TAPE_SPRING,
    "magnets": lambda: MAGNETS,
    "thick-panel": lambda: THICK_PANEL,
    "bistable-strip": lambda: json.dumps(bistable_strip(), indent=1) + "\n",
}
"""What makes the text of each: scenes as TOML, the strip as FOLD."""
