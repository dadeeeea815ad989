"""What a bifurcation diagram of equilibria is made of: nodes (events and ends) and arcs between them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from origami_nlp.continuation.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.continuation.one_sided_branches import OneSidedBranch
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.numerics import NEAR_SINGULAR_TOL, SETTLED
from origami_nlp.problem import Contact

START, RANGE, EVENT, LATE, AGAIN = "start", "range", "event", OUT_OF_TIME, "stable again"


@dataclass(eq=False)
class SpecialPoint:
    """A state at which arcs end.

    type: ``fold``, ``nonsmooth-fold``, ``closes``, ``leaves``, ``branching``, ``breaks-symmetry``, ``singular``;
    ``slides``, ``touches``; ``start`` (of a state given), ``range`` (an end of what is followed), ``corner`` (the
    contacts held change, the states do not turn), `AGAIN` (stable states beyond unstable ones, not followed further
    yet) or `LATE` (the time was over) where nothing happens.
    point: (x, s).  contact, value, residual: what closes or leaves, values of the event's function and of the KKT
    system.  located: whether both are rounding.  why: in words, where it is not, or where nothing goes on.  between:
    values of s between which it lies, where only that is known.
    halves: in which directions equilibria go on.  used: those that were followed, or come from there.  left: those that
    may be followed later.
    """

    type: str
    point: np.ndarray
    contact: Contact | None = None
    value: float = 0.0
    residual: float = 0.0
    located: bool = True
    why: str = ""
    between: tuple[float, float] | None = None
    halves: list[OneSidedBranch] = field(default_factory=list)
    used: list[int] = field(default_factory=list)
    left: list[int] = field(default_factory=list)

    @property
    def s(self) -> float:
        """Where on the line."""
        return float(self.point[-1])


@dataclass(frozen=True, eq=False)
class BranchSegment:
    """Equilibria between two nodes, in the order in which they were followed.

    frames: at least two, ends included.  start, end: positions of the nodes.
    """

    frames: tuple[Equilibrium, ...]
    start: int
    end: int

    @property
    def low(self) -> float:
        """Smallest s."""
        return min(self.frames[0].s, self.frames[-1].s)

    @property
    def high(self) -> float:
        """Largest s."""
        return max(self.frames[0].s, self.frames[-1].s)

    @property
    def middle(self) -> int:
        """Position of a frame in the middle; of two ends of the one that is less degenerate."""
        if len(self.frames) > 2:
            return (len(self.frames) - 1) // 2
        first, last = (abs(min(f.eigenvalues, default=np.inf)) for f in self.frames)
        return int(last > first)

    @property
    def index(self) -> int:
        """Number of directions in which the energy falls."""
        return self.frames[self.middle].index

    def at(self, s: float) -> Equilibrium | None:
        """Return its state at s, by Newton; None outside."""
        if not self.low - SETTLED <= s <= self.high + SETTLED:
            return None
        values = np.array([frame.s for frame in self.frames])
        forward = values[-1] >= values[0]
        k = int(np.searchsorted(values if forward else -values, s if forward else -s))
        a, b = self.frames[max(k - 1, 0)], self.frames[min(k, len(values) - 1)]
        share = 0.0 if a.s == b.s else (s - a.s) / (b.s - a.s)
        middle = self.frames[len(self.frames) // 2]
        curve = EquilibriumCurve(middle.system.line, middle.hold)
        guess = a.x + share * (b.x - a.x)
        found = curve.at(guess, s, middle.tangent)
        # just outside it is beside the end: at a fold at the square root of how far outside
        far = NEAR_SINGULAR_TOL if a is b else max(curve.apart(b.x, a.x), SETTLED)
        # Newton may go over to another branch beside states where branches cross
        if a is not b and (found is None or curve.apart(found.x, guess) > far):
            # where Newton at s fails, bisection along the curve finds the state
            found = curve.between(a, b, s)
        return found if found is not None and curve.apart(found.x, guess) <= far else None
