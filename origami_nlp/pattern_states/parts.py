"""What is done in parts, until its time or the user ends it: what was left out is noted, what failed is counted."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np

from origami_nlp.errors import OutOfTime
from origami_nlp.kkt import project, singular_beside
from origami_nlp.minima import JudgedState, SearchReport, chao1, chao1_error
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, LEVEL, NEAR_SINGULAR_TOL, rank
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states.curves import TracedCurves
from origami_nlp.pattern_states.judgement import is_level_along

FAILURES = np.linalg.LinAlgError, ArithmeticError
"""What linear algebra may end in at some start: it is counted and named."""


class Places:
    """Points [n] that grow in number.

    Parameters
    ----------
    size
        n.
    """

    def __init__(self, size: int) -> None:
        self._at, self.count = np.empty((64, size)), 0

    def add(self, x: np.ndarray) -> None:
        """Add one."""
        if self.count == len(self._at):
            self._at = np.concatenate([self._at, np.empty_like(self._at)])
        self._at[self.count] = x
        self.count += 1

    def far(self, x: np.ndarray) -> np.ndarray:
        """Return how far each is from a point, largest difference of a coordinate, [K]."""
        return np.asarray(np.abs(self._at[: self.count] - x).max(axis=1, initial=0.0))


class Parts:
    """Work on a problem, with the record of what it did and the states that it judged."""

    curves: TracedCurves
    tally: SearchReport
    judged: list[JudgedState]
    progress: Callable[[int, int, str], object] | None = None
    found: Callable[[float, np.ndarray], object] | None = None
    at = ""
    family = ""

    def __init__(self, problem: PatternProblem) -> None:
        self.problem, self.labels = problem, problem.labels
        self._reached: dict[int, set[tuple[str, int]]] = defaultdict(set)
        self._at: dict[tuple[float, ...], np.ndarray] = {}
        self._places = Places(self.problem.size)
        self._met = set[int]()  # since it was emptied

    def say(self) -> None:
        """Say how far the work is: starts, minima and the part that it is at."""
        if self.progress is not None:
            self.progress(self.tally.starts, self.count()[0], self.at)

    def begin(self, family: str) -> None:
        """Count a start of a family."""
        self.family = family
        self.tally.starts += 1
        self.tally.by_source[family] = self.tally.by_source.get(family, 0) + 1
        self.say()

    def _reach(self, k: int) -> None:
        """Note that the start that is on led to a minimum."""
        self._met.add(k)
        if self.judged[k].verdict == "minimum":
            self._reached[k].add((self.family, self.tally.starts))

    def note_hits(self) -> None:
        """Note in what was judged how many starts led there."""
        self.judged = [replace(s, hits=len(self._reached[k])) for k, s in enumerate(self.judged)]

    def count_families(self, drawn: Collection[str]) -> None:
        """Sum up what each family led to; how many minima drawn starts miss at least, in expectation."""
        tally, by = self.tally, [{family for family, _ in at} for at in self._reached.values()]
        tally.reached = {f: sum(f in at for at in by) for f in tally.by_source}
        tally.alone = {f: sum(at == {f} for at in by) for f in tally.by_source}
        hits = [sum(f in drawn for f, _ in at) for at in self._reached.values()]
        tally.seen_once = hits.count(1)
        late = tally.starts - tally.starts // 3
        new = sum(min(number for _, number in at) > late for at in self._reached.values() if at)
        tally.new_per_thousand = 1000 * new / max(tally.starts // 3, 1)
        if tally.drawn and not tally.curves:
            tally.expected_undiscovered, tally.expected_error = chao1(hits), chao1_error(hits)

    def part(self, what: str, work: Callable[..., None], *given: Any) -> bool:
        """Do a part of the search; False, and noted as left out, where time or the user ends it before."""
        self.at = self.family = what
        self.say()
        try:
            self.problem.check_time()
            work(*given)
        except (OutOfTime, KeyboardInterrupt) as stop:
            if isinstance(stop, KeyboardInterrupt):
                self.problem.until, self.tally.interrupted = -math.inf, True
            self.tally.leave_out(what)
            return False
        except FAILURES as failure:
            self.tally.fail(failure)
        return True

    def attempt(self, work: Callable[..., object], *given: Any) -> None:
        """Do what concerns one start, or one well; where linear algebra fails there, count and name it."""
        try:
            work(*given)
        except FAILURES as failure:
            self.tally.fail(failure)

    def at_state(self, state: JudgedState) -> np.ndarray:
        """Return a judged state in the variables of the problem, [n]."""
        at = self._at.get(state.fold_angles)
        if at is None:
            at = self._at[state.fold_angles] = self.problem.reduce(state.phi)
        return at

    def known(self, phi: np.ndarray, verdict: str = "minimum") -> bool:
        """Return whether a state was judged: one that is not stationary says nothing of a minimum beside it.

        Of a minimum it is noted that the start that is on led to it.
        """
        least = {"not stationary": CLOSURE_TOL} if verdict == "minimum" else {}
        for state in self.judged[self._places.count :]:
            self._places.add(self.at_state(state))
        far = self._places.far(phi)
        here = [
            k
            for k in np.flatnonzero(far <= 10 * DUPLICATE_TOL).tolist()
            if far[k] <= least.get(self.judged[k].verdict, math.inf)
        ]
        for k in here:
            self._reach(k)
        return bool(here)

    def add(self, state: JudgedState) -> None:
        """Keep a state, once, if it is one that is asked for."""
        if not (winding := self.problem.winding(self.at_state(state))):
            return
        state = replace(state, winding=winding)
        near = (
            singular_beside(self.problem, self.at_state(state))
            if state.verdict == "undecided"
            else None
        )
        if state.dof < 0:  # it does not close, or is beyond a limit
            self.tally.open += 1
        elif near is not None and self.known(near):  # not distinguished from what was judged
            self.tally.stalled += 1
        elif not self.known(self.at_state(state), state.verdict) and not self._level_with_known(
            state
        ):
            self.judged.append(state)
            self._reach(len(self.judged) - 1)
            if state.verdict == "minimum" and self.found is not None:
                self.found(state.energy, state.phi.copy())
            self.say()

    def exchange(self, k: int, state: JudgedState) -> None:
        """Put a state in the place of the k-th, which was not told from it."""
        self.judged[k], self._places = state, Places(self.problem.size)

    def on_level_set(self, x: np.ndarray) -> bool:
        """Return whether hinges leave some way from a state level, where an undecided one has that energy: one stands
        for the whole set.
        """
        problem = self.problem
        if not problem.pattern.laws:
            return False
        energy = problem.energy(x)
        level = LEVEL * max(problem.scale, abs(energy))
        alike = (abs(energy - s.energy) <= level for s in self.judged if s.verdict == "undecided")
        return any(alike) and is_level_along(problem, x, problem.kernel(x).T)

    def _level_with_known(self, state: JudgedState) -> bool:
        """Return whether a state is one that is known: beside it, and level with it and with what is between.

        Where hinges have no stiffness at the bottom of a well, descents end somewhere near it.
        """
        if state.verdict not in ("minimum", "undecided") or not self.problem.pattern.laws:
            return False
        x = self.at_state(state)
        for k, s in enumerate(self.judged):
            y = self.at_state(s)
            beside = s.verdict == "minimum" or s.verdict == state.verdict
            if not beside or np.abs(x - y).max() > NEAR_SINGULAR_TOL:
                continue
            level = LEVEL * max(abs(s.energy), self.problem.scale)
            between, residual = project(self.problem, 0.5 * (x + y))
            other, middle = (self.problem.energy_change(y, z) for z in (x, between))
            if residual <= CLOSURE_TOL and abs(other) <= level and middle <= level:
                self._reach(k)
                return True
        return False

    def by_energy(self) -> list[JudgedState]:
        """Return what was judged, by energy; states of one energy in an order that labels do not change."""
        by_key = sorted(self.judged, key=lambda s: self.labels.key(self.at_state(s)))
        return sorted(by_key, key=lambda s: rank(s.energy / self.problem.scale, ()))

    def count(self) -> tuple[int, int]:
        """Return how many minima and curves are known."""
        return sum(s.verdict == "minimum" for s in self.judged), len(self.curves.found)
