"""A pattern with one freedom left, traced: every state on its curve, and every state of it that can hold still.

The curve is followed by its unit tangent, the kernel of the Jacobian; where rows lose more rank (at a flat or
flat-folded state, branches cross) the walk goes straight on, so that each branch is followed through the crossing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import CLOSES, null_space
from origami_nlp.sheets.linear import dense
from origami_nlp.sheets.sheet import Sheet

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
    energy
        Over the mean stiffness, [S].
    slope
        Of the energy along the curve, [S].
    ends
        Why it ends at either side: ``"limit"``, ``"closed"`` (it returns to its start), or the reason that it was lost.
    """

    phi: np.ndarray
    arc: np.ndarray
    energy: np.ndarray
    slope: np.ndarray
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
    path, h, gone = [phi], step, 0.0
    for _ in range(MOST_STEPS):
        ahead = _advance(sheet, phi, d, h * root)
        if ahead is None:
            h *= 0.5
            if h < SHORTEST:
                return path, "lost: no closed state ahead"
            continue
        new, turned = ahead
        if (np.abs(new) > math.pi).any():
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
        phi, d = new, turned
        path.append(phi)
        h = min(step, 1.5 * h)
    return path, "lost: too many steps"


def _advance(
    sheet: Sheet, phi: np.ndarray, d: np.ndarray, h: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Step by h along d and project back; None where that is not the same branch any more."""
    new, residual = sheet.project(phi + h * d, steps=12)
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


def _to_limit(sheet: Sheet, phi: np.ndarray, d: np.ndarray, h: float) -> np.ndarray | None:
    """Return the state between here and a step ahead at which the first fold angle is at pi."""
    low, high = 0.0, h
    for _ in range(60):
        middle = 0.5 * (low + high)
        new, residual = sheet.project(phi + middle * d, steps=12)
        if residual > CLOSES or (np.abs(new) > math.pi).any():
            high = middle
        else:
            low = middle
    new, residual = sheet.project(phi + low * d, steps=12)
    i = int(np.abs(new).argmax())
    if math.pi - abs(new[i]) > 1e-6:
        return None
    held = np.zeros(sheet.size, bool)
    held[i] = True
    new[i] = math.copysign(math.pi, new[i])
    end, residual = sheet.project(new, held)
    end = np.clip(end, -math.pi, math.pi)
    return end if sheet.residual(end) <= CLOSES else None


def _curve(sheet: Sheet, path: list[np.ndarray], ends: tuple[str, str]) -> Curve:
    phi = np.array(path)
    root = math.sqrt(sheet.size)
    steps = np.linalg.norm(np.diff(phi, axis=0), axis=1) / root
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    energy = np.array([sheet.energy(x) for x in phi])
    slope = np.empty(len(phi))
    for i, x in enumerate(phi):
        t = sheet.along(x, phi[min(i + 1, len(phi) - 1)] - phi[max(i - 1, 0)])
        slope[i] = sheet.torque(x) @ t / max(float(np.linalg.norm(t)), 1e-300)
    return Curve(phi, arc, energy, slope, ends)


def wells(sheet: Sheet, curve: Curve) -> list[tuple[np.ndarray, str]]:
    """Return where the energy has its minima along a curve: inside, and at ends that it falls towards.

    Parameters
    ----------
    sheet
        The programme.
    curve
        Of `follow_curve`.

    Returns
    -------
    list of tuple
        Fold angles [n], to the accuracy of bisection; ``"inside"`` or ``"end"``.
    """
    found: list[tuple[np.ndarray, str]] = []
    s = curve.slope
    for i in np.flatnonzero((s[:-1] < 0) & (s[1:] >= 0)):
        found.append((_still(sheet, curve.phi[i], curve.phi[i + 1]), "inside"))
    if curve.ends[0] == "limit" and s[0] >= 0:
        found.append((curve.phi[0], "end"))
    if curve.ends[1] == "limit" and s[-1] <= 0:
        found.append((curve.phi[-1], "end"))
    return found


def _still(sheet: Sheet, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Bisect between two neighbouring states of a curve for the state where the slope vanishes."""
    way = b - a
    start = a
    if sheet.pattern.is_flat and a @ way < 0 < b @ way:
        # through the flat state a curve is odd, phi(-t) = -phi(t): closer to it than to a and b, its tangent is
        # the better guess, and does not lead to another branch
        start = a - (a @ way) / float(way @ way) * way
        start = np.zeros(sheet.size) if np.abs(start).max() < 0.1 * np.abs(way).max() else a
    middle = a
    low, high = (float((x - start) @ way) / float(way @ way) for x in (a, b))
    for _ in range(60):
        t = 0.5 * (low + high)
        middle, residual = sheet.project(start + t * way)
        if residual > CLOSES:
            break
        if sheet.torque(middle) @ sheet.along(middle, way) < 0:
            low = t
        else:
            high = t
        if high - low < 1e-9:
            break
    return middle
