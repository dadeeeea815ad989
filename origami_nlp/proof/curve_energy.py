"""The energy along curves over boxes: its slope, fold limits and contact, as far as certain."""

from __future__ import annotations

import functools
import math
import operator
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from origami_nlp.pattern import Pattern
from origami_nlp.proof.balls import Ball, exact
from origami_nlp.proof.curve_contact import (
    APART,
    CROSSING,
    TOUCHING,
    UNKNOWN,
    CurveContact,
    FacetTouch,
)
from origami_nlp.proof.law_torques import LawPieces
from origami_nlp.proof.quad_states import QuadCurve, QuadStates
from origami_nlp.proof.rows import SLIGHTLY, UNIT, variables

HALF_TURN = math.nextafter(math.pi, 0.0)
"""Not above pi, which is between two doubles."""
TOGETHER = 2.0**-30
"""Width of theta within which folds of several vertices pass their limits at once [rad]."""
FARTHEST = 8.0
"""Radius of a fold angle of which nothing is known any more [rad]."""
NONE, RISING, FALLING, OUTSIDE, LIMIT, OPEN = range(6)
"""Kinds of boxes: U' is not 0; U'' > 0; U'' < 0; no state within fold limits; a crease reaches +-pi; undecided."""


class Stop(NamedTuple):
    """A fold limit within +-180 degrees: of a crease, on a side, +1 for the upper one."""

    crease: int
    side: float
    at: float


class StopTouch(NamedTuple):
    """A crease that reaches a stop within a box, on a side; how far it is from there grows with theta or falls."""

    crease: int
    side: float
    slope: float


class ThetaEnergy:
    """The energy's derivatives U' and U'' along a curve, over boxes of theta."""

    def __init__(self, along: QuadCurve, pattern: Pattern) -> None:
        self.curve = along
        self.k, self.rest = pattern.stiffness, pattern.rest
        self.across = along.across
        laws = pattern.laws or (None,) * pattern.creases
        self.laws = [None if law is None else LawPieces(law, 0.0, 1.0) for law in laws]
        self.stops = [
            Stop(c, side, float(pattern.limit_angles[row, c]))
            for c in range(pattern.creases)
            for row, side in ((0, -1.0), (1, 1.0))
            if abs(pattern.limit_angles[row, c]) < HALF_TURN
        ]
        self.limits = pattern.limit_angles

    @property
    def rests_flat(self) -> bool:
        """Whether all torques are 0 in the flat state exactly."""
        return not self.rest.any() and not any(self.laws)

    def over(self, lower: np.ndarray, upper: np.ndarray) -> ThetaBoxes:
        """Return what is known over boxes."""
        middle, half = variables(lower, upper)
        at = self.curve.states(exact(middle))
        box = self.curve.states(Ball(middle, half), at)
        # phi = phi(middle) + phi' (theta - middle)
        angles = {c: a.widened(box.slopes[c].value.magnitude * half) for c, a in at.angles.items()}
        return ThetaBoxes(self, at, box, angles, half)

    def first(self, states: QuadStates, angles: dict[int, Ball]) -> Ball:
        """Return U' = sum k (phi - rest) phi'."""
        return total(self.torque(c, phi) * states.slopes[c].value for c, phi in angles.items())

    def second(self, states: QuadStates, angles: dict[int, Ball]) -> Ball:
        """Return U'' = sum k (phi'^2 + (phi - rest) phi'')."""
        return total(
            self._stiffness(c, phi) * states.slopes[c].value * states.slopes[c].value
            + self.torque(c, phi) * states.slopes[c].slope
            for c, phi in angles.items()
        )

    def torque(self, crease: int, phi: Ball) -> Ball:
        """Return the torque at fold angles."""
        law = self.laws[crease]
        if law is None:
            return exact(self.k[crease]) * (phi - exact(self.rest[crease]))
        known = np.isfinite(phi.centre) & (phi.radius < FARTHEST)
        at = np.where(known, phi.centre, 0.0), np.where(known, phi.radius, 0.0)
        centre, slope, error = law.over(*(np.atleast_1d(x) for x in at))
        return Ball(centre, np.where(known, (np.abs(slope) + error) * SLIGHTLY, np.nan))

    def _stiffness(self, crease: int, phi: Ball) -> Ball:
        """Return the slopes of the torque over fold angles, on both sides of what is a knot."""
        law = self.laws[crease]
        if law is None:
            return exact(self.k[crease])
        known = np.isfinite(phi.centre) & (phi.radius < FARTHEST)
        centre, radius = np.where(known, phi.centre, 0.0), np.where(known, phi.radius, 0.0)
        ends = np.nextafter(centre - radius, -np.inf), np.nextafter(centre + radius, np.inf)
        least, most = law.slopes(*(np.atleast_1d(x) for x in ends))
        middle = 0.5 * (least + most)
        size = np.maximum(most - middle, middle - least) + law.ripple + 4 * UNIT * np.abs(middle)
        return Ball(middle, np.where(known, size * SLIGHTLY, np.nan))


def total(parts: Iterable[Ball]) -> Ball:
    """Sum balls."""
    return functools.reduce(operator.add, parts)


@dataclass(frozen=True, eq=False)
class ThetaBoxes:
    """States in the middle of boxes and over them, and all fold angles over them."""

    energy: ThetaEnergy
    at: QuadStates
    box: QuadStates
    angles: dict[int, Ball]
    half: np.ndarray

    def slope(self, lifted: dict[int, Ball] | None = None) -> tuple[Ball, Ball]:
        """Return U' over the boxes, from its middle and U'', and U''; folds in the middle may be lifted by 2 pi."""
        middle = self.at.angles | (lifted or {})
        moved = {
            c: a.widened(self.box.slopes[c].value.magnitude * self.half)
            for c, a in (lifted or {}).items()
        }
        bend = self.energy.second(self.box, self.angles | moved)
        first = self.energy.first(self.at, middle)
        return first.widened(bend.magnitude * self.half), bend

    def reaching(self, across: np.ndarray, sides: np.ndarray) -> tuple[Ball, Ball]:
        """Return how far in the middle a fold across the row, [K], is beyond sides pi, and its slope over the boxes."""
        value, rate = [], []
        for i, (a, s) in enumerate(zip(across.tolist(), sides.tolist(), strict=True)):
            crease = self.energy.across[a]
            phi, slope = self.at.angles[crease], self.box.slopes[crease].value
            here = phi.centre[i] + (s * 2 * math.pi if s * phi.centre[i] < 0 else 0.0)
            value.append((here - s * math.pi, phi.radius[i] + 16 * UNIT))
            rate.append((slope.centre[i], slope.radius[i]))
        return Ball(*np.array(value).T), Ball(*np.array(rate).T)

    def passing(self) -> np.ndarray:
        """Return which folds across the row may be at +-pi, [creases across, K]; where nothing is known, too."""
        found = [~(self.angles[c].magnitude < HALF_TURN) for c in self.energy.across]
        return np.array(found, bool).reshape(len(self.energy.across), len(self.half))

    def leaving(self, moving: np.ndarray) -> np.ndarray:
        """Return which folds across the row, moving up or down, certainly come from a limit or do not get to theirs,
        [across, K].
        """
        found = []
        for c, sign in zip(self.energy.across, moving, strict=True):
            a, rate = self.at.angles[c], self.box.slopes[c].value
            ends = [a + exact(s * self.half) * rate for s in (-1.0, 1.0)]
            within = [e.magnitude < HALF_TURN for e in ends]
            found.append(
                (within[0] & (ends[0].sign == -sign)) | (within[1] & (ends[1].sign == sign))
            )
        return np.array(found, bool).reshape(len(self.energy.across), len(self.half))

    def gap(self, stop: Stop) -> Ball:
        """Return how far a fold is from a stop over the boxes, negative beyond it."""
        return exact(stop.side) * (exact(stop.at) - self.angles[stop.crease])

    def stops(self) -> tuple[np.ndarray, list[StopTouch], np.ndarray, np.ndarray]:
        """Return where a fold is beyond a stop certainly, [K]; the stops, whether each may be reached, and how the room
        there changes, [S, K].
        """
        energy, none = self.energy, np.zeros((0, len(self.half)))
        beyond, met, slopes, touches = np.zeros(len(self.half), bool), [], [], []
        for stop in energy.stops:
            gap = self.gap(stop)
            # seen once round, too: fold angles are known modulo a full turn
            low, high = energy.limits[:, stop.crease]
            other = exact(stop.side) * (
                exact(low if stop.side > 0 else high) - self.angles[stop.crease]
            )
            beyond |= (gap.sign < 0) & ((other + exact(2 * math.pi)).sign > 0)
            met.append(gap.sign <= 0)
            slopes.append(-stop.side * self.box.slopes[stop.crease].value.sign)
            touches.append(StopTouch(stop.crease, stop.side, 0.0))
        return beyond, touches, np.array(met or none, bool), np.array(slopes or none)

    def lifted(self, signs: np.ndarray, passing: np.ndarray) -> dict[int, Ball]:
        """Return folds across the row in the middle, those that pass a limit continued to signs pi, [across, K]."""
        found = {}
        for c, sign, passes in zip(self.energy.across, signs, passing, strict=True):
            a = self.at.angles[c]
            turn = np.where(passes & (sign * a.centre < 0), sign * 2 * math.pi, 0.0)
            found[c] = Ball(a.centre + turn, a.radius + 16 * UNIT)
        return found


class ThetaStretch(NamedTuple):
    """A box of theta, or several beside each other: its kind, and the sign of U' over it.

    Where folds across the row reach limits: the signs of U' with them continued as towards larger theta, and as towards
    smaller, the sum of 2^i over their numbers i among those across, and over those that grow.
    """

    lower: float
    upper: float
    kind: float
    slope: float
    ahead: float
    behind: float
    passing: float
    growing: float
    contact: float

    def at_limits(self, toward: float) -> dict[int, float]:
        """Return which folds across the row pass limits, and +-1 for the limit, coming from smaller theta (1) or larger
        (-1).
        """
        return {
            i: toward * (1.0 if int(self.growing) >> i & 1 else -1.0)
            for i in range(int(self.passing).bit_length())
            if int(self.passing) >> i & 1
        }

    @property
    def valid(self) -> bool:
        """Whether all its states close within fold limits, and no facets cross in all or some of them."""
        return self.closes and self.contact != CROSSING

    @property
    def closes(self) -> bool:
        """Whether all its states close within fold limits."""
        return self.kind in (NONE, RISING, FALLING)

    def joins(self, other: ThetaStretch) -> bool:
        """Return whether both are of one kind, and say the same."""
        if self.contact != other.contact or self.contact == TOUCHING:
            return False
        if self.kind == LIMIT:
            passing = int(self.passing)
            grow = int(self.growing) & passing == int(other.growing) & passing
            return grow and self[2:3] + self[4:7] == other[2:3] + other[4:7]
        return self.kind == other.kind and (self.kind != NONE or self.slope == other.slope)


def kinds_of_boxes(
    energy: ThetaEnergy,
    lower: np.ndarray,
    upper: np.ndarray,
    contact: CurveContact | None,
    touches: dict[tuple[float, float], tuple[FacetTouch | StopTouch, ...]],
) -> tuple[np.ndarray, ...]:
    """Return what a `ThetaStretch` says of each box; where facets meet is added to the touches."""
    boxes = energy.over(lower, upper)
    slope, bend = boxes.slope()
    passing = boxes.passing()
    narrow = boxes.at.narrow
    inside = narrow & ~passing.any(axis=0)
    kind = np.full(len(lower), OPEN)
    kind[inside & (bend.sign > 0)] = RISING
    kind[inside & (bend.sign < 0)] = FALLING
    kind[inside & (slope.sign != 0)] = NONE
    kind[inside & ~boxes.at.closes().all(axis=0)] = OUTSIDE
    # folds that pass a limit, each once, of one vertex one at most: towards larger theta they grow to pi or fall to -pi
    rates = [boxes.box.slopes[c].value for c in energy.across]
    moving = np.array([r.sign for r in rates], float).reshape(passing.shape)
    once = np.array([(r.sign != 0) & (r.magnitude * boxes.half < 1) for r in rates], bool)
    once = once.reshape(passing.shape)
    known = (once | ~passing).all(axis=0)
    for one, other in energy.curve.beside:
        known &= ~(passing[one] & passing[other])
    ahead, behind = (boxes.slope(boxes.lifted(s * moving, passing))[0].sign for s in (1.0, -1.0))
    # several at once: each reaches its limit or is past it, none leaves one or is still to come to it
    together = ~(passing & boxes.leaving(moving)).any(axis=0) & (upper - lower <= TOGETHER)
    known &= (passing.sum(axis=0) == 1) | together
    kind[narrow & passing.any(axis=0) & known & (ahead != 0) & (behind != 0)] = LIMIT
    beyond, stops, met, opening = boxes.stops()
    reached = met.any(axis=0) & ~beyond
    kind[reached & (kind == LIMIT)] = OPEN
    kind[beyond | boxes.box.outside] = OUTSIDE
    bits = 2.0 ** np.arange(len(energy.across))
    status = np.full(len(lower), APART)
    asked = np.flatnonzero((kind != OPEN) & (kind != OUTSIDE))
    if contact is not None and len(asked):
        few = len(asked) < len(lower)
        some = energy.over(lower[asked], upper[asked]) if few else boxes
        facets = contact.facets(some.at, some.box, some.angles, some.half)
        status[asked], found = contact.over(facets, some.angles, (upper - lower)[asked])
        for k, touch in found.items():
            i = int(asked[k])
            if kind[i] == NONE:
                touches[float(lower[i]), float(upper[i])] = touch
            else:
                status[i] = UNKNOWN
    for i in np.flatnonzero(
        reached & ((kind == RISING) | (kind == FALLING) | (kind == NONE))
    ).tolist():
        box = float(lower[i]), float(upper[i])
        both = touches.pop(box, ()) + tuple(
            s._replace(slope=float(o))
            for s, m, o in zip(stops, met[:, i], opening[:, i], strict=True)
            if m
        )
        ways = {t.slope for t in both}
        if status[i] in (APART, TOUCHING):
            one_way = kind[i] == NONE and len(ways) == 1 and 0.0 not in ways
            status[i] = TOUCHING if one_way else UNKNOWN
        if status[i] == TOUCHING:
            touches[box] = both
        elif status[i] == UNKNOWN:
            kind[i] = OPEN  # no facet that is asked of the end of a curve: creases at stops
    return kind, slope.sign, ahead, behind, bits @ passing, bits @ (moving > 0), status
