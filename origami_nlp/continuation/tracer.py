"""Continuation of a curve in its arclength: predictor, corrector, step control, and what ends it.

A curve is anything that moves a point near it onto it (`CurveProblem.correct`) and says where it goes there
(`CurveProblem.frame`): states with contacts held, later states and a load together.  Nothing of an energy or of a
vertex enters.  Lengths are those of the metric y = root x; with unit tangent y' and bend y'' the predictor is y + h y'
+ h^2 y'' / 2, and the corrector steps across the curve (pseudo-arclength continuation), so that limit points need no
special care.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from origami_nlp.arguments import check_number, check_whole
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.numerics import NONZERO, ROUNDED, SETTLED

CLOSED_CURVE = "closed curve"
"""Why a curve ends that comes back to its first point."""
SINGULAR = "singular: closure or contacts lose rank, or no solution beyond"
"""Why a curve ends where even the shortest step fails, or turns too far."""
ALIGNED = 0.9
"""A curve is closed where it comes back with tangents whose scalar product is larger: it may also cross itself."""


ASIDE = 0.3
"""The corrector moves a point by a smaller share of the step: one that it moves further lies on another curve."""

TOWARDS_AN_END = 0.75
"""Each accepted step towards an end over the one before: a half would reach it only if steps had no bend."""


class CurveFrame(Protocol):
    """Where a curve is and where it goes: x [n], unit tangent y' and bend y'' [n] in the metric."""

    @property
    def x(self) -> np.ndarray: ...  # noqa: D102
    @property
    def tangent(self) -> np.ndarray: ...  # noqa: D102
    @property
    def bend(self) -> np.ndarray: ...  # noqa: D102


F = TypeVar("F", bound=CurveFrame)
F_co = TypeVar("F_co", bound=CurveFrame, covariant=True)


class CurveProblem(Protocol[F_co]):
    """What is traced; `root` [n] is its metric."""

    @property
    def root(self) -> np.ndarray: ...  # noqa: D102
    def correct(self, x: np.ndarray) -> np.ndarray | None:
        """Move x [n] onto the curve; None if that fails."""

    def frame(self, x: np.ndarray, along: np.ndarray) -> F_co | None:
        """Return where the curve goes at x, its tangent on the side of `along` [n] (metric); None where it does not."""


@dataclass(frozen=True)
class ContinuationOptions:
    """How a curve is followed; lengths are those of its metric, the root of the stiffnesses over their mean [rad].

    Attributes
    ----------
    first, longest, shortest
        Steps of the predictor; events are bisected to the shortest.
    turn, sharpest
        The tangent turns by about the first [rad] a step; a step that turns it by more than the second is halved.
    growth
        Longest step over the one before.
    corrector
        Steps of Newton that bring a predicted point back onto a curve of equilibria.
    aside
        A corrector that moves a point by more than this share of the step went to another curve: the step is halved.
    together
        Steps made before ends are looked for, in all of them at once.
    most
        Points of a curve one way, and of an arc between events.
    arcs
        Arcs that are followed from one state on.
    far
        Length of a curve one way [rad].
    until
        Time of `time.monotonic` after which no further step is made.

    Raises
    ------
    OptionError
        If a field is not what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> fine = o.ContinuationOptions(longest=0.02, turn=0.02)
    >>> path = o.load_path(o.examples.degree6("5*pi/12"), 1, to=0.05, options=fine)
    >>> [(event.type, round(event.t, 6)) for event in path.events]
    [('closes', 0.042461)]
    """

    first: float = 1e-3
    longest: float = 0.1
    shortest: float = 1e-9
    turn: float = 0.1
    sharpest: float = 0.3
    growth: float = 2.0
    corrector: int = 10
    aside: float = ASIDE
    together: int = 1
    most: int = 2000
    arcs: int = 400
    far: float = math.inf
    until: float = math.inf

    def __post_init__(self) -> None:
        check_number("shortest", self.shortest, ROUNDED)
        for name in ("first", "longest"):
            check_number(name, getattr(self, name), self.shortest)
        check_number("turn", self.turn, SETTLED, math.pi)
        check_number("sharpest", self.sharpest, self.turn, 2 * math.pi)
        check_number("growth", self.growth, 1.0)
        check_number("aside", self.aside, SETTLED, 1.0)
        for name in ("corrector", "together", "most", "arcs"):
            check_whole(name, getattr(self, name), 1)


@dataclass(frozen=True)
class End(Generic[F]):
    """What ends a curve inside a step.

    before: how many of the given points, in order, come before it; all of them where it does not come.
    why: in words.  meet: the end itself between the last point before it and the first one after (that last point,
    where it is at the end), or None; then, as without it, the step is bisected.
    """

    before: Callable[[Sequence[F]], int]
    why: str
    meet: Callable[[F, F], F | None] | None = None


@dataclass(frozen=True)
class Trace(Generic[F]):
    """A traced curve: points in order, arclength s [m], 0 at the point it was started from, and why it ends.

    behind: how many points lie behind that one; their tangents point to smaller s.
    """

    frames: tuple[F, ...]
    s: np.ndarray
    start: str
    end: str
    behind: int

    @property
    def states(self) -> np.ndarray:
        """Its points, [m, n]."""
        return np.array([frame.x for frame in self.frames])

    @property
    def signs(self) -> np.ndarray:
        """1 where the tangent points to larger s, -1 where to smaller, [m]."""
        return np.where(np.arange(len(self.s)) < self.behind, -1.0, 1.0)


@dataclass(frozen=True)
class _TracedStep(Generic[F]):
    frame: F
    length: float  # arclength of the step
    tried: float


def advance(
    curve: CurveProblem[F], frame: F, h: float, aside: float = ASIDE
) -> tuple[F, float] | None:
    """Take one predictor-corrector step of arclength about h; return the new frame and the arclength; None if that
    fails.

    The arclength is exact to O(h^5); without a bend it is the chord.
    """
    root = curve.root
    # Taylor to second order; lengths are those of y = root x, states are x
    ahead = frame.x + (h * frame.tangent + 0.5 * h * h * frame.bend) / root
    x = curve.correct(ahead)
    if x is None or np.linalg.norm(root * (x - ahead)) > aside * h:
        return None
    along = frame.tangent + h * frame.bend
    new = curve.frame(x, along / np.linalg.norm(along))
    if new is None:
        return None
    good = 0.5 * h <= np.linalg.norm(root * (x - frame.x)) <= 2 * h
    return (new, _arc(root, frame, new)) if good else None


def _arc(root: np.ndarray, a: CurveFrame, b: CurveFrame) -> float:
    chord = float(np.linalg.norm(root * (b.x - a.x)))
    # an arc of curvature k over a chord c is c (1 + k^2 c^2 / 24 + ...), k^2 the mean of both ends
    return chord * (1 + 0.5 * float(a.bend @ a.bend + b.bend @ b.bend) * chord * chord / 24)


def trace(
    curve: CurveProblem[F], first: F, steps: ContinuationOptions, ends: Sequence[End[F]] = ()
) -> Trace[F] | None:
    """Trace a curve both ways from the frame `first`; once around where it is closed.

    It ends at the first of `ends` (the first in their order where two come at once), where it is singular, and after
    `steps.most` points, the length `steps.far` or the time `steps.until`.  None where the curve does not turn around.
    """
    ahead, lengths, end = trace_ahead(curve, first, steps, ends)
    behind, back, start = list[F](), list[float](), end
    if end != CLOSED_CURVE:
        turned = curve.frame(first.x, -first.tangent)
        if turned is None:
            return None
        behind, back, start = trace_ahead(curve, turned, steps, ends)
    s = np.array([*(-v for v in reversed(back)), 0.0, *lengths])
    return Trace((*reversed(behind), first, *ahead), s, start, end, len(behind))


def trace_ahead(
    curve: CurveProblem[F], first: F, steps: ContinuationOptions, ends: Sequence[End[F]]
) -> tuple[list[F], list[float], str]:
    """Trace from `first` along its tangent: the frames after it with their arclength, and why they end."""
    frames, s = list[F](), list[float]()
    here, at, h = first, 0.0, steps.first
    found: End[F] | None = None  # an end that lies within the next step
    while len(frames) < steps.most and at < steps.far:
        if time.monotonic() > steps.until:
            return frames, s, OUT_OF_TIME
        ahead, after = _ahead(curve, here, h, steps, 1 if found else steps.together)
        kept, end = _before([step.frame for step in ahead], ends)
        for step in ahead[:kept]:
            back = float(np.linalg.norm(curve.root * (step.frame.x - first.x)))
            # invariant: `here` is the last point kept, `at` its arclength, and no end lies before it
            if len(frames) >= 3 and _is_back(curve, step, first, back):
                # a last point short of the start is still one of the curve
                if (first.x - step.frame.x) * curve.root @ step.frame.tangent > 0:
                    at += step.length
                    frames.append(step.frame)
                    s.append(at)
                    here = step.frame
                return [*frames, first], [*s, at + _arc(curve.root, here, first)], CLOSED_CURVE
            here, at = step.frame, at + step.length
            frames.append(here)
            s.append(at)
        if end is not None:
            beyond = ahead[kept]
            last = None if end.meet is None else end.meet(here, beyond.frame)
            if last is here:
                return frames, s, end.why
            if last is not None:
                return [*frames, last], [*s, at + _arc(curve.root, here, last)], end.why
            # an end that is only known to lie between two points: steps are halved down to the shortest
            found, h = end, beyond.tried / 2
        elif len(ahead) == kept and not after:
            return frames, s, found.why if found else SINGULAR
        else:
            h = TOWARDS_AN_END * ahead[-1].tried if found else after
        if found and h <= steps.shortest:
            return frames, s, found.why
    far = f"longer than {steps.far:g} rad"
    return frames, s, far if at >= steps.far else f"more than {steps.most} points"


def _ahead(
    curve: CurveProblem[F], here: F, h: float, steps: ContinuationOptions, count: int
) -> tuple[list[_TracedStep[F]], float]:
    """Make up to `count` steps, the first of about h; returns them and the next step, 0 where none is short enough."""
    ahead: list[_TracedStep[F]] = []
    while len(ahead) < count:
        moved = advance(curve, here, h, steps.aside)
        turn = 0.0 if moved is None else float(np.linalg.norm(moved[0].tangent - here.tangent))
        if moved is None or turn > steps.sharpest:
            h /= 2
            if h <= steps.shortest:
                return ahead, 0.0
            continue
        here = moved[0]
        ahead.append(_TracedStep(here, moved[1], h))
        # the turn of unit tangents is their angle, to second order: the next step shall turn by `steps.turn`
        h = min(steps.longest, h * min(steps.growth, steps.turn / max(turn, NONZERO)))
    return ahead, h


def _before(frames: Sequence[F], ends: Sequence[End[F]]) -> tuple[int, End[F] | None]:
    """Return how many frames come before the first end, and that end."""
    kept, found = len(frames), None
    for end in ends:
        count = end.before(frames[:kept]) if kept else 0
        if count < kept:
            kept, found = count, end
    return kept, found


def _is_back(curve: CurveProblem[F], step: _TracedStep[F], first: F, back: float) -> bool:
    """Return whether a step came back to the first point: nearer than it is long, in the same direction."""
    return back <= 0.75 * step.length and float(step.frame.tangent @ first.tangent) > ALIGNED
