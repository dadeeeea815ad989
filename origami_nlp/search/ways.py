"""What goes down from the starts of a problem."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np

from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search.descend import StartState
from origami_nlp.search.follow import Follower
from origami_nlp.search.ipopt import ByIpopt
from origami_nlp.search.newton import ByNewton

WayDown: TypeAlias = Follower | ByIpopt | ByNewton


def way_down(problem: PatternProblem, *, ipopt: bool = False) -> WayDown:
    """Return what goes down from starts: compiled descents, Newton's method where a problem is too large for these.

    IPOPT where it is asked for, or where there is no compiler.
    """
    follower = Follower(problem)
    if follower.usable and not ipopt:
        return follower
    return ByNewton(problem) if follower.descents.is_large and not ipopt else ByIpopt(problem)


class Relabelled:
    """Ways down of the same origami under labels that all its labels agree on: rounding hangs on none of them.

    Parameters
    ----------
    way
        Of the problem under those labels.
    order
        Which variable of the stated problem comes first, second, ...
    sign
        Of fold angles.
    """

    def __init__(self, way: WayDown, order: np.ndarray, sign: float) -> None:
        self._way, self._order, self._sign = way, order, sign

    @property
    def work(self) -> int:
        """Evaluations of closure so far."""
        return self._way.work

    def _to(self, x: np.ndarray) -> np.ndarray:
        return np.asarray(self._sign * x[..., self._order] + 0.0)

    def _back(self, x: np.ndarray) -> np.ndarray:
        out = np.empty_like(x)
        out[..., self._order] = self._sign * x
        return out

    def _start(self, start: StartState) -> StartState:
        return replace(start, x=self._to(start.x), side=self._to(start.side).astype(int))

    def __call__(
        self, start: StartState, aside: np.ndarray, known_end: Callable[[np.ndarray], bool]
    ) -> tuple[np.ndarray, str]:
        """Return where a start leads, and why it ends there, as `Follower`."""
        given = self._start(start), self._to(aside), lambda y: known_end(self._back(y))
        return self._told(partial(self._way, *given))

    def each(
        self,
        starts: Sequence[StartState],
        asides: np.ndarray,
        known_end: Callable[[np.ndarray], bool],
    ) -> list[Callable[[], tuple[np.ndarray, str]]]:
        """Return what tells where each of some starts leads."""
        ways = self._way.each(
            [*map(self._start, starts)], self._to(asides), lambda y: known_end(self._back(y))
        )

        return [partial(self._told, way) for way in ways]

    def _told(self, way: Callable[[], tuple[np.ndarray, str]]) -> tuple[np.ndarray, str]:
        x, why = way()
        return self._back(x), why
