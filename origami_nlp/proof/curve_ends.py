"""Where the energy has its least values along curves: inside, where facets meet, or where a curve ends."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.proof.balls import Ball
from origami_nlp.proof.curve_contact import (
    APART,
    CROSSING,
    TOUCHING,
    UNKNOWN,
    CurveContact,
    FacetTouch,
)
from origami_nlp.proof.curve_energy import (
    FALLING,
    LIMIT,
    NONE,
    OPEN,
    OUTSIDE,
    RISING,
    Stop,
    StopTouch,
    ThetaEnergy,
    ThetaStretch,
    kinds_of_boxes,
)
from origami_nlp.proof.flat_sheets import SheetMinimum
from origami_nlp.proof.rows import UNIT, variables

AT_LIMIT = "whether facets cross where a crease is at +-pi is not decided"
BALL = ("centre", "radius")
WIDEST = 1e-6
"""Radius within which a minimum is listed, at most [rad]: a wider one names no state."""


@dataclass(frozen=True, kw_only=True)
class CurveMinimum(SheetMinimum):
    """A minimum of the energy on a curve, fold angles in the middle of theta.

    Attributes
    ----------
    theta
        Two numbers that it lies between [rad].
    at_limit
        Whether a crease is at +-pi there.
    touching
        Pairs of facets (polygons of the pattern, from 0) that hold it; none but with contact.
    stops
        Creases (from 0) at stops within +-180 degrees that hold it, each with the side, +1 for the upper one.
    """

    theta: tuple[float, float]
    at_limit: bool
    touching: tuple[tuple[int, int], ...] = ()
    stops: tuple[tuple[int, int], ...] = ()


class CurveEnds:
    """Where the energy has its least values along curves: inside, or where a curve ends."""

    def __init__(
        self,
        energy: ThetaEnergy,
        contact: CurveContact | None,
        touches: dict[tuple[float, float], tuple[FacetTouch | StopTouch, ...]],
    ) -> None:
        self.energy, self.maxima = energy, 0
        self.contact, self.touches = contact, touches
        self.open: list[tuple[np.ndarray, np.ndarray, str]] = []
        self._inside: list[ThetaStretch] = []
        self._limits: list[tuple[ThetaStretch, float]] = []
        self._ends: list[float] = []
        self._held: list[ThetaStretch] = []

    def along(self, boxes: list[ThetaStretch]) -> None:
        """Add what the boxes of a curve show, which cover it."""
        pieces = [boxes[0]]
        for box in boxes[1:]:
            if pieces[-1].joins(box):
                pieces[-1] = pieces[-1]._replace(upper=box.upper)
            else:
                pieces.append(box)
        for before, piece, after in zip([None, *pieces], pieces, [*pieces[1:], None], strict=False):
            if self._is_end(piece):
                toward = 1.0 if piece.upper > 0 else -1.0
                driven = self.energy.curve.driven
                contact = self._limit_contact(piece, {c: toward * s for c, s in driven.items()})
                beside = before if piece.upper > 0 else after
                if contact == CROSSING and beside is not None and beside.contact == CROSSING:
                    continue
                if contact != APART:
                    self._leave(piece, AT_LIMIT)
                    continue
            elif piece.kind == OPEN:
                self._leave(piece, "not decided in the smallest boxes")
            elif piece.contact == CROSSING or piece.kind == OUTSIDE:
                continue
            elif piece.contact == UNKNOWN:
                self._leave(
                    piece,
                    "whether facets cross, or creases are at stops, is not decided in the smallest boxes",
                )
                continue
            elif piece.contact == TOUCHING and piece.kind != LIMIT:
                self._touch(piece, before is None, after is None)
                continue
            elif piece.kind in (RISING, FALLING):
                low, high = (self._slope(piece, x) for x in (piece.lower, piece.upper))
                if low * high == 0:
                    self._leave(piece, "U' is 0 at an end, to rounding")
                elif low != high:
                    self._inside += [piece] * (piece.kind == RISING)
                    self.maxima += piece.kind == FALLING
            elif piece.kind == LIMIT:
                # another crease reaches its limit in the next box: what is between them, at one state
                before, after = (
                    self._at(p, x) if p is not None and p.kind == LIMIT else p
                    for p, x in ((before, piece.lower), (after, piece.upper))
                )
                sides = [p for p in (before, after) if p is not None and p.closes]
                whole = all(p is None or p.closes or p.kind == OUTSIDE for p in (before, after))
                if whole and not sides and before is not None and after is not None:
                    # each vertex changes once at most: one that is open on both sides is open between them
                    if not (
                        self._closing(piece, piece.lower) | self._closing(piece, piece.upper)
                    ).all():
                        continue
                if len(sides) == 2 and piece.contact == APART:
                    continue  # so that no fold passes, and U' is not 0
                if len(sides) != 1 or not whole or before is None or after is None:
                    self._leave(piece, "creases reach +-pi together")
                    continue
                toward = 1.0 if sides[0] is before else -1.0
                folds = piece.at_limits(toward)
                held = {self.energy.across[i]: side for i, side in folds.items()}
                contact = self._limit_contact(piece, held) if piece.contact == TOUCHING else APART
                if contact == CROSSING and sides[0].contact == CROSSING:
                    continue
                if contact != APART:
                    self._leave(piece, AT_LIMIT)
                    continue
                if toward * (piece.ahead if toward > 0 else piece.behind) < 0:
                    self._limits.append((piece, toward))
            for beyond, x, toward in ((before, piece.lower, -1.0), (after, piece.upper, 1.0)):
                if beyond is None and piece.valid:
                    slope = toward * self._slope(piece, x)
                    if slope == 0:
                        self._leave(piece, "U' is 0 at +-pi, to rounding")
                    elif slope < 0:
                        self._ends.append(x)

    def _is_end(self, piece: ThetaStretch) -> bool:
        """Whether facets come to lie on each other at the end of a curve, where the fold that gives it is at +-pi."""
        return piece.contact == TOUCHING and piece.kind == NONE and piece[:2] not in self.touches

    def _touch(self, piece: ThetaStretch, first: bool, last: bool) -> None:
        """Add the state of a piece where two facets meet, if the energy falls towards it, and the end of a curve."""
        touch = self.touches[piece[:2]]
        low, high = (self._gap(piece, touch, x) for x in (piece.lower, piece.upper))
        if low * high == 0:
            self._leave(piece, "whether facets cross at an end of a box is not decided")
            return
        if (low < 0 < high and piece.slope > 0) or (high < 0 < low and piece.slope < 0):
            self._held.append(piece)
        # U' has one sign over the piece
        if first and low > 0 and piece.slope > 0:
            self._ends.append(piece.lower)
        if last and high > 0 and piece.slope < 0:
            self._ends.append(piece.upper)

    def _limit_contact(self, piece: ThetaStretch, held: dict[int, float]) -> int:
        """Return what is known of facets at the state of a piece where creases reach their limits from one side."""
        ends = np.array([[piece.lower], [piece.upper]])
        boxes = self.energy.over(*ends)
        assert self.contact is not None
        facets = self.contact.facets(boxes.at, boxes.box, boxes.angles, boxes.half)
        return self.contact.at_limits(facets, boxes.angles, held)

    def _gaps(
        self, piece: ThetaStretch, touch: tuple[FacetTouch | StopTouch, ...], theta: float
    ) -> Ball:
        """Return the gaps of facets that meet at one state of a piece, then what is left of stops."""
        at = self.energy.over(*np.array([[theta], [theta]]))
        facets = tuple(t for t in touch if isinstance(t, FacetTouch))
        found = [at.gap(self._stop(t)) for t in touch if isinstance(t, StopTouch)]
        if facets:
            assert self.contact is not None
            found = [self.contact.gaps(facets, at.at), *found]
        return Ball(*(np.concatenate([getattr(b, x).ravel() for b in found]) for x in BALL))

    def _stop(self, touch: StopTouch) -> Stop:
        return next(s for s in self.energy.stops if s[:2] == touch[:2])

    def _gap(
        self, piece: ThetaStretch, touch: tuple[FacetTouch | StopTouch, ...], theta: float
    ) -> float:
        """Return the least sign of their gaps at one state, 0 where it is not certain."""
        return float(self._gaps(piece, touch, theta).sign.min())

    def _leave(self, piece: ThetaStretch, why: str) -> None:
        self._leave_open(piece.lower, piece.upper, why)

    def _leave_open(self, lower: float, upper: float, why: str) -> None:
        angles = self.energy.over(*np.array([[lower], [upper]])).angles
        low, high = (np.full(len(self.energy.rest), s * math.pi) for s in (-1, 1))
        for crease, a in angles.items():
            low[crease] = np.fmax(-math.pi, a.centre[0] - a.radius[0])
            high[crease] = np.fmin(math.pi, a.centre[0] + a.radius[0])
        self.open.append((low, high, why))

    def _at(self, piece: ThetaStretch, theta: float) -> ThetaStretch:
        """Return what is known of one state of a piece."""
        x = np.array([theta])
        found = kinds_of_boxes(self.energy, x, x, self.contact, {})
        return ThetaStretch(theta, theta, *(float(v[0]) for v in found))

    def _slope(self, piece: ThetaStretch, theta: float) -> float:
        """Return the sign of U' at one state of a piece, 0 where it is not certain."""
        if piece.kind == NONE:
            return piece.slope
        x = np.array([theta])
        # an end of the curve is between two doubles
        inner = np.where(np.abs(x) > 0.5 * math.pi, np.nextafter(x, 0.0), x)
        low, high = np.fmin(x, inner), np.fmax(x, inner)
        return float(self.energy.over(low, high).slope()[0].sign[0])

    def _closing(self, piece: ThetaStretch, theta: float) -> np.ndarray:
        """Return which vertices may close at one state of a piece, [k]."""
        at = self.energy.over(*np.array([[theta], [theta]])).at
        return (at.closes() | ~at.narrow)[:, 0]

    def minima(self) -> list[CurveMinimum]:
        """Return all minima that were found, each in a narrow box."""
        found = []
        boxes = self._narrowed(self._inside, None)
        for piece, low, high in zip(self._inside, *boxes, strict=True):
            if low <= 0 <= high and self.energy.rests_flat:
                flat = np.zeros(len(self.energy.rest))
                found.append(
                    CurveMinimum(flat, 0.0, theta=(float(low), float(high)), at_limit=False)
                )
                continue
            if low <= 0 <= high:
                self._leave(piece, "a minimum at the flat state, or beside it")
            found.append(self._state(low, high, {}))
        limits = [piece for piece, _ in self._limits]
        held = [piece.at_limits(toward) for piece, toward in self._limits]
        boxes = self._narrowed(limits, [next(iter(folds.items())) for folds in held])
        for folds, low, high in zip(held, *boxes, strict=True):
            at = {self.energy.across[i]: side * math.pi for i, side in folds.items()}
            found.append(self._state(low, high, at))
        found += [self._state(x, x, {-1: 0.0}) for x in self._ends]
        found += [self._held_state(piece) for piece in self._held]
        for one in found:
            if not one.radius <= WIDEST:
                self._leave_open(*one.theta, "the fold angles of a minimum")
        return [one for one in found if one.radius <= WIDEST]

    def _held_state(self, piece: ThetaStretch) -> CurveMinimum:
        """Return the state of a piece where two facets meet, in a narrow box."""
        # facets first, as their gaps are
        touch = tuple(sorted(self.touches[piece[:2]], key=lambda t: isinstance(t, StopTouch)))
        low, high = piece.lower, piece.upper
        while (middle := 0.5 * (low + high)) not in (low, high):
            side = self._gap(piece, touch, middle) * touch[0].slope
            if side == 0:
                break
            low, high = (low, middle) if side > 0 else (middle, high)
        # which of them meet there, and where to rounding: the middle may be off by more than a touch is judged by
        gaps = [self._gaps(piece, touch, x) for x in (low, high)]
        first, last = (g.centre for g in gaps)
        meet = (gaps[0].sign <= 0) | (gaps[1].sign <= 0)
        zeros = (low + (high - low) * np.clip(first / (first - last), 0, 1))[meet]
        zero = float(zeros.max() if touch[0].slope > 0 else zeros.min())
        box = self._state(low, high, {})
        at = self._state(zero, zero, {})
        held = [t for t, m in zip(touch, meet, strict=True) if m]
        stops = [self._stop(t) for t in held if isinstance(t, StopTouch)]
        phi = at.fold_angles.copy()
        phi[[s.crease for s in stops]] = [s.at for s in stops]
        far = float(np.abs(phi - box.fold_angles).max())
        return replace(
            at,
            theta=box.theta,
            fold_angles=phi,
            radius=box.radius + far,
            touching=tuple(t.polygons for t in held if isinstance(t, FacetTouch)),
            stops=tuple((s.crease, int(s.side)) for s in stops),
        )

    def _narrowed(
        self, pieces: list[ThetaStretch], first: list[tuple[int, float]] | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of theta after interval Newton steps: for U' = 0, or for the first fold at its limit."""
        low, high = (np.array([getattr(p, end) for p in pieces]) for end in ("lower", "upper"))
        across, sides = np.array(first or [(0, 0.0)]).T
        grows = [
            1.0 if int(p.growing) >> int(i) & 1 else -1.0
            for p, i in zip(pieces, across, strict=False)
        ]
        rising = np.array(grows) if first else np.ones(len(pieces))
        for _ in range(40 * bool(pieces)):
            boxes = self.energy.over(low, high)
            middle, _ = variables(low, high)
            if first is None:
                value, rate = self.energy.first(boxes.at, boxes.at.angles), boxes.slope()[1]
            else:
                value, rate = boxes.reaching(across.astype(int), sides)
            step = value * rate.inverse()
            root = Ball(middle - step.centre, step.radius + 4 * UNIT)
            # where the slope over the box is not certain, the half that the sign in the middle points to
            beyond = value.sign * rising
            new_low = np.where(beyond < 0, middle, np.fmax(low, root.centre - root.radius))
            new_high = np.where(beyond > 0, middle, np.fmin(high, root.centre + root.radius))
            shrunk = new_high - new_low < 0.9 * (high - low)
            low, high = np.fmax(low, new_low), np.fmin(high, new_high)
            if not shrunk.any():
                break
        return low, high

    def _state(self, low: float, high: float, held: dict[int, float]) -> CurveMinimum:
        """Return the state in a narrow box, creases across the row held at limits."""
        boxes = self.energy.over(np.array([low]), np.array([high]))
        phi, radius = np.zeros(len(self.energy.rest)), 0.0
        for crease, angle in boxes.angles.items():
            phi[crease] = held.get(crease, np.clip(angle.centre[0], -math.pi, math.pi))
            radius = max(radius, float(angle.radius[0]))
        return CurveMinimum(phi, radius, theta=(float(low), float(high)), at_limit=bool(held))
