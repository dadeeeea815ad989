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
from origami_nlp.pattern import Scene
from origami_nlp.programme import Model

FEWEST_STARTS = 128
"""Starts that are made whatever the stopping rule says."""
MOST_STARTS = 1000
"""Default cap on starts; the report says when the search stopped there."""
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
    verdicts: dict[int, Classification] = {}
    found, missing = 0, 0.0
    stopped_by = "cap"
    # isolated flat foldings, and thin sets at phi = +-pi, are not found by descent
    thin = handle_minima if model.freedom > 0 else rigid_states
    # (a lowest state on a hinge set beside its flat folding is the one of the two that may be a minimum)
    listed = itertools.chain(
        rest_state(model), hinge_minima(model), flat_foldings(model), thin(model, seed)
    )
    for state in listed:
        _judge_new(model, add_state(model, state, record), verdicts, record)
    if model.freedom <= 0:
        stopped_by = (
            "rule"  # nothing can move within the symmetry: the listed states are all there is
        )
    else:
        for new in run_boundaries(model, seed, record):
            _judge_new(model, new, verdicts, record)
        for guess in guesses:
            new = run_one(model, model.reduce(guess), record, count=False)
            _judge_new(model, new, verdicts, record)
        stream = run_starts(model, seed, record)
        while record.starts < max_starts:
            new = next(stream)
            _judge_new(model, new, verdicts, record)
            found = sum(v.verdict == "minimum" for v in verdicts.values())
            hits = sum(a.hits for a in record.answers if verdicts[id(a)].verdict == "minimum")
            reached = sum(
                a.hits > 0 and verdicts[id(a)].verdict == "minimum" for a in record.answers
            )
            missing = expected_undiscovered(hits, reached)
            if progress:
                progress(record.starts, found, missing)
            if record.starts >= fewest_starts and enough(hits, reached):
                stopped_by = "rule"
                break
    minima, others, outcomes = [], [], Counter[str]()
    for answer in [*record.listed, *record.answers]:
        what = _that_closes(model, answer.polished.x, verdicts[id(answer)])
        outcomes[what.verdict] += answer.hits
        phi = tuple(model.expand(answer.polished.x).tolist())
        energy = model.energy(answer.polished.x)
        if what.verdict != "minimum":
            others.append(Rejected(what.verdict, what.reason, phi, energy, answer.hits))
            continue
        assert what.kind is not None
        p = answer.polished
        minima.append(
            Minimum(
                energy,
                phi,
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
    if full:
        minima = _in_full_space(scene, minima)
    others.sort(key=lambda r: (r.verdict, round(r.energy / model.scale, 9), r.fold_angles))
    report = SearchReport(
        starts=record.starts,
        feasible_starts=record.feasible_starts,
        solves=record.solves,
        statuses=dict(record.statuses),
        outcomes=dict(outcomes),
        expected_undiscovered=missing,
        stopped_by=stopped_by,
        seconds=time.perf_counter() - begin,
        seed=seed,
        rejected=tuple(r for r in others if r.verdict != "undecided"),
        undecided=tuple(r for r in others if r.verdict == "undecided"),
        iterations=record.iterations,
    )
    return MinimaResult(scene, model, tuple(minima), report)


def _that_closes(model: Model, x: np.ndarray, what: Classification) -> Classification:
    """Let nothing be a minimum whose final numbers do not close, by a product of rotations of their own."""
    if what.verdict != "minimum":
        return what
    _, q = fold_vertex(model.scene.vertex, model.expand(x))
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


def _judge_new(
    model: Model, new: Answer | None, verdicts: dict[int, Classification], record: Record
) -> None:
    """Classify a new answer; from a saddle, go down both sides once."""
    pending = [new] if new else []
    while pending:
        answer = pending.pop()
        what = classify(State(model, answer.polished.x), polished=answer.polished.converged)
        verdicts[id(answer)] = what
        if what.descent is not None and answer.hits:
            for sign in (1.0, -1.0):
                start = answer.polished.x + sign * 0.05 * what.descent
                below = run_one(
                    model, np.clip(start, -model.bound, model.bound), record, count=False
                )
                if below:
                    pending.append(below)
