"""Strict minima by first order alone, at states where closure loses rank.

Where vertices are flat, or folded flat, motions that closure allows to first order are more than those along which
closed states leave: no multipliers balance the springs, and the state may be a strict minimum all the same.  What
counts is the tangent cone: energy rises along every way out if its slope is positive on all of the cone but 0, and
then it rises beside the state (a sequence of lower states that came to it would leave a direction of the cone along
which it does not).  The ways that `list_branches` enumerates contain the cone; with none of them the state is alone.
"""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.facets import Sheet, dense
from origami_nlp.numerics import (
    CLOSES,
    RANK,
    nearest_in_cone,
    nonnegative_least_squares,
    null_space,
)
from origami_nlp.sheets.branches import SAME_WAY, Branches, combine, list_modes

STEEP = 1e-4
"""Slopes along unit directions below this share of the largest torque do not count as rising: ways are known to
`SAME_WAY`."""


LEVEL = 1e-9
"""Slopes below this share of the largest torque are level: rounding of modes and their products."""
BESIDE_FLAT = 1e-3
"""Distance from the flat state at which its ways are looked at [rad]."""


def slopes(
    sheet: Sheet, phi: np.ndarray, ways: Branches, gaps: np.ndarray | None = None
) -> tuple[bool, list[np.ndarray]]:
    """Compare the energy with the ways out of a closed state.

    Parameters
    ----------
    sheet, phi
        The programme and the state, [n] [rad].
    ways
        Of `list_ways`.
    gaps
        Slopes of gaps that stay open, [r, n]; none by default.

    Returns
    -------
    rises : bool
        Whether it rises to first order along all of them, or none leads out: a strict minimum.
    falling : list of numpy.ndarray
        Directions [n] of ways along which it falls.
    """
    if ways.reason:
        return False, []
    gaps = np.zeros((0, sheet.size)) if gaps is None else gaps
    lengths = np.linalg.norm(gaps, axis=1)
    torque = sheet.torque(phi)
    steep = STEEP * float(np.abs(torque).max(initial=0.0))
    inward = -np.sign(phi) * (math.pi - np.abs(phi) < SAME_WAY)
    rises, falling = True, []
    for d in ways.open(phi):
        if (gaps @ d < -STEEP * lengths).any():
            continue
        rises &= bool(torque @ d > steep)
        if torque @ d < -steep:
            falling.append(d)
    for basis in ways.families:
        rows = np.vstack([inward[:, None] * basis, gaps @ basis])
        rows = rows[np.abs(rows).max(axis=1) > SAME_WAY]
        rises &= _rises_on(rows, basis.T @ torque, steep)
        down = basis @ nearest_in_cone(-basis.T @ torque, rows)
        if np.linalg.norm(down) > steep:
            falling.append(down)
    return rises, falling


def level_curvature(sheet: Sheet, ways: Branches) -> float | None:
    """Return the least curvature of the energy along the ways out of the flat state, where it is level along all.

    A way that is met once (`_met_once`) is the tangent of one curve of closed states.  Turned over, a closed state
    phi is -phi, so that the curve is its own mirror image, phi(-t) = -phi(t): it has no part in t^2, and the energy
    changes by d'K d t^2 / 2 + O(t^3), whatever moments closure lacks.

    Parameters
    ----------
    sheet
        The programme.
    ways
        Of the flat state.

    Returns
    -------
    float or None
        Over the mean stiffness; None where a family leads out, a way is not met once, or the energy is not level.
    """
    torque = sheet.torque(np.zeros(sheet.size))
    level = LEVEL * float(np.abs(torque).max(initial=0.0))
    if ways.reason or ways.families or not len(ways.lines):
        return None
    if any(abs(torque @ d) > level or not _met_once(sheet, d) for d in ways.lines):
        return None
    return min(float(sheet.stiffness @ d**2) for d in ways.lines)


def _met_once(sheet: Sheet, d: np.ndarray) -> bool:
    """Tell whether closed states leave the flat one along d with one freedom, and closure bends as it should there.

    What holds them to the curve grows as the distance where the way is a single root of closure to second order, and
    as its square where two curves are tangent.
    """
    held = []
    for far in (BESIDE_FLAT, BESIDE_FLAT / 2):
        phi, residual = sheet.project(far * d)
        if residual > CLOSES or np.abs(phi / far - d).max() > 10 * BESIDE_FLAT:
            return False
        values = np.linalg.svd(dense(sheet.closure.jacobian(phi)), compute_uv=False)
        held.append(float(values[sheet.size - 2]) if 0 <= sheet.size - 2 < len(values) else 0.0)
    return held[1] > RANK and held[0] < 3 * held[1]


def list_ways(sheet: Sheet, phi: np.ndarray) -> Branches:
    """List the ways out of a closed state.

    Parameters
    ----------
    sheet, phi
        The programme and the state, [n] [rad].

    Returns
    -------
    Branches
        Subspaces that contain the tangent cone: of vertices without modes, what first order allows.
    """
    axes = sheet.closure.axes(phi)
    known = zip(list_modes(sheet.pattern, phi), axes, strict=True)
    modes = [[null_space(a.T, SAME_WAY)] if m is None else m for m, a in known]
    return combine(sheet.pattern, modes, sheet.check_time)


def _rises_on(rows: np.ndarray, torque: np.ndarray, steep: float) -> bool:
    """Tell whether torque . y > 0 for all y != 0 with rows y >= 0, [r, k].

    So it is where the torque is a sum of rows with positive factors, and rows span.
    """
    if len(rows) < len(torque) or np.linalg.svd(rows, compute_uv=False)[-1] < SAME_WAY:
        return False
    aim = torque - steep * rows.sum(axis=0)
    left = rows.T @ nonnegative_least_squares(rows.T, aim) - aim
    return float(np.abs(left).max()) <= SAME_WAY * steep
