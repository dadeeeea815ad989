"""One search: what it may spend, what it lists, traces and descends to, and when it stops."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np

from origami_nlp.kkt import Polished, Solve, Verdict, polish, polished_nearby, project
from origami_nlp.minima.account import OPEN_FROM, SearchReport
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.one_dof import EXACT, CandidateMinima, trace
from origami_nlp.minima.record import (
    BREAKDOWNS,
    FoundState,
    Record,
    closes,
    exact_state,
    judge,
    listed,
)
from origami_nlp.minima.stopping import chao1, chao1_error
from origami_nlp.numerics import (
    CLOSURE_TOL,
    DESIGN_SNAP,
    DUPLICATE_TOL,
    NEAR_CONTACT,
    NEAR_SINGULAR_TOL,
)
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import Model
from origami_nlp.starts import FlatFoldings, HingeSets, RigidStates, SearchOptions

Progress = Callable[[int, int, int], None]
"""Called as progress(starts, minima found, how many of these one drawn start reached)."""
Found = Callable[[float, np.ndarray], object]
"""Called as found(energy, fold angles [N]) with each minimum."""


class Job:
    """One search: what it may spend, and its record."""

    def __init__(
        self,
        model: Model,
        seed: int,
        options: SearchOptions,
        starts: tuple[int | None, int | None],
        progress: Progress | None,
        until: float = math.inf,
        found: Found | None = None,
        problem: PatternProblem | None = None,
    ) -> None:
        self.model, self.seed, self.options = model, seed, options
        self.progress, self.until = progress, until
        self._found, self._told = found, set[int]()
        self.record = Record(problem or pose(model.scene))
        self.in_a_row, self.most = options.random_starts(*starts, self.record.problem)
        self.stopped_by = "rule"
        self.complete = ""
        self.foldings: list[np.ndarray] = []
        self.given: list[tuple[np.ndarray, FoundState | None]] = []
        self.traced: CandidateMinima | None = None
        self.interrupted = False
        self.begin = time.perf_counter()
        self.turn = (
            until if math.isinf(until) else until - options.judging * (until - time.monotonic())
        )

    def work(self, guesses: list[np.ndarray]) -> bool:
        """List states, and trace curves; guesses: states [N], also judged where they are.

        Returns
        -------
        bool
            Whether there is more to search for.
        """
        self.list_states()
        self.tell()
        self.given = [(g, self._stationary_at(self.model.reduce(g))) for g in guesses]
        # where nothing can move within the symmetry, the listed states are all there is
        if self.model.dof <= 0 or self.late():
            return False
        # how finely curves are cut suits the torque of springs: under forces in space a search goes on from there
        if self.model.dof == 1 and self._traced() and self.model.parameters.dead is None:
            self.stopped_by = "complete"
            self.tell()
            return False
        return True

    def list_states(self) -> None:
        """Judge the states that no descent finds: isolated flat foldings, hinge sets, states that cannot move."""
        model, record = self.model, self.record
        self.foldings = record.states_of(FlatFoldings(model))
        states = [*record.states_of(HingeSets(model)), *self.foldings]
        if model.dof <= 0:
            states += record.states_of(RigidStates(model, self.seed))
        for x in states:
            if self.late():
                return
            if record.known(x) is None:
                with record.surviving("a listed state"):
                    record.answers.append(listed(record, model, x))

    def _stationary_at(self, x: np.ndarray) -> FoundState | None:
        """Return the stationary state next to a guess, judged: a minimum before others; None where there is none."""
        best = self.record.known(x)
        # what people type holds contacts to fewer digits than what was computed
        for tolerance in (NEAR_CONTACT, DESIGN_SNAP):
            if best is not None and best.is_minimum:
                return best
            for state in self._nearby(x, tolerance):
                answer, new = self.record.file(self.model, state)
                if new:
                    answer.listed = True
                    judge(self.record, answer)
                if best is None or answer.is_minimum:
                    best = answer
                if answer.is_minimum:
                    break
        return best

    def _nearby(self, x: np.ndarray, tolerance: float) -> list[Polished]:
        try:
            found = list(polished_nearby(self.model, x, tolerance))
        except BREAKDOWNS as error:
            self.record.failed[str(error)] += 1
            return []
        return [state for state in found if closes(self.model, state.x)]

    def _refusal(self, guess: np.ndarray, answer: FoundState | None) -> JudgedState | None:
        """Return why no minimum is listed at a guess [N]; None where one is."""
        model = self.model
        x = model.reduce(guess)
        verdict: Verdict = "not admissible"
        if np.abs(model.expand(x) - guess).max() > NEAR_SINGULAR_TOL:
            why = "it does not have the symmetry of the scene"
        elif answer is not None and answer.what is not None:
            if answer.is_minimum:
                return None
            verdict, why = answer.what.verdict, answer.what.reason
        else:
            closed, residual = project(model, x)
            refused = model.refuses(closed)
            if residual > CLOSURE_TOL or np.abs(closed - x).max() > NEAR_SINGULAR_TOL:
                why = f"no state within {NEAR_SINGULAR_TOL:g} rad of it closes"
            elif refused:
                why = refused
            else:
                verdict = "not stationary"
                why = f"no state within {NEAR_SINGULAR_TOL:g} rad of it is an equilibrium: it was descended from"
        return JudgedState(model.energy(x), tuple(guess.tolist()), verdict, why)

    def interrupt(self) -> None:
        """End the search where the user interrupted it, with the states that it had judged."""
        self.stopped_by, self.until, self.interrupted = "time", -math.inf, True
        self.record.answers = [a for a in self.record.answers if a.what is not None]

    def late(self) -> bool:
        """Return whether the time is over, and remember it."""
        if time.monotonic() > self.turn:
            self.stopped_by = "time"
        return self.stopped_by == "time"

    def _traced(self) -> bool:
        """Judge all states on curves (one degree of freedom); return whether these were resolved and all was judged."""
        broken = self.record.failed.total()
        with self.record.surviving("curves of one degree of freedom"):
            self.traced = trace(self.model)
        if (traced := self.traced) is None:
            return False
        exact = np.isin(traced.origins, EXACT)
        for x, contacts, verify_minimum in zip(traced.states, traced.contacts, exact, strict=True):
            with self.record.surviving("a candidate on a curve"):
                end = Solve(x, "", 0, math.nan, np.ones(self.model.size), None)
                state = polish(self.model, end, contacts)
                if verify_minimum and not (
                    state.converged and np.abs(state.x - x).max() <= DUPLICATE_TOL
                ):
                    # Newton leaves or cannot resolve a state where closure is singular: it is judged where it was found
                    state = exact_state(self.model, x)
                answer, new = self.record.file(self.model, state)
                answer.listed = True
                if new:
                    judge(self.record, answer)
        whole = traced.complete and self.record.failed.total() == broken
        self.complete = traced.reason if whole and self.model.parameters.dead is None else ""
        return whole

    @property
    def is_enough(self) -> bool:
        """Whether so many random starts in a row found nothing new, and none is expected that nothing has reached."""
        return self.record.quiet >= self.in_a_row and chao1(self.record.drawn_hits) < OPEN_FROM

    def tell(self) -> None:
        """Tell of minima that are new, and of how far the search is."""
        r, found = self.record, self._found
        for answer in r.minima if found else ():
            if found and id(answer) not in self._told:
                self._told.add(id(answer))
                x = answer.polished.x
                found(float(self.model.energy(x)), self.model.expand(x))
        if self.progress:
            self.progress(r.starts, len(r.minima), r.seen_once)

    def report(
        self, others: list[JudgedState], outcomes: dict[str, int], seconds: float, effort: str
    ) -> SearchReport:
        """Describe what was done."""
        r = self.record
        return SearchReport(
            starts=r.starts,
            feasible_starts=r.feasible_starts,
            solves=r.solves,
            statuses=dict(r.statuses),
            outcomes=outcomes,
            expected_undiscovered=chao1(r.drawn_hits),
            expected_error=chao1_error(r.drawn_hits),
            stopped_by=self.stopped_by,
            seconds=seconds,
            seed=self.seed,
            rejected=tuple(o for o in others if o.verdict != "undecided"),
            undecided=tuple(o for o in others if o.verdict == "undecided"),
            iterations=r.iterations,
            effort=effort,
            by_source={name: count for name, count in r.by_source.items() if count},
            stalled=r.stalled,
            refused=tuple(why for g in self.given if (why := self._refusal(*g)) is not None),
            failed={why: count for why, count in sorted(r.failed.items()) if count},
            seen_once=r.seen_once,
            quiet=0 if self.stopped_by == "time" else r.quiet,
            complete=self.complete,
            interrupted=self.interrupted,
        )
