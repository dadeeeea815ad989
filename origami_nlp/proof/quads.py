"""All minima of a sheet of which no vertex folds flat (`quad_states`): curves, and what ends them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from flint import arb

from origami_nlp.pattern import Pattern
from origami_nlp.proof.quad_states import Modes, QuadSheet, narrowed
from origami_nlp.proof.result import ProvedState, Region
from origami_nlp.proof.sheets import closer, sign_of, state_of
from origami_nlp.proof.slopes import DEPTH, Budget, Look, least

QUARTER = math.nextafter(0.5 * math.pi, math.inf)
"""Not below pi/2, which is between two doubles."""
ALIKE = 1e-9
"""Folds that differ by less reach 180 degrees all but together: none is known to be the first [rad]."""
WIDEST = 1e-6
"""Radius within which a minimum is listed, at most [rad]: a wider one names no state."""


class CurveState(NamedTuple):
    """States of a curve over theta: |z| of all numbers, folds of all creases, U' and U''."""

    zs: list[Any]
    folds: list[Any]
    first: Any
    second: Any


class QuadCurve:
    """The energy along a curve through the flat state, on a side of it; fold limits as gaps."""

    def __init__(self, modes: Modes, side: int, pattern: Pattern) -> None:
        self.modes, self.side = modes, side
        springs = zip(pattern.stiffness.tolist(), pattern.rest.tolist(), strict=True)
        self.hinges = [(arb(k), arb(rest)) for k, rest in springs]
        self.sides = {c: side * s for c, s in modes.signs.items()}

    def _known(self, x: Any, middle: CurveState | None) -> CurveState | None:
        zs = self.modes.states(x)
        if zs is None:
            return None
        folds = self.modes.of_creases(self.modes.folds(x, zs), self.side)
        if middle:
            both = zip(folds, middle.folds, strict=True)
            folds = [narrowed(f, at, x - x.mid()) for f, at in both]
        first, second = arb(0), arb(0)
        for phi, (k, rest) in zip(folds, self.hinges, strict=True):
            torque = k * (phi[0] - rest)
            first += torque * phi[1]
            second += k * phi[1] * phi[1] + 2 * torque * phi[2]
        return CurveState(zs, folds, first, second)

    def over(self, x: Any) -> Look | None:
        """Return U', U'' and gaps over theta."""
        middle = at = self._known(x.mid(), None)
        box = at if x == x.mid() else self._known(x, at)
        if box is None:
            return None
        gaps = {n: (z[0], z[1]) for n, z in enumerate(box.zs)}
        first = box.first
        if middle:
            first = closer(first, middle.first + box.second * (x - x.mid()))
        return Look(first, box.second, gaps, box.folds)

    def state(self, low: float, high: float, gaps: Sequence[Any] = ()) -> ProvedState | None:
        """Return the state of a minimum between two numbers, held by some of the gaps; None where it is not known."""
        known = self.over(arb(low).union(arb(high)))
        if known is None:
            return None
        ends = [self.over(arb(x)) for x in (low, high)]
        held = {n for n in gaps if not all(e is not None and e.gaps[n][0] > 0 for e in ends)}
        exactly = {c: self.sides[c] * math.pi for c, n in self.modes.node.items() if n in held}
        return state_of([f[0] for f in known.known], exactly)


class QuadSearch:
    """All choices of modes, what closes in each, and its minima.

    Attributes
    ----------
    minima, open
        What is shown, and what is left.
    curves
        How many go through the flat state.
    """

    def __init__(self, quads: QuadSheet, budget: Budget) -> None:
        self.quads, self.budget = quads, budget
        self.pattern = pattern = quads.sheet.pattern
        self.minima: list[ProvedState] = []
        self.open: list[Region] = []
        self.curves = 0
        self.rests = not pattern.rest.any()
        first = quads.vertices[0]
        k = first.beside
        # of two opposite creases that which folds more
        self.drive = first.creases[0 if k[1] * k[2] > k[0] * k[3] else 2]

    @property
    def over(self) -> str:
        """Over which states the statement ranges, in words."""
        return (
            f"the flat state and {self.curves} curves through it, along which vertices of equal sectors "
            "fold alike"
        )

    def run(self) -> None:
        """Go through all choices; then ask of the flat state."""
        self._choose((), [(0.0, QUARTER)])
        # off it the energy falls along every curve, but where no spring pulls
        if not self.curves or self.rests:
            self.minima.append(ProvedState(np.zeros(self.pattern.creases), 0.0))

    def _choose(self, modes: tuple[int, ...], left: list[tuple[float, float]]) -> None:
        """Choose a mode at each vertex in turn; theta is in what is left."""
        signs = self.quads.signs(modes)
        if signs is None:
            return
        whole = len(modes) == len(self.quads.vertices)
        if modes:
            links = Modes(self.quads, modes, self.drive, signs)
            if links.loops:
                left = list(self._closing(links, left))
        if not whole:
            for mode in (1, -1) if left else ():
                self._choose((*modes, mode), left)
        elif not links.loops:
            self._curve(links)
        else:
            for (low, high), side in itertools.product(left, (1, -1)):
                self._leave(links, side, low, high, "whether a loop closes at a rigid state")

    def _curve(self, links: Modes) -> None:
        """Add the minima of a curve along which all loops close."""
        self.curves += 1
        links = _first_folded(links)
        for side in (1, -1):
            curve = QuadCurve(links, side, self.pattern)
            found = least(curve.over, 0.0, QUARTER, self.budget, self.rests)
            for low, high, why in found.open:
                self._leave(links, side, low, high, why)
            for low, high, gaps in found.minima:
                state = curve.state(low, high, gaps)
                if state is not None and state.radius <= WIDEST:
                    self.minima.append(state)
                else:
                    self._leave(links, side, low, high, "the fold angles of a minimum")

    def _closing(
        self, links: Modes, left: list[tuple[float, float]]
    ) -> Iterator[tuple[float, float]]:
        """Yield the smallest intervals in which loops may close, those that meet as one."""
        front = [(low, high, 0) for low, high in reversed(left)]
        last: tuple[float, float] | None = None
        while front:
            low, high, depth = front.pop()
            over = self.budget.spent()
            if self._none(links, low, high):
                continue
            middle = 0.5 * (low + high)
            if not (over or depth == DEPTH or middle in (low, high)):
                front += [(middle, high, depth + 1), (low, middle, depth + 1)]
            elif last is not None and last[1] == low:
                last = last[0], high
            else:
                if last is not None:
                    yield last
                last = low, high
        if last is not None:
            yield last

    def _none(self, links: Modes, low: float, high: float) -> bool:
        """Return whether no state closes in an interval."""
        theta = arb(low).union(arb(high))
        at, zs = links.states(theta.mid()), links.states(theta)
        if zs is None:
            return True
        off = [_differ(zs, one) for one in links.loops]
        if at is not None:
            both = zip(off, links.loops, strict=True)
            off = [narrowed(x, _differ(at, one), theta - theta.mid()) for x, one in both]
        return any(sign_of(x[0]) for x in off)

    def _leave(self, links: Modes, side: int, low: float, high: float, why: str) -> None:
        ends = np.array([np.full(self.pattern.creases, s * math.pi) for s in (-1, 1)])
        theta = arb(low).union(arb(high))
        zs = links.states(theta)
        folds = links.of_creases(links.folds(theta, zs), side) if zs else []
        for (c, _), f in zip(sorted(links.node.items()), folds, strict=bool(folds)):
            s = side * links.signs[c]
            ends[:, c] = (0.0, math.pi) if s > 0 else (-math.pi, 0.0)
            if f[0].is_finite():
                ends[0, c] = max(ends[0, c], float(f[0].lower()))
                ends[1, c] = min(ends[1, c], float(f[0].upper()))
        self.open.append(Region(ends[0], ends[1], why))


def _differ(zs: Sequence[Any], loop: tuple[int, int]) -> Any:
    return zs[loop[0]] - zs[loop[1]]


def _first_folded(links: Modes) -> Modes:
    """Return a curve given by the crease that is first at 180 degrees: no root is 0 before."""
    low, high = 0.0, 0.5 * math.pi
    for _ in range(60):
        middle = 0.5 * (low + high)
        zs = links.states(arb(middle))
        low, high = (low, middle) if zs is None or any(not z[0] > 0 for z in zs) else (middle, high)
    zs = links.states(arb(low))
    if zs is None:
        return links
    sizes = [float(z[0].mid()) for z in zs]
    first = sizes.index(min(sizes))
    if not first or sizes[0] - sizes[first] < ALIKE:
        return links
    drive = min(c for c, n in links.node.items() if n == first)
    return Modes(links.quads, links.modes, drive, links.signs)
