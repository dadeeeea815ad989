"""What it takes to leave a stable state, a way that shows it, and the elder rule, which says it of all by passes.

The barrier is the least energy that a path to a state of no higher energy climbs; where there is none such, to one that
is not shallow itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final, Literal, NamedTuple

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import LEVEL, SETTLED, SHALLOW

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

    @classmethod
    def bound(cls, barrier: float, to: int, scale: float, top: tuple[float, ...] = ()) -> Escape:
        """State what an explicit path climbs, to a state by its number from 0; energies by `energy_scale`."""
        why = "an explicit path climbs so high; lower ones are not excluded"
        return cls(barrier, BOUND, why, to + 1, top, barrier < SHALLOW * scale)

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


def barriers(
    energies: np.ndarray,
    heights: np.ndarray,
    level: float,
    scale: float,
    beyond: np.ndarray | None = None,
) -> list[tuple[float, int]]:
    """Return the escape barrier of each state, and the position of the state that it leads to, -1 for none.

    Parameters
    ----------
    energies
        Of the states, [M].
    heights
        Of the lowest pass between two of them, over zero, [M, M]; inf where there is none.
    level
        Energies that differ by no more are equal.
    scale
        Of energies, see `energy_scale`.
    beyond
        What a way from each to a lower state that is not among these climbs, [M]; inf for none.

    Returns
    -------
    list
        A pair a state; the barrier is inf where no way is known.
    """
    heights = _closed(heights)
    out: list[tuple[float, int]] = []
    direct = np.full(len(energies), math.inf) if beyond is None else beyond
    for k, energy in enumerate(energies):
        others = (energies <= energy + level) & (np.arange(len(energies)) != k)
        out.append(
            min(_least(heights[k], others, energy), (float(direct[k]), -1), key=lambda way: way[0])
        )
    for k, (barrier, _) in enumerate(out):
        # the lowest state has no lower one to go to: its barrier is that to any other that is not shallow
        if math.isinf(barrier) and (energies >= energies[k] - level).all():
            deep = np.array([b >= SHALLOW * scale for b, _ in out])
            deep[k] = False
            out[k] = _least(heights[k], deep, energies[k])
    return out


def _least(heights: np.ndarray, which: np.ndarray, energy: float) -> tuple[float, int]:
    over = np.where(which, heights, math.inf)
    j = int(over.argmin())
    return (float(max(over[j] - energy, 0.0)), j) if math.isfinite(over[j]) else (math.inf, -1)


def _closed(heights: np.ndarray) -> np.ndarray:
    """Return heights [M, M] of ways over other states as well, where these are lower."""
    # least height over all ways: the recursion of Floyd and Warshall with (min, max) in place of (min, +)
    h = np.minimum(heights, heights.T)
    for k in range(len(h)):
        h = np.minimum(h, np.maximum(h[:, k : k + 1], h[k]))
    return h


def level_of(energies: np.ndarray, scale: float) -> float:
    """Return by how much energies may differ that are equal [their units]."""
    return LEVEL * (scale + float(np.abs(energies).max(initial=0.0)))
