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
    State,
    classify,
    flat_foldings,
    handle_minima,
    rest_state,
    rigid_states,
)
from origami_nlp.minima.full_space import judge_in_full_space
from origami_nlp.minima.hinges import hinge_minima
from origami_nlp.minima.minimum import Minimum, Rejected, SearchReport
from origami_nlp.minima.result import MinimaResult
from origami_nlp.minima.search import Answer, Record, add_state, run_boundaries, run_one, run_starts
from origami_nlp.minima.stopping import enough, expected_undiscovered
from origami_nlp.numerics import CLOSES
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.programme import Model

FEWEST_STARTS = 128
"""Starts that are made whatever the stopping rule says."""
MOST_STARTS = 1000
"""Default cap on starts; the report says when the search stopped there."""
DOWN = 0.05
"""First step [rad] down either side of a saddle."""
Progress = Callable[[int, int, float], None]
"""Called as progress(starts, minima found, expected undiscovered answers)."""


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
    max_starts: int = MOST_STARTS,
    fewest_starts: int = FEWEST_STARTS,
    guesses: Sequence[np.ndarray] = (),
    full: bool = False,
    progress: Progress | None = None,
) -> MinimaResult:
    """Find and classify the energy minima of a scene among states of its symmetry.

    Parameters
    ----------
    scene
        What is folded: vertex, springs, symmetry and contact.
    seed
        Of the random starts; the same seed gives the same answer.
    max_starts
        Cap on random starts, for scenes where the stopping rule asks for more.
    fewest_starts
        Random starts before the stopping rule is believed.
    guesses
        States to start from before the random starts (of a neighbouring scene, say), shape [N] each [rad]; they do not
        enter the stopping rule.
    full
        Also decide each minimum in the full contact-admissible space, symmetry-breaking motions
        included.
    progress
        Called after each start, as progress(starts, minima found, expected undiscovered).

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
    check_flag("full", full)
    check_callback("progress", progress)
    guesses = _check_guesses(guesses, scene.degree)
    begin = time.perf_counter()
    model = Model(scene)
    record = Record()
    _list_states(model, seed, record)
    missing, stopped_by = 0.0, "rule"
    # where nothing can move within the symmetry, the listed states are all there is
    if model.freedom > 0:
        for new in run_boundaries(model, seed, record):
            _judge_new(model, new, record)
        for guess in guesses:
            new = run_one(model, model.reduce(guess), record, count=False)
            _judge_new(model, new, record)
        missing, stopped_by = _start_at_random(
            model, seed, record, (fewest_starts, max_starts), progress
        )
    minima, others, outcomes = _sort_out(model, record)
    if full:
        minima = _in_full_space(scene, minima)
    report = SearchReport(
        starts=record.starts,
        feasible_starts=record.feasible_starts,
        solves=record.solves,
        statuses=dict(record.statuses),
        outcomes=outcomes,
        expected_undiscovered=missing,
        stopped_by=stopped_by,
        seconds=time.perf_counter() - begin,
        seed=seed,
        rejected=tuple(r for r in others if r.verdict != "undecided"),
        undecided=tuple(r for r in others if r.verdict == "undecided"),
        iterations=record.iterations,
    )
    return MinimaResult(scene, model, tuple(minima), report)


def _list_states(model: Model, seed: int, record: Record) -> None:
    """Judge the states that no descent finds: isolated flat foldings, hinge sets, thin sets at phi = +-pi."""
    thin = handle_minima if model.freedom > 0 else rigid_states
    # (a lowest state on a hinge set beside its flat folding is the one of the two that may be a minimum)
    listed = itertools.chain(
        rest_state(model), hinge_minima(model), flat_foldings(model), thin(model, seed)
    )
    for state in listed:
        _judge_new(model, add_state(model, state, record), record)


def _start_at_random(
    model: Model, seed: int, record: Record, starts: tuple[int, int], progress: Progress | None
) -> tuple[float, str]:
    """Search from random starts, at least and at most `starts`, until the stopping rule says that it is enough.

    Returns the expected number of answers not yet found, and what stopped the search: ``rule`` or ``cap``.
    """
    missing = 0.0
    for new in itertools.islice(run_starts(model, seed, record), starts[1]):
        _judge_new(model, new, record)
        hits = [a.hits for a in record.answers if a.is_minimum]
        reached = sum(h > 0 for h in hits)
        missing = expected_undiscovered(sum(hits), reached)
        if progress:
            found = len(hits) + sum(a.is_minimum for a in record.listed)
            progress(record.starts, found, missing)
        if record.starts >= starts[0] and enough(sum(hits), reached):
            return missing, "rule"
    return missing, "cap"


def _sort_out(model: Model, record: Record) -> tuple[list[Minimum], list[Rejected], dict[str, int]]:
    """Return minima and other states, each in order of energy, and how many starts ended at which verdict."""
    minima, others, outcomes = [], [], Counter[str]()
    for answer in [*record.listed, *record.answers]:
        p, energy = answer.polished, model.energy(answer.polished.x)
        phi = model.expand(p.x)
        assert answer.what is not None
        what = _that_closes(model.scene.vertex, phi, answer.what)
        outcomes[what.verdict] += answer.hits
        angles = tuple(phi.tolist())
        if what.verdict != "minimum":
            others.append(Rejected(what.verdict, what.reason, angles, energy, answer.hits))
            continue
        assert what.kind is not None
        minima.append(
            Minimum(
                energy,
                angles,
                what.kind,
                what.local_dimension,
                p.closure_residual,
                what.stationarity if math.isnan(p.kkt_residual) else p.kkt_residual,
                p.converged,
                answer.hits,
                what.contacts,
                what.reason,
                what.eigenvalues,
            )
        )
    # ties (mirror images of one another) in a fixed order
    minima.sort(key=lambda m: (round(m.energy / model.scale, 9), m.fold_angles))
    others.sort(key=lambda r: (r.verdict, round(r.energy / model.scale, 9), r.fold_angles))
    return minima, others, dict(outcomes)


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


def _judge_new(model: Model, new: Answer | None, record: Record) -> None:
    """Classify a new answer; from a saddle, go down both sides once."""
    pending = [new] if new else []
    while pending:
        answer = pending.pop()
        x = answer.polished.x
        answer.what = what = classify(State(model, x), polished=answer.polished.converged)
        if what.descent is not None and answer.hits:
            for sign in (1.0, -1.0):
                start = np.clip(x + sign * DOWN * what.descent, -model.bound, model.bound)
                below = run_one(model, start, record, count=False)
                if below:
                    pending.append(below)
