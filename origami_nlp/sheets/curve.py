"""A pattern with one freedom left, traced: the curve of its closed states, from limit to limit.

The curve is followed by its unit tangent, the kernel of the Jacobian; where rows lose more rank (at a flat or
flat-folded state, branches cross) the walk goes straight on, so that each branch is followed through the crossing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.facets import Sheet
from origami_nlp.numerics import CLOSES, EXPLORED, RESOLVED, ROUNDED, SETTLED, dense, null_space

STEP = 0.05
"""Largest step of a walk [rad], in the norm over creases divided by the square root of their number."""
SHORTEST = 1e-7
BENT = 0.95
"""Cosine between tangents of one step and the next, at least."""
MOST_STEPS = 5_000


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve of closed states.

    Attributes
    ----------
    phi
        Fold angles along it, [S, n] [rad].
    arc
        Length from the start, in the norm over creases over sqrt n, [S].
    ends
        Why it ends at either side: ``"limit"``, ``"closed"`` (it returns to its start), or the reason that it was lost.
    """

    phi: np.ndarray
    arc: np.ndarray
    ends: tuple[str, str]

    @property
    def complete(self) -> bool:
        """Whether both ends are fold limits, or the curve is closed."""
        return all(end in ("limit", "closed") for end in self.ends)


def tangents(sheet: Sheet, phi: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the kernel of the Jacobian, [n, t]."""
    return null_space(dense(sheet.closure.jacobian(phi)))


def follow_curve(sheet: Sheet, phi: np.ndarray, along: np.ndarray, step: float = STEP) -> Curve:
    """Walk along the curve through a closed state both ways.

    Parameters
    ----------
    sheet
        The programme.
    phi
        A closed state, [n] [rad].
    along
        Direction in which the walk begins, [n]; the other way is walked as well.
    step
        Largest step [rad].

    Returns
    -------
    Curve
        From the end of the walk against `along` to that of the other.
    """
    there, end = _walk(sheet, phi, along, step)
    if end == "closed":
        return _curve(sheet, there, (end, end))
    back, begin = _walk(sheet, phi, -along, step)
    return _curve(sheet, [*back[:0:-1], *there], (begin, end))


def _walk(
    sheet: Sheet, phi: np.ndarray, along: np.ndarray, step: float
) -> tuple[list[np.ndarray], str]:
    root = math.sqrt(sheet.size)
    first, d = phi, along / np.linalg.norm(along)
    bend = np.zeros(sheet.size)
    path, h, gone = [phi], step, 0.0
    for _ in range(MOST_STEPS):
        ahead = _advance(sheet, phi, d, bend, h * root)
        if ahead is None:
            h *= 0.5
            if h < SHORTEST:
                return path, "lost: no closed state ahead"
            continue
        new, turned = ahead
        if (np.abs(new) > math.pi + EXPLORED).any():
            last = _shut(sheet, phi, new, d)
            if last is None:
                last = _to_limit(sheet, phi, d, h * root)
            if last is not None:
                return [*path, last], "limit"
            h *= 0.5  # many creases reach it together, where branches meet: closer first
            if h < SHORTEST:
                return path, "lost at a fold limit"
            continue
        gone += h
        if gone > 3 * step and np.linalg.norm(new - first) < 0.75 * h * root:
            return [*path, first], "closed"
        bend = (turned - d) / np.linalg.norm(new - phi)
        phi, d = np.clip(new, -math.pi, math.pi), turned
        path.append(phi)
        h = min(step, 1.5 * h)
    return path, "lost: too many steps"


def _advance(
    sheet: Sheet, phi: np.ndarray, d: np.ndarray, bend: np.ndarray, h: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Step by h along d and project back; None where that is not the same branch any more."""
    # predictor to second order: the bend is that of the last step
    new, residual = sheet.project(phi + h * d + 0.5 * h * h * bend, steps=12)
    if residual > CLOSES or not sheet.closure.on_sheet(new):
        return None
    went = new - phi
    size = float(np.linalg.norm(went))
    if not 0.5 * h < size < 1.5 * h or float(went @ d) < BENT * size:
        return None
    turned = sheet.along(new, went)  # where branches cross, the kernel is larger: straight on
    length = float(np.linalg.norm(turned))
    if length < BENT * size:
        return None
    return new, turned / length


def _shut(sheet: Sheet, phi: np.ndarray, new: np.ndarray, d: np.ndarray) -> np.ndarray | None:
    """Return the state ahead, not beyond a step, at which all creases that come close to pi together are shut."""
    went = new - phi
    held = np.abs(new) > math.pi - np.abs(went) - EXPLORED
    start = np.where(held, np.copysign(math.pi, new), new)
    end, residual = sheet.project(start, held, steps=12)
    there = end - phi
    size = float(np.linalg.norm(there))
    if (
        residual > CLOSES
        or (np.abs(end) > math.pi + EXPLORED).any()
        or not sheet.closure.on_sheet(end)
    ):
        return None
    end = np.clip(end, -math.pi, math.pi)
    if size > 1.5 * float(np.linalg.norm(went)) or float(there @ d) < BENT * size:
        return None
    return end


def _to_limit(sheet: Sheet, phi: np.ndarray, d: np.ndarray, h: float) -> np.ndarray | None:
    """Return the state between here and a step ahead at which the first fold angle is at pi."""
    low, high = 0.0, h
    # creases that are shut and stay so do not end the curve
    ends = math.pi - np.abs(phi) > EXPLORED
    if not ends.any():
        return None
    here = float(np.abs(phi[ends]).max()) - math.pi
    there = math.nan
    for k in range(60):
        # secants and halves in turn
        share = 0.5 if k % 2 or not there > 0 else here / (here - there)
        middle = low + share * (high - low)
        new, residual = sheet.project(phi + middle * d, steps=12)
        beyond = float(np.abs(new[ends]).max()) - math.pi
        if residual > CLOSES:
            high, there = middle, math.nan
        elif beyond > 0:
            high, there = middle, beyond
        else:
            low, here = middle, beyond
        if -RESOLVED < here <= 0 or high - low < ROUNDED:
            break
    new, residual = sheet.project(phi + low * d, steps=12)
    i = int(np.where(ends, np.abs(new), 0.0).argmax())
    if math.pi - abs(new[i]) > SETTLED:
        return None
    held = np.zeros(sheet.size, bool)
    held[i] = True
    new[i] = math.copysign(math.pi, new[i])
    end, residual = sheet.project(new, held)
    end = np.clip(end, -math.pi, math.pi)
    return end if sheet.residual(end) <= CLOSES else None


def _curve(sheet: Sheet, path: list[np.ndarray], ends: tuple[str, str]) -> Curve:
    phi = np.array(path)
    steps = np.linalg.norm(np.diff(phi, axis=0), axis=1) / math.sqrt(sheet.size)
    return Curve(phi, np.concatenate([[0.0], np.cumsum(steps)]), ends)
