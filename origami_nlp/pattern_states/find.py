"""Finds the stable states of an origami: searched for, proved, and what else is asked of each."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from origami_nlp.arguments import (
    check_angles,
    check_callback,
    check_flag,
    check_number,
    check_whole,
    shown,
)
from origami_nlp.errors import Interrupted, OptionError
from origami_nlp.minima import (
    NOISE,
    Completeness,
    JudgedState,
    MinimaResult,
    check_noise,
    check_prove,
    with_full_space,
    with_survival,
)
from origami_nlp.numerics import BESIDE_SINGULAR, DUPLICATE_TOL, NEAR_SINGULAR_TOL
from origami_nlp.pattern import Pattern, Scene, Stated, as_origami
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.pattern_states.escape import with_escapes
from origami_nlp.pattern_states.proved import FEW, Provable, provable_of, prove_list
from origami_nlp.pattern_states.search import Search
from origami_nlp.proof import ProofOptions
from origami_nlp.search import OWN, SearchOptions, confirm, options_of

METHODS = ("batch", "ipopt")
"""Engines of a search: compiled descents with an active set, or IPOPT."""
FULL = "verdicts without the symmetry"
CONFIRMED, MOST_STATES = "confirmation by IPOPT", 3
PROOF = "the proof that the list is complete"
OF_PROOF = 0.4
"""Share of the time of a search that is kept for a proof that is asked for."""
BRIEF = 8
"""Share of the random starts in a row that are made before a proof."""
OF_ESCAPES, LEAST_WORK = 2, 100_000
"""Counted work of escapes over that of the search, and what they may take in any case."""
SECONDS = 300.0
"""For a search, of wall time."""


def _check_method(method: object) -> None:
    if method not in METHODS:
        raise OptionError(f"method = {shown(method)} must be {' or '.join(map(repr, METHODS))}")


def find_states(
    origami: Stated,
    *,
    seed: int = 0,
    effort: str = "normal",
    options: SearchOptions | None = None,
    starts: int | None = None,
    max_starts: int | None = None,
    guesses: Sequence[np.ndarray] = (),
    seconds: float | None = None,
    prove: bool | float | ProofOptions | None = None,
    escape: bool = True,
    full: bool | None = None,
    noise: float | None = None,
    method: str = "batch",
    progress: Callable[[int, int, str], object] | None = None,
    found: Callable[[float, np.ndarray], object] | None = None,
) -> MinimaResult:
    """Find the stable states of an origami: of a scene among states of its symmetry, whichever way they wind.

    Parameters
    ----------
    origami
        As `as_origami` takes it.
    seed
        Of the random starts, whatever the numbers of creases, the sheet's place and the side it is seen from.
    effort
        ``"quick"``, ``"normal"`` or ``"thorough"``: how many starts in a row find nothing new.
    options
        All that steers the search, in place of the effort.
    starts, max_starts
        Random starts in a row that find no other minimum or curve, and starts in all; None: as `effort` says, an eighth
        of those in a row before a proof that is tried unasked, the others where it fails.
    guesses
        States to start from first, fold angles [N] [rad] each: `SearchReport.refused` says why one is no minimum.
    seconds
        Wall time for the search, give or take a second: what was left out is named.  None: 300 s.
    prove
        Whether to prove that the list is complete: True, seconds, or `ProofOptions`; False: no.
        None: where that is cheap.  A proof that is asked for has its share of the time; of a mesh that folds flat,
        within fold limits, it comes first, and where it is complete nothing else is searched for.
    escape
        Whether to say what it takes to leave each minimum (`JudgedState.escape`).
    full
        Whether each minimum is also judged without an imposed symmetry; None: where that is affordable
        (`minima.full_space.is_affordable`).
    noise
        Standard deviation [degrees] of random errors of rest angles, stiffnesses (as a share, in radians) and sector
        angles, of a pattern positions of vertices: how many of 20 draws each minimum survives.
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
    AngleError
        If a guess is not N finite numbers.
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
    stated = as_origami(origami)
    asked = options_of(effort, options)
    check_whole("seed", seed, 0)
    check_flag("escape", escape)
    if full is not None:
        check_flag("full", full)
    check_noise(noise)
    check_prove("prove", prove)
    check_callback("progress", progress)
    check_callback("found", found)
    _check_method(method)
    stated.check_wide()
    posed = pose(stated)
    if not posed.size:
        raise OptionError("the pattern has no crease: there is nothing to fold")
    guesses = _check_guesses(guesses, posed)
    search = _Answer(posed.arranged(), begin + seconds, asked, seed, ipopt=method == "ipopt")
    search.stated, search.posed = stated, posed
    in_a_row, most = asked.random_starts(starts, max_starts, search.problem)
    search.progress, search.found = progress, found
    search.tally.seed, search.tally.effort = seed, OWN if options else effort
    wanted = prove is not None and prove is not False
    if wanted and search.provable.alone:
        search.part(PROOF, search.prove, prove)
    if not search.proved:
        until = search.problem.until
        search.problem.until -= OF_PROOF * seconds * wanted
        # a proof that follows finds what few starts miss
        brief = prove is not False and starts is None and search.proves
        search.go(guesses, in_a_row // (BRIEF if brief else 1), most)
        if not search.tally.interrupted:
            search.problem.until = until
        if prove is not False:
            search.part(PROOF, search.prove, prove)
        if brief and (search.completeness is None or search.completeness.status == "not-proved"):
            search.go_on(in_a_row, most)
    if escape:
        search.part("escape barriers", search.add_escapes)
    search.part(CONFIRMED, search.add_confirmations)
    if noise is not None:
        search.part(NOISE, search.add_survival, noise)
    if full or (full is None and posed.orbits is not None):
        search.part(FULL, search.add_full_space, full)
    result = search.result()
    if search.tally.interrupted:
        raise Interrupted(result)
    return result


def _check_guesses(guesses: object, problem: PatternProblem) -> list[np.ndarray]:
    if isinstance(guesses, str | bytes | dict) or not isinstance(guesses, Iterable):
        raise OptionError(
            f"guesses = {shown(guesses)} must be a list of states, [N] fold angles each"
        )
    many = problem.pattern.creases
    return [
        check_angles(f"guesses[{k}]", g, many, one=True) for k, g in enumerate(guesses, start=1)
    ]


class _Answer(Search):
    """A search, and what is asked of the states that it found."""

    completeness: Completeness | None = None
    stated: Scene | Pattern
    posed: PatternProblem

    @property
    def few(self) -> bool:
        """Whether it has few vertices: to read the sectors of thousands takes seconds."""
        return len(self.problem.pattern.vertices) <= FEW

    @property
    def proves(self) -> bool:
        """Whether a proof is tried unasked."""
        return self.few and bool(self.provable.unasked)

    @cached_property
    def provable(self) -> Provable:
        """How the list is proved."""
        return provable_of(self.stated, self.posed)

    @property
    def proved(self) -> bool:
        """Whether all that was found is proved to be all."""
        return self.completeness is not None and self.completeness.proved

    def prove(self, wanted: bool | float | ProofOptions | None) -> None:
        """Try to prove that the minima are all; what is missing is added."""
        self.completeness, new = None, list[JudgedState]()
        if wanted is not None or self.few:
            self.completeness, new = prove_list(self.provable, self.problem, self.judged, wanted)
        minima = [s for s in new if s.verdict == "minimum"]

        def is_beside(one: JudgedState, other: JudgedState) -> bool:
            """Whether one of two states is undecided, as it was not distinguished from the other."""
            far = np.abs(one.phi - other.phi).max()
            return one.verdict == "undecided" and bool(far <= BESIDE_SINGULAR)

        for state in new:
            if not any(is_beside(state, m) for m in minima):
                beside = [k for k, s in enumerate(self.judged) if is_beside(s, state)]
                if state.verdict == "minimum" and beside:
                    self.exchange(beside[0], state)
                self.add(state)
        listed = [s.phi for s in self.judged if s.verdict == "minimum"]
        for m in minima:
            far = min((np.abs(m.phi - x).max() for x in listed), default=np.inf)
            if self.completeness and far > DUPLICATE_TOL:
                why = "a proved minimum is not distinguished from a state that is listed otherwise"
                self.completeness = replace(self.completeness, status="not-proved", reason=why)

    def add_escapes(self) -> None:
        """Add what it takes to leave each minimum."""
        most = max(OF_ESCAPES * self.go_down.work, LEAST_WORK)
        self.judged = with_escapes(self.curves, self.by_energy(), most)
        self.problem.check_time()

    def add_confirmations(self) -> None:
        """Add what IPOPT says of the lowest minima from beside them, up to so many creases."""
        self.judged = self.by_energy()
        lowest = [k for k, s in enumerate(self.judged) if s.verdict == "minimum"][:MOST_STATES]
        for k in lowest:
            self.problem.check_time()
            if (solver := confirm(self.problem, self.at_state(self.judged[k]))) is not None:
                self.judged[k] = replace(self.judged[k], solver=solver)

    def add_survival(self, degrees: float) -> None:
        """Add how many random errors each minimum survives."""
        self.problem.pattern.check_alone("the survival of states under errors")
        whole = self.problem.whole
        self.judged = with_survival(whole, self.by_energy(), degrees, self.engine)

    def add_full_space(self, full: bool | None) -> None:
        """Add the verdict without an imposed symmetry to each minimum, where that is asked for or affordable."""
        self.judged = with_full_space(self.problem, self.by_energy(), full)

    def result(self) -> MinimaResult:
        """Sum up what was judged and done."""
        minima = self.tally.sum_up(self.by_energy(), self.curves.found, self.in_a_row)
        self.count_families(self._draws.names)
        self.tally.seconds = time.perf_counter() - self._since
        curves, listed = tuple(self.curves.found), [m.phi for m in minima]
        self.tally.refused = tuple(
            replace(state, fold_angles=tuple(guess.tolist()), contacts=(), hits=0)
            for guess, state in self._guesses
            if min((np.abs(guess - x).max() for x in listed), default=math.inf) > NEAR_SINGULAR_TOL
        )
        return MinimaResult(self.stated, minima, self.tally, self.completeness, curves=curves)
