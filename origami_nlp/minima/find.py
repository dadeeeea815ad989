"""The main job: the energy minima of a scene, classified, with the record of the search."""

from __future__ import annotations

import itertools
import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.arguments import (
    check_angles,
    check_callback,
    check_flag,
    check_type,
    check_whole,
    shown,
)
from origami_nlp.errors import OptionError
from origami_nlp.folding import fold_vertex
from origami_nlp.kkt import (
    Classification,
    Solve,
    State,
    flat_foldings,
    passing_moment,
    polish,
    rest_state,
    rigid_states,
)
from origami_nlp.minima.coverage import StrataCount, count_strata
from origami_nlp.minima.full_space import judge_in_full_space
from origami_nlp.minima.hinges import hinge_minima
from origami_nlp.minima.ipopt import Confirmation, confirm
from origami_nlp.minima.minimum import Minimum, Rejected, SearchReport
from origami_nlp.minima.multistart import run_starts
from origami_nlp.minima.near_flat import flat_minima
from origami_nlp.minima.one_freedom import EXACT, trace
from origami_nlp.minima.proved import check_prove, prove_complete
from origami_nlp.minima.record import Answer, Record, close_orbit, exact_state, judge, listed
from origami_nlp.minima.result import MinimaResult
from origami_nlp.minima.search import Search
from origami_nlp.minima.starts import CORNER, SOURCES, Effort, Rounds, effort_of, is_chain
from origami_nlp.minima.stopping import chao1
from origami_nlp.numerics import CLOSES, SAME
from origami_nlp.pattern import Labels, Scene, Vertex, canonical_labels
from origami_nlp.programme import Model

FEWEST_STARTS = 1
"""Starts that are made whatever the stopping rule says."""
MOST_STARTS = 100_000
"""Default cap on starts; the report says when the search stopped there."""
MOST_BATCHED = 24
"""Variables up to which descents are made in batches with symmetry or facets that may touch; above, IPOPT solves from
one start after the other."""
MOST_CONFIRMED = 100
"""Variables up to which IPOPT confirms minima: it needs a compiled Hessian, whose number of entries is their square."""
FEW_FREEDOMS = 2
"""Freedoms up to which the first round may be the last, within fold limits (beyond, each shape comes in lifts)."""
Progress = Callable[[int, int, int], None]
"""Called as progress(starts, minima found, how many of these one drawn start reached)."""


def check_options(seed: object, max_starts: object, fewest_starts: object = FEWEST_STARTS) -> None:
    """Complain about a seed or a cap on starts that is no natural number.

    Raises
    ------
    OptionError
        With the name, the value and what it must be.
    """
    check_whole("seed", seed, 0)
    check_whole("max_starts", max_starts, 1)
    check_whole("fewest_starts", fewest_starts, 1)


def _check_guesses(guesses: object, degree: int) -> list[np.ndarray]:
    if isinstance(guesses, str | bytes | dict) or not isinstance(guesses, Iterable):
        raise OptionError(
            f"guesses = {shown(guesses)} must be a list of states, [N] fold angles each"
        )
    return [
        check_angles(f"guesses[{k}]", g, degree, one=True) for k, g in enumerate(guesses, start=1)
    ]


def find_minima(
    scene: Scene,
    *,
    seed: int = 0,
    effort: str = "normal",
    max_starts: int = MOST_STARTS,
    fewest_starts: int = FEWEST_STARTS,
    guesses: Sequence[np.ndarray] = (),
    full: bool = False,
    prove: bool | float | None = None,
    workers: int = 1,
    progress: Progress | None = None,
) -> MinimaResult:
    """Find and classify the energy minima of a scene among states of its symmetry.

    Parameters
    ----------
    scene
        What is folded: vertex, springs, symmetry and contact.
    seed
        Of the random starts; the same seed gives the same answer.
    effort
        ``"quick"``, ``"normal"`` or ``"thorough"``: how many starts, and how often each minimum must have been
        reached before the search stops.
    max_starts
        Cap on starts.
    fewest_starts
        Starts before the stopping rule is believed.
    guesses
        States to start from first (of a neighbouring scene, say), shape [N] each [rad]; they do not
        enter the stopping rule.
    full
        Also decide each minimum in the full contact-admissible space, symmetry-breaking motions
        included.
    prove
        Prove that the list is complete: True, or seconds that this may take; False: do not try.  Without being asked
        it is tried where it is cheap: within fold limits, up to two freedoms.
    workers
        Processes that descents are shared out to, where there are many; the result is the same.
    progress
        Called after each new minimum and each round of starts, as progress(starts, minima found, how many of these one
        drawn start reached).

    Returns
    -------
    MinimaResult
        The minima in order of energy, and the record of the search.

    Raises
    ------
    OptionError
        If an argument is not what it must be.
    AngleError
        If a guess is not N finite numbers.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> [(m.kind, round(m.energy, 6)) for m in result.minima]
    [('interior', 0.009086), ('contact-touching', 1.233701)]
    """
    check_type("scene", scene, Scene)
    check_options(seed, max_starts, fewest_starts)
    wanted = effort_of(effort)
    check_flag("full", full)
    check_prove("prove", prove)
    check_whole("workers", workers, 1)
    check_callback("progress", progress)
    guesses = _check_guesses(guesses, scene.degree)
    begin = time.perf_counter()
    model = Model(scene)
    job = _Job(model, seed, wanted, (fewest_starts, max_starts), progress)
    job.list_states()
    # where nothing can move within the symmetry, the listed states are all there is
    if model.freedom > 0:
        job.search([model.reduce(g) for g in guesses], workers)
    for answer in job.record.minima:
        close_orbit(model, job.record, answer)
    completeness = prove_complete(model, job.record, prove)
    minima, others, outcomes = _sort_out(model, job.record)
    if full:
        minima = _in_full_space(scene, minima)
    report = job.report(others, outcomes, time.perf_counter() - begin, effort)
    return MinimaResult(scene, model, tuple(minima), report, completeness)


class _Job:
    """One search: what it may spend, and its record."""

    def __init__(
        self,
        model: Model,
        seed: int,
        effort: Effort,
        starts: tuple[int, int],
        progress: Progress | None,
    ) -> None:
        self.model, self.seed, self.effort = model, seed, effort
        self.fewest, self.most = starts
        self.progress = progress
        self.record = Record()
        self.stopped_by = "rule"
        self.complete = ""
        self.strata: tuple[StrataCount, ...] = ()
        self.corners: tuple[int, bool] = (0, False)

    def list_states(self) -> None:
        """Judge the states that no descent finds: isolated flat foldings, hinge sets, states that cannot move."""
        model = self.model
        states = itertools.chain(rest_state(model), hinge_minima(model), flat_foldings(model))
        if model.freedom <= 0:
            states = itertools.chain(states, rigid_states(model, self.seed))
        for x in states:
            if self.record.known(x) is None:
                self.record.answers.append(listed(model, x))

    def search(self, guesses: list[np.ndarray], workers: int) -> None:
        """Start from guesses, then round after round until the stopping rule says that it is enough."""
        # how finely curves are cut suits the torque of springs: under forces in space a search goes on from there
        if self.model.freedom == 1 and self._traced() and not self.model.scene.loads:
            self.stopped_by = "complete"
            return
        if self.model.size > MOST_BATCHED and not is_chain(self.model):
            self._one_by_one()
            return
        under = self._under()
        with Search(self.model, self.record, under, workers, self._tell) as search:
            search.also_from(flat_minima(self.model))
            if guesses:
                search.run(search.closed(np.array(guesses)))
            self._rounds(search, Rounds(under[0] if under else self.model, self.seed, self.effort))

    def _rounds(self, search: Search, rounds: Rounds) -> None:
        self.stopped_by = "cap"
        quiet = 0
        for samples in rounds:
            found = len(self.record.minima)
            search.run(samples[np.arange(min(len(samples), self.most - self.record.starts))])
            quiet = quiet + 1 if len(self.record.minima) == found else 0
            self._tell()
            if self.record.starts >= self.most:
                break
            if self.record.starts >= self.fewest and self._enough(quiet):
                found = len(self.record.minima)
                search.run()
                if len(self.record.minima) == found:
                    self.stopped_by = "rule"
                    break
                quiet = 0
        search.run()
        tried = self.record.by_source[SOURCES[CORNER]]  # a cap on starts leaves some out
        self.corners = tried, rounds.every_corner and tried == rounds.corners
        if rounds.touches is not None:
            self.strata, _ = count_strata(rounds.touches, search.minima_on_touches())

    def _traced(self) -> bool:
        """Judge all that the curves of one freedom hold; tells whether they were resolved."""
        traced = trace(self.model)
        exact = np.isin(traced.origins, EXACT)
        for x, contacts, stands in zip(traced.states, traced.contacts, exact, strict=True):
            end = Solve(x, "", 0, math.nan, np.ones(self.model.size), None)
            state = polish(self.model, end, contacts)
            if stands and not (state.converged and np.abs(state.x - x).max() <= SAME):
                # Newton leaves or cannot resolve a state where closure is singular: it is judged where it was found
                state = exact_state(self.model, x)
            answer, new = self.record.file(self.model, state)
            answer.listed = True
            if new:
                judge(self.model, answer)
        self.complete = traced.reason if traced.complete and not self.model.scene.loads else ""
        return traced.complete

    def _under(self) -> tuple[Model, Labels] | None:
        """Pose the scene under labels that do not depend on how it was labelled; None where it is as well as is."""
        scene = self.model.scene
        if not scene.group.is_trivial or scene.loads:
            return None
        labels = canonical_labels(scene)
        return Model(labels.relabelled(scene)), labels

    def _enough(self, quiet: int) -> bool:
        hits = self.record.drawn_hits
        if min(hits, default=self.effort.hits) >= self.effort.hits:
            # the first round holds several: where there is more to find, one that found nothing is wanted as well
            few = self.model.freedom <= FEW_FREEDOMS and self.model.has_limits
            return quiet > 0 or few
        return quiet >= self.effort.quiet and chao1(hits) < 0.5

    def _one_by_one(self) -> None:
        """Search with IPOPT alone."""
        self.stopped_by = "cap"
        quiet = 0
        fewest = max(self.fewest, 16 * self.effort.hits)
        for new in itertools.islice(run_starts(self.model, self.seed, self.record), self.most):
            if new is not None:
                judge(self.model, new)
            quiet = 0 if new is not None and new.is_minimum else quiet + 1
            self._tell()
            if self.record.starts >= fewest and self._enough(quiet // fewest):
                self.stopped_by = "rule"
                break

    def _tell(self) -> None:
        if self.progress:
            r = self.record
            self.progress(r.starts, len(r.minima), r.seen_once)

    def report(
        self,
        others: list[Rejected],
        outcomes: dict[str, int],
        seconds: float,
        effort: str,
    ) -> SearchReport:
        """Say what was done."""
        r = self.record
        return SearchReport(
            starts=r.starts,
            feasible_starts=r.feasible_starts,
            solves=r.solves,
            statuses=dict(r.statuses),
            outcomes=outcomes,
            expected_undiscovered=chao1(r.drawn_hits),
            stopped_by=self.stopped_by,
            seconds=seconds,
            seed=self.seed,
            rejected=tuple(o for o in others if o.verdict != "undecided"),
            undecided=tuple(o for o in others if o.verdict == "undecided"),
            iterations=r.iterations,
            effort=effort,
            by_source={name: count for name, count in r.by_source.items() if count},
            stalled=r.stalled,
            seen_once=r.seen_once,
            quiet=r.quiet,
            corners=self.corners[0],
            every_corner=self.corners[1],
            complete=self.complete,
            strata=self.strata,
        )


def _sort_out(model: Model, record: Record) -> tuple[list[Minimum], list[Rejected], dict[str, int]]:
    """Return minima and other states, each in order of energy, and how many starts ended at which verdict."""
    minima, others, outcomes = [], [], Counter[str]()
    for answer in record.answers:
        energy = model.energy(answer.polished.x)
        phi = model.expand(answer.polished.x)
        assert answer.what is not None
        what = _that_closes(model.scene.vertex, phi, answer.what)
        outcomes[what.verdict] += answer.hits
        if what.verdict == "minimum":
            minima.append(_minimum(model, answer, what, _confirmed(model, answer, record)))
        else:
            angles = tuple(phi.tolist())
            others.append(Rejected(what.verdict, what.reason, angles, energy, answer.hits))
    # ties (mirror images of one another) in a fixed order
    minima.sort(key=lambda m: (round(m.energy / model.scale, 9), m.fold_angles))
    others.sort(key=lambda r: (r.verdict, round(r.energy / model.scale, 9), r.fold_angles))
    return minima, others, dict(outcomes)


def _minimum(
    model: Model, answer: Answer, what: Classification, solver: Confirmation | None
) -> Minimum:
    p = answer.polished
    assert what.kind is not None
    phi = model.expand(p.x)
    passing = passing_moment(model.scene, phi)
    return Minimum(
        model.energy(p.x),
        tuple(phi.tolist()),
        what.kind,
        what.local_dimension,
        p.closure_residual,
        what.stationarity if math.isnan(p.kkt_residual) else p.kkt_residual,
        p.converged,
        answer.hits,
        what.contacts,
        what.reason,
        what.eigenvalues,
        solver=solver,
        moment=passing.vector if passing else None,
        moment_residual=passing.residual if passing else math.nan,
    )


def _confirmed(model: Model, answer: Answer, record: Record) -> Confirmation | None:
    """Let IPOPT solve from a minimum, with the contacts that are closed there; None with too many creases."""
    if model.size > MOST_CONFIRMED:
        return None
    state = State(model, answer.polished.x)
    solver = confirm(model, state.on(answer.polished.rows or state.pieces[0]))
    record.solves += 1
    record.statuses[solver.status] += 1
    record.iterations += solver.iterations
    return solver


def _that_closes(vertex: Vertex, fold_angles: np.ndarray, what: Classification) -> Classification:
    """Let nothing be a minimum whose final numbers do not close, by a product of rotations of their own."""
    if what.verdict != "minimum":
        return what
    _, q = fold_vertex(vertex, fold_angles)
    residual = float(np.linalg.norm(q[1:]))
    if residual <= CLOSES:
        return what
    return Classification("undecided", None, f"closes only to {residual:.0e}; {what.reason}", 0)


def _in_full_space(scene: Scene, minima: list[Minimum]) -> list[Minimum]:
    """Add the verdict in the full space to each minimum."""
    states = tuple(np.array(m.fold_angles) for m in minima)
    return [
        replace(m, full_space=judge_in_full_space(scene, x, states))
        for m, x in zip(minima, states, strict=True)
    ]
