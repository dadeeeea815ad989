"""One search: what it may spend, what it lists, traces and descends to, and when it stops."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from origami_nlp.kkt import Polished, Solve, Verdict, polish, polished_nearby, project
from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.canonical import canonical_model
from origami_nlp.minima.coverage import StrataCount, count_strata
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
from origami_nlp.minima.search import Search
from origami_nlp.minima.stopping import chao1, chao1_error
from origami_nlp.numerics import (
    CLOSURE_TOL,
    DESIGN_SNAP,
    DUPLICATE_TOL,
    NEAR_CONTACT,
    NEAR_SINGULAR_TOL,
)
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem, pose
from origami_nlp.problem import Model
from origami_nlp.search import ByIpopt, FoldedCreases, Follower, Touch, Uniform
from origami_nlp.starts import (
    CORNER,
    SOURCES,
    FlatFoldings,
    HingeSets,
    NearFlat,
    NearFolded,
    RigidStates,
    Rounds,
    SearchOptions,
    is_chain,
)

FEW_DOF = 2
"""Degrees of freedom up to which one round may suffice, within fold limits (beyond, each shape comes in lifts)."""
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
        starts: tuple[int, int],
        progress: Progress | None,
        until: float = math.inf,
        found: Found | None = None,
        problem: PatternProblem | None = None,
    ) -> None:
        self.model, self.seed, self.options = model, seed, options
        self.fewest, self.most = starts
        self.progress, self.until = progress, until
        self._found, self._told = found, set[int]()
        self.record = Record(problem or pose(model.scene))
        self.stopped_by = "rule"
        self.complete = ""
        self.strata: tuple[StrataCount, ...] = ()
        self.corners: tuple[int, bool] = (0, False)
        self.foldings: list[np.ndarray] = []
        self.given: list[tuple[np.ndarray, FoundState | None]] = []
        self.traced: CandidateMinima | None = None
        self.interrupted = self.by_ipopt = False
        self.begin = time.perf_counter()
        self.turn = (
            until if math.isinf(until) else until - options.judging * (until - time.monotonic())
        )

    def work(self, guesses: list[np.ndarray], workers: int = 1) -> None:
        """List states, and search; guesses: states [N] to start from first."""
        self.list_states()
        self._tell()
        self.given = [(g, self._stationary_at(self.model.reduce(g))) for g in guesses]
        # where nothing can move within the symmetry, the listed states are all there is
        if self.model.dof > 0 and not self._late():
            self.search([self.model.reduce(g) for g in guesses], workers)

    def list_states(self) -> None:
        """Judge the states that no descent finds: isolated flat foldings, hinge sets, states that cannot move."""
        model, record = self.model, self.record
        self.foldings = record.states_of(FlatFoldings(model))
        states = [*record.states_of(HingeSets(model)), *self.foldings]
        if model.dof <= 0:
            states += record.states_of(RigidStates(model, self.seed))
        for x in states:
            if self._late():
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

    def search(self, guesses: list[np.ndarray], workers: int) -> None:
        """Start from guesses, then round after round until the stopping rule says that it is enough."""
        # how finely curves are cut suits the torque of springs: under forces in space a search goes on from there
        if self.model.dof == 1 and self._traced() and self.model.parameters.dead is None:
            self.stopped_by = "complete"
            self._tell()
            return
        under = canonical_model(self.model)
        limits = self.turn, self.until
        search = Search(self.model, self.record, under, workers, self._tell, limits)
        large = self.model.size > self.options.most_batched and not is_chain(self.model)
        if self.by_ipopt or large or not search.usable:
            self._one_by_one()
            return
        for family in (NearFlat(self.model), NearFolded(self.model, self.foldings)):
            search.also_from(self.record.states_of(family))
        if guesses:
            search.run(search.closed(np.array(guesses), touching=True))
        self._rounds(search, Rounds(under[0] if under else self.model, self.seed, self.options))

    def _rounds(self, search: Search, rounds: Rounds) -> None:
        self.stopped_by = "cap"
        quiet = found = 0
        for number, samples in enumerate(rounds, start=1):
            found = found if 1 < number <= rounds.opening else len(self.record.minima)
            some = np.arange(min(len(samples), self.most - self.record.starts))
            search.run(samples[some])
            if number < rounds.opening and self.record.starts < self.most:
                self._tell()
                if self._late():
                    return
                continue
            quiet = quiet + 1 if len(self.record.minima) == found else 0
            self._tell()
            if self._late():
                return
            if self.record.starts >= self.most:
                break
            if self.record.starts >= self.fewest and self._enough(quiet):
                found = len(self.record.minima)
                search.run()
                if self._late():
                    return
                if len(self.record.minima) == found:
                    self.stopped_by = "rule"
                    break
                quiet = 0
        search.run()
        if self._late():
            return
        tried = self.record.by_source[SOURCES[CORNER]]  # a cap on starts leaves some out
        self.corners = tried, rounds.every_corner and tried == rounds.corners
        if rounds.touches is not None and rounds.touches.found is not None:
            self.strata, _ = count_strata(rounds.touches.found, search.minima_on_touches())

    def interrupt(self) -> None:
        """End the search where the user interrupted it, with the states that it had judged."""
        self.stopped_by, self.until, self.interrupted = "time", -math.inf, True
        self.record.answers = [a for a in self.record.answers if a.what is not None]

    def _late(self) -> bool:
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

    def _enough(self, quiet: int) -> bool:
        hits = self.record.drawn_hits
        if min(hits, default=self.options.hits) >= self.options.hits:
            # the first round holds several: where there is more to find, one that found nothing is wanted as well
            few = self.model.dof <= FEW_DOF and self.model.has_limits
            # of laws that fall minima are many and their basins small
            few &= all(law is None or law.monotone for law in self.model.scene.laws)
            return quiet > 0 or few
        # Chao's estimate of the minima that nothing has reached yet, from those reached once and twice
        return quiet >= self.options.quiet and chao1(hits) < 0.5

    def _one_by_one(self) -> None:
        """Search with one way down after the other: by IPOPT, or under forces in space with an active set."""
        self.stopped_by = "cap"
        quiet = 0
        fewest = max(self.fewest, 16 * self.options.hits)
        for new in itertools.islice(self._ways_down(), self.most):
            if new is not None:
                judge(self.record, new)
            quiet = 0 if new is not None and new.is_minimum else quiet + 1
            self._tell()
            if self._late():
                break
            if self.record.starts >= fewest and self._enough(quiet // fewest):
                self.stopped_by = "rule"
                break

    def _ways_down(self) -> Iterator[FoundState | None]:
        """Go down from random starts for ever; yields each answer that has to be judged, else None."""
        record, problem = self.record, self.record.problem
        go_down: Follower | ByIpopt = Follower(problem)
        ipopt = self.by_ipopt or self.model.parameters.dead is None or not go_down.usable
        if ipopt:
            go_down = ByIpopt(problem)
        n, rng = problem.size, np.random.default_rng(self.seed)
        labels = CanonicalLabelling(np.arange(n), 1.0, False, ())
        kinds: list[type[Any]] = [
            Uniform,
            *[FoldedCreases] * problem.has_limits,
            *[Touch] * problem.contact,
        ]
        for kind in itertools.cycle(kind(problem, labels) for kind in kinds):
            for start in kind.draw(rng, 1):
                record.starts += 1
                record.drawn += 1
                record.by_source[kind.name] += 1
                before = go_down.work
                (way,) = go_down.each([start], rng.normal(size=(1, n)))
                x, why = way()
                if ipopt:
                    record.solves += 1
                    record.iterations += go_down.work - before
                    record.statuses[why or "Solve_Succeeded"] += 1
                record.stalled += bool(why)
                if why:
                    yield None
                    continue
                record.feasible_starts += 1
                record.converged += 1
                found, new = record.file(self.model, exact_state(self.model, x))
                found.hits += 1
                found.in_rounds += 1
                found.first = found.first or record.drawn
                yield found if new else None

    def _tell(self) -> None:
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
            corners=self.corners[0],
            every_corner=self.corners[1],
            complete=self.complete,
            strata=self.strata,
            interrupted=self.interrupted,
        )
