"""What must stay open at a state, fold limits and gaps, and states put onto them.

Rows that push balance the springs; a state is solved for with those rows as equations, to rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from origami_nlp.facets import Parallel, Placed, Sheet, Touch
from origami_nlp.numerics import (
    CARRIES,
    CLOSES,
    NONZERO,
    ROUNDED,
    Normal,
    dense,
    nearest,
    nonnegative_least_squares,
    null_space,
)

NEAR = 1e-6
"""Gaps and openings that carry forces while a descent goes on; those of its end are solved for."""
STILL = 1e-13
"""Reduced torque over the mean stiffness at which the polish has arrived."""
LONGEST = 0.5
"""Steps of a projection are cut to this largest change of a fold angle [rad]."""
CLOSE = 0.1
"""A polish that goes further [rad] is not trusted."""
SOFTEST = 1e-6
"""Of curvatures in steps, over the mean stiffness."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Fold limits and gaps at a state, over the sheet's size: what must stay >= 0.

    Attributes
    ----------
    limits
        Creases, [l].
    touches
        Features, [r - l].
    gaps
        Openings [rad] and gaps, [r].
    slopes
        Their derivatives, [r, n].
    """

    limits: np.ndarray
    touches: tuple[Touch, ...]
    gaps: np.ndarray
    slopes: np.ndarray

    @classmethod
    def at(
        cls, sheet: Sheet, phi: np.ndarray, limits: np.ndarray, touches: Sequence[Touch]
    ) -> Rows:
        """Evaluate rows at a state."""
        place = Placed(sheet.crossings.poses, phi)
        size = sheet.crossings.size
        sides = np.zeros((len(limits), sheet.size))
        sides[np.arange(len(limits)), limits] = -np.sign(phi[limits])
        gaps = [t.gap(place) / size for t in touches]
        slopes = np.array([t.row(place) / size for t in touches]).reshape(-1, sheet.size)
        opening = math.pi - np.abs(phi[limits])
        return cls(limits, tuple(touches), np.r_[opening, gaps], np.vstack([sides, slopes]))

    def only(self, which: np.ndarray) -> Rows:
        """Return some of the rows, `which` of bool [r]."""
        many = len(self.limits)
        touches = tuple(t for t, on in zip(self.touches, which[many:], strict=True) if on)
        return Rows(self.limits[which[:many]], touches, self.gaps[which], self.slopes[which])

    def bent(self, sheet: Sheet, phi: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """Return the Hessian of forces . gaps, [n, n]; forces over the mean stiffness, [r]."""
        place = Placed(sheet.crossings.poses, phi)
        out = np.zeros((sheet.size, sheet.size))
        for force, touch in zip(forces[len(self.limits) :], self.touches, strict=True):
            if force:
                creases, _ = touch.slopes(place)
                out[np.ix_(creases, creases)] += force / sheet.crossings.size * touch.bends(place)
        return out


def balanced(
    sheet: Sheet, phi: np.ndarray, rows: Rows, z: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Balance the springs by rows that are all but closed: forces [r], Hessian of the Lagrangian, torque left [t]."""
    forces = np.zeros(len(rows.gaps))
    close = np.flatnonzero(rows.gaps < NEAR)
    torque = sheet.torque(phi)
    pushed = z.T @ rows.slopes[close].T
    forces[close] = nonnegative_least_squares(pushed, z.T @ torque)
    rest = torque - rows.slopes.T @ forces
    lam = sheet.normal(phi).multipliers(rest)
    hessian = dense(sheet.hessian(phi, lam)) - rows.bent(sheet, phi, forces)
    return forces, hessian, z.T @ rest


def quadratic(
    h: np.ndarray, g: np.ndarray, rows: Rows, z: np.ndarray, pushing: np.ndarray
) -> np.ndarray:
    """Minimise g.y + y'Hy/2 with gaps + slopes z y >= 0, H [t, t] with its negative curvatures turned round.

    They are so along what slopes of rows that push, `pushing` [p, n], leave free, and across it apart: what a gap adds
    to the curvature across would otherwise stiffen directions along which the energy hardly curves, and a descent would
    creep beyond a fold.
    """
    if not len(g):
        return g
    free, back = null_space(pushing @ z), []  # y = back x, with x'x/2 the quadratic form
    for basis in (free, null_space(free.T)):
        values, vectors = np.linalg.eigh(basis.T @ h @ basis)
        back.append(basis @ vectors / np.sqrt(np.maximum(np.abs(values), SOFTEST)))
    whole = np.hstack(back)
    x = nearest(-whole.T @ g, rows.slopes @ z @ whole, -np.maximum(rows.gaps, 0.0))
    return np.zeros(len(g)) if x is None else whole @ x


def _onto(
    sheet: Sheet, phi: np.ndarray, held: np.ndarray, touches: Sequence[Touch], sharp: bool = False
) -> np.ndarray | None:
    """Move onto closure with creases held and gaps closed, by steps of least length; None if that fails.

    Beside singular states what is left over, `ROUNDED`, is a long way: where `sharp`, singular vectors take it back.
    """
    free, none = np.flatnonzero(~held), np.zeros(0, int)
    last, before, whole = phi, math.inf, False
    phi = phi.copy()
    for count in range(30):
        sheet.check_time()
        rows = Rows.at(sheet, phi, none, touches)
        miss = np.r_[sheet.closure.values(phi), rows.gaps]
        worst = float(np.abs(miss).max(initial=0.0))
        if worst <= ROUNDED and not sharp:
            return phi
        if whole and worst >= before:  # rounding
            return last
        whole = sharp and worst <= CLOSES
        if not whole and count > 3 and worst > 0.3 * before:
            break  # rounding, or rows that cannot be met together
        last, before = phi.copy(), worst
        normal = Normal(np.vstack([dense(sheet.closure.jacobian(phi)), rows.slopes])[:, free])
        d = normal.whole_step(-miss) if whole else normal.step(-miss)
        phi[free] += d * min(1.0, LONGEST / max(float(np.abs(d).max(initial=0.0)), NONZERO))
    return phi if worst <= CLOSES else None


def put_back(
    sheet: Sheet, phi: np.ndarray, rows: Rows, kept: Sequence[Touch] = ()
) -> np.ndarray | None:
    """Put a trial state onto closure; limits and gaps that it has passed are met.

    Where two sides that are to be kept apart become parallel there is no gap between them, and no such state is told.

    Parameters
    ----------
    sheet, phi
        The programme and fold angles near closure, [n] [rad].
    rows
        Gaps that must not be passed.
    kept
        Features that touch, and shall do so.

    Returns
    -------
    numpy.ndarray
        The state [n]; None where there is none near by.
    """
    with suppress(Parallel):
        return _put_back(sheet, phi, rows, kept)
    return None


def _put_back(
    sheet: Sheet, phi: np.ndarray, rows: Rows, kept: Sequence[Touch]
) -> np.ndarray | None:
    held = np.abs(phi) >= math.pi
    touches = list(kept)
    for _ in range(10):
        start = np.where(held, np.copysign(math.pi, phi), phi)
        new = _onto(sheet, start, held, touches)
        if new is None:
            return None
        place = Placed(sheet.crossings.poses, new)
        passed = [
            t
            for t in rows.touches
            if t not in touches and t.gap(place) < -ROUNDED * sheet.crossings.size
        ]
        beyond = np.abs(new) > math.pi
        if not passed and not beyond.any():
            return new if sheet.closure.on_sheet(new) else None
        touches += passed
        held = held | beyond
    return None


def polish(sheet: Sheet, phi: np.ndarray, rows: Rows, forces: np.ndarray) -> np.ndarray | None:
    """Solve for a state with the rows that push closed, and nothing else: Newton's method.

    Parameters
    ----------
    sheet
        The programme.
    phi
        A state close by, [n] [rad].
    rows
        Its limits and gaps.
    forces
        Of the rows, over the mean stiffness, [r]: those above `CARRIES` are closed.

    Returns
    -------
    numpy.ndarray
        The state [n], to rounding; None where Newton does not arrive.
    """
    with suppress(Parallel):
        return _polish(sheet, phi, rows, forces)
    return None


def _polish(sheet: Sheet, phi: np.ndarray, rows: Rows, forces: np.ndarray) -> np.ndarray | None:
    loaded = forces > CARRIES
    held = np.zeros(sheet.size, bool)
    held[rows.limits[loaded[: len(rows.limits)]]] = True
    touches = [t for t, on in zip(rows.touches, loaded[len(rows.limits) :], strict=True) if on]
    start = np.where(held, np.copysign(math.pi, phi), phi)
    new, before = _onto(sheet, start, held, touches, sharp=True), math.inf
    for _ in range(12):
        if new is None:
            return None
        at = Rows.at(sheet, new, np.flatnonzero(held), touches)
        torque = sheet.torque(new)
        fixed = np.vstack([dense(sheet.closure.jacobian(new)), at.slopes])
        multipliers = Normal(fixed).multipliers(torque)
        z = null_space(fixed)
        m = sheet.closure.count
        reduced = z.T @ torque
        left = float(np.abs(reduced).max(initial=0.0))
        # large multipliers round coarsely: as far as Newton gets
        rounded = STILL * (1 + np.abs(multipliers).max(initial=0.0))
        if left <= STILL or rounded >= left >= 0.1 * before:
            return new
        before = left
        h = dense(sheet.hessian(new, multipliers[:m])) - at.bent(sheet, new, multipliers[m:])
        d = -z @ np.linalg.lstsq(z.T @ h @ z, reduced, rcond=ROUNDED)[0]
        if np.abs(d).max() > CLOSE:
            return None
        new = _onto(sheet, new + d, held, touches, sharp=True)
    return None
