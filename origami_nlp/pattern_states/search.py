"""A search for the stable states of an origami: starts, descents, what is distinct, certified, and fed on; then curves.

Starts are drawn by labels that do not depend on how creases are numbered.  Where one degree of freedom is left, the
curves through what was found are traced after the search, and each well of the energy along them is asked for.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from origami_nlp.kkt import TangentCone, Verdict, classified, polished_nearby, singular_beside
from origami_nlp.minima import (
    ESCAPE_PATHS,
    MEETINGS,
    JudgedState,
    SearchReport,
)
from origami_nlp.numerics import (
    CLOSURE_TOL,
    DESIGN_SNAP,
    DUPLICATE_TOL,
    NEAR_CONTACT,
    NEAR_SINGULAR_TOL,
    RESOLVED,
    STATIONARY,
)
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states.branch_points import branch_directions, into_family, split
from origami_nlp.pattern_states.clearance import last_free
from origami_nlp.pattern_states.curve import tangents
from origami_nlp.pattern_states.curves import TracedCurve, TracedCurves
from origami_nlp.pattern_states.flat_folded import escape_paths, list_branches, list_flat_folded
from origami_nlp.pattern_states.interpolant import ON_CURVE, wells
from origami_nlp.pattern_states.judgement import (
    judge,
    judge_end,
)
from origami_nlp.pattern_states.near_folded import beside_folded
from origami_nlp.pattern_states.parts import Parts, Places
from origami_nlp.search import (
    BESIDE_FLAT,
    CLOSES_NOT,
    DEEP,
    MOST_TRIED,
    NO_LOWER,
    ByIpopt,
    Changed,
    Draws,
    Relabelled,
    SearchOptions,
    StartState,
    at_limits,
    close,
    given,
    hinge_rests,
    on_grid,
    other_wells,
    stationary_beside,
    way_down,
)

BRANCHES = "branch directions"
"""Out of the flat state and of others where curves meet, as starts."""
FLAT_FOLDED = "flat-folded states"
BESIDE_FOLDED = "starts beside flat-folded states"
MOST_SETTLED = 100
"""Flat-folded states without modes that are judged, those of least energy."""
GIVEN, GUESSES = "what the pattern gives", "guesses"
SNAPPED = "minima with a hinge in another well"
CURVES = "wells along curves"
NO_COMPILER = "compiled descents: no C compiler was found, or none is wanted; IPOPT searched"
"""Said of a search that had none."""
BESIDE = 1e-3
"""Step along a branch at which it is asked whether facets cross there [rad]."""
OUT = 0.2
"""First step out of a state where curves meet, of the longest fold angle [rad]."""


class Search(Parts):
    """A search on its way."""

    in_a_row = 0
    """Random starts in a row that were to find nothing new."""

    def __init__(
        self,
        problem: PatternProblem,
        until: float,
        options: SearchOptions,
        seed: int,
        *,
        ipopt: bool = False,
    ) -> None:
        super().__init__(problem)
        self._since, self.options = time.perf_counter(), options
        _ = self.problem.dof  # kept, before the clock can stop it
        self.problem.until = until
        self.curves = TracedCurves(self.problem)
        self.tally = SearchReport(contact=self.problem.mode)
        self.judged = list[JudgedState]()
        self._side = self.labels.drawn(np.random.default_rng(0).normal(size=self.problem.size))
        self._draws = Draws(self.problem, seed)
        self._met_at, self._cells = list[np.ndarray](), set[tuple[float, ...]]()
        self._ends = Places(self.problem.size)
        self._guesses: list[tuple[np.ndarray, JudgedState]] = []
        known = self.problem.canonical
        way = way_down(known[0] if known else self.problem, ipopt=ipopt)
        self.engine = type(way)
        self.go_down = Relabelled(way, known[1], self.labels.sign) if known else way
        if isinstance(way, ByIpopt) and not ipopt:
            self.tally.skip(NO_COMPILER)
        self._seed = seed

    def go(self, guesses: Sequence[np.ndarray], starts: int, most: int) -> None:
        """Search, with so many random starts in a row that find nothing new, and so many of them at most."""
        for guess in guesses:
            self.part(GUESSES, self.judge_guess, guess)
        self.part(GIVEN, self._explore_given)
        if self.problem.pattern.lies_flat:
            self.part("the flat state", self.add_flat)
        if self.problem.pattern.lies_flat or len(self.problem.pattern.vertices) == 1:
            self.part(FLAT_FOLDED, self.from_flat_folded)
        self.go_on(starts, most)

    def go_on(self, starts: int, most: int) -> None:
        """Make random starts, and trace the curves through all that was found."""
        self.part("random starts", self.draw, starts, most)
        self.part(CURVES, self.trace_curves)
        self.note_hits()

    def add_flat(self) -> None:
        """Judge the flat state: descents that end there are counted."""
        self.add(judge(self.problem, np.zeros(self.problem.size)))

    def judge_guess(self, guess: np.ndarray) -> None:
        """Judge the stationary state beside a guess [N], and go down from there."""
        x = self.problem.reduce(guess)
        closed, residual = self.problem.project(x)
        state = judge(self.problem, closed)
        verdict: Verdict = "not admissible"
        if np.abs(self.problem.expand(x) - guess).max() > NEAR_SINGULAR_TOL:
            why = "it does not have the symmetry of the scene"
        elif (beside := self._stationary_at(x)) is not None:
            self.begin(GUESSES)
            self.add(beside)
            state, verdict, why = beside, beside.verdict, beside.certificate
        elif residual > CLOSURE_TOL or np.abs(closed - x).max() > NEAR_SINGULAR_TOL:
            why = f"no state within {NEAR_SINGULAR_TOL:g} rad of it closes"
        elif state.verdict == "not admissible":
            why = state.certificate
        else:
            verdict = "not stationary"
            why = f"no state within {NEAR_SINGULAR_TOL:g} rad of it is an equilibrium"
        self._guesses.append((guess, replace(state, verdict=verdict, kind="", certificate=why)))
        self.explore(x, GUESSES)

    def _stationary_at(self, x: np.ndarray) -> JudgedState | None:
        """Return the stationary state beside a guess [n], judged: a minimum before others; None where there is none."""
        best = None
        # what people type holds contacts to fewer digits than what was computed
        for tolerance in (NEAR_CONTACT, DESIGN_SNAP):
            for end in polished_nearby(self.problem, x, tolerance):
                if self.problem.residual(end.x) <= CLOSURE_TOL:
                    state = judge_end(self.problem, end.x)
                    if state.verdict == "minimum":
                        return state
                    best = best or state
        return best

    def _explore_given(self) -> None:
        for start in given(self.problem.pattern):
            self.explore(self.problem.reduce(start), GIVEN)

    def draw(self, starts: int, most: int) -> None:
        """Make random starts, by what families led to and evenly, until so many led to nothing new.

        Each start is drawn from numbers of its own, and what it takes is counted, not measured: one that rounding sends
        elsewhere moves no other.
        """
        draws, tally, self.in_a_row = self._draws, self.tally, starts
        while tally.drawn < most and tally.quiet < starts and draws.made < MOST_TRIED * most:
            self.problem.check_time()
            name, batch, asides = draws.next(most - tally.drawn)
            for way in self.go_down.each(batch, asides, self._is_end):
                self.begin(name)
                before, lost = len(self.judged), tally.stopped[CLOSES_NOT] + tally.open
                self.attempt(self._arrive, way)
                new = sum(s.verdict == "minimum" for s in self.judged[before:])
                closed = lost == tally.stopped[CLOSES_NOT] + tally.open
                draws.note(name, new, closed)
                tally.drawn += closed
                # what starts from minima leads back to them says nothing of others
                tally.quiet = 0 if new else tally.quiet + (closed and name != Changed.name)

    def explore(self, start: np.ndarray, family: str, hold: bool = False) -> None:
        """Follow a state from which a listed family starts, with creases at their limits kept there if possible.

        hold: until the others are at rest.
        """
        self.begin(family)
        self.attempt(self.follow, StartState(start, at_limits(self.problem, start), (), hold))

    def follow(self, start: StartState, deep: int = DEEP) -> None:
        """Go downhill from a start, on either side of saddles, and judge what is reached."""
        here = [*self.family.encode(), self.tally.by_source[self.family]]
        rng = np.random.default_rng([self._seed, *here])
        aside = self.labels.drawn(rng.normal(size=self.problem.size))
        self._arrive(partial(self.go_down, start, aside, self._is_end), deep)

    def _arrive(self, way: Callable[[], tuple[np.ndarray, str]], deep: int = DEEP) -> None:
        """Judge where a way down ends."""
        x, why = way()
        if why == NO_LOWER and (near := singular_beside(self.problem, x)) is not None:
            x, why = near, ""  # it is not told from that state, where closure loses rank
        if why:
            self.tally.stopped[why] += 1
        elif np.abs(x).max(initial=0.0) < BESIDE_FLAT and self.problem.pattern.lies_flat:
            self.tally.flat += 1
        else:
            self.settle(x, deep)

    def _is_end(self, x: np.ndarray) -> bool:
        """Return whether a descent ended at a state before, and note that the start that is on led to it as well."""
        if not (self._ends.far(x) <= DUPLICATE_TOL).any():
            return False
        self.known(x)
        return True

    def settle(self, x: np.ndarray, deep: int = DEEP) -> None:
        """Judge where a descent ended, and its images; beside one that is refuted, go on from a lower state."""
        if self._is_end(x) or self.known(x) or (state := self._judged(x)) is None:
            return
        x = self.at_state(state)
        images = self._images(x)
        if state.verdict == "minimum" and x.any():
            self._draws.changed.add(*(on_grid(self.problem, x) for x in images))
        for other in images[1:]:
            if not state.refuted and not self.known(other):
                self.attempt(self._judged, other)
        if state.verdict == "minimum":
            self.snap(x)
        elif state.refuted and deep:
            lower = classified(self.problem, x).lower
            if lower is not None:
                self.follow(StartState(lower, at_limits(self.problem, lower)), deep - 1)

    def _judged(self, x: np.ndarray) -> JudgedState | None:
        """Judge a state, or a singular one that it is not told from, and keep it; None where that is known."""
        self._ends.add(x)
        if not self.problem.winding(x):
            return None
        if self.on_level_set(x):
            self.tally.stalled += 1
            return None
        state = judge_end(self.problem, x)
        near = None if state.verdict == "minimum" else singular_beside(self.problem, x)
        if near is not None:
            exact = judge(self.problem, near)
            state = state if exact.verdict == "undecided" else exact
        at = self.at_state(state)
        alike = self._images(at) if state.refuted else [at]
        if any(self.known(x, state.verdict) for x in alike):
            return None  # of what is refuted one image is kept
        self.add(state)
        return state

    def _images(self, x: np.ndarray) -> list[np.ndarray]:
        """Return a state and its images under the symmetries of the sheet and its springs."""
        return [x, *(move(x) for move in self.problem.moves)]

    def snap(self, x: np.ndarray) -> None:
        """Start from a minimum with each hinge in each other well of its law."""
        if hinge_rests(self.problem.pattern):
            for start in other_wells(self.problem.pattern, self.labels, x):
                if self.tally.by_source.get(SNAPPED, 0) < self.options.most_on:
                    self.explore(start, SNAPPED)

    def trace_curves(self) -> None:
        """Trace the curves through what was found, and ask for wells of the energy along them that are missing."""
        if not self._traces:
            return
        gone = 0
        while gone < len(self.judged) and len(self.curves.found) < self.options.most_curves:
            phi = self.at_state(self.judged[gone])
            gone += 1
            if phi not in self.curves and self.judged[gone - 1].verdict != "not admissible":
                self._trace(phi)
            if gone == len(self.judged):
                self.part(MEETINGS, self._leave_meetings)

    @property
    def _traces(self) -> bool:
        """Whether curves are traced: they end at fold limits."""
        return self.problem.size <= self.options.most_traced and self.problem.has_limits

    def _trace_from(self, start: np.ndarray) -> bool:
        """Trace the curve beside the start [n] of a branch; False where there is none."""
        if not self._traces or (phi := close(self.problem, start)) is None:
            return False
        if phi not in self.curves:
            self._trace(phi)
        return phi in self.curves

    def _trace(self, phi: np.ndarray) -> None:
        """Trace the curve through a closed state, where one degree of freedom is left."""
        z = tangents(self.problem, phi)
        if z.shape[1] == 1 and len(self.curves.found) < self.options.most_curves:
            for traced in self.curves.trace(phi, z[:, 0]):
                self._along(traced)

    def _along(self, traced: TracedCurve) -> None:
        """Judge the wells of a curve, and go down from where facets begin to cross along it."""
        for well in wells(self.problem, traced.curve):
            self.tally.wells += 1
            self.begin(CURVES)
            self.attempt(self._settle_well, well)
        if (seen := traced.stretches) is not None:
            for i in np.flatnonzero(seen.crosses[:-1] != seen.crosses[1:]):
                free, crossed = (i + 1, i) if seen.crosses[i] else (i, i + 1)
                start, _ = last_free(self.problem, seen.states[free], seen.states[crossed])
                self.explore(start, CURVES)

    def _settle_well(self, well: np.ndarray) -> None:
        """Judge the stationary state at a well of a curve, and go downhill from it."""
        known = {"minimum": ON_CURVE, "not admissible": ON_CURVE}
        known |= dict.fromkeys(("saddle", "not stationary"), 10 * DUPLICATE_TOL)

        def judged() -> bool:
            return any(
                np.abs(well - self.at_state(s)).max() <= known.get(s.verdict, -1.0)
                for s in self.judged
            )

        if (closed := close(self.problem, well)) is not None:
            beside = stationary_beside(self.problem, closed)
            if beside is not None:
                self._add_exact(beside)
        if not judged():
            self.follow(StartState(well, at_limits(self.problem, well)))
        self.tally.resolved += judged()

    def _add_exact(self, x: np.ndarray) -> None:
        """Add the state at a well; where it is not decided, it stands for a minimum that is not told from it."""
        state = judge_end(self.problem, x)
        beside = [
            k
            for k, s in enumerate(self.judged)
            if np.abs(self.at_state(s) - x).max() <= 10 * DUPLICATE_TOL
        ]
        if not self.known(x):
            self.add(state)
        elif state.verdict == "undecided":
            self.exchange(beside[0], state)

    def from_flat_folded(self) -> None:
        """Judge flat-folded states, and go all directions out of them: branches, or to where second order says."""
        problem, tally = self.problem, self.tally
        folded = list_flat_folded(problem)
        states = folded.states
        if folded.reason:
            lies_flat = problem.pattern.lies_flat
            words = "; only ways from the flat state are followed" * lies_flat
            tally.skip(f"flat-folded states: not enumerated, {folded.reason}{words}")
            states = np.zeros((int(lies_flat), problem.size))
        rank = [(round(np.abs(x).sum(), 6), self.labels.key(x)) for x in states]
        states = states[sorted(range(len(states)), key=rank.__getitem__)]
        flat = None if problem.orbits else list_branches(problem)
        if flat is not None and not flat.reason:
            self.part(ESCAPE_PATHS, self._leave_flat_folded, states)
            return
        low = np.argsort(problem.energies(states), kind="stable")[:MOST_SETTLED]
        for x in states[low]:
            self.begin(FLAT_FOLDED)
            self.attempt(self.settle, x, 0)
        for start in beside_folded(problem, list(states), self.problem.moves):
            self.explore(start, BESIDE_FOLDED)

    def _leave_meetings(self) -> None:
        """Go all branch directions of states at which curves meet."""
        for traced in self.curves.found:
            for phi in traced.branch_points:
                if not any(np.abs(phi - x).max() < 10 * RESOLVED for x in self._met_at):
                    self._met_at.append(phi)
                    self._leave(phi, branch_directions(self.problem, phi))

    def _leave_flat_folded(self, states: np.ndarray) -> None:
        """Go all branch directions of flat-folded states [S, n]."""
        for phi, ways in escape_paths(self.problem.pattern, states, self.problem.check_time):
            self.begin(BRANCHES)
            ways = split(self.problem, phi, ways)
            if not self._falls(phi, ways):
                self.attempt(self.settle, phi, 0)  # there is no one way down: its branches are
            self._leave(phi, ways)

    def _falls(self, phi: np.ndarray, ways: TangentCone) -> bool:
        """Return whether the energy falls along a branch out of a flat-folded state, to where no facets cross."""
        problem = self.problem
        pull = problem.torque(phi)
        for d in ways.open(phi, problem.fold_limits):
            if pull @ d < -STATIONARY * float(np.abs(pull).max()):
                beside = close(problem, phi + BESIDE * d)
                if beside is not None and problem.energy_change(phi, beside) < 0:
                    if not (problem.refuses(beside) or problem.doubt(beside)):
                        return True
        return False

    def _leave(self, phi: np.ndarray, ways: TangentCone) -> None:
        """Go all branch directions of a state."""
        if ways.reason:
            self.tally.skip(f"branch directions of a state where curves meet: {ways.reason}")
            return
        lines = sorted(ways.open(phi, self.problem.fold_limits), key=self.labels.key)
        for d in lines:
            start = phi + OUT * d / np.abs(d).max()
            if not self._trace_from(start):
                self.explore(start, BRANCHES)
        for basis in ways.families:
            for d in into_family(phi, basis, self._side, self.problem.fold_limits):
                start = phi + OUT * d / np.abs(d).max()
                # one for each set of creases at limits, with the signs of the others
                sides = np.where(np.abs(start) > RESOLVED, np.sign(start), 0.0)
                cell = (*at_limits(self.problem, start).tolist(), *sides.tolist())
                if cell not in self._cells:
                    self._cells.add(cell)
                    self.explore(start, BRANCHES, hold=True)
        if not lines and not ways.families and not self.known(phi):
            self.add(judge(self.problem, phi))
