"""What it takes to leave a stable state, and a way that shows it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final, Literal, NamedTuple

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import SETTLED

Method = Literal["exact (traced)", "upper bound (descents)", "not determined", "isolated"]
TRACED: Final = "exact (traced)"
BOUND: Final = "upper bound (descents)"
OPEN: Final = "not determined"
ALONE: Final = "isolated"


@dataclass(frozen=True, repr=False)
class Escape(ShortRepr):
    """What it takes to leave a stable state.

    Attributes
    ----------
    barrier
        Energy that has to be put in [the scene's units]; of a vertex upper bounds are rounded up to two digits.  inf
        where no way leads to another state, nan where it is not determined.  Under an imposed symmetry it is that of
        ways that keep the symmetry.
    method
        ``exact (traced)`` (curves of one degree of freedom), ``upper bound (descents)`` (an explicit escape path: there
        may be lower ones), ``isolated`` (no other state is near: geometry holds it), or ``not determined``.
    why
        What that rests on.
    to
        Number (1-based) of the state that the way leads to; 0 for none, or one that is not listed.
    top
        Fold angles where the way is highest [rad], shape [N]; empty where that is not known.
    shallow
        Whether the barrier is below `SHALLOW` of the energy that it takes to fold every crease by pi.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.miura("pi/3"))
    >>> result.minima[1].escape.method
    'exact (traced)'
    """

    barrier: float
    method: Method
    why: str
    to: int = 0
    top: tuple[float, ...] = field(default=(), repr=False)
    shallow: bool = False

    def __post_init__(self) -> None:
        if math.isnan(self.barrier) and self.method in (TRACED, ALONE):  # read from a file
            object.__setattr__(self, "barrier", math.inf)  # no escape path

    @property
    def known(self) -> bool:
        """Whether there is a number."""
        return math.isfinite(self.barrier)

    def words(self) -> str:
        """Format it for a cell of a table: "0.0123", "<= 0.013", "none" (no escape path), "?" (not determined)."""
        if not self.known:
            return {ALONE: "isolated", OPEN: "?"}.get(self.method, "no escape path")
        return f"<= {rounded_up(self.barrier)}" if self.method == BOUND else f"{self.barrier:.3g}"


def rounded_up(value: float) -> str:
    """Return a positive number with two digits, not below it: an upper bound stays one."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1) if value > 0 else 1.0
    # what rounding, and the accuracy of a bisection, may change does not show
    return f"{math.ceil(value / unit * (1 - SETTLED)) * unit:.2g}"


class EscapePath(NamedTuple):
    """An escape path: how high it climbs over its state, where, and number of the listed state it leads to, or -1.

    states: on the way, [S, n], to where descents in batches take over; empty where they are not kept.
    """

    height: float
    top: np.ndarray
    to: int
    states: np.ndarray = np.zeros((0, 0))
