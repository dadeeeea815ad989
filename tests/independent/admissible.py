"""Which closed states are admissible, in batches."""

from __future__ import annotations

import math

import numpy as np

from tests.independent.arcs import crossing_margin, nearest_touch
from tests.independent.layering import combinatorics, stackable
from tests.independent.rotations import fold, spin_sign

TOUCH = 1e-9
"""Distance [rad] below which features are taken to touch; states are closed to 1e-14."""


def admissible(
    sectors: np.ndarray, phi: np.ndarray, contact: str = "full", touch: float = TOUCH
) -> np.ndarray:
    """Return which closed states phi [B, N] the contact mode admits, shape [B]."""
    phi = np.atleast_2d(phi)
    ok = spin_sign(sectors, phi) > 0
    if contact == "none":
        return ok
    ok &= (np.abs(phi) <= math.pi).all(axis=1)
    if contact != "full" or not ok.any():
        return ok
    creases, _ = fold(sectors, phi[ok])
    alive = np.flatnonzero(ok)
    crossing = crossing_margin(creases)
    # arcs that lie on one another have depths of rounding size: their layers decide
    ok[alive[crossing > 1e-13]] = False
    close = (nearest_touch(creases) <= touch) & (crossing <= 1e-13)
    for k in np.flatnonzero(close):
        ok[alive[k]] = stackable(*combinatorics(creases[k], phi[alive[k]], touch))
    return ok
