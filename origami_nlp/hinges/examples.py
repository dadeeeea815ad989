"""Hinges as they are, as files to begin with: what `origami-nlp example NAME` prints."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


def bistable_strip(creases: int = 4) -> dict[str, Any]:
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


FILES = Path(__file__).parent / "example_files"
HINGE_EXAMPLES: dict[str, Callable[[], str]] = {
    **{path.stem: path.read_text for path in sorted(FILES.glob("*.toml"), reverse=True)},
    "bistable-strip": lambda: json.dumps(bistable_strip(), indent=1) + "\n",
}
"""What makes the text of each: scenes as TOML, the strip as FOLD."""
