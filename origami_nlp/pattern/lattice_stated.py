"""The lattice that a FOLD file states for a cell that repeats."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import FoldFileError

LATTICE_KEY = "origaminlp:lattice"
"""Both vectors by which a cell repeats, in the unit of the coordinates."""


def read_lattice(value: object) -> np.ndarray | None:
    """Return both lattice vectors that a file states, [2, 2] or [2, 3]; None where it states none."""
    if value is None:
        return None
    rows = value if isinstance(value, list) else []
    sizes = {len(row) if isinstance(row, list) else 0 for row in rows}
    numbers = [x for row in rows if isinstance(row, list) for x in row]
    good = all(isinstance(x, int | float) and not isinstance(x, bool) for x in numbers)
    if len(rows) != 2 or sizes not in ({2}, {3}) or not (good and all(map(math.isfinite, numbers))):
        raise FoldFileError(
            f"{LATTICE_KEY} = {shown(value)} must be two vectors, such as [[2, 0], [0, 2]]"
        )
    return np.array(rows, float)
