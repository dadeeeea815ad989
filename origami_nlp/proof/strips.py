"""All minima of a strip within fold limits (`strip_states`), with a proof.

Each curve is cut into boxes of theta.  The slope U' of the energy has no zero in a box, by its value in the middle and
U'' over the box; or U'' has none, and then U' has one at most, which signs of U' at the ends decide.
"""

from __future__ import annotations

import functools
import itertools
import math
import operator
import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.pattern import Pattern
from origami_nlp.proof.affine import UNIT, variables
from origami_nlp.proof.balls import Ball, exact
from origami_nlp.proof.strip_states import Strip, StripStates, as_strip

HALF_TURN = math.nextafter(math.pi, 0.0)
"""Not above pi, which is between two doubles."""
NARROWEST = 2.0**-44
"""Width of theta below which a box is left open [rad]."""
TOGETHER = 2.0**-30
"""Width of theta within which folds of several vertices pass their limits at once [rad]."""
BEYOND = math.nextafter(0.5 * math.pi, math.inf)
"""Not below pi/2, which is between two doubles."""
FIRST = np.array([-BEYOND, -1.0, -0.1, 0.13, 1.0, BEYOND])
"""Where the first boxes end [rad]: the flat state, theta = 0, is within one, at any depth."""
NONE, RISING, FALLING, OUTSIDE, LIMIT, OPEN = range(6)
"""Kinds of boxes: U' is not 0; U'' > 0; U'' < 0; no state within fold limits; a crease reaches +-pi; undecided."""


@dataclass(frozen=True)
class StripMinimum:
    """A minimum of the energy on a curve.

    Attributes
    ----------
    signs
        Of the folds along the row for theta > 0, [k + 1].
    theta
        Two numbers that it lies between [rad].
    fold_angles
        In the middle, [n] [rad].
    radius
        None of the fold angles differs by more [rad].
    at_limit
        Whether a crease is at +-pi there.
    """

    signs: tuple[int, ...]
    theta: tuple[float, float]
    fold_angles: np.ndarray
    radius: float
    at_limit: bool


@dataclass(frozen=True)
class StripProof:
    """What is proved of a strip within fold limits.

    Attributes
    ----------
    curves
        Curves through the flat state on which all closed states lie.
    minima
        On them, each once.
    maxima
        How many maxima of the energy lie inside the curves.
    undecided
        What is left open: between which fold angles [n], [n], and why.
    boxes, seconds
        Boxes of theta, and the processor time that they took.
    """

    curves: int
    minima: tuple[StripMinimum, ...]
    maxima: int
    undecided: tuple[tuple[np.ndarray, np.ndarray, str], ...]
    boxes: int
    seconds: float


class _StripEnergy:
    """The energy's derivatives U' and U'' along curves with these signs, [k + 1, curves], over boxes of theta."""

    def __init__(self, strip: Strip, pattern: Pattern, signs: np.ndarray) -> None:
        self.strip, self.signs = strip, signs
        self.k, self.rest = pattern.stiffness, pattern.rest
        self.across = [c for v in strip.corners for c in (v.creases[1], v.creases[3])]

    def over(self, curve: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> _ThetaBoxes:
        """Return what is known over boxes on curves of these numbers."""
        middle, half = variables(lower, upper)
        signs = self.signs[:, curve]
        at = StripStates(self.strip, signs, exact(middle))
        box = StripStates(self.strip, signs, Ball(middle, half))
        # phi = phi(middle) + phi' (theta - middle)
        angles = {c: a.widened(box.slopes[c].value.magnitude * half) for c, a in at.angles.items()}
        return _ThetaBoxes(self, at, box, angles, half)

    def first(self, states: StripStates, angles: dict[int, Ball]) -> Ball:
        """Return U' = sum k (phi - rest) phi'."""
        return total(
            exact(self.k[c]) * (phi - exact(self.rest[c])) * states.slopes[c].value
            for c, phi in angles.items()
        )

    def second(self, states: StripStates, angles: dict[int, Ball]) -> Ball:
        """Return U'' = sum k (phi'^2 + (phi - rest) phi'')."""
        return total(
            exact(self.k[c])
            * (
                states.slopes[c].value * states.slopes[c].value
                + (phi - exact(self.rest[c])) * states.slopes[c].slope
            )
            for c, phi in angles.items()
        )


def total(parts: Iterable[Ball]) -> Ball:
    """Sum balls."""
    return functools.reduce(operator.add, parts)


@dataclass(frozen=True, eq=False)
class _ThetaBoxes:
    """States in the middle of boxes and over them, and all fold angles over them."""

    energy: _StripEnergy
    at: StripStates
    box: StripStates
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
        return np.array([~(self.angles[c].magnitude < HALF_TURN) for c in self.energy.across])

    def lifted(self, signs: np.ndarray, passing: np.ndarray) -> dict[int, Ball]:
        """Return folds across the row in the middle, those that pass a limit continued to signs pi, [across, K]."""
        found = {}
        for c, sign, passes in zip(self.energy.across, signs, passing, strict=True):
            a = self.at.angles[c]
            turn = np.where(passes & (sign * a.centre < 0), sign * 2 * math.pi, 0.0)
            found[c] = Ball(a.centre + turn, a.radius + 16 * UNIT)
        return found


def prove_strip(pattern: Pattern, *, boxes: int = 1_000_000, until: float = math.inf) -> StripProof:
    """Find every minimum of the energy of a strip within fold limits, with a proof.

    Parameters
    ----------
    pattern
        Vertices of degree four in a row on flat paper.
    boxes
        At most so many boxes of theta; what is left is undecided.
    until
        Stop then (`time.monotonic`).

    Returns
    -------
    StripProof
        All minima, but for what is undecided.

    Raises
    ------
    OptionError
        If the pattern is no such strip: `why_no_strip` says why.

    Examples
    --------
    >>> from origami_nlp.pattern import make_pattern
    >>> from origami_nlp.proof import prove_strip
    >>> points = [[0, 0], [1, 0.1], [0.2, 1], [-1, 0.3], [-0.3, -1]]
    >>> faces = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)]
    >>> vertex = make_pattern(points, faces).with_springs(stiffness=0.01, rest_angles=[1.0, -0.5, 0.8, 0.9])
    >>> proof = prove_strip(vertex)
    >>> proof.curves, len(proof.minima), proof.undecided
    (2, 2, ())
    """
    pattern.check_no_stops("a proof")
    strip, why = as_strip(pattern)
    if strip is None:
        raise OptionError(f"pattern = {pattern.title}: no strip that can be proved: {why}")
    started = time.process_time()
    k = len(strip.corners)
    signs = np.array([(1, *rest) for rest in itertools.product((1, -1), repeat=k)], float).T
    energy = _StripEnergy(strip, pattern, signs)
    curve = np.repeat(np.arange(signs.shape[1]), len(FIRST) - 1)
    lower, upper = (np.tile(ends, signs.shape[1]) for ends in (FIRST[:-1], FIRST[1:]))
    cover: list[np.ndarray] = []
    examined = 0
    with np.errstate(all="ignore"):
        while len(curve):
            stop = examined + len(curve) > boxes or time.monotonic() > until
            examined += len(curve)
            found = _kinds(energy, curve, lower, upper)
            split = (found[0] == OPEN) & (upper - lower > NARROWEST) & (not stop)
            cover.append(np.array([curve, lower, upper, *found])[:, ~split])
            middle = 0.5 * (lower + upper)[split]
            lower, upper = np.r_[lower[split], middle], np.r_[middle, upper[split]]
            curve = np.r_[curve[split], curve[split]]
        boxes_of = np.concatenate(cover, axis=1)
        order = np.lexsort((boxes_of[1], boxes_of[0]))
        ends = _CurveEnds(energy)
        for number in range(signs.shape[1]):
            ends.along([_Stretch(*b) for b in boxes_of[:, order].T.tolist() if b[0] == number])
        minima = ends.minima()
    seconds = time.process_time() - started
    return StripProof(
        signs.shape[1], tuple(minima), ends.maxima, tuple(ends.open), examined, seconds
    )


def _kinds(
    energy: _StripEnergy, curve: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Return what a `_Stretch` says of each box."""
    boxes = energy.over(curve, lower, upper)
    slope, bend = boxes.slope()
    passing = boxes.passing()
    narrow = boxes.at.narrow
    inside = narrow & ~passing.any(axis=0)
    kind = np.full(len(curve), OPEN)
    kind[inside & (bend.sign > 0)] = RISING
    kind[inside & (bend.sign < 0)] = FALLING
    kind[inside & (slope.sign != 0)] = NONE
    kind[inside & ~boxes.at.closes().all(axis=0)] = OUTSIDE
    # folds that pass a limit, each once, of one vertex one at most: towards larger theta they grow to pi or fall to -pi
    rates = [boxes.box.slopes[c].value for c in energy.across]
    moving = np.array([r.sign for r in rates])
    once = np.array([(r.sign != 0) & (r.magnitude * boxes.half < 1) for r in rates])
    known = (once | ~passing).all(axis=0) & ~(passing[::2] & passing[1::2]).any(axis=0)
    ahead, behind = (boxes.slope(boxes.lifted(s * moving, passing))[0].sign for s in (1.0, -1.0))
    known &= (passing.sum(axis=0) == 1) | (upper - lower <= TOGETHER)
    kind[narrow & passing.any(axis=0) & known & (ahead != 0) & (behind != 0)] = LIMIT
    bits = 2.0 ** np.arange(len(energy.across))
    return kind, slope.sign, ahead, behind, bits @ passing, bits @ (moving > 0)


class _Stretch(NamedTuple):
    """A box of theta of one curve, or several beside each other: its kind, and the sign of U' over it.

    Where folds across the row reach limits: the signs of U' with them continued as towards larger theta, and as towards
    smaller, the sum of 2^i over their numbers i among those across, and over those that grow.
    """

    curve: float
    lower: float
    upper: float
    kind: float
    slope: float
    ahead: float
    behind: float
    passing: float
    growing: float

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
        """Whether all its states close within fold limits."""
        return self.kind in (NONE, RISING, FALLING)

    def joins(self, other: _Stretch) -> bool:
        """Return whether both are of one kind, and say the same."""
        if self.kind == LIMIT:
            passing = int(self.passing)
            grow = int(self.growing) & passing == int(other.growing) & passing
            return grow and self[3:4] + self[5:8] == other[3:4] + other[5:8]
        return self.kind == other.kind and (self.kind != NONE or self.slope == other.slope)


class _CurveEnds:
    """Where the energy has its least values along curves: inside, or where a curve ends."""

    def __init__(self, energy: _StripEnergy) -> None:
        self.energy, self.maxima = energy, 0
        self.open: list[tuple[np.ndarray, np.ndarray, str]] = []
        self._inside: list[_Stretch] = []
        self._limits: list[tuple[_Stretch, float]] = []
        self._ends: list[tuple[int, float]] = []

    def along(self, boxes: list[_Stretch]) -> None:
        """Add what the boxes of a curve show, which cover it."""
        pieces = [boxes[0]]
        for box in boxes[1:]:
            if pieces[-1].joins(box):
                pieces[-1] = pieces[-1]._replace(upper=box.upper)
            else:
                pieces.append(box)
        for before, piece, after in zip([None, *pieces], pieces, [*pieces[1:], None], strict=False):
            if piece.kind == OPEN:
                self._leave(piece, "not decided in the smallest boxes")
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
                sides = [p for p in (before, after) if p is not None and p.valid]
                whole = all(p is None or p.valid or p.kind == OUTSIDE for p in (before, after))
                if whole and not sides and before is not None and after is not None:
                    # each vertex changes once at most: one that is open on both sides is open between them
                    if not (
                        self._closing(piece, piece.lower) | self._closing(piece, piece.upper)
                    ).all():
                        continue
                if len(sides) != 1 or not whole or before is None or after is None:
                    self._leave(piece, "creases reach +-pi together")
                    continue
                toward = 1.0 if sides[0] is before else -1.0
                if toward * (piece.ahead if toward > 0 else piece.behind) < 0:
                    self._limits.append((piece, toward))
            for beyond, x, toward in ((before, piece.lower, -1.0), (after, piece.upper, 1.0)):
                if beyond is None and piece.valid:
                    slope = toward * self._slope(piece, x)
                    if slope == 0:
                        self._leave(piece, "U' is 0 at +-pi, to rounding")
                    elif slope < 0:
                        self._ends.append((int(piece.curve), x))

    def _leave(self, piece: _Stretch, why: str) -> None:
        ends = np.array([piece.lower]), np.array([piece.upper])
        angles = self.energy.over(np.array([int(piece.curve)]), *ends).angles
        low, high = (np.full(len(self.energy.rest), s * math.pi) for s in (-1, 1))
        for crease, a in angles.items():
            low[crease] = np.fmax(-math.pi, a.centre[0] - a.radius[0])
            high[crease] = np.fmin(math.pi, a.centre[0] + a.radius[0])
        self.open.append((low, high, why))

    def _at(self, piece: _Stretch, theta: float) -> _Stretch:
        """Return what is known of one state of a piece."""
        x = np.array([theta])
        found = _kinds(self.energy, np.array([int(piece.curve)]), x, x)
        return _Stretch(piece.curve, theta, theta, *(float(v[0]) for v in found))

    def _slope(self, piece: _Stretch, theta: float) -> float:
        """Return the sign of U' at one state of a piece, 0 where it is not certain."""
        if piece.kind == NONE:
            return piece.slope
        x = np.array([theta])
        return float(self.energy.over(np.array([int(piece.curve)]), x, x).slope()[0].sign[0])

    def _closing(self, piece: _Stretch, theta: float) -> np.ndarray:
        """Return which vertices may close at one state of a piece, [k]."""
        at = self.energy.over(np.array([int(piece.curve)]), *np.array([[theta], [theta]])).at
        return (at.closes() | ~at.narrow)[:, 0]

    def minima(self) -> list[StripMinimum]:
        """Return all minima that were found, each in a narrow box."""
        found = []
        curve = np.array([int(p.curve) for p in self._inside], int)
        boxes = self._narrowed(curve, self._inside, None)
        flat = 0
        for piece, low, high in zip(self._inside, *boxes, strict=True):
            if low <= 0 <= high:  # at the flat state, if U' is 0 there
                if self.energy.rest.any():
                    self._leave(piece, "a minimum at the flat state, or beside it")
                flat += 1
                if flat != self.energy.signs.shape[1]:
                    continue
            found.append(self._state(int(piece.curve), low, high, {}))
        if 0 < flat < self.energy.signs.shape[1]:
            self._leave(self._inside[0], "the flat state is a minimum of some of its curves only")
        limits = [piece for piece, _ in self._limits]
        curve = np.array([int(p.curve) for p in limits], int)
        held = [piece.at_limits(toward) for piece, toward in self._limits]
        boxes = self._narrowed(curve, limits, [next(iter(folds.items())) for folds in held])
        for piece, folds, low, high in zip(limits, held, *boxes, strict=True):
            at = {self.energy.across[i]: side * math.pi for i, side in folds.items()}
            found.append(self._state(int(piece.curve), low, high, at))
        return found + [self._state(curve, x, x, {-1: 0.0}) for curve, x in self._ends]

    def _narrowed(
        self, curve: np.ndarray, pieces: list[_Stretch], first: list[tuple[int, float]] | None
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
            boxes = self.energy.over(curve, low, high)
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

    def _state(self, curve: int, low: float, high: float, held: dict[int, float]) -> StripMinimum:
        """Return the state in a narrow box, creases across the row held at limits."""
        boxes = self.energy.over(np.array([curve]), np.array([low]), np.array([high]))
        phi, radius = np.zeros(len(self.energy.rest)), 0.0
        for crease, angle in boxes.angles.items():
            phi[crease] = held.get(crease, np.clip(angle.centre[0], -math.pi, math.pi))
            radius = max(radius, float(angle.radius[0]))
        signs = tuple(int(s) for s in self.energy.signs[:, curve])
        return StripMinimum(signs, (float(low), float(high)), phi, radius, bool(held))
