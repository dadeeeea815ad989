"""Downhill along closed states that do not cross, into contact: steps of a quadratic programme whose rows are gaps.

Each step minimises the energy to second order over motions that closure allows, with the fold limits and the gaps of
features that face each other kept open to first order; it is then put back onto closure, and onto the gaps and limits
that it would have passed.  A step after which facets cross is shortened.  So every state on the way is closed and free
of crossings, and features that face each other are all that has to be known: no planes, no forces from afar.

Where features meet at borders, one of several gaps is enough to keep facets apart: the state is judged on every piece
(`kkt.classify`), and where one of them leads down the descent goes on there.  Beside such places steps are tried with
the gap that is open furthest.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np

from origami_nlp.facets import MOST_DENSE, Placed, Sheet, Touch, choices
from origami_nlp.numerics import (
    CARRIES,
    CLOSES,
    DECREASE,
    INSIDE,
    LEVEL,
    NONZERO,
    ROUNDED,
    null_space,
)
from origami_nlp.sheets.descent import TRUST, Descended
from origami_nlp.sheets.judgement import classified
from origami_nlp.sheets.pops import is_jump, pop_rows
from origami_nlp.sheets.rows import CLOSE, NEAR, STILL, Rows, balanced, polish, put_back, quadratic

MOST_PAIRS = 1_000
"""Pairs of facets that face each other closely: more are refused."""
REACH = 0.05
"""Features that face each other closer than this, over the sheet's size, are rows of a step."""
FAR = 1.0
"""Distance from which features are looked at, over the sheet's size, once facets have been found to cross."""
REACHES = (0.1, 0.01, 0.001)
"""Steps [rad] that are tried in turn."""
SHORTEST = 1e-8
"""Of a step [rad]."""
SETTLING = 1e-2
"""Reduced torque over the mean stiffness from which on the polish is tried."""
FLAT = 1e-9
"""Curvatures over the mean stiffness above minus this are not left as saddles."""
SLIPS = 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8
"""Steps [rad] beside borders that are as close, over the sheet's size."""
MOST_SLIPS = 2
"""Of them in one descent: they are short, and dear."""
End: TypeAlias = Literal["still", "lower", "held", "not settled"]
"""Of a step: a minimum, gone to a lower state, a state that was not decided, none."""
UNTOLD = "facets meet at borders or face to face, where no single gap tells them apart"
"""Why a descent ends at a state that is neither held on every piece nor left on one."""


def press(sheet: Sheet, phi: np.ndarray, most: int = 300, keep: bool = False) -> Descended:
    """Follow the energy downhill from a closed state in which no facets cross, along states of the same kind.

    Parameters
    ----------
    sheet
        The programme.
    phi
        The start, within the fold limits, [n] [rad].
    most
        Steps.
    keep
        Whether steps that take a vertex past its flat state are refused, see `pops`: motions of paper do not.

    Returns
    -------
    Descended
        Where it arrived a state that closure and contacts balance, polished: not yet judged.
    """
    if sheet.size > MOST_DENSE:
        many = f"the pattern has {sheet.size:,} creases, contact is solved up to {MOST_DENSE}"
        return Descended(phi, False, 0, many)
    return _Press(sheet, phi, keep).run(most)


class _Press:
    """A descent: where it is, and which features it has run into."""

    def __init__(self, sheet: Sheet, phi: np.ndarray, keep: bool = False) -> None:
        self.sheet, self.features = sheet, sheet.features
        self.radius, self.pops = TRUST, pop_rows(sheet.pattern) if keep else None
        self.path: list[np.ndarray] = []
        self.known: dict[object, Touch] = {}
        self._go(phi)

    def _go(self, phi: np.ndarray) -> None:
        """Be at a state."""
        self.path.append(phi)
        self.phi, self.energy = phi, self.sheet.scaled_energy(phi)
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

    def run(self, most: int) -> Descended:
        """Go down."""
        end = self._run(most)
        return replace(end, path=tuple(self.path))

    def _run(self, most: int) -> Descended:
        sheet = self.sheet
        slips = 0
        for step in range(most):
            rows = self._rows()
            if len({frozenset(t.facets) for t in rows.touches}) > MOST_PAIRS:
                many = f"more than {MOST_PAIRS} pairs of facets come close to each other"
                return Descended(self.phi, False, step, many)
            z = sheet.kernel(self.phi)
            forces, hessian, left = balanced(sheet, self.phi, rows, z)
            near = np.abs(left).max(initial=0.0) < SETTLING
            end = self._settled(rows, forces) if near else "not settled"
            if end == "still":
                return Descended(self.phi, True, step, end)
            if end == "lower" or (
                end != "held" and self._step(rows, z, hessian, rows.only(forces > CARRIES))
            ):
                continue
            slips += 1
            end = self._slip() if slips <= MOST_SLIPS else "held"
            end = self._judged() if end == "held" else end
            if end != "lower":
                return Descended(
                    self.phi, end == "still", step, "still" if end == "still" else UNTOLD
                )
        return Descended(self.phi, False, most, "too many steps")

    def _step(self, rows: Rows, z: np.ndarray, hessian: np.ndarray, pushing: Rows) -> bool:
        """Take a step down; False if there is none."""
        sheet = self.sheet
        while self.radius > SHORTEST:
            slope = z.T @ sheet.torque(self.phi)
            d = z @ quadratic(z.T @ hessian @ z, slope, rows, z, pushing.slopes)
            length = float(np.abs(d).max(initial=0.0))
            if length == 0.0:
                return False
            share = min(1.0, self.radius / length)
            # a straight step along facets that push leaves them by its square, which costs more than it gains
            stay = np.abs(pushing.slopes @ d)[len(pushing.limits) :] <= NEAR * length
            kept = [t for t, on in zip(pushing.touches, stay, strict=True) if on]
            new = put_back(sheet, self.phi + share * d, rows, kept)
            fall = share * float(sheet.torque(self.phi) @ d)
            if new is not None and self.pops is not None and is_jump(self.pops, self.phi, new):
                new = None
            if new is not None and sheet.scaled_energy(new) < self.energy + DECREASE * fall:
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

    def _settled(self, rows: Rows, forces: np.ndarray) -> End:
        """Solve for the state beside this one that contacts hold and judge it; go to a lower one beside it."""
        sheet = self.sheet
        if not self._polished(rows, forces):
            return "not settled"
        at = self._rows()
        z = sheet.kernel(self.phi)
        forces, hessian, left = balanced(sheet, self.phi, at, z)
        if np.abs(left).max(initial=0.0) > 1e3 * STILL * (1 + np.abs(forces).max(initial=0.0)):
            return "not settled"
        free = z @ null_space(at.slopes[forces > CARRIES] @ z)
        if free.shape[1]:
            values, vectors = np.linalg.eigh(free.T @ hessian @ free)
            if values[0] < -FLAT and self._off(at, free @ vectors[:, 0]):
                return "lower"
        met = {t.key for t, _ in self.features.facing(self.place, 2 * NEAR, INSIDE)}
        pushing = forces[len(at.limits) :] > CARRIES
        if all(t.key in met for t, on in zip(at.touches, pushing, strict=True) if on):
            return "still"
        return self._judged()

    def _polished(self, rows: Rows, forces: np.ndarray) -> bool:
        """Go to the state beside this one at which rows that push are closed, and nothing is left."""
        sheet = self.sheet
        end = polish(sheet, self.phi, rows, forces)
        if end is not None and (beyond := np.abs(end[rows.limits]) > math.pi).any():
            held = np.r_[beyond, np.zeros(len(rows.touches), bool)]
            end = polish(sheet, self.phi, rows, np.where(held, 1.0, forces))
        if end is None or np.abs(end).max() > math.pi or np.abs(end - self.phi).max() > CLOSE:
            return False
        if sheet.crossings.find(end):
            return False
        opened = float(
            forces @ np.maximum(-rows.gaps, 0.0)
        )  # facets may have reached into each other
        if sheet.scaled_energy(end) > self.energy + LEVEL * (1 + self.energy) + 2 * opened:
            return False
        before = self.phi, self.known
        self._go(end)
        if not opened and self._rows().gaps.min(initial=0.0) < -CLOSES:
            self.phi, self.known = before
            self._go(self.phi)
            del self.path[-2:]
            return False
        return True

    def _judged(self) -> End:
        """Judge a state on every piece that meets there; go to a lower one beside it."""
        what = classified(self.sheet, self.phi)
        if what.lower is not None:
            self.radius = float(np.abs(what.lower - self.phi).max())
            self._go(what.lower)
            return "lower"
        return "still" if what.verdict == "minimum" else "held"

    def _slip(self) -> End:
        """Step down beside borders: of what keeps facets apart there, with the gap that is open furthest."""
        sheet = self.sheet
        z = sheet.kernel(self.phi)
        for reach in SLIPS:
            limits = np.flatnonzero(math.pi - np.abs(self.phi) < 2 * reach)
            inside = [t for t, _ in self.features.facing(self.place, REACH, reach)]
            meeting = choices(self.features, self.place, reach)
            furthest = [max(choice, key=lambda t: t.gap(self.place)) for choice in meeting]
            rows = Rows.at(sheet, self.phi, limits, [*dict.fromkeys([*inside, *furthest])])
            forces, hessian, left = balanced(sheet, self.phi, rows, z)
            if np.abs(left).max(initial=0.0) < SETTLING and self._polished(rows, forces):
                return self._judged()
            slope, pushing = z.T @ sheet.torque(self.phi), rows.slopes[forces > CARRIES]
            d = z @ quadratic(z.T @ hessian @ z, slope, rows, z, pushing)
            share = min(1.0, reach / max(float(np.abs(d).max(initial=0.0)), NONZERO))
            new = put_back(sheet, self.phi + share * d, rows)
            if new is None or sheet.scaled_energy(new) > self.energy - LEVEL * (1 + self.energy):
                continue
            if np.abs(new - self.phi).max() <= 3 * reach and not sheet.crossings.find(new):
                self._go(new)
                self.radius = reach
                return "lower"
        return "held"

    def _off(self, rows: Rows, way: np.ndarray) -> bool:
        """Leave a saddle along a way of negative curvature, where it is free."""
        way = way / np.abs(way).max()
        for reach in REACHES:
            for sign in (1.0, -1.0):
                new = put_back(self.sheet, self.phi + sign * reach * way, rows)
                if new is None or self.sheet.scaled_energy(new) > self.energy - 10 * ROUNDED * (
                    1 + self.energy
                ):
                    continue
                if not self.sheet.crossings.find(new):
                    self._go(new)
                    self.radius = reach
                    return True
        return False
