"""One search and one proof for each winding of symmetric states, reported as one.

Symmetric states may wind several times round the axis (`Scene.windings`): each winding is a problem of its own, and
no path leads from one to another.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.kkt import OPEN, Escape
from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.completeness import Completeness
from origami_nlp.minima.escape import with_escapes
from origami_nlp.minima.job import Found, Job, Progress
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.proved import is_cheap, prove_complete
from origami_nlp.minima.record import BREAKDOWNS
from origami_nlp.minima.search import Search, missed
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import pose
from origami_nlp.problem import Model
from origami_nlp.proof import ProofOptions
from origami_nlp.search import MOST_TRIED
from origami_nlp.starts import NearFlat, NearFolded, SearchOptions

STOPPED = ("complete", "rule", "cap", "time")
"""Why searches stop, from the best reason to the worst."""


def jobs_of(
    scene: Scene,
    seed: int,
    options: SearchOptions,
    starts: tuple[int | None, int | None],
    progress: Progress | None,
    until: float = math.inf,
    found: Found | None = None,
) -> list[Job]:
    """Return the searches that a scene asks for, one for each winding; arguments as for `Job`."""
    each = scene.of_each_winding
    problem = pose(scene)
    jobs = [Job(Model(one), seed, options, starts, None, until, found, problem) for one in each]
    if progress is not None:
        records = [job.record for job in jobs]

        def show(*_: int) -> None:
            progress(
                sum(r.starts for r in records),
                sum(len(r.minima) for r in records),
                sum(r.seen_once for r in records),
            )

        for job in jobs:
            job.progress = show
    return jobs


def finish_all(
    jobs: Sequence[Job], guesses: Sequence[np.ndarray] = (), *, ipopt: bool = False
) -> None:
    """Bring searches to their ends; guesses [N] go to the winding that they miss least."""
    given: dict[int, list[np.ndarray]] = {id(job): [] for job in jobs}
    for guess in guesses:
        # a state closes in the problem of its own winding only
        at = min(jobs, key=lambda job: missed(job.model, job.model.reduce(guess)))
        given[id(at)].append(guess)
    more = [job for job in jobs if job.work(given[id(job)])]
    if not more:
        return
    first = more[0]
    search = Search([(job.model, job.record) for job in more], first.seed, ipopt=ipopt)
    for job in more:
        for family in (NearFlat(job.model), NearFolded(job.model, job.foldings)):
            search.from_states(job.record.states_of(family))
        search.from_states([job.model.reduce(g) for g in given[id(job)]])
    stopped_by = "cap"
    while first.record.drawn < first.most and search.made < MOST_TRIED * first.most:
        search.draw(first.most - first.record.drawn)
        for job in more:
            job.tell()
        if any([job.late() for job in more]):
            return
        if all(job.is_enough for job in more):
            stopped_by = "rule"
            break
    for job in more:
        job.stopped_by = stopped_by


def prove_each(
    jobs: Sequence[Job], wanted: bool | float | ProofOptions | None
) -> Completeness | None:
    """Try to prove that the minima on record are all, of every winding; arguments and result as of `prove_complete`."""
    first = jobs[0].model
    if len(jobs) == 1 or (wanted is None and not is_cheap(first)):
        return prove_complete(first, jobs[0].record, wanted, jobs[0].until)
    until = math.inf
    if wanted is not None and not isinstance(wanted, bool | ProofOptions):
        until = time.process_time() + wanted
    found: list[Completeness] = []
    for job in jobs:
        if until < math.inf:
            wanted = max(until - time.process_time(), 0.0)
        one = prove_complete(job.model, job.record, wanted, job.until)
        if one is None:
            return None
        found.append(one)
    return _joined([job.model.structure.winding for job in jobs], found)


def _joined(windings: Sequence[int], found: Sequence[Completeness]) -> Completeness:
    order = ("proved", "proved-except-singular", "not-proved")
    regions = Counter[str]()
    for one in found:
        regions.update(one.critical_points)
    reasons = [
        f"winding {w}: {one.reason}" for w, one in zip(windings, found, strict=True) if one.reason
    ]
    return Completeness(
        max((one.status for one in found), key=order.index),
        "; ".join(reasons),
        sum(one.boxes for one in found),
        sum(one.seconds for one in found),
        dict(sorted(regions.items())),
        sum(one.held for one in found),
        sum(one.minima for one in found),
        tuple(region for one in found for region in one.undecided),
        tuple(region for one in found for region in one.singular),
        tuple(new for one in found for new in one.added),
        over=found[0].over,
    )


def escapes_of_each(jobs: Sequence[Job], minima: Sequence[JudgedState]) -> list[JudgedState]:
    """Add what it takes to leave each minimum, along states of its winding, numbered as in the whole list."""
    found = list(minima)
    for job, which in _apart(jobs, minima):
        some = [minima[k] for k in which]
        if time.monotonic() > job.until:
            late = Escape(math.nan, OPEN, OUT_OF_TIME)
            some = [replace(m, escape=late) for m in some]
        else:
            try:
                some = with_escapes(job.model, some, job.traced, job.record.problem)
            except BREAKDOWNS as error:
                broken = Escape(math.nan, OPEN, f"linear algebra failed: {error}")
                some = [replace(m, escape=broken) for m in some]
        for k, m in zip(which, some, strict=True):
            assert m.escape is not None
            to = which[m.escape.to - 1] + 1 if m.escape.to else 0
            found[k] = replace(m, escape=replace(m.escape, to=to))
    return found


def _apart(jobs: Sequence[Job], minima: Sequence[JudgedState]) -> Iterator[tuple[Job, list[int]]]:
    """Each search with the places of its minima in the whole list."""
    for job in jobs:
        winding = job.model.structure.winding
        yield job, [k for k, m in enumerate(minima) if m.winding == winding]


def join_reports(windings: Sequence[int], reports: Sequence[SearchReport]) -> SearchReport:
    """Report several searches as one.

    Parameters
    ----------
    windings, reports
        How often states wind, and the report of their search.

    Returns
    -------
    SearchReport
        Counts added up; stopped by the worst of their reasons.
    """
    if len(reports) == 1:
        return reports[0]
    first = reports[0]
    counted: dict[str, Counter[str]] = {}
    for name in ("statuses", "outcomes", "by_source", "failed"):
        counted[name] = Counter()
        for r in reports:
            counted[name].update(getattr(r, name))
    drawn = [r for r in reports if r.stopped_by != "complete"]
    return SearchReport(
        starts=sum(r.starts for r in reports),
        feasible_starts=sum(r.feasible_starts for r in reports),
        solves=sum(r.solves for r in reports),
        statuses=dict(counted["statuses"]),
        outcomes=dict(counted["outcomes"]),
        expected_undiscovered=sum(r.expected_undiscovered for r in reports),
        expected_error=math.hypot(*(r.expected_error for r in reports)),
        stopped_by=max((r.stopped_by for r in reports), key=STOPPED.index),
        seconds=max(r.seconds for r in reports),
        seed=first.seed,
        rejected=_in_order(r.rejected for r in reports),
        undecided=_in_order(r.undecided for r in reports),
        iterations=sum(r.iterations for r in reports),
        effort=first.effort,
        by_source=dict(counted["by_source"]),
        refused=tuple(why for r in reports for why in r.refused),
        failed=dict(sorted(counted["failed"].items())),
        stalled=sum(r.stalled for r in reports),
        interrupted=first.interrupted,
        seen_once=sum(r.seen_once for r in reports),
        quiet=min((r.quiet for r in drawn), default=0),
        complete="; ".join(
            f"winding {w}: {r.complete}" for w, r in zip(windings, reports, strict=True)
        )
        if all(r.complete for r in reports)
        else "",
    )


def _in_order(states: Iterable[tuple[JudgedState, ...]]) -> tuple[JudgedState, ...]:
    every = (one for some in states for one in some)
    return tuple(sorted(every, key=lambda r: (r.verdict, r.energy, r.fold_angles)))
