"""Escape barriers of the stable states of a sheet: along traced curves, and by descents out of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.errors import OutOfTime
from origami_nlp.facets import Sheet
from origami_nlp.kkt import (
    ALONE,
    BOUND,
    FLOOR,
    OPEN,
    TRACED,
    Escape,
    barriers,
    energy_scale,
    level_of,
    ways_out,
)
from origami_nlp.numerics import SETTLED, SHALLOW
from origami_nlp.sheets.curve_passes import CurvePasses, curve_passes
from origami_nlp.sheets.curves import Curves
from origami_nlp.sheets.descent import AT_LIMIT
from origami_nlp.sheets.starts import creases_around
from origami_nlp.sheets.state import SheetState
from origami_nlp.sheets.terrain import SheetTerrain

MOST_CREASES = 60
"""Creases up to which ways out are sought by descents."""
MOST_DESCENTS, A_STATE = 60, 15
"""Descents in all, and for each state out of which ways are sought."""
SECTIONS, MOST_CONFIRMED = 3, 3
"""Of `kkt.ways_out`: a descent takes some ten milliseconds."""


def with_escapes(
    curves: Curves, states: Sequence[SheetState], contact: bool, most: int
) -> list[SheetState]:
    """Add what it takes to leave each stable state.

    Parameters
    ----------
    curves
        Of the sheet, those that were traced.
    states
        Judged; ways lead to minima among them, numbered in their order.
    contact
        Whether facets must not cross.
    most
        Descents in all: as many as the search made.

    Returns
    -------
    list of SheetState
        With `escape` where they are minima.
    """
    minima = [s for s in states if s.verdict == "minimum"]
    if not minima:
        return list(states)
    found = iter(_escapes(curves, minima, contact, most))
    return [replace(s, escape=next(found)) if s.verdict == "minimum" else s for s in states]


def _escapes(
    curves: Curves, minima: Sequence[SheetState], contact: bool, most: int
) -> list[Escape]:
    sheet = curves.sheet
    at = np.array([s.fold_angles for s in minima])
    energies = np.array([s.energy for s in minima])
    scale = energy_scale(sheet.pattern.stiffness)
    level = level_of(energies, scale)
    traced = curve_passes(sheet, curves.found, at)
    heights, sure = (np.full((len(at),) * 2, math.inf) for _ in range(2))
    if traced is not None:
        heights, sure = (t.heights() * sheet.scale for t in (traced.passes, traced.sure))
    exact = _exact(sheet, minima, traced, sure, level, scale, contact)
    why = ""
    if sheet.size > MOST_CREASES:
        why = f"more than {MOST_CREASES} creases: ways out are not sought"
    loose = [k for k, s in enumerate(minima) if s.freedoms > 0 and k not in exact]
    most = min(most, MOST_DESCENTS)
    many = -(-most // A_STATE)
    last = energies[loose[:many]].max(initial=-math.inf) + level
    sought = [] if why else [k for k in loose if energies[k] <= last]
    ways = {}
    beyond = np.full(len(at), math.inf)
    if sought and len(at) > 1:
        modes = [_modes(sheet, s) for s in minima]
        terrain = SheetTerrain(
            sheet, at, contact, modes, creases_around(sheet.pattern, curves.labels), most
        )
        try:
            ways = ways_out(terrain, sought, SECTIONS, MOST_CONFIRMED)
        except OutOfTime:
            why = "interrupted by the time limit"
    for k, way in ways.items():
        if way.to < 0:
            beyond[k] = way.height
        else:
            heights[k, way.to] = min(heights[k, way.to], energies[k] + way.height)
    out = []
    for k, (barrier, to) in enumerate(barriers(energies, heights, level, scale, beyond)):
        if k in exact:
            out.append(exact[k])
        elif minima[k].freedoms == 0:
            out.append(Escape(math.inf, ALONE, "no other closed state is near"))
        elif math.isinf(barrier):
            reason = why or "no way that was tried led to a state of lower energy"
            if not why and len(at) == 1:
                reason = "no other state is known that it could be left for"
            elif not why and k not in sought:
                reason = f"sought for the {len(sought)} states of lowest energy"
            out.append(Escape(math.nan, OPEN, reason))
        else:
            barrier = max(barrier, FLOOR * scale)
            what = "an explicit way out climbs so high; lower ones are not excluded"
            top = tuple(ways[k].top.tolist()) if k in ways and ways[k].to == to else ()
            out.append(Escape(barrier, BOUND, what, to + 1, top, barrier < SHALLOW * scale))
    return out


def _exact(
    sheet: Sheet,
    minima: Sequence[SheetState],
    traced: CurvePasses | None,
    sure: np.ndarray,
    level: float,
    scale: float,
    contact: bool,
) -> dict[int, Escape]:
    """Return the barriers that curves tell exactly: a way that climbs no higher than every way does."""
    if traced is None:
        return {}
    energies = np.array([s.energy for s in minima])
    found = {}
    for k, (barrier, to) in enumerate(barriers(energies, sure, level, scale)):
        if minima[k].freedoms != 1 or not traced.sure.on_curves[k]:
            continue
        equal = np.flatnonzero(energies <= energies[k] + level).tolist()
        others = [*equal, *([to] if to >= 0 else [])]
        least = traced.least(k, others, level / sheet.scale) * sheet.scale
        if math.isinf(least):
            if contact:  # samples at which facets cross are no proof that no way leads past
                continue
            why = "its curve leads to no state of no higher energy: it ends at limits"
            found[k] = Escape(math.inf, TRACED, why)
        elif math.isfinite(barrier) and energies[k] + barrier <= least + level:
            why = "the lowest pass of the curves of closed states, both ways"
            top = tuple(traced.sure.top(k, to).tolist())
            found[k] = Escape(barrier, TRACED, why, to + 1, top, barrier < SHALLOW * scale)
    return found


def _modes(sheet: Sheet, state: SheetState) -> list[np.ndarray]:
    """Return the softest motions of a state that closure allows, shut creases held, where they are single."""
    phi = state.fold_angles
    shut = np.flatnonzero(np.abs(phi) >= math.pi - AT_LIMIT)
    z = sheet.kernel(phi, shut)
    lam, _, _ = sheet.multipliers(phi, shut)
    values, vectors = np.linalg.eigh(z.T @ (sheet.hessian(phi, lam) @ z))
    if not len(values) or (len(values) > 1 and values[1] - values[0] <= SETTLED):
        return []
    return [z @ vectors[:, 0]]
