"""The main job: the energy minima of a scene, classified, with the record of the search."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.arguments import (
    check_angles,
    check_callback,
    check_flag,
    check_type,
    check_until,
    check_whole,
    shown,
)
from origami_nlp.errors import OUT_OF_TIME, Interrupted, OptionError
from origami_nlp.kkt import Classification, State, passing_moment
from origami_nlp.minima.full_space import (
    FullSpace,
    full_scene,
    is_affordable,
    judge_in_full_space,
    not_judged,
)
from origami_nlp.minima.job import Found, Job, Progress
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.noise import check_noise, with_survival
from origami_nlp.minima.proved import check_prove
from origami_nlp.minima.record import BREAKDOWNS, FoundState, Record, close_orbit
from origami_nlp.minima.result import MinimaResult
from origami_nlp.minima.windings import (
    escapes_of_each,
    finish_all,
    jobs_of,
    join_reports,
    prove_each,
)
from origami_nlp.numerics import energy_or_zero, rank
from origami_nlp.pattern import Scene, canonical_labels
from origami_nlp.pattern_problem import CanonicalLabelling, pose
from origami_nlp.problem import Model
from origami_nlp.proof import ProofOptions
from origami_nlp.search import Confirmation, confirm
from origami_nlp.starts import OWN, SearchOptions, options_of

METHODS = ("batch", "ipopt")
"""Engines of a search: compiled descents with an active set, or IPOPT."""


def check_method(method: object) -> None:
    """Raise OptionError unless it is one of `METHODS`."""
    if method not in METHODS:
        raise OptionError(f"method = {shown(method)} must be {' or '.join(map(repr, METHODS))}")


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
    options: SearchOptions | None = None,
    max_starts: int | None = None,
    starts: int | None = None,
    guesses: Sequence[np.ndarray] = (),
    full: bool | None = None,
    prove: bool | float | ProofOptions | None = None,
    seconds: float | None = None,
    escape: bool = True,
    noise: float | None = None,
    method: str = "batch",
    progress: Progress | None = None,
    found: Found | None = None,
) -> MinimaResult:
    """Find and classify the energy minima of a scene among states of its symmetry, of each of its `Scene.windings`.

    Parameters
    ----------
    scene
        What is folded: vertex, springs, symmetry and contact.
    seed
        Of the random starts; the same seed gives the same answer.
    effort
        ``"quick"``, ``"normal"`` or ``"thorough"``: how many starts, and how often each minimum must have been reached.
    options
        All that steers the search, in place of the effort.
    starts, max_starts
        Random starts in a row that find nothing new, and starts in all; None: as `effort` says.
    guesses
        States to start from first, shape [N] each [rad]; they do not enter the stopping rule.  Each is also judged
        where it is: a minimum there is listed, `SearchReport.refused` says why another is not one.
    full
        Whether each minimum is also judged without the symmetry; None: where that is affordable
        (`minima.full_space.is_affordable`).
    prove
        Whether to prove that the list is complete: True (in at most 10 million boxes, ten minutes), seconds, or
        `ProofOptions`; False: no.  None: within fold limits, up to two degrees of freedom.
    seconds
        Wall time after which the search goes no further; a proof gets what is left, and the answer depends on the
        machine. None: the effort alone bounds it.
    escape
        Whether to say what it takes to leave each minimum (`JudgedState.escape`).
    noise
        Standard deviation [degrees] of random errors of rest angles, stiffnesses (as a share, in radians) and sector
        angles: how many of 20 draws each minimum survives (`JudgedState.survival`).
    method
        ``"batch"``: descents with an active set, compiled; ``"ipopt"``: IPOPT, one solve a start.
    progress
        Called as progress(starts, minima, how many of these one random start reached), after each new minimum and
        round.
    found
        Called as found(energy, fold angles [N] [rad]) with each minimum as soon as it is certified: ``found=print``
        shows them while the search goes on.

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
    Interrupted
        If the user interrupts it: a `KeyboardInterrupt` whose ``result`` holds what was found.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> [(m.kind, round(m.energy, 6)) for m in result.minima]
    [('interior', 0.009086), ('contact-touching', 1.233701)]
    """
    check_type("scene", scene, Scene)
    check_whole("seed", seed, 0)
    wanted = options_of(effort, options)
    if starts is not None:
        check_whole("starts", starts, 0)
    if max_starts is not None:
        check_whole("max_starts", max_starts, 1)
    if full is not None:
        check_flag("full", full)
    check_prove("prove", prove)
    until = check_until(seconds)
    check_flag("escape", escape)
    check_noise(noise)
    check_callback("progress", progress)
    check_callback("found", found)
    check_method(method)
    guesses = _check_guesses(guesses, scene.degree)
    jobs = jobs_of(scene, seed, wanted, (starts, max_starts), progress, until, found)
    named = effort if options is None else OWN
    try:
        finish_all(jobs, guesses, ipopt=method == "ipopt")
        return _result(jobs, named, prove, full, escape, noise)
    except KeyboardInterrupt:
        for job in jobs:
            job.interrupt()
        raise Interrupted(_result(jobs, named, False, False)) from None


def _result(
    jobs: Sequence[Job],
    effort: str,
    prove: bool | float | ProofOptions | None,
    full: bool | None,
    escape: bool = False,
    noise: float | None = None,
) -> MinimaResult:
    """Close orbits, prove, decide in the full space, as far as asked, and report; jobs: one a winding."""
    model, until, minima, reports = jobs[0].model, jobs[0].until, list[JudgedState](), []
    for job in jobs:
        for answer in job.record.minima:
            close_orbit(job.model, job.record, answer)
    late = any(job.stopped_by == "time" for job in jobs)
    completeness = None if late else prove_each(jobs, prove)
    for job in jobs:
        some, others, outcomes = _sort_out(job.model, job.record, until)
        minima += some
        seconds = time.perf_counter() - job.begin
        reports.append(job.report(others, outcomes, seconds, effort))
    # ties (mirror images of one another) in a fixed order
    minima.sort(key=lambda m: rank(m.energy / model.scale, m.fold_angles))
    if escape:
        minima = escapes_of_each(jobs, minima)
    if noise is not None:
        scene = full_scene(model.scene)
        labels = canonical_labels(scene)
        order = CanonicalLabelling(labels.creases, labels.sign, labels.backward, ())
        minima = with_survival(pose(scene), order, minima, noise)
    if is_affordable(model.scene, len(minima)) if full is None else full:
        minima = _in_full_space(model.scene, minima, until)
    windings = [job.model.structure.winding for job in jobs]
    report = join_reports(windings, reports)
    return MinimaResult(
        model.scene, tuple(minima), report, completeness, model=jobs[0].record.problem
    )


def _sort_out(
    model: Model, record: Record, until: float
) -> tuple[list[JudgedState], list[JudgedState], dict[str, int]]:
    """Return minima, other states in order of energy, and how many starts ended at which verdict."""
    minima, others, outcomes = [], [], Counter[str]()
    for answer in record.answers:
        energy = model.energy(answer.polished.x)
        phi = model.expand(answer.polished.x)
        assert answer.what is not None
        what = answer.what
        outcomes[what.verdict] += answer.hits
        if what.verdict == "minimum":
            solver = _confirmed(answer, record) if time.monotonic() <= until else None
            minima.append(_minimum(model, record, answer, what, solver))
        else:
            angles = tuple(phi.tolist())
            others.append(JudgedState(energy, angles, what.verdict, what.reason, hits=answer.hits))
    others.sort(key=lambda r: (r.verdict, *rank(r.energy / model.scale, r.fold_angles)))
    return minima, others, dict(outcomes)


def _minimum(
    model: Model,
    record: Record,
    answer: FoundState,
    what: Classification,
    solver: Confirmation | None,
) -> JudgedState:
    p = answer.polished
    phi = model.expand(p.x)
    passing = passing_moment(model.scene, phi)
    return JudgedState(
        float(energy_or_zero(model.energy(p.x), model.scene.stiffness)),
        tuple(phi.tolist()),
        what.verdict,
        what.reason,
        what.kind or "",
        what.local_dimension,
        closure_residual=p.closure_residual,
        kkt_residual=what.stationarity if math.isnan(p.kkt_residual) else p.kkt_residual,
        polished=p.converged,
        hits=answer.hits,
        contacts=what.contacts,
        hessian_eigenvalues=what.eigenvalues,
        solver=solver,
        moment=passing.vector if passing else None,
        moment_residual=passing.residual if passing else math.nan,
        dof=State(record.problem, p.x).kernel.shape[1],
        winding=model.structure.winding,
        softest_mode=() if what.mode is None else tuple(model.expand(what.mode).tolist()),
    )


def _confirmed(answer: FoundState, record: Record) -> Confirmation | None:
    """Let IPOPT solve from beside a minimum; None with too many variables."""
    with record.surviving("a confirmation by IPOPT"):
        if (solver := confirm(record.problem, answer.polished.x)) is not None:
            record.solves += 1
            record.statuses[solver.status] += 1
            record.iterations += solver.iterations
        return solver
    return None


def _in_full_space(scene: Scene, minima: list[JudgedState], until: float) -> list[JudgedState]:
    """Add the verdict in the full space to each minimum; undecided, by name, where the time is over."""
    states = tuple(np.array(m.fold_angles) for m in minima)

    def verdict(x: np.ndarray) -> FullSpace:
        if time.monotonic() > until:
            return not_judged(f"{OUT_OF_TIME} before it was judged")
        try:
            return judge_in_full_space(scene, x, states)
        except BREAKDOWNS as error:
            return not_judged(f"linear algebra failed where it was judged: {error}")

    return [replace(m, full_space=verdict(x)) for m, x in zip(minima, states, strict=True)]
