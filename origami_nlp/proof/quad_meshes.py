"""All minima of a mesh of vertices of degree four, with cycles or without, that need not fold flat (`quad_states`).

A mode is chosen at each vertex in turn, and theta, from 0 to 90 degrees, is cut into boxes: those go in which no
state closes within fold limits, or a loop does not close.  Where a loop moves steeply it closes once, if the signs at
the ends say so: a rigid state, that stands alone.  At theta = 0 every loop closes: there is no other state in a box
round it where a loop is steep.  Where all loops close identically, as where none is, a curve is left, whose minima
`curves` finds.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.pattern import Pattern, laid_flat
from origami_nlp.proof.balls import Ball, exact
from origami_nlp.proof.curve_contact import APART, CROSSING, CurveContact, why_no_contact
from origami_nlp.proof.curve_energy import HALF_TURN, ThetaEnergy
from origami_nlp.proof.curves import BEYOND, NARROWEST, along_curve
from origami_nlp.proof.flat_sheets import SheetMinimum, SheetProof
from origami_nlp.proof.quad_sheets import QuadMesh, as_quad_mesh, why_no_quad_mesh
from origami_nlp.proof.quad_states import QuadCurve, QuadStates
from origami_nlp.proof.rows import UNIT, variables

FULL_TURN = math.nextafter(2 * math.pi, 0.0)
"""Not above 2 pi, which is between two doubles."""
FIRST = np.array([0.0, 0.01, 0.1, 0.4, 1.0, BEYOND])
"""Where the first boxes end [rad]."""
MANY = 16
"""Parts that boxes are cut into where they are fewer: it costs what two do."""
ALIKE = 1e-6
"""Folds that differ by less reach 180 degrees all but together: none is known to be the first [rad]."""


class ThetaInterval(NamedTuple):
    """Theta between two numbers: where a rigid state is, once, or what is left open."""

    low: float
    high: float
    is_root: bool


@dataclass(frozen=True, kw_only=True)
class QuadProof(SheetProof):
    """What is proved of a mesh of vertices of degree four: the flat state, curves through it, and rigid states.

    Attributes
    ----------
    choices
        Of a mode at each vertex, that do not contradict each other in signs.
    rigid
        States beside the flat one that stand alone.
    """

    choices: int
    rigid: int

    @property
    def states(self) -> str:
        """Where all closed states are, in words."""
        curves = f"{self.curves} curve{'s' * (self.curves != 1)} through it"
        return (
            f"are the flat state, {self.rigid} rigid states that stand alone, and "
            f"{curves}, along which vertices of equal sectors fold alike ({self.choices} choices of a mode at each "
            "vertex, the others excluded by intervals)"
        )

    meant = "of the sheet whose equal sectors are equal exactly"


def prove_quad_mesh(
    pattern: Pattern, *, contact: bool = False, boxes: int = 1_000_000, until: float = math.inf
) -> QuadProof:
    """Find every minimum of the energy of a mesh of vertices of degree four within fold limits, with a proof.

    Parameters
    ----------
    pattern
        Flat vertices of degree four, no opposite creases of one in a line; in any order, with cycles.
    contact
        Whether facets must not cross.
    boxes
        At most so many boxes of theta; what is left is undecided.
    until
        Stop then (`time.monotonic`).

    Returns
    -------
    QuadProof
        All minima, but for what is undecided.

    Raises
    ------
    OptionError
        If the pattern is no such mesh, or its contact cannot be proved: `why_no_quad_mesh` and
        `why_no_contact` say why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import prove_quad_mesh
    >>> proof = prove_quad_mesh(o.examples.pattern("metasheet", 3, 3))
    >>> proof.curves, proof.rigid, len(proof.minima), proof.undecided
    (2, 0, 3, ())
    """
    mesh, why = as_quad_mesh(pattern)
    if mesh is None or (why := why_no_quad_mesh(pattern)):
        raise OptionError(f"pattern = {pattern.title}: no mesh that can be proved: {why}")
    if contact and (why := why_no_contact(pattern)):
        raise OptionError(f"pattern = {pattern.title}: no mesh whose contact can be proved: {why}")
    started = time.process_time()
    pattern = laid_flat(pattern)
    search = _QuadSearch(mesh, pattern, CurveContact(pattern) if contact else None, boxes, until)
    with np.errstate(all="ignore"):
        search.run()
    return QuadProof(
        curves=search.curves,
        minima=tuple(search.minima),
        maxima=search.maxima,
        undecided=tuple(search.open),
        deviation=mesh.deviation,
        moved=mesh.moved,
        boxes=search.boxes,
        seconds=time.process_time() - started,
        contact=contact,
        choices=search.choices,
        rigid=search.rigid,
    )


class _QuadSearch:
    """All choices of modes, what closes in each, and its minima."""

    def __init__(
        self,
        mesh: QuadMesh,
        pattern: Pattern,
        facets: CurveContact | None,
        boxes: int,
        until: float,
    ) -> None:
        self.mesh, self.pattern, self.facets = mesh, pattern, facets
        self.most, self.until = boxes, until
        self.curves = self.choices = self.rigid = self.maxima = self.boxes = 0
        self.minima: list[SheetMinimum] = []
        self.open: list[tuple[np.ndarray, np.ndarray, str]] = []
        self._flat: list[SheetMinimum | None] = []

    def run(self) -> None:
        """Go through all choices; then ask of the flat state."""
        self._choose((), None)
        low, high = self.pattern.limit_angles
        if not self.curves:
            if ((low <= 0) & (high >= 0)).all():  # no stop excludes it
                self.minima.append(SheetMinimum(np.zeros(self.mesh.creases), 0.0))
        elif all(self._flat):
            self.minima += [one for one in self._flat[:1] if one is not None]
        elif any(self._flat):
            flat = np.zeros(self.mesh.creases)
            self.open.append((flat, flat, "the flat state is a minimum of some of its curves only"))

    def _choose(self, modes: tuple[int, ...], left: list[ThetaInterval] | None) -> None:
        """Go through all modes of the vertices after these; theta is in what is left, anywhere if that is None."""
        if len(modes) == len(self.mesh.vertices):
            self.choices += 1
        for mode in (1, -1) if len(modes) < len(self.mesh.vertices) else ():
            more = (*modes, mode)
            signs = self.mesh.signs(more)
            if signs is None:
                continue
            curve = QuadCurve(self.mesh, more, self._drive(), signs)
            found = left
            if curve.loops:
                found = list(self._scan(curve, left))
                if not found:
                    self.choices += self._completed(more)
                    continue
            if len(more) < len(self.mesh.vertices):
                self._choose(more, found)
                continue
            self.choices += 1
            if found is None:
                self._along(more, signs)
            for one in found or []:
                self._rigid(curve, one)

    def _completed(self, modes: tuple[int, ...]) -> int:
        """Return how many choices begin with these modes."""
        left = len(self.mesh.vertices) - len(modes)
        ways = itertools.product((1, -1), repeat=left)
        return sum(self.mesh.signs((*modes, *way)) is not None for way in ways)

    def _drive(self) -> int:
        """Return which of two opposite creases of the first vertex folds more."""
        first = self.mesh.vertices[0]
        return first.creases[2 if first.squares[0].centre > 1 else 0]

    def _scan(self, curve: QuadCurve, left: list[ThetaInterval] | None) -> Iterator[ThetaInterval]:
        """Yield where all loops of a curve may close, but for theta = 0: roots of one of them, and what stays open."""
        if left is None:
            low, high = FIRST[:-1], FIRST[1:]
        else:
            low, high = (np.array([one[i] for one in left]) for i in (0, 1))
        steep: list[tuple[float, float, int]] = []
        kept: list[tuple[float, float]] = []
        while len(low):
            stop = self.boxes + len(low) > self.most or time.monotonic() > self.until
            self.boxes += len(low)
            gone, slope = _over(curve, low, high)
            alone = ~gone & (slope != 0)
            for ends in (low, high):
                alone[alone] = curve.states(exact(ends[alone])).inside
            steep += zip(*(x[alone].tolist() for x in (low, high, slope)), strict=True)
            middle = 0.5 * (low + high)
            narrow = (high - low <= NARROWEST) | (middle <= low) | (middle >= high) | stop
            last = ~gone & ~alone & narrow
            kept += zip(low[last].tolist(), high[last].tolist(), strict=True)
            split = ~gone & ~alone & ~narrow
            parts = MANY if np.count_nonzero(split) < MANY else 2
            ends = np.linspace(low[split], high[split], parts + 1)
            low, high = ends[:-1].ravel(), ends[1:].ravel()
        for a, b, sign in _joined(sorted(steep)):
            yield from _root(curve, a, b, sign)
        for a, b, _ in _joined([(*one, 0) for one in sorted(kept)]):
            yield ThetaInterval(a, b, False)

    def _rigid(self, curve: QuadCurve, one: ThetaInterval) -> None:
        """Add the two states of an interval of theta, one the other's mirror image, or leave it open."""
        low, high = np.array([one.low]), np.array([one.high])
        middle, half = variables(low, high)
        at = curve.states(exact(middle))
        box = curve.states(Ball(middle, half), at)
        angles = [box.angles[c] for c in range(self.mesh.creases)]
        phi = np.array([float(a.centre[0]) for a in angles])
        radius = np.array([float(a.radius[0]) for a in angles])
        if box.outside[0]:  # where the loop closes, folds are beyond their limits
            return
        within = all(bool(a.magnitude[0] < HALF_TURN) and bool(a.sign[0]) for a in angles)
        if not (one.is_root and within and len(curve.loops) == 1):
            why = "several loops close to rounding" if one.is_root else "whether a loop closes"
            self._leave(curve, one, why if within else "whether a loop closes at a fold limit")
            return
        facets = APART
        if self.facets is not None:
            corners = self.facets.facets(at, box, box.angles, half)
            facets = int(self.facets.over(corners, box.angles, high - low)[0][0])
        for side in (1.0, -1.0):
            room = self.pattern.limit_angles - side * phi
            if facets == CROSSING:
                continue
            inside = (room[0] < -radius) & (room[1] > radius)
            beyond = (room[0] > radius) | (room[1] < -radius)
            if facets != APART or not (inside | beyond).all():
                self.open.append(
                    (side * phi - radius, side * phi + radius, "contact at a rigid state")
                )
            elif inside.all():
                self.rigid += 1
                self.minima.append(SheetMinimum(side * phi, float(radius.max())))

    def _along(self, modes: tuple[int, ...], signs: dict[int, int]) -> None:
        """Add the minima of a curve along which all loops close."""
        self.curves += 1
        curve = QuadCurve(self.mesh, modes, self._first_folded(modes, signs), signs)
        energy = ThetaEnergy(curve, self.pattern)
        ends, examined = along_curve(
            energy, self.facets, max(0, self.most - self.boxes), self.until
        )
        self.boxes += examined
        flat = None
        for one in ends.minima():
            if one.theta[0] <= 0 <= one.theta[1] and not one.at_limit:
                flat = SheetMinimum(np.zeros(self.mesh.creases), 0.0)
            else:
                self.minima.append(one)
        self._flat.append(flat)
        self.maxima += ends.maxima
        self.open += ends.open

    def _first_folded(self, modes: tuple[int, ...], signs: dict[int, int]) -> int:
        """Return the crease that is first at 180 degrees along a curve, if one is: all others are smooth until then."""
        curve = QuadCurve(self.mesh, modes, self._drive(), signs)

        def states(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            at = QuadStates(curve, exact(theta), None)
            angles = np.array([np.broadcast_to(a.centre, theta.shape) for a, _ in at.nodes])
            return ~at.outside & np.isfinite(angles).all(axis=0), np.abs(angles)

        low, high, most = 0.0, 0.5 * math.pi, np.zeros(len(curve.sense))
        for _ in range(6):
            theta = np.linspace(low, high, 200)[1:]
            closes, angles = states(theta)
            last = len(theta) if closes.all() else int(np.argmin(closes))
            if last == 0:
                break
            low, most = float(theta[last - 1]), angles[:, last - 1]
            if last == len(theta):
                break
            high = float(theta[last])
        first = np.flatnonzero(most >= most.max() - ALIKE)
        if len(first) > 1:
            return self._drive()
        return min(c for c, n in curve.node.items() if n == first[0])

    def _leave(self, curve: QuadCurve, one: ThetaInterval, why: str) -> None:
        low, high = np.array([one.low]), np.array([one.high])
        middle, half = variables(low, high)
        box = curve.states(Ball(middle, half))
        ends = np.array([np.full(self.mesh.creases, s * math.pi) for s in (-1, 1)])
        for c, a in box.angles.items():
            s = curve.signs[c]
            ends[0, c], ends[1, c] = (0.0, math.pi) if s > 0 else (-math.pi, 0.0)
            if a.magnitude[0] < HALF_TURN:
                ends[0, c] = max(ends[0, c], a.centre[0] - a.radius[0])
                ends[1, c] = min(ends[1, c], a.centre[0] + a.radius[0])
        self.open.append((ends[0], ends[1], why))
        self.open.append((-ends[1], -ends[0], why))


def _over(curve: QuadCurve, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return of boxes which hold no closed state beside the flat one, and the sign of the slope of the first loop."""
    middle, half = variables(low, high)
    at = curve.states(exact(middle))
    box = curve.states(Ball(middle, half), at)
    gone = box.outside.copy()
    flat = low <= 0
    steep = np.zeros(len(low), int)
    for k, (one, wide) in enumerate(zip(at.mismatch(), box.mismatch(), strict=True)):
        value = one.value.widened(wide.slope.magnitude * half)
        gone |= (_differs(value) & at.inside) | _differs(wide.value)
        # of folds that move by less than a turn
        sign = np.where(wide.slope.magnitude * half < 1, wide.slope.sign, 0.0).astype(int)
        gone |= flat & (sign != 0)
        if k == 0:
            steep = np.where(flat | ~(value.magnitude < FULL_TURN), 0, sign)
    return gone, steep


def _differs(value: Ball) -> np.ndarray:
    """Return whether two folds, known modulo a full turn, certainly differ."""
    return (value.sign != 0) & (value.magnitude < FULL_TURN)


def _joined(pieces: list[tuple[float, float, int]]) -> list[tuple[float, float, int]]:
    """Join intervals that follow each other and are of one kind."""
    found: list[tuple[float, float, int]] = []
    for low, high, kind in pieces:
        if found and found[-1][1] == low and found[-1][2] == kind:
            found[-1] = (found[-1][0], high, kind)
        else:
            found.append((low, high, kind))
    return found


def _root(curve: QuadCurve, low: float, high: float, sign: int) -> Iterator[ThetaInterval]:
    """Yield where the first loop closes in an interval in which its mismatch grows (1) or falls."""
    ends = [_mismatch_at(curve, x) for x in (low, high)]
    if not all(ends):
        yield ThetaInterval(low, high, False)
    elif ends[0] != ends[1]:
        a, b = low, high
        for _ in range(60):
            middle, half = variables(np.array([a]), np.array([b]))
            at = curve.states(exact(middle))
            box = curve.states(Ball(middle, half), at)
            step = at.mismatch()[0].value * Ball(*_first(box.mismatch()[0].slope)).inverse()
            x, far = float(middle[0] - step.centre[0]), float(step.radius[0]) + 4 * UNIT
            new = max(a, x - far), min(b, x + far)
            if not 0 <= new[1] - new[0] < 0.9 * (b - a):
                new = _halved(curve, a, b, sign)
            if not new[1] - new[0] < 0.9 * (b - a):
                break
            a, b = new
        yield ThetaInterval(a, b, True)


def _first(ball: Ball) -> tuple[np.ndarray, np.ndarray]:
    return np.atleast_1d(ball.centre), np.atleast_1d(ball.radius)


def _halved(curve: QuadCurve, low: float, high: float, sign: int) -> tuple[float, float]:
    """Return the half in which the first loop closes."""
    middle = 0.5 * (low + high)
    at = _mismatch_at(curve, middle) * sign
    return (low, middle) if at > 0 else (middle, high) if at < 0 else (low, high)


def _mismatch_at(curve: QuadCurve, theta: float) -> int:
    """Return the sign of the mismatch of the first loop at one state, 0 where it is not certain."""
    x = np.array([theta])
    value = curve.states(Ball(x, np.zeros(1))).mismatch()[0].value
    return int(value.sign[0]) if value.magnitude[0] < FULL_TURN else 0
