"""Finds the stable states of a sheet: traced curves where one degree of freedom is left, descents elsewhere.

Curves leave flat-folded states, which are enumerated, and cross each other at states where closure loses rank, which
are looked for along each; random starts, drawn by labels that do not depend on how creases are numbered, are for what
is on none of them.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from origami_nlp.arguments import check_callback, check_flag, check_number, check_whole
from origami_nlp.errors import Interrupted, OptionError
from origami_nlp.kkt import TangentCone
from origami_nlp.minima import (
    ESCAPE_PATHS,
    MEETINGS,
    Completeness,
    JudgedState,
    MinimaResult,
    PatternSearchReport,
    check_noise,
    check_prove,
)
from origami_nlp.numerics import BESIDE_SINGULAR, DUPLICATE_TOL, RESOLVED, SETTLED
from origami_nlp.pattern import Pattern, as_pattern
from origami_nlp.pattern_problem import PatternProblem, find_labels
from origami_nlp.pattern_states.branch_points import (
    branch_directions,
    closes_along,
    into_family,
    is_on_plane,
    split,
)
from origami_nlp.pattern_states.closed import BESIDE_FLAT, close, lowest_on, of_vertex
from origami_nlp.pattern_states.contact_descents import (
    UNTOLD,
    contact_descent_off,
    contact_descents_along,
)
from origami_nlp.pattern_states.curve import tangents
from origami_nlp.pattern_states.curves import TracedCurve, TracedCurves
from origami_nlp.pattern_states.descent import Descended, descend
from origami_nlp.pattern_states.escape import with_escapes
from origami_nlp.pattern_states.flat_folded import escape_paths, list_branches, list_flat_folded
from origami_nlp.pattern_states.from_minima import IMAGES, are_among
from origami_nlp.pattern_states.interpolant import ON_CURVE, wells
from origami_nlp.pattern_states.judgement import (
    judge,
    judge_end,
    singular_beside,
    stationary_beside,
)
from origami_nlp.pattern_states.noise import NOISE, with_survival
from origami_nlp.pattern_states.plane_faces import contact_descents_on_plane
from origami_nlp.pattern_states.proved import covers, is_tried, prove_list
from origami_nlp.pattern_states.scouting import Scouting
from origami_nlp.proof import ProofOptions
from origami_nlp.starts import (
    OWN,
    Given,
    OtherWells,
    SearchOptions,
    families_in_turn,
    options_of,
)

BRANCHES = "branch directions"
"""Out of the flat state and of others where curves meet, as starts."""
OUT = 0.2
"""First step out of a state where curves meet, of the longest fold angle [rad]."""
PROOF = "the proof that the list is complete"
OF_PROOF = 0.4
"""Share of the time of a search that is kept for a proof that is asked for."""
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
) -> MinimaResult:
    """Find the stable states of a pattern.

    Parameters
    ----------
    pattern
        As `as_pattern` takes it.
    starts
        Random starts in a row that find no other minimum or curve, ten times as many at most; None: as `effort` says.
    seed
        Of the random starts: numbers of creases, the sheet's place and the side it is seen from change nothing.
    contact
        Whether facets must not cross; without, only fold limits count.
    seconds
        Wall time for the search, give or take a second: what was left out is named.  None: 300 s.
    escape, noise, effort, options, max_starts, prove
        As for `minima.find_minima`; errors are those of springs and of the positions of vertices, proofs are for strips
        of vertices of degree four (`proof.prove_strip`), unasked of up to two, or three within fold limits, and for
        meshes whose vertices fold flat (`proof.prove_mesh`).  A proof that is asked for has its share of the time; of
        a mesh within fold limits it comes first, and where it is complete nothing else is searched for.
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
    rng = np.random.default_rng(check_whole("seed", seed, 0))
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
    search = _Search(pattern, contact, begin + seconds, asked)
    starts, most = asked.random_starts(starts, max_starts, search.goes_ahead)
    search.progress, search.found = progress, found
    search.tally.seed, search.tally.effort = seed, OWN if options else effort
    wanted = prove is not None and prove is not False
    if wanted and covers(pattern, contact):
        search.part(PROOF, search.prove, pattern, prove)
    if not search.proved:
        until = search.problem.until
        search.problem.until -= OF_PROOF * seconds * wanted
        search.go(pattern, rng, seed, starts, most)
        if not search.tally.interrupted:
            search.problem.until = until
        if is_tried(pattern, prove, contact):
            search.part(PROOF, search.prove, pattern, prove)
    if escape:
        search.part("escape barriers", search.add_escapes)
    if noise is not None:
        search.part(NOISE, search.add_survival, noise)
    if search.tally.interrupted:
        raise Interrupted(search.result(pattern, starts))
    return search.result(pattern, starts)


class _Search(Scouting):
    """A search on its way."""

    def __init__(
        self, pattern: Pattern, contact: bool, until: float, options: SearchOptions
    ) -> None:
        super().__init__()
        self._since, self.options = time.perf_counter(), options
        self.labels, self.contact = find_labels(pattern), contact
        self.problem = PatternProblem(self.labels.arranged(pattern))
        self.problem.until = until
        self.problem.origin = pattern.corners.mean(axis=0) * (pattern.cell is None)
        self._symmetries = self.labels.symmetries(pattern)
        self.curves = TracedCurves(self.problem, self.labels, contact)
        self.tally = PatternSearchReport(contact="full" if contact else "fold-limits")
        self.judged, self._traced = list[JudgedState](), 0
        self.completeness: Completeness | None = None
        self._planes: list[tuple[np.ndarray, np.ndarray]] = []
        self._families = families_in_turn(self.problem, self.labels)
        self._side = self.labels.drawn(np.random.default_rng(0).normal(size=pattern.creases))

    @property
    def proved(self) -> bool:
        """Whether all that was found is proved to be all."""
        return self.completeness is not None and self.completeness.proved

    def go(
        self, pattern: Pattern, rng: np.random.Generator, seed: int, starts: int, most: int
    ) -> None:
        """Search, with so many random starts in a row that find nothing new, and so many of them at most."""
        for start in Given(self.problem.pattern).states():
            self.part(Given.name, self.explore, start, Given.name)
        if pattern.lies_flat:
            self.part("branch directions of the flat state", self.from_crossroads)
        if len(pattern.vertices) == 1 and not (pattern.holes or pattern.cell):
            self.part("the search for single vertices", self.round_the_vertex, seed)
        asked = self.options
        self.part(OtherWells.name, self.snap, asked.most_popped * starts, asked.most_on * starts)
        for k in range(min(asked.most_drawn * starts, most)):
            if not self.part("random starts", self.draw, rng, k) or self.tally.quiet == starts:
                break
        self.go_on(asked, starts, rng)
        self.part(IMAGES, self.add_images)

    def settle(self, phi: np.ndarray) -> None:
        """Go downhill from a state that all but closes, on either side of saddles, and judge what is reached."""
        if (closed := close(self.problem, phi)) is None or self.known(closed):
            self.tally.open += closed is None
            return
        for side in (self._side, -self._side):
            end = descend(self.problem, closed, side=side)
            if not end.arrived and (better := stationary_beside(self.problem, end.phi)) is not None:
                end = replace(end, phi=better, arrived=True)
            if not end.arrived:
                self.tally.stalled += 1
            elif not self.known(end.phi):
                self.add(judge_end(self.problem, end.phi, self.contact))
            if (
                self.contact
                and (held := contact_descent_off(self.problem, end.path, self.known_minima))
                is not None
            ):
                self.contact_descent(held)
            if not end.saddles:
                return

    def contact_descent(self, end: Descended) -> None:
        """Judge where a descent into contact ended."""
        self.tally.pressed += 1
        if not end.arrived and end.why != UNTOLD:
            self.tally.gave_up[end.why] += 1
            return
        if end.arrived and are_among(end.phi[None], self.known_minima).any():
            self.known(end.phi)
            return
        state = judge(self.problem, end.phi)
        if not end.arrived or state.verdict == "undecided":
            beside = singular_beside(self.problem, end.phi)
            state = state if beside is None else judge(self.problem, beside)
        if not end.arrived and state.verdict != "minimum":
            why = f"not decided: pressed down to where {end.why}"
            state = replace(state, verdict="undecided", kind="", certificate=why)
        self.add(state)

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
        states, most = self.by_energy(), self.tally.starts
        self.judged = with_escapes(self.curves, states, self.contact, most)
        self.problem.check_time()

    def add_survival(self, degrees: float) -> None:
        """Add how many random errors each minimum survives."""
        given = self.by_energy(), self.contact, degrees
        self.judged = with_survival(self.problem, self.labels, *given)

    def result(self, pattern: Pattern, starts: int) -> MinimaResult:
        """Sum up what was judged and done, where `starts` random ones in a row were to find nothing new."""
        minima = self.tally.sum_up(self.by_energy(), self.curves.found, starts)
        self.count_families({family.name for family in self._families})
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
            range(len(states)), key=lambda i: (np.abs(states[i]).sum(), self.labels.key(states[i]))
        )
        if self.part(ESCAPE_PATHS, self._leave_flat_folded, states[order]):
            self.part(MEETINGS, self._leave_meetings)

    def _leave_meetings(self) -> None:
        """Go all branch directions of states at which curves meet."""
        met: list[np.ndarray] = []
        for traced in self.curves.found:  # which grows
            for phi in traced.branch_points:
                if not any(np.abs(phi - x).max() < 10 * RESOLVED for x in met):
                    met.append(phi)
                    self.tally.branch_points += 1
                    self._leave(phi, branch_directions(self.problem, phi))

    def _leave_flat_folded(self, states: np.ndarray) -> None:
        """Go all branch directions of flat-folded states [S, n]."""
        for phi, ways in escape_paths(self.problem.pattern, states, self.problem.check_time):
            self._leave(phi, split(self.problem, phi, ways))

    def _leave(self, phi: np.ndarray, ways: TangentCone) -> None:
        """Go all branch directions of a state."""
        if ways.reason:
            self.tally.skip(f"branch directions of a state where curves meet: {ways.reason}")
            return
        lines = sorted(ways.open(phi, self.problem.fold_limits), key=self.labels.key)
        for d in lines:
            self.explore(phi + OUT * d / np.abs(d).max(), BRANCHES)
        for basis in ways.families:
            self._leave_family(phi, basis)
        if not lines and not ways.families and not self.known(phi):
            self.add(judge(self.problem, phi, self.contact))

    def _leave_family(self, phi: np.ndarray, basis: np.ndarray) -> None:
        """Start into a family of several dimensions: once where it is a plane, on which energy has one minimum."""
        problem = self.problem
        off = phi - basis @ (basis.T @ phi)
        if is_on_plane(self._planes, basis, off):
            return
        d = basis @ (basis.T @ self._side)
        d /= np.abs(d).max()
        if closes_along(problem, phi, d):
            self._planes.append((basis, off))
            lowest = lowest_on(problem, phi, basis)
            if lowest is not None and not self.known(lowest):
                self.add(judge(problem, lowest, self.contact))
            if lowest is not None and self.contact:
                given = problem, self.curves.clearance, (phi, basis), lowest, self.known_minima
                for end in contact_descents_on_plane(*given):
                    self.attempt(self.contact_descent, end)
            return
        for d in into_family(phi, basis, self._side, self.problem.fold_limits):
            self.explore(phi + OUT * d / np.abs(d).max(), BRANCHES)

    def round_the_vertex(self, seed: int) -> None:
        """Judge the minima that the search for single vertices finds, where there is but one."""
        # half of the time that is left: what is found is to be judged, and there are other starts
        seconds = max(0.5 * (self.problem.until - time.monotonic()), 0.0)
        states, whole = of_vertex(self.problem.pattern, self.contact, seed, seconds)
        if not whole:
            self.tally.leave_out("the search for single vertices")
        for phi in states:
            self.tally.of_vertex += 1
            if not self.known(phi):
                self.add(judge_end(self.problem, phi, self.contact))

    def draw(self, rng: np.random.Generator, k: int) -> None:
        """Make a random start."""
        before = self.count()
        family = self._families[k % len(self._families)]
        self.explore(family.draw(rng, 1).x[0], family.name)
        self.tally.drawn += 1
        self.tally.outside += len(self.curves.found) - before[1]
        self.tally.quiet = self.tally.quiet + 1 if self.count() == before else 0

    def explore(self, start: np.ndarray, family: str) -> None:
        """Close a start, trace its curve or go downhill from it, and judge what is found."""
        self.begin(family)
        self.attempt(self._explore, start)

    def _explore(self, start: np.ndarray) -> None:
        if (phi := self._begun(start)) is not None:
            self._enter(phi)

    def _begun(self, start: np.ndarray) -> np.ndarray | None:
        """Close a start; None, and counted, where that fails or leads back to the flat state."""
        phi = close(self.problem, start)
        near = phi is not None and bool(np.abs(phi).max() < BESIDE_FLAT)
        flat = near and self.problem.pattern.lies_flat
        self.tally.open += phi is None
        self.tally.flat += flat
        return None if flat else phi

    def _enter(self, phi: np.ndarray) -> None:
        """Trace the curve through a closed state, or go downhill from it."""
        problem, tally = self.problem, self.tally
        if problem.size > self.options.most_traced or (z := tangents(problem, phi)).shape[1] != 1:
            self.foresee(phi)
        elif phi not in self.curves:
            if self._traced == self.options.most_curves:
                tally.not_traced += 1
                if not self._leads_through_flat(phi):
                    self.settle(phi)
                return
            self._traced += 1
            for traced in self.curves.trace(phi, z[:, 0]):
                self._along(traced)

    def _leads_through_flat(self, phi: np.ndarray) -> bool:
        """Return whether energy falls from a state to the flat one, and on to its mirror image or no further.

        The mirror image is another start, and the flat state, where it is the well of its curve, was judged.
        """
        problem = self.problem
        # of laws that fall wells may be beside it
        convex = all(law is None or law.monotone for law in problem.pattern.laws)
        if not (problem.pattern.lies_flat and convex) or np.abs(phi).max() > 2 * OUT:
            return False
        here, there = (float(problem.torque(x) @ problem.along(x, phi)) for x in (phi, -phi))
        return here > 0 and (there > 0 or abs(here + there) <= SETTLED * here)

    def _along(self, traced: TracedCurve) -> None:
        """Polish and judge the wells of a curve, and states of it that touching facets hold."""
        for well in wells(self.problem, traced.curve):
            self.tally.wells += 1
            self.attempt(self._settle_well, well)
        if traced.stretches is None:
            return
        for end in contact_descents_along(self.problem, traced.stretches, self.known_minima):
            self.attempt(self.contact_descent, end)

    def _settle_well(self, well: np.ndarray) -> None:
        """Go downhill from a well of a curve; where that leads elsewhere, judge the stationary state beside it."""
        self.settle(well)
        known = {"minimum": ON_CURVE, "not admissible": ON_CURVE}
        known |= dict.fromkeys(("saddle", "not stationary"), 10 * DUPLICATE_TOL)
        judged = any(np.abs(well - s.phi).max() <= known.get(s.verdict, -1.0) for s in self.judged)
        if not judged and (closed := close(self.problem, well)) is not None:
            beside = stationary_beside(self.problem, closed)
            if beside is not None:
                if not self.known(beside):
                    self.add(judge_end(self.problem, beside, self.contact))
                # where curves meet, a state that is no minimum says nothing of wells beside it on one of them
                judged = any(
                    np.abs(beside - s.phi).max() <= 10 * DUPLICATE_TOL
                    and (s.verdict in ("minimum", "not admissible") or s.dof == 1)
                    for s in self.judged
                    if s.verdict in known
                )
        self.tally.resolved += judged
