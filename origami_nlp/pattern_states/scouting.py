"""Starts whose end is foreseen: a scout ends where an earlier one did, whose descent was followed to its end."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from origami_nlp.pattern_problem import PopSigns, Scouts, image
from origami_nlp.pattern_states.contact_descents import LEFT, contact_descent, less_folded
from origami_nlp.pattern_states.from_minima import FromMinima
from origami_nlp.starts import Changed

ONE_END = 3e-4
"""Ends of scouts that are as near to each other are one [rad]: of one minimum they agree to 1e-6, and minima of
waterbomb:2x2 lie 0.009 apart."""

EVERY = 4
"""Steps of a descent from one scout on its way to the next."""
BESIDE_END = 0.01
"""Largest distance of such an end from its minimum at which that is started from in its place [rad]."""


class Scouting(FromMinima):
    """A search that sends scouts ahead: what is new is left to descents that decide."""

    def __init__(self) -> None:
        super().__init__()
        self._ends: list[np.ndarray] = []
        self._led: list[set[int]] = []
        self._nowhere: list[np.ndarray] = []

    @cached_property
    def scouts(self) -> Scouts:
        """Of the problem."""
        return Scouts(self.problem)

    @property
    def goes_ahead(self) -> bool:
        """Whether scouts go ahead of most starts: none is on a curve that is traced."""
        return self.problem.size - self.problem.equation_count > 1 and self.scouts.usable

    def foresee(self, phi: np.ndarray) -> None:
        """Go downhill from a closed state, unless it is foreseen where that ends."""
        ends = self._foreseen(phi) if self.scouts.usable and not self.known(phi) else None
        self._follow(ends, lambda: self.settle(phi))

    def foresee_apart(self, phi: np.ndarray) -> None:
        """Go downhill from a state at which facets do not cross, along such states, unless it is foreseen where to."""
        held = self.scouts.descend(phi, True) if self.scouts.usable else None
        if held is not None and PopSigns(self.problem.pattern).is_jump(phi, held[0]):
            held = None
        ends = None if held is None else [(held[0], True)]
        self._follow(ends, lambda: self._press(phi))

    def look_ahead(self, start: np.ndarray) -> None:
        """Go down from a start, closed first; where scouts can be sent, only if one comes to an end."""
        if not self.goes_ahead:
            self._kept_apart(start)
        elif (phi := self._begun(start)) is not None:
            if self.problem.crossings.find(phi):
                phi = less_folded(self.problem, phi)
            held = None if phi is None else self.scouts.descend(phi, True)
            if held is None:
                return
            # where an image of the end is foreseen, so is what images of minima are added for
            ends = [held[0], *self._images(held[0])]
            if any(_nearest(self._nowhere, end)[1] <= ONE_END for end in ends):
                return
            if any(map(self._is_foreseen, ends)):
                self.tally.foreseen += 1
            else:
                self._counts[self.family]["followed"] += 1
                self._follow([(held[0], True)], lambda: self._nowhere.append(held[0]))

    def _images(self, phi: np.ndarray) -> list[np.ndarray]:
        """Return the images of a state [n] under symmetries of the sheet with its springs."""
        return [image(symmetry, phi) for symmetry in self._symmetries]

    def _look_on(self, phi: np.ndarray) -> bool:
        """Follow a short descent along states that do not cross, until scouts end from it where earlier ones did.

        A scout keeps creases at the fold limits that it begins at, which the first step may leave.  Return whether it
        came to no end of its own; of minima changed at random such ends are many, and they are not judged.
        """
        steps = itertools.count()

        def leave(x: np.ndarray) -> bool:
            held = self.scouts.descend(x, True) if next(steps) % EVERY == 1 else None
            ends = [] if held is None else [held[0], *self._images(held[0])]
            return any(map(self._is_foreseen, ends))

        end = contact_descent(self.problem, phi, True, self.known_minima, leave)
        if end.arrived or (end.why != LEFT and self.family != Changed.name):
            self.contact_descent(end)
        return not end.arrived

    def _press(self, phi: np.ndarray) -> None:
        self.contact_descent(contact_descent(self.problem, phi, True, self.known_minima))

    def beside(self, phi: np.ndarray) -> np.ndarray:
        """Return the end of a scout near a minimum [n]; the minimum itself where none is known."""
        for end in self._ends:
            if np.abs(end - phi).max() <= BESIDE_END:
                return end
        return phi

    def _foreseen(self, phi: np.ndarray) -> list[tuple[np.ndarray, bool]] | None:
        """Return near which states descents from a closed one end: without contact, and into it, kept apart.

        None where one is in doubt.
        """
        if (free := self.scouts.descend(phi, False)) is None:
            return None
        end, start, crosses = free
        if not (self.contact and crosses):
            return [(end, False)]
        if self.problem.crossings.find(start):
            smaller = less_folded(self.problem, start)
            if smaller is None:
                return None
            start = smaller
        if (held := self.scouts.descend(start, True)) is None:
            return None
        # where facets cross at its end, a descent without contact leads to no state
        free_ends = [] if self.problem.crossings.find(end) else [(end, False)]
        return [*free_ends, (held[0], True)]

    def _is_foreseen(self, end: np.ndarray) -> bool:
        """Return whether an earlier scout ended there: what its descent led to is reached again."""
        k, far = _nearest(self._ends, end)
        if far > ONE_END:
            return False
        for j in self._led[k]:
            self._reach(j)
        return True

    def _follow(
        self,
        ends: Sequence[tuple[np.ndarray, bool]] | None,
        decide: Callable[[], None],
    ) -> None:
        """Follow the descents from where scouts ended that no other did; where one is in doubt, from the start.

        Where layers at an end have no order, or the descent from there leads to nothing, nothing is foreseen by it.
        """
        new = [] if ends is None else [x for x in ends if not self._is_foreseen(x[0])]
        if ends is None or any(apart and self.problem.refuses(end) for end, apart in new):
            decide()
            return
        self.tally.foreseen += not new
        for end, apart in new:
            self._met.clear()
            left = self._look_on(end) if apart else self.settle(end)
            if not (left or self._met):
                decide()
                return
            self._ends.append(end)
            self._led.append(set(self._met))


def _nearest(states: list[np.ndarray], phi: np.ndarray) -> tuple[int, float]:
    """Return the number of the nearest of some states to one [n], and how far it is; infinitely where there is none."""
    if not states:
        return -1, math.inf
    far = np.abs(np.array(states) - phi).max(axis=1)
    return int(far.argmin()), float(far.min())
