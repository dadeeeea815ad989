"""Downhill along closed states that do not cross, into contact: steps of a quadratic programme whose rows are gaps.

Each step minimises the energy to second order over motions that closure allows, with the fold limits and the gaps of
features that face each other kept open to first order; it is then put back onto closure, and onto the gaps and limits
that it would have passed.  A step after which facets cross is shortened.  So every state on the way is closed and free
of crossings, and features that face each other are all that has to be known: no planes, no forces from afar.

Where features meet at borders, one of several gaps is enough to keep facets apart, and it is not known which: steps are
tried with the one that is passed least.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable

import numpy as np

from origami_nlp.facets import INSIDE, MOST_DENSE, Features, Placed, Sheet, Touch
from origami_nlp.numerics import CLOSES, null_space
from origami_nlp.sheets.descent import TRUST, Descended
from origami_nlp.sheets.rows import (
    CLOSE,
    LOADED,
    NEAR,
    STILL,
    Rows,
    balanced,
    polish,
    put_back,
    quadratic,
)

MOST_PAIRS = 1_000
"""Pairs of facets that face each other closely: more are refused."""
REACH = 0.05
"""Features that face each other closer than this, over the sheet's size, are rows of a step."""
FAR = 1.0
"""Distance from which features are looked at, over the sheet's size, once facets have been found to cross."""
SHORTEST = 1e-11
"""Of a step [rad]."""
SETTLING = 1e-2
"""Reduced torque over the mean stiffness from which on the polish is tried."""
FLAT = 1e-9
"""Curvatures over the mean stiffness above minus this are not left as saddles."""
SLIPS = 1e-2, 1e-3, 1e-4
"""Steps [rad] with which a state at borders is left."""
MOST_CHOSEN = 12
"""Rounds in which rows are chosen for such a step."""
UNTOLD = "facets meet at borders or face to face, where no single gap tells them apart"
"""Why a descent ends that is left without features."""


def press(sheet: Sheet, phi: np.ndarray, most: int = 300, until: float = math.inf) -> Descended:
    """Follow the energy downhill from a closed state in which no facets cross, along states of the same kind.

    Parameters
    ----------
    sheet
        The programme.
    phi
        The start, within the fold limits, [n] [rad].
    most
        Steps.
    until
        Time of `time.process_time` at which it is given up.

    Returns
    -------
    Descended
        Where it arrived a state that closure and contacts balance, polished: not yet judged.
    """
    if sheet.size > MOST_DENSE:
        many = f"the pattern has {sheet.size:,} creases, contact is solved up to {MOST_DENSE}"
        return Descended(phi, False, 0, many)
    return _Press(sheet, phi).run(most, until)


class _Press:
    """A descent: where it is, and which features it has run into."""

    def __init__(self, sheet: Sheet, phi: np.ndarray) -> None:
        self.sheet, self.features = sheet, Features(sheet.crossings)
        self.radius = TRUST
        self.known: dict[object, Touch] = {}
        self._go(phi)

    def _go(self, phi: np.ndarray) -> None:
        """Be at a state."""
        self.phi, self.energy = phi, self.sheet.energy(phi)
        self.place = Placed(self.sheet.crossings.poses, phi)
        self.near = self._facing(REACH)
        still = self._facing(FAR, {t.facets for t in self.known.values()}) if self.known else {}
        self.known = {k: t for k, t in still.items() if k in self.known}

    def _facing(
        self, reach: float, only: Iterable[tuple[int, int]] | None = None
    ) -> dict[object, Touch]:
        found = self.features.facing(self.place, reach, only=only)
        return {t.key: t for t, _ in found}

    def _rows(self) -> Rows:
        """Return what must stay open: limits in reach, features that are close or were run into."""
        limits = np.flatnonzero(math.pi - np.abs(self.phi) < 2 * self.radius)
        return Rows.at(self.sheet, self.phi, limits, [*{**self.known, **self.near}.values()])

    def run(self, most: int, until: float) -> Descended:
        """Go down."""
        sheet = self.sheet
        for step in range(most):
            if time.process_time() > until:
                return Descended(self.phi, False, step, "the processor time allowed was over")
            rows = self._rows()
            if len({frozenset(t.facets) for t in rows.touches}) > MOST_PAIRS:
                many = f"more than {MOST_PAIRS} pairs of facets come close to each other"
                return Descended(self.phi, False, step, many)
            z = sheet.kernel(self.phi)
            forces, hessian, left = balanced(sheet, self.phi, rows, z)
            if np.abs(left).max(initial=0.0) < SETTLING:
                end = self._settled(rows, forces)
                if end is not None:
                    if self._sure():
                        return Descended(end, True, step, "still")
                    if not self._slip():
                        return Descended(end, False, step, UNTOLD)
                    continue
            if not self._step(rows, z, hessian) and not self._slip():
                return Descended(self.phi, False, step, UNTOLD)
        return Descended(self.phi, False, most, "too many steps")

    def _step(self, rows: Rows, z: np.ndarray, hessian: np.ndarray) -> bool:
        """Take a step down; False if there is none."""
        sheet = self.sheet
        while self.radius > SHORTEST:
            d = z @ quadratic(z.T @ hessian @ z, z.T @ sheet.torque(self.phi), rows, z)
            length = float(np.abs(d).max(initial=0.0))
            if length == 0.0:
                return False
            share = min(1.0, self.radius / length)
            new = put_back(sheet, self.phi + share * d, rows)
            fall = share * float(sheet.torque(self.phi) @ d)
            if new is not None and sheet.energy(new) < self.energy + 1e-4 * fall:
                crossed = sheet.crossings.find(new)
                if not crossed and np.abs(new - self.phi).max() <= 3 * share * length:
                    self.radius = min(TRUST, 2 * self.radius if share < 1 else self.radius)
                    self._go(new)
                    return True
                if crossed:
                    self.known |= self._facing(FAR, crossed)
                    more = self._rows()
                    if len(more.gaps) > len(rows.gaps):
                        rows = more
                        continue
            self.radius = 0.3 * min(self.radius, length)
        return False

    def _settled(self, rows: Rows, forces: np.ndarray) -> np.ndarray | None:
        """Solve for the state beside this one that contacts hold; None if there is none, or lower ones beside it."""
        sheet = self.sheet
        end = polish(sheet, self.phi, rows, forces)
        if end is None or np.abs(end - self.phi).max() > CLOSE:
            return None
        if sheet.energy(end) > self.energy + 1e-12 * (1 + self.energy):
            return None
        if sheet.crossings.find(end):
            return None
        before = self.phi, self.known
        self._go(end)
        at = self._rows()
        if at.gaps.min(initial=0.0) < -CLOSES:
            self.phi, self.known = before
            self._go(self.phi)
            return None
        z = sheet.kernel(end)
        forces, hessian, left = balanced(sheet, end, at, z)
        if np.abs(left).max(initial=0.0) > 1e3 * STILL * (1 + np.abs(forces).max(initial=0.0)):
            return None
        free = z @ null_space(at.slopes[forces > LOADED] @ z)
        if free.shape[1]:
            values, vectors = np.linalg.eigh(free.T @ hessian @ free)
            if values[0] < -FLAT and self._off(at, free @ vectors[:, 0]):
                return None
        return end

    def _sure(self) -> bool:
        """Tell whether all that pushes are features that meet inside each other."""
        rows, inside = self._apart()
        forces, _, _ = balanced(self.sheet, self.phi, rows, self.sheet.kernel(self.phi))
        return bool((forces[~inside] <= LOADED).all())

    def _apart(self) -> tuple[Rows, np.ndarray]:
        """Return the rows, and which of them are limits, open, or of features that meet inside each other."""
        rows = self._rows()
        met = {t.key for t, _ in self.features.facing(self.place, 2 * NEAR, INSIDE)}
        inside = rows.gaps > NEAR
        inside[: len(rows.limits)] = True
        inside[len(rows.limits) :] |= np.array([t.key in met for t in rows.touches], bool)
        return rows, inside

    def _slip(self) -> bool:
        """Step down where features meet at borders: with rows that are certain, and of the others as few as will do."""
        sheet = self.sheet
        rows, use = self._apart()
        z = sheet.kernel(self.phi)
        _, hessian, _ = balanced(sheet, self.phi, rows, z)
        reduced, torque = z.T @ hessian @ z, z.T @ sheet.torque(self.phi)
        for reach in SLIPS:
            chosen = use.copy()
            for _ in range(MOST_CHOSEN):
                some = rows.only(chosen)
                d = z @ quadratic(reduced, torque, some, z)
                length = float(np.abs(d).max(initial=0.0))
                if length == 0.0:
                    break
                new = put_back(sheet, self.phi + min(1.0, reach / length) * d, some)
                if new is None or sheet.energy(new) > self.energy - 1e-12 * (1 + self.energy):
                    break
                crossed = sheet.crossings.find(new)
                if not crossed:
                    self._go(new)
                    self.radius = reach
                    return True
                gaps = Rows.at(sheet, new, rows.limits, rows.touches).gaps
                more = chosen.copy()
                for pair in crossed:
                    passed = [
                        k
                        for k, t in enumerate(rows.touches, len(rows.limits))
                        if not chosen[k] and gaps[k] < 0 and self.features.between(t, pair)
                    ]
                    if passed:
                        more[max(passed, key=lambda k: gaps[k])] = True
                if (more == chosen).all():
                    break
                chosen = more
        return False

    def _off(self, rows: Rows, way: np.ndarray) -> bool:
        """Leave a saddle along a way of negative curvature, where it is free."""
        way = way / np.abs(way).max()
        for reach in (0.1, 0.01, 0.001):
            for sign in (1.0, -1.0):
                new = put_back(self.sheet, self.phi + sign * reach * way, rows)
                if new is None or self.sheet.energy(new) > self.energy - 1e-13 * (1 + self.energy):
                    continue
                if not self.sheet.crossings.find(new):
                    self._go(new)
                    self.radius = reach
                    return True
        return False
