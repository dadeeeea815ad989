"""Lower states beside a state, along a direction: what shows that it is no minimum."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.facets import Sheet, order_layers
from origami_nlp.numerics import CLOSES
from origami_nlp.sheets.rows import Rows, put_back

REACHES = 1e-4, 1e-3, 1e-2, 1e-1
"""Distances at which lower states are looked for [rad]."""
NEAREST = 1e-5
"""Distance of lower states at least [rad]: beside a singular state anything closes to the square of its distance, here
a hundred times `CLOSES`, so that states that are nearer may be none."""


def lower_state(
    sheet: Sheet, phi: np.ndarray, way: np.ndarray, rows: Rows | None = None, contact: bool = False
) -> np.ndarray | None:
    """Find a closed state within the limits beside another, lower than rounding, along a direction.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state, [n] [rad].
    way
        The direction, [n].
    rows
        Gaps that must stay open; none by default.
    contact
        Whether facets must not cross, and their layers have an order.

    Returns
    -------
    numpy.ndarray or None
        The state, [n]; None where none is found, or facets cross before.
    """
    size = float(np.abs(way).max(initial=0.0))
    if not size:
        return None
    for reach in REACHES:
        start = np.clip(phi + reach * way / size, -math.pi, math.pi)
        if rows is not None and rows.touches:
            back = put_back(sheet, start, rows)
            if back is None:
                continue
            new, residual = back, sheet.residual(back)
        else:
            new, residual = sheet.project(start, np.abs(start) == math.pi)
        if residual > CLOSES or np.abs(new).max() > math.pi or not sheet.closure.on_sheet(new):
            continue
        if np.abs(new - phi).max() < NEAREST:
            continue
        if contact and (sheet.crossings.find(new) or order_layers(sheet, new).verdict != "ordered"):
            return None  # what lies further that way would be reached through facets
        drop = sheet.scaled_energy(phi) - sheet.scaled_energy(new)
        if np.abs(new - phi).max() <= 3 * reach and drop > 1e-13 * (1 + sheet.scaled_energy(phi)):
            return new
    return None
