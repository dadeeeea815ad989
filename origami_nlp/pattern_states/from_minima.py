"""Starts that follow from what was found: of minima their images, vertices popped, hinges in other wells, any
changes."""

from __future__ import annotations

from abc import abstractmethod
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from functools import cached_property, partial

import numpy as np

from origami_nlp.minima import JudgedState
from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.pattern_problem import MOST_DENSE, image
from origami_nlp.pattern_states.descent import Descended
from origami_nlp.pattern_states.parts import Parts
from origami_nlp.starts import (
    POPPED,
    Changed,
    Listed,
    OtherWells,
    Popped,
    SearchOptions,
    hinge_rests,
)

FORESEEN = 20
"""Starts from minima changed at random for each descent that is followed, and so many more descents: 320 of 6,000."""
IMAGES = "images of minima under symmetries"


class FromMinima(Parts):
    """A search that knows some minima, and goes on from them."""

    contact: bool
    _symmetries: list[tuple[np.ndarray, float]]

    def __init__(self) -> None:
        super().__init__()
        self._gone: dict[str, list[np.ndarray]] = {}
        self._counts: dict[str, Counter[str]] = defaultdict(Counter)
        self._mirrored = 0

    @abstractmethod
    def settle(self, phi: np.ndarray) -> None:
        """Go downhill from a state that all but closes, and judge what is reached."""

    @abstractmethod
    def contact_descent(self, end: Descended) -> None:
        """Judge where a descent into contact ended."""

    @abstractmethod
    def foresee_apart(self, phi: np.ndarray) -> None:
        """Go downhill from a closed state along states that do not cross, and judge what is reached."""

    @abstractmethod
    def look_ahead(self, start: np.ndarray) -> None:
        """Go down from a start, closed first; where scouts can be sent, only if one comes to an end."""

    @abstractmethod
    def beside(self, phi: np.ndarray) -> np.ndarray:
        """Return a state beside a minimum [n] at which facets that touch there are apart, if one is known; else it."""

    @abstractmethod
    def _begun(self, start: np.ndarray) -> np.ndarray | None: ...

    @abstractmethod
    def _enter(self, phi: np.ndarray) -> None: ...

    @cached_property
    def _changed(self) -> Changed:
        return Changed(self.problem, self.labels)

    @property
    def known_minima(self) -> np.ndarray:
        """Their fold angles, [m, n]."""
        known = [s.phi for s in self.judged if s.verdict == "minimum"]
        return np.array(known).reshape(-1, self.problem.size)

    @property
    def minima(self) -> list[JudgedState]:
        """Those that are known, by energy."""
        return [s for s in self.by_energy() if s.verdict == "minimum"]

    def _kept_apart(self, start: np.ndarray) -> None:
        """Go downhill from a start along states that do not cross, if it is one of them and on no curve."""
        phi = self._begun(start)
        if phi is None or phi in self.curves:
            return
        if (
            self.contact
            and self.problem.size <= MOST_DENSE
            and not self.problem.crossings.find(phi)
        ):
            self.foresee_apart(phi)
        else:
            self._enter(phi)

    def add_images(self) -> None:
        """Judge images of minima under symmetries of the sheet with its springs; once of each."""
        new = self.judged[self._mirrored :]
        for symmetry in self._symmetries:
            for state in [s for s in new if s.verdict == "minimum"]:
                self.attempt(self.settle, image(symmetry, state.phi))
        self._mirrored += len(new)

    def go_on(self, options: SearchOptions, starts: int, rng: np.random.Generator) -> None:
        """Start from minima, and from what that leads to, until nothing new comes; `starts` multiplies limits."""
        longest, known = options.most_on * starts, None
        while known != (known := self.count()):
            self.part(IMAGES, self.add_images)
            self.part(OtherWells.name, self.snap, options.most_popped * starts, longest)
            self.part(Popped.name, self.pop, options.most_popped * starts, longest)
            given = options.most_changed * starts, options.most_drawn * starts
            self.part(Changed.name, self.change, rng, *given)

    def pop(self, most: int, longest: int) -> None:
        """Start from each minimum with one vertex popped.

        There are states on either side of a vertex (`pops`); those that touching facets hold are seldom met by descents
        that let facets cross.  Each minimum is popped in one way before any is in another: the next way seldom leads
        elsewhere from there.
        """
        pattern, labels = self.problem.pattern, self.labels
        ways = [partial(Popped, pattern, labels, shares=[shares]) for shares in POPPED]
        self._go_on(Popped.name, ways, most, longest)

    def snap(self, most: int, longest: int) -> None:
        """Start from each minimum with one hinge in another well of its law."""
        pattern, labels = self.problem.pattern, self.labels
        if hinge_rests(pattern):
            ways = [partial(OtherWells, pattern, labels)]
            self._go_on(OtherWells.name, ways, most, longest)

    def change(self, rng: np.random.Generator, most: int, longest: int) -> None:
        """Start from minima changed at random, those among them that this leads to.

        Until `most` starts in a row led to no other minimum, or after `longest` in all, of which few descents are
        followed.  A single vertex has a search of its own, and where branches are enumerated these lead to what the
        starts would.
        """
        problem, name, counts = self.problem, Changed.name, self._counts[Changed.name]
        alone = len(problem.pattern.vertices) < 2 or problem.size > MOST_DENSE
        if alone or not (most and self.contact) or self.tally.lines or self.tally.families:
            return
        [gone] = self._gone.setdefault(name, [np.empty((0, problem.size))])
        known, quiet = -1, 0
        while quiet < most and name not in self.tally.cut:
            problem.check_time()
            if known != (known := self.count()[0]):
                quiet = 0
                for phi in (s.phi for s in self.minima if s.phi.any()):
                    if not are_among(phi[None], gone)[0]:
                        images = [image(symmetry, phi) for symmetry in self._symmetries]
                        gone = self._gone[name][0] = np.vstack([gone, phi, *images])
                        self._changed.add(self.beside(phi), images)
            if not len(start := self._changed.draw(rng, 1).x):
                return
            self.begin(name)
            self.attempt(self.look_ahead, start[0])
            counts["made"] += 1
            quiet += 1
            if counts["made"] == longest or counts["followed"] > FORESEEN + longest // FORESEEN:
                self.tally.cut = (*self.tally.cut, name)

    def _go_on(
        self,
        name: str,
        ways: Sequence[Callable[[np.ndarray], Listed]],
        most: int,
        longest: int,
        least: int = 0,
    ) -> None:
        """Start from each minimum, the lowest first, in one way after the other, what that leads to among them.

        Until `most` starts in all led to no other minimum, or after `longest`; minima with fewer degrees of freedom
        than `least` are left out.  Where the sheet has symmetries, one of a minimum and its images is enough.  What was
        gone on from is not gone on from again.
        """
        none = [np.empty((0, self.problem.size)) for _ in ways]
        gone, counts = self._gone.setdefault(name, none), self._counts[name]
        while name not in self.tally.cut:
            self.problem.check_time()
            states = np.array([s.phi for s in self.minima if s.phi.any() and s.dof >= least])
            states = states.reshape(-1, self.problem.size)
            waiting = (
                (k, phi) for k, done in enumerate(gone) for phi in states[~are_among(states, done)]
            )
            if (first := next(waiting, None)) is None:
                return
            k, phi = first
            images = [image(symmetry, phi) for symmetry in self._symmetries]
            gone[k] = np.vstack([gone[k], phi, *images])
            for start in ways[k](self.beside(phi)).states():
                if are_among(start[None], states).any():
                    continue
                if counts["idle"] == most or counts["made"] == longest:
                    self.tally.cut = (*self.tally.cut, name)
                    break
                before = self.count()
                self.begin(name)
                self.attempt(self.look_ahead, start)
                counts["made"] += 1
                counts["idle"] += self.count() == before


def are_among(states: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return which of some states [s, n] are among others [o, n]."""
    apart = np.abs(states[:, None] - others).max(axis=2, initial=0.0)
    return (apart <= 10 * DUPLICATE_TOL).any(axis=1)
