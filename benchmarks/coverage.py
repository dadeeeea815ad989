"""How much of what there is a search finds, and how fast: families of scenes, several seeds, against everything known.

Each scene has a union (`union`): what ten thorough runs of the main job and foreign multi-starts found.  The main job
of this checkout, and of another one where asked for, runs with every seed, one after the other in rotating order, each
in a process of its own; foreign searches run for the same scenes at equal time.  Whatever a run lists beyond the union
is verified and joins it, so that shares are taken of all that is known at the end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import union as unions
from benchmarks.checkout import HERE, Checkout, Job
from benchmarks.families import family_scene
from benchmarks.foreign import Ends, distinct, foreign_methods, run_foreign, vertex_starts
from benchmarks.union import (
    APART,
    FOUND,
    Member,
    Union,
    complete,
    member,
    verified,
    write_union,
)
from origami_nlp.errors import OptionError
from origami_nlp.io import Unbounded, to_plain
from origami_nlp.numerics import ANSWERED
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model

SCHEMA = "origami-nlp/coverage/1"
SCENES = {
    "panels": 18,
    "fold-limits": 10,
    "large": 5,
    "full-contact": 60,
    "designed": 6,
    "one-dof": 6,
    "crowded": 6,
}
"""Scenes of each family in the whole measurement."""
COMPARED = ("fold-limits", "large", "full-contact")
"""Families on which foreign searches run for the record."""
EXACT = 1e-10
"""A foreign answer within this [rad] of a minimum is correct without a polish."""

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Searched:
    """What one run found.

    seed, seconds: of it.  found: members of the union.  curve: (seconds, how many were known).
    attempts, rejected, false: of foreign searches: local solves; those that did not converge or ended at no state
    (wrong sheet, facets that cross); distinct states that were claimed and are no minima.
    exact, exact_seconds: members that they found to 1e-10, and when the last of these.
    error: of what they claimed near a member, median of the largest error of a fold angle [rad].
    other_kind: of the main job: minima that the union's run called another kind.
    """

    seed: int
    seconds: float
    found: tuple[int, ...]
    curve: tuple[tuple[float, int], ...]
    attempts: int = 0
    rejected: int = 0
    false: int = 0
    exact: int = 0
    exact_seconds: Unbounded = math.inf
    error: Unbounded = math.inf
    other_kind: int = 0


@dataclass
class Covered:
    """All runs on one scene, by the name of the searcher.

    minima: of its union.  once: those that a single run behind the union found: how sure it is to be complete.
    proved: whether the union is proved to be complete, a `Completeness.status`; "" where that was not tried.
    """

    family: str
    name: str
    degree: int
    minima: int = 0
    once: int = 0
    runs: dict[str, list[Searched]] = field(default_factory=dict)
    proved: str = ""


NOW, BEFORE = "this package", "before"


def scenes_for(
    families: Sequence[str], quick: bool = False, most: int | None = None
) -> dict[str, Sequence[int]]:
    """Return the numbers of the scenes of some families (all, if none is named): at most so many, `quick` two, of each.

    Raises
    ------
    OptionError
        If there is no such family.
    """
    for family in families:
        if family not in SCENES:
            raise OptionError(f"family = {family!r} is unknown: use one of {', '.join(SCENES)}")
    most = 2 if quick else most
    return {f: range(min(SCENES[f], most or SCENES[f])) for f in families or SCENES}


def measure_coverage(
    families: dict[str, Sequence[int]],
    folder: str | Path,
    *,
    before: str | Path | None = None,
    seeds: int = 5,
    budget: float = 5.0,
    effort: str | None = None,
    starts: Callable[[Model], np.ndarray] = vertex_starts,
    progress: Progress = lambda text: None,
) -> dict[str, Any]:
    """Measure searches on families of scenes; returns plain data.

    Parameters
    ----------
    families
        Numbers of the scenes (0-based) of each family.
    folder
        Where unions are kept; what is missing there is built first, and every scene can be built alone.
    before
        Another checkout to compare with.
    seeds
        Of the main job on each scene.
    budget
        Processor seconds of each foreign search.
    effort
        Of the main job, where it is not the default.
    starts
        Starts [K, n] of a model that one more foreign search, SLSQP, is given: found at no cost.
    progress
        Called with what is being done.
    """
    options = {} if effort is None else {"effort": effort}
    out = []
    folders = {NOW: HERE} if before is None else {NOW: HERE, BEFORE: before}
    with ExitStack() as stack:
        workers = {k: stack.enter_context(Checkout(v)) for k, v in folders.items()}
        for family, number in ((f, k) for f, numbers in families.items() for k in numbers):
            scene = family_scene(family, number)
            union = complete(scene, folder, progress)
            progress(f"{scene.name}: {len(union.members)} minima; {seeds} seeds of {len(workers)}")
            jobs = _jobs(workers, scene, seeds, options)
            ends = []
            if family in COMPARED:
                model = Model(scene)
                methods = [m for m in foreign_methods(starts(model)) if not m.aided]
                ends = [run_foreign(m, model, 1, budget) for m in methods]
            out.append(judge(family, scene, union, jobs, ends))
            write_union(union, folder)
    return {
        "schema": SCHEMA,
        "settings": {
            "seeds": seeds,
            "budget": budget,
            "effort": effort,
            "union_seeds": unions.UNION_SEEDS,
            "union_seconds": [min(unions.SECONDS.values()), unions.MOST_SECONDS],
        },
        "scenes": [to_plain(c) for c in out],
    }


def _jobs(
    workers: dict[str, Checkout], scene: Scene, seeds: int, options: dict[str, Any]
) -> dict[str, list[Job]]:
    """Run all seeds of all checkouts, functions built before; who comes first changes from seed to seed."""
    for worker in workers.values():
        worker.warm_up(scene)
    jobs: dict[str, list[Job]] = {name: [] for name in workers}
    for seed in range(seeds):
        order = list(workers)[:: 1 if seed % 2 == 0 else -1]
        for name in order:
            jobs[name].append(workers[name].search(scene, seed, **options))
    return jobs


def judge(
    family: str, scene: Scene, union: Union, jobs: dict[str, list[Job]], ends: Sequence[Ends]
) -> Covered:
    """Describe what each run found; what is new is verified, and joins the union first."""
    before = len(union.members)
    model = Model(scene)
    for name, of in jobs.items():
        for seed, job in enumerate(of):
            _join(model, union, job.minima, f"{name}, seed {seed}, measured")
    claims = [_claimed(model, e) for e in ends]
    false = [_false(model, union, e, c) for e, c in zip(ends, claims, strict=True)]
    once = sum(len(m.found_by) == 1 for m in union.members)
    known = union.proved if len(union.members) == before else ""
    out = Covered(family, scene.name or "", scene.degree, len(union.members), once, proved=known)
    for name, of in jobs.items():
        out.runs[name] = [_of_job(union, seed, job) for seed, job in enumerate(of)]
    for e, c, wrong in zip(ends, claims, false, strict=True):
        out.runs[e.method] = [_of_ends(model, union, e, c, wrong)]
    return out


def _join(model: Model, union: Union, minima: Sequence[Member], name: str) -> None:
    """Let minima that the union lacks join it, if a polish and the classifier agree that they are minima."""
    for m in minima:
        if union.nearest(np.array([m.fold_angles]))[1][0] > APART:
            state, kind, _ = verified(model, model.reduce(np.array(m.fold_angles)))
            if kind:
                union.add(name, [member(model, state.x, kind)], 0.0)


def _claimed(model: Model, ends: Ends) -> np.ndarray:
    """Return which attempts claim a state: they converged, on the sheet, and no facets cross by more than 1e-6 [a]."""
    good = ends.claims.copy()
    if good.any():
        good[good] = model.admissible(ends.x[good], ANSWERED)
    return good


def _false(model: Model, union: Union, ends: Ends, claimed: np.ndarray) -> int:
    """Count the distinct states that a search claimed and that are no minima; new minima join the union."""
    x = ends.x[claimed]
    far = union.nearest(model.expand(x))[1] if len(x) else np.zeros(0)
    false = 0
    for end in distinct(x[far > FOUND], FOUND):
        state, kind, _ = verified(model, end)
        false += not kind
        if kind:
            name = f"{ends.method}, seed {ends.seed}, measured"
            union.add(name, [member(model, state.x, kind)], 0.0)
    return false


def _of_job(union: Union, seed: int, job: Job) -> Searched:
    states = np.array([m.fold_angles for m in job.minima]).reshape(-1, union.scene.degree)
    near, far = union.nearest(states)
    known = [(int(k), m) for k, d, m in zip(near, far, job.minima, strict=True) if d <= APART]
    other = sum(union.members[k].kind != m.kind for k, m in known)
    found = tuple(sorted({k for k, _ in known}))
    return Searched(seed, job.seconds, found, job.curve, other_kind=other)


def _of_ends(model: Model, union: Union, ends: Ends, claimed: np.ndarray, false: int) -> Searched:
    """Say when a foreign search first came to each member: near it, and to `EXACT`."""
    attempts = len(ends.seconds)
    near, far = union.nearest(model.expand(ends.x)) if attempts else (np.zeros(0, int), np.zeros(0))
    first: dict[float, dict[int, float]] = {FOUND: {}, EXACT: {}}
    for t, k, d, good in zip(ends.seconds, near, far, claimed, strict=True):
        for within, when in first.items():
            if good and d <= within:
                when.setdefault(int(k), float(t))
    times = sorted(first[FOUND].values())
    near_one = far[claimed & (far <= FOUND)]
    return Searched(
        ends.seed,
        float(ends.seconds[-1]) if attempts else 0.0,
        tuple(sorted(first[FOUND])),
        tuple((t, n) for n, t in enumerate(times, start=1)),
        attempts,
        int(attempts - claimed.sum()),
        false,
        len(first[EXACT]),
        max(first[EXACT].values(), default=math.inf),
        float(np.median(near_one)) if len(near_one) else math.inf,
    )
