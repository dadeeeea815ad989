"""Finds the stable states of a sheet: starts, descents, what is distinct, certified, and fed on; then curves.

Starts are drawn by labels that do not depend on how creases are numbered.  Where one degree of freedom is left, the
curves through what was found are traced after the search, and each well of the energy along them is asked for.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from origami_nlp.arguments import check_callback, check_flag, check_number, check_whole
from origami_nlp.errors import Interrupted, OptionError
from origami_nlp.kkt import TangentCone, singular_beside
from origami_nlp.minima import (
    ESCAPE_PATHS,
    MEETINGS,
    NOISE,
    Completeness,
    JudgedState,
    MinimaResult,
    PatternSearchReport,
    check_method,
    check_noise,
    check_prove,
    with_survival,
)
from origami_nlp.numerics import BESIDE_SINGULAR, DUPLICATE_TOL, RESOLVED
from origami_nlp.pattern import Pattern, as_pattern
from origami_nlp.pattern_problem import PatternProblem, find_labels, image
from origami_nlp.pattern_states.branch_points import branch_directions, into_family, split
from origami_nlp.pattern_states.clearance import last_free
from origami_nlp.pattern_states.curve import tangents
from origami_nlp.pattern_states.curves import TracedCurve, TracedCurves
from origami_nlp.pattern_states.escape import with_escapes
from origami_nlp.pattern_states.flat_folded import escape_paths, list_branches, list_flat_folded
from origami_nlp.pattern_states.interpolant import ON_CURVE, wells
from origami_nlp.pattern_states.judgement import (
    classified,
    judge,
    judge_end,
)
from origami_nlp.pattern_states.parts import Parts
from origami_nlp.pattern_states.proved import covers, is_tried, prove_list
from origami_nlp.proof import ProofOptions
from origami_nlp.search import (
    BESIDE_FLAT,
    CLOSES_NOT,
    DEEP,
    MOST_TRIED,
    NO_LOWER,
    ByIpopt,
    Changed,
    Draws,
    StartState,
    at_limits,
    close,
    confirm,
    given,
    hinge_rests,
    on_grid,
    other_wells,
    stationary_beside,
    way_down,
)
from origami_nlp.starts import OWN, SearchOptions, options_of

BRANCHES = "branch directions"
"""Out of the flat state and of others where curves meet, as starts."""
GIVEN = "what the pattern gives"
SNAPPED = "minima with a hinge in another well"
CURVES = "wells along curves"
CONFIRMED, MOST_STATES = "confirmation by IPOPT", 12
NO_COMPILER = "compiled descents: no C compiler was found, or none is wanted; IPOPT searched"
"""Said of a search that had none."""
OUT = 0.2
"""First step out of a state where curves meet, of the longest fold angle [rad]."""
PROOF = "the proof that the list is complete"
OF_PROOF = 0.4
"""Share of the time of a search that is kept for a proof that is asked for."""
OF_ESCAPES, LEAST_WORK = 2, 100_000
"""Counted work of escapes over that of the search, and what they may take in any case."""
SECONDS = 300.0
"""For a search, of wall time."""


def find_states(
    pattern: Pattern | str,
    starts: int | None = None,
    seed: int = 0,
    contact: bool = True,
    seconds: float | None = None,
    escape: bool = True,
    noise: float | None = None,
    *,
    progress: Callable[[int, int, str], object] | None = None,
    found: Callable[[float, np.ndarray], object] | None = None,
    effort: str = "normal",
    options: SearchOptions | None = None,
    max_starts: int | None = None,
    prove: bool | float | ProofOptions | None = None,
    method: str = "batch",
) -> MinimaResult:
    """Find the stable states of a pattern.

    Parameters
    ----------
    pattern
        As `as_pattern` takes it.
    starts
        Random starts in a row that find no other minimum or curve, ten times as many at most; None: as `effort` says.
    seed
        Of the random starts, whatever the numbers of creases, the sheet's place and the side it is seen from.
    contact
        Whether facets must not cross; without, only fold limits count.
    seconds
        Wall time for the search, give or take a second: what was left out is named.  None: 300 s.
    escape, noise, effort, options, max_starts, prove
        As for `minima.find_minima`; errors are those of springs and of the positions of vertices, proofs are for
        meshes of vertices of degree four of which none folds flat (`proof.prove_sheet`), unasked of up to four
        within fold limits, or all do, unasked of up to two.  A proof that is asked for has its share of the time;
        of a mesh within fold limits it comes first, and where it is complete nothing else is searched for.
    method
        ``"batch"``: compiled descents with an active set; ``"ipopt"``: IPOPT from the same starts.
    progress
        Called as progress(starts, minima, what the search is at), after each start and each minimum.
    found
        Called with energy [J] and fold angles [rad] of each minimum as it is found.

    Returns
    -------
    MinimaResult
        Minima with their certificates, what could not be decided, and what was enumerated, sampled, and ended open.

    Raises
    ------
    OptionError
        If an argument is not what it must be, or the pattern has no crease.
    Interrupted
        If the user interrupts it: a `KeyboardInterrupt` whose ``result`` holds what was found.

    Examples
    --------
    >>> from origami_nlp.pattern_states import find_states
    >>> len(find_states("metasheet:2x3", starts=4).minima)
    5
    """
    begin = time.monotonic()
    seconds = check_number("seconds", SECONDS if seconds is None else seconds, 0.0)
    pattern = as_pattern(pattern)
    asked = options_of(effort, options)
    check_whole("seed", seed, 0)
    check_flag("escape", escape)
    check_noise(noise)
    if noise is not None:
        pattern.check_alone("the survival of states under errors")
    check_prove("prove", prove)
    check_callback("progress", progress)
    check_callback("found", found)
    if not pattern.creases:
        raise OptionError("the pattern has no crease: there is nothing to fold")
    if contact:
        pattern.check_wide()
    check_method(method)
    search = _Search(pattern, contact, begin + seconds, asked, seed)
    if method == "ipopt":
        search.go_down = ByIpopt(search.problem)
    starts, most = asked.random_starts(starts, max_starts, search.problem)
    search.progress, search.found = progress, found
    search.tally.seed, search.tally.effort = seed, OWN if options else effort
    wanted = prove is not None and prove is not False
    if wanted and covers(pattern, contact):
        search.part(PROOF, search.prove, pattern, prove)
    if not search.proved:
        until = search.problem.until
        search.problem.until -= OF_PROOF * seconds * wanted
        search.go(pattern, starts, most)
        if not search.tally.interrupted:
            search.problem.until = until
        if is_tried(pattern, prove, contact):
            search.part(PROOF, search.prove, pattern, prove)
    if escape:
        search.part("escape barriers", search.add_escapes)
    search.part(CONFIRMED, search.add_confirmations)
    if noise is not None:
        search.part(NOISE, search.add_survival, noise)
    if search.tally.interrupted:
        raise Interrupted(search.result(pattern, starts))
    return search.result(pattern, starts)


class _Search(Parts):
    """A search on its way."""

    def __init__(
        self, pattern: Pattern, contact: bool, until: float, options: SearchOptions, seed: int
    ) -> None:
        super().__init__()
        self._since, self.options = time.perf_counter(), options
        self.labels, self.contact = find_labels(pattern), contact
        self.problem = PatternProblem(self.labels.arranged(pattern), contact)
        self.dof = self.problem.dof  # before the clock can stop it
        self.problem.until = until
        self.problem.origin = pattern.corners.mean(axis=0) * (pattern.cell is None)
        self._symmetries = self.labels.symmetries(pattern)
        self.curves = TracedCurves(self.problem, self.labels, contact)
        self.tally = PatternSearchReport(contact="full" if contact else "fold-limits")
        self.judged = list[JudgedState]()
        self.completeness: Completeness | None = None
        self._side = self.labels.drawn(np.random.default_rng(0).normal(size=pattern.creases))
        self._draws = Draws(self.problem, self.labels, seed)
        self._met_at, self._ends, self._branches = [list[np.ndarray]() for _ in range(3)]
        self.go_down = way_down(self.problem)
        if isinstance(self.go_down, ByIpopt):
            self.tally.skip(NO_COMPILER)
        self._seed = seed

    @property
    def proved(self) -> bool:
        """Whether all that was found is proved to be all."""
        return self.completeness is not None and self.completeness.proved

    def go(self, pattern: Pattern, starts: int, most: int) -> None:
        """Search, with so many random starts in a row that find nothing new, and so many of them at most."""
        for start in given(self.problem.pattern):
            self.part(GIVEN, self.explore, start, GIVEN)
        if pattern.lies_flat:
            self.part("branch directions of the flat state", self.from_crossroads)
        self.part("random starts", self.draw, starts, most)
        self.part(CURVES, self.trace_curves)

    def draw(self, starts: int, most: int) -> None:
        """Make random starts, by what families led to and evenly, until so many led to nothing new.

        Each start is drawn from numbers of its own, and what it takes is counted, not measured: one that rounding sends
        elsewhere moves no other.
        """
        draws, tally = self._draws, self.tally
        while tally.drawn < most and tally.quiet < starts and draws.made < MOST_TRIED * most:
            self.problem.check_time()
            name, batch, asides = draws.next(most - tally.drawn)
            for way in self.go_down.each(batch, asides, self._is_end):
                self.begin(name)
                before, lost = self.count()[0], tally.stopped[CLOSES_NOT] + tally.open
                self.attempt(self._arrive, way)
                new = self.count()[0] - before
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
        far = np.abs(np.array(self._ends).reshape(-1, len(x)) - x).max(axis=1, initial=0.0)
        if not (far <= DUPLICATE_TOL).any():
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
        self._ends.append(x)
        state = judge_end(self.problem, x, self.contact)
        near = None if state.verdict == "minimum" else singular_beside(self.problem, x)
        if near is not None:
            exact = judge(self.problem, near, self.contact)
            state = state if exact.verdict == "undecided" else exact
        at = self.at_state(state)
        alike = self._images(at) if state.refuted else [at]
        if any(self.known(x, state.verdict) for x in alike):
            return None  # of what is refuted one image is kept
        self.add(state)
        return state

    def _images(self, x: np.ndarray) -> list[np.ndarray]:
        """Return a state and its images under the symmetries of the sheet and its springs."""
        return [x, *(image(symmetry, x) for symmetry in self._symmetries)]

    def snap(self, x: np.ndarray) -> None:
        """Start from a minimum with each hinge in each other well of its law."""
        if hinge_rests(self.problem.pattern):
            for start in other_wells(self.problem.pattern, self.labels, x):
                if self.tally.by_source.get(SNAPPED, 0) < self.options.most_on:
                    self.explore(start, SNAPPED)

    def trace_curves(self) -> None:
        """Trace the curves through what was found, and ask for wells of the energy along them that are missing."""
        if self.problem.size > self.options.most_traced:
            return
        for start in self._branches:
            if (phi := close(self.problem, start)) is not None and phi not in self.curves:
                self._trace(phi)
        gone = 0
        while gone < len(self.judged) and len(self.curves.found) < self.options.most_curves:
            phi = self.at_state(self.judged[gone])
            gone += 1
            if phi not in self.curves and self.judged[gone - 1].verdict != "not admissible":
                self._trace(phi)
            if gone == len(self.judged):
                self.part(MEETINGS, self._leave_meetings)

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
                start = last_free(self.problem, seen.states[free], seen.states[crossed])
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
        state = judge_end(self.problem, x, self.contact)
        beside = [
            k
            for k, s in enumerate(self.judged)
            if np.abs(self.at_state(s) - x).max() <= 10 * DUPLICATE_TOL
        ]
        if not self.known(x):
            self.add(state)
        elif state.verdict == "undecided":
            self.judged[beside[0]] = state

    def prove(self, pattern: Pattern, wanted: bool | float | ProofOptions | None) -> None:
        """Try to prove that the minima are all; what is missing is added."""
        known = self.problem, self.judged, self.contact
        self.completeness, new = prove_list(pattern, *known, wanted)
        minima = [s for s in new if s.verdict == "minimum"]

        def is_beside(one: JudgedState, other: JudgedState) -> bool:
            """Whether one of two states is undecided, as it was not distinguished from the other."""
            far = np.abs(one.phi - other.phi).max()
            return one.verdict == "undecided" and bool(far <= BESIDE_SINGULAR)

        for state in new:
            if not any(is_beside(state, m) for m in minima):
                beside = [k for k, s in enumerate(self.judged) if is_beside(s, state)]
                if state.verdict == "minimum" and beside:
                    self.judged[beside[0]] = state
                self.add(state)
        listed = [s.phi for s in self.judged if s.verdict == "minimum"]
        for m in minima:
            if min((np.abs(m.phi - x).max() for x in listed), default=np.inf) > DUPLICATE_TOL:
                why = "a proved minimum is not distinguished from a state that is listed otherwise"
                self.completeness = replace(self.completeness, status="not-proved", reason=why)

    def add_escapes(self) -> None:
        """Add what it takes to leave each minimum."""
        most = max(OF_ESCAPES * self.go_down.work, LEAST_WORK)
        self.judged = with_escapes(self.curves, self.by_energy(), self.contact, most)
        self.problem.check_time()

    def add_confirmations(self) -> None:
        """Add what IPOPT says of the lowest minima from beside them, up to so many creases."""
        self.judged = self.by_energy()
        lowest = [k for k, s in enumerate(self.judged) if s.verdict == "minimum"][:MOST_STATES]
        for k in lowest:
            self.problem.check_time()
            if (solver := confirm(self.problem, self.at_state(self.judged[k]))) is not None:
                self.tally.solves += 1
                self.tally.iterations += solver.iterations
                self.judged[k] = replace(self.judged[k], solver=solver)

    def add_survival(self, degrees: float) -> None:
        """Add how many random errors each minimum survives."""
        given = self.by_energy(), degrees, type(self.go_down)
        self.judged = with_survival(self.problem, self.labels, *given)

    def result(self, pattern: Pattern, starts: int) -> MinimaResult:
        """Sum up what was judged and done, where `starts` random ones in a row were to find nothing new."""
        minima = self.tally.sum_up(self.by_energy(), self.curves.found, starts)
        self.count_families(self._draws.names)
        self.tally.seconds = time.perf_counter() - self._since
        curves = tuple(self.curves.found)
        return MinimaResult(pattern, minima, self.tally, self.completeness, curves=curves)

    def from_crossroads(self) -> None:
        """Go all branch directions of flat-folded states, and out of states at which the curves meet others."""
        pattern, tally = self.problem.pattern, self.tally
        self.add(judge(self.problem, np.zeros(pattern.creases), self.contact))
        flat = list_branches(pattern, None, self.problem.check_time)
        if flat.reason:
            self.tally.skip(
                f"branch directions of the flat state, and of flat-folded ones: not enumerated, {flat.reason}"
            )
            return
        tally.lines, tally.families = len(flat.lines), len(flat.families)
        folded = list_flat_folded(pattern, self.contact, self.problem.check_time)
        states = folded.states
        if folded.reason:
            self.tally.skip(
                f"flat-folded states: not enumerated, {folded.reason}; only branches from the flat state are followed"
            )
            states = np.zeros((1, pattern.creases))
        tally.flat_folded = len(states)
        order = sorted(
            range(len(states)),
            key=lambda i: (round(np.abs(states[i]).sum(), 6), self.labels.key(states[i])),
        )
        self.part(ESCAPE_PATHS, self._leave_flat_folded, states[order])

    def _leave_meetings(self) -> None:
        """Go all branch directions of states at which curves meet."""
        for traced in self.curves.found:
            for phi in traced.branch_points:
                if not any(np.abs(phi - x).max() < 10 * RESOLVED for x in self._met_at):
                    self._met_at.append(phi)
                    self.tally.branch_points += 1
                    self._leave(phi, branch_directions(self.problem, phi))

    def _leave_flat_folded(self, states: np.ndarray) -> None:
        """Go all branch directions of flat-folded states [S, n]."""
        for phi, ways in escape_paths(self.problem.pattern, states, self.problem.check_time):
            self.begin(BRANCHES)
            self.attempt(self.settle, phi, 0)  # there is no one way down: its branches are
            self._leave(phi, split(self.problem, phi, ways))

    def _leave(self, phi: np.ndarray, ways: TangentCone) -> None:
        """Go all branch directions of a state."""
        if ways.reason:
            self.tally.skip(f"branch directions of a state where curves meet: {ways.reason}")
            return
        lines = sorted(ways.open(phi, self.problem.fold_limits), key=self.labels.key)
        for d in lines:
            self._branches.append(phi + OUT * d / np.abs(d).max())
            self.explore(self._branches[-1], BRANCHES)
        for basis in ways.families:
            for d in into_family(phi, basis, self._side, self.problem.fold_limits):
                self.explore(phi + OUT * d / np.abs(d).max(), BRANCHES, hold=True)
        if not lines and not ways.families and not self.known(phi):
            self.add(judge(self.problem, phi, self.contact))
