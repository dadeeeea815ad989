"""Can the layers of a touching symmetric state be stacked with the symmetry of the scene?

A state of tied fold angles can be foldable only with a stacking that the mirror does not map to
itself, for example two flaps on the mirror plane that pass each other tip by tip, one above the
other.  Such a state is a limit of embedded states, but not of symmetric ones.
"""

from __future__ import annotations

import math

import numpy as np

from tests.independent.arcs import crossing_margin, nearest_touch
from tests.independent.layering import Map, combinatorics, stackable_with
from tests.independent.rotations import fold, spin_sign
from tests.independent.search_manifold import Piece

TOUCH = 2e-6
"""Features this close touch; refined states are known to about 1e-7."""


def symmetries(n: int, half: bool) -> tuple[Map, ...]:
    """Generators of D1 (half) or D2: where each crease goes, and whether the map is a reflection."""
    mirror = (tuple((-i) % n for i in range(n)), True)
    return (mirror,) if half else (mirror, (tuple((i + n // 2) % n for i in range(n)), False))


def symmetrically_admissible(piece: Piece, x: np.ndarray) -> np.ndarray:
    """Return which closed states x [B, n] have no crossings and layers with the whole symmetry."""
    x = np.atleast_2d(x)
    phi = piece.expand(x)
    ok = (spin_sign(piece.sectors, phi) > 0) & (np.abs(phi) <= math.pi).all(axis=1)
    creases, _ = fold(piece.sectors, phi)
    ok &= crossing_margin(creases) <= TOUCH
    for k in np.flatnonzero(ok & (nearest_touch(creases) <= TOUCH)):
        close = np.linalg.norm(creases[k][:, None] - creases[k][None], axis=2) <= TOUCH
        label = tuple(int(row.argmax()) for row in close)
        key = combinatorics(creases[k], phi[k], TOUCH)
        ok[k] = stackable_with(*key, label, symmetries(len(label), piece.half))
    return ok
