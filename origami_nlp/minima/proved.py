"""A `Proof` over the whole box of fold angles, held against what a search found."""

from __future__ import annotations

import math
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.kkt import Solve, exact_beside, polish, project
from origami_nlp.minima.completeness import Added, Completeness, Open
from origami_nlp.minima.record import BREAKDOWNS, FoundState, Record, closes, judge, listed
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, NEAR_SINGULAR_TOL
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model
from origami_nlp.proof import (
    Cluster,
    Proof,
    ProofOptions,
    ProvedCriticalPoint,
    prove,
    why_not as not_by_boxes,
)

MOST_DOF = 4
"""Degrees of freedom up to which a proof is tried where it is asked for: each multiplies boxes by about 11."""
FEW_DOF = 2
"""Degrees of freedom up to which it is tried without being asked; 1 where facets may touch and there is no symmetry."""
UNASKED = 50_000
"""Boxes after which a proof that nobody asked for gives up: two seconds; panels and degree 5 take at most 17,000."""


def check_prove(name: str, value: object) -> None:
    """Raise an error for what is neither None, a flag, a positive number of seconds nor `ProofOptions`.

    Raises
    ------
    OptionError
        With the name, the value and what it must be.
    """
    if value is None or isinstance(value, bool | np.bool_ | ProofOptions):
        return
    check_number(name, value, 0.0, math.inf)


def prove_complete(
    model: Model,
    record: Record,
    wanted: bool | float | ProofOptions | None,
    until: float = math.inf,
) -> Completeness | None:
    """Try to prove that the minima on record are all; what is missing is added to the record.

    Parameters
    ----------
    model
        The scene.
    record
        Of the search; gets further answers.
    wanted
        True, or options: in at most as many boxes as they say; or the seconds that it may take; None:
        where it is cheap; False: not at all.
    until
        When the time of the search is over (`time.monotonic`).

    Returns
    -------
    Completeness or None
        None where it was not tried.
    """
    once = model.structure.winding == 1  # other windings are tried where this one is
    if wanted is False or (wanted is None and once and not is_cheap(model)):
        return None
    refused = why_not(model)
    if refused:
        return Completeness("not-proved", refused)
    try:
        if isinstance(wanted, ProofOptions):
            boxes = wanted.boxes
        else:
            boxes = UNASKED if wanted is None else ProofOptions().boxes
            if wanted is not None and wanted is not True:
                boxes, until = sys.maxsize, min(until, time.monotonic() + float(wanted))
        return hold_against(model, record, prove(model, until=until, boxes=boxes), until)
    except BREAKDOWNS as error:
        return Completeness("not-proved", f"linear algebra failed on the way: {error}")


MOST_JUDGED = 20
"""Of regions that a proof leaves open: in so many it is asked whether there is a minimum that the search lacks.  There
are hundreds where whole sets of states are level."""

MOST_SINGULAR = 100
"""Of singular states that are judged where a proof has failed for other reasons, those of least energy: along creases
that are one line there are hundreds."""


def why_not(model: Model) -> str:
    """Return why a scene is not tried to be proved complete; "" where it is."""
    if model.scene.loads:
        return "dead loads: proofs know springs and torques on creases only"
    if not model.has_limits:
        return "without fold limits fold angles are not bounded by +-pi"
    if not model.scene.vertex.flat:
        return "the paper does not lie flat: proofs are for flat sheets"
    if model.dof <= 0 and model.structure.winding == 1:
        return "nothing can move: the states listed are all that were looked for"
    if model.dof > MOST_DOF:
        return f"{model.dof} degrees of freedom (at most {MOST_DOF})"
    return not_by_boxes(model)


def is_cheap(model: Model) -> bool:
    """Return whether a proof is tried without being asked for."""
    touching = bool(model.structure.gaps) and model.scene.group.is_trivial
    return not why_not(model) and 0 < model.dof <= (1 if touching else FEW_DOF)


def hold_against(
    model: Model, record: Record, proof: Proof, until: float = math.inf
) -> Completeness:
    """Hold what a search has on record against a proof; what the proof has and the record lacks is judged and filed.

    Parameters
    ----------
    model
        The scene.
    record
        Of the search; gets further answers.
    proof
        Of the same model.
    until
        When the time is over (`time.monotonic`): what is not judged by then stays open.

    Returns
    -------
    Completeness
        A minimum counts as missing where no answer on record is that state, to `DUPLICATE_TOL` and the proof's own
        radius.
    """
    against: list[str] = []
    added: list[FoundState] = []
    undecided: list[Open] = []
    for point in proof.points:
        answer, new = _answer_at(model, record, point)
        if new and answer is not None and answer.is_minimum:
            added.append(answer)
        undecided += _disagreement(model, point, answer, against)

    def open_region(cluster: Cluster) -> Open:
        return _region(model, np.array(cluster.lower), np.array(cluster.upper), OUT_OF_TIME)

    least = _worth_judging(model, proof)
    singular = _merged(
        [
            open_region(cluster)
            if time.monotonic() > until
            else _judged(model, record, cluster, added)
            if k in least
            else _region(model, np.array(cluster.lower), np.array(cluster.upper), cluster.reason)
            for k, cluster in enumerate(proof.singular)
        ]
    )
    if proof.flat_radius and proof.flat_is_minimum is None:
        flat = np.zeros(model.size)
        singular.append(
            _region(
                model,
                flat,
                flat,
                "the flat state",
                _verdict_at(model, record, flat, added),
                proof.flat,
            )
        )
    undecided += [
        open_region(cluster)
        if time.monotonic() > until
        else _judged(model, record, cluster, added)
        if k < MOST_JUDGED
        else _region(model, np.array(cluster.lower), np.array(cluster.upper), cluster.reason)
        for k, cluster in enumerate(proof.undecided)
    ]
    # each listed minimum must be a root of the proof, or lie in a region that it leaves open
    for answer in record.minima:
        if not _covered(answer.polished.x, proof):
            against.append(
                f"a listed minimum ({model.energy(answer.polished.x):.9g} J) is in no region that is left"
            )
    left = [s for s in singular if _is_open(s)]
    still = [p for p in proof.points if not _leaves(p)]
    status = _status(proof, undecided, against, left, singular)
    reason = _why_not(proof, undecided, against, left) if status == "not-proved" else ""
    return Completeness(
        status,
        reason,
        proof.boxes,
        proof.seconds,
        dict(sorted(Counter(map(_index, still)).items())),
        len(proof.points) - len(still),
        len(record.minima),
        tuple(undecided),
        tuple(singular),
        tuple(
            Added(model.energy(a.polished.x), tuple(model.expand(a.polished.x).tolist()))
            for a in added
        ),
        over=_ranges_over(model.scene),
    )


def _worth_judging(model: Model, proof: Proof) -> set[int]:
    """Return which singular states are judged: all, unless the list stays without proof whatever they are."""
    if (proof.finished and not proof.undecided) or len(proof.singular) <= MOST_SINGULAR:
        return set(range(len(proof.singular)))
    middles = np.array([0.5 * np.add(c.lower, c.upper) for c in proof.singular])
    # those of one energy stay in the order of the proof
    order = np.argsort(np.round(model.parameters.energy(middles), 9), kind="stable")
    return set(order[:MOST_SINGULAR].tolist())


def _ranges_over(scene: Scene) -> str:
    """Say over which states a proof ranges, where a symmetry is imposed."""
    if scene.group.is_trivial:
        return ""
    windings = scene.windings
    wind = ""
    if len(windings) > 1 or windings != (1,):
        wind = f", winding {' or '.join(map(str, windings))} times round its axis"
    return f"among closed states that keep {scene.group.name}{wind}"


def _answer_at(
    model: Model, record: Record, point: ProvedCriticalPoint
) -> tuple[FoundState | None, bool]:
    """Return the answer at a certified critical point; a possible minimum that is not on record is judged and filed."""
    x = np.array(point.x)
    # the point is the only critical one within its radius: what is on record there is it
    near = _nearest(record, x, point.radius + DUPLICATE_TOL)
    if near is not None or point.is_minimum is False:
        return near, False
    return _file(model, record, x)


def _index(point: ProvedCriticalPoint) -> str:
    """Name the index of a critical state, if it is certain."""
    unclear = any(s and not sign for s, sign in zip(point.stratum, point.pinned_signs, strict=True))
    return "unclear" if unclear or point.index is None else str(point.index)


def _leaves(point: ProvedCriticalPoint) -> bool:
    """Return whether a point is critical only while contacts are held that it would leave."""
    return 1 in point.pinned_signs or min(point.forces, default=0.0) < 0


def _file(model: Model, record: Record, x: np.ndarray) -> tuple[FoundState | None, bool]:
    """Polish, file and judge a state; return whether it is new.

    The middle of a box is no state: where it cannot be polished there is none.
    """
    end = Solve(x, "", 0, math.nan, np.ones(model.size), None)
    state = polish(model, end)
    if not state.converged:
        state = exact_beside(model, state)
    if not (state.converged and closes(model, state.x)):
        return None, False
    answer, new = record.file(model, state)
    if new:
        answer.listed = True
        judge(record, answer)
    return answer, new


def _singular(model: Model, x: np.ndarray) -> np.ndarray | None:
    """Return the state beside x whose fold angles next to 0 and +-pi are these; None where none closes."""
    flat = math.pi * np.round(x / math.pi)
    frozen = np.abs(x - flat) <= NEAR_SINGULAR_TOL
    y, residual = project(model, np.where(frozen, flat, x), frozen=frozen)
    return y if residual <= CLOSURE_TOL else None


def _nearest(record: Record, x: np.ndarray, within: float) -> FoundState | None:
    """Return the answer nearest to a state, None where none is within a distance (largest entry)."""
    distance = [float(np.abs(a.polished.x - x).max()) for a in record.answers]
    return (
        record.answers[int(np.argmin(distance))]
        if min(distance, default=math.inf) <= within
        else None
    )


def _disagreement(
    model: Model, point: ProvedCriticalPoint, answer: FoundState | None, against: list[str]
) -> Iterator[Open]:
    """Describe what stays open at a critical point: unclear to proof and judgement, or judged differently by them."""
    verdict = answer.what.verdict if answer is not None and answer.what is not None else ""
    where = f"at {model.energy(np.array(point.x)):.9g} J"
    moved = (
        answer is not None
        and np.abs(answer.polished.x - point.x).max() > point.radius + NEAR_SINGULAR_TOL
    )
    if point.is_minimum is False and verdict == "minimum":
        against.append(f"the proof refutes a listed minimum {where}")
    elif point.is_minimum and (verdict != "minimum" or moved):
        against.append(
            f"the judge does not confirm a proved minimum {where}: {verdict or 'not found'}"
        )
    elif point.is_minimum is None and (moved or verdict in ("", "undecided")):
        lower, upper = (np.array(point.x) + s * point.unique_radius for s in (-1, 1))
        yield _region(model, lower, upper, "a critical point of which it is not certain what it is")


def _verdict_at(model: Model, record: Record, x: np.ndarray, added: list[FoundState]) -> str:
    """Return what an exact singular state is; one that is not on record is judged and filed."""
    answer = record.known(x)
    if answer is None:
        answer = listed(record, model, x)
        record.answers.append(answer)
        added += [answer] * answer.is_minimum
    assert answer.what is not None
    return answer.what.verdict


def _judged(model: Model, record: Record, cluster: Cluster, added: list[FoundState]) -> Open:
    """Judge the state in a small cluster: that on record, else the polished middle."""
    lower, upper = np.array(cluster.lower), np.array(cluster.upper)
    if (upper - lower).max() > NEAR_SINGULAR_TOL:
        return _region(model, lower, upper, cluster.reason)
    middle = 0.5 * (lower + upper)
    inside = [a for a in record.answers if _within(a.polished.x, lower, upper)]
    verdicts: set[str] = {a.what.verdict for a in inside if a.what is not None}
    exact = _singular(model, middle)
    if exact is not None and _within(exact, lower, upper):
        verdicts.add(_verdict_at(model, record, exact, added))
    elif not inside:
        answer, new = _file(model, record, middle)
        if answer is not None:
            added += [answer] * (new and answer.is_minimum)
            if answer.what is not None and _within(answer.polished.x, lower, upper):
                verdicts = {answer.what.verdict}
    return _region(model, lower, upper, cluster.reason, ", ".join(sorted(verdicts)))


def _region(
    model: Model,
    lower: np.ndarray,
    upper: np.ndarray,
    reason: str,
    verdict: str = "",
    isolated: str = "",
) -> Open:
    low, high = model.expand(lower), model.expand(upper)
    energy = model.energy(0.5 * (lower + upper))
    return Open(tuple(low.tolist()), tuple(high.tolist()), float(energy), reason, verdict, isolated)


def _is_open(region: Open) -> bool:
    """Return whether nothing decides what is in a region: no state was judged there, or one of them without success."""
    return not region.verdict or "undecided" in region.verdict


def _merged(regions: list[Open]) -> list[Open]:
    """Name each state once: it is a cluster on several strata if they have it in common; what is not judged first."""
    kept: list[Open] = []
    middles = np.empty((len(regions), len(regions[0].lower) if regions else 0))
    # regions of one state on several strata are often the same
    for r in sorted(dict.fromkeys(regions), key=lambda r: (not _is_open(r), r.energy)):
        count, middle = len(kept), np.add(r.lower, r.upper) / 2
        near = np.abs(middles[:count] - middle).max(axis=1) <= DUPLICATE_TOL
        same = [kept[i] for i in np.flatnonzero(near)]
        if not any((k.verdict, bool(k.isolated)) == (r.verdict, bool(r.isolated)) for k in same):
            middles[count] = middle
            kept.append(r)
    return kept


def _within(x: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> bool:
    return bool(((x >= lower - DUPLICATE_TOL) & (x <= upper + DUPLICATE_TOL)).all())


def _covered(x: np.ndarray, proof: Proof) -> bool:
    """Return whether a state is a critical point of the proof, or in what it leaves open."""
    # what is certainly no minimum covers none
    points = (p for p in proof.points if p.is_minimum is not False)
    if any(np.abs(np.array(p.x) - x).max() <= p.radius + DUPLICATE_TOL for p in points):
        return True
    if proof.flat_radius and proof.flat_is_minimum is None and np.abs(x).max() <= DUPLICATE_TOL:
        return True
    return any(_within(x, np.array(c.lower), np.array(c.upper)) for c in _open(proof))


def _open(proof: Proof) -> Iterable[Cluster]:
    return (*proof.singular, *proof.undecided)


def _status(
    proof: Proof, undecided: list[Open], against: list[str], left: list[Open], singular: list[Open]
) -> str:
    if undecided or against or left or not proof.finished:
        return "not-proved"
    return "proved" if all(s.isolated for s in singular) else "proved-except-singular"


def _why_not(proof: Proof, undecided: list[Open], against: list[str], left: list[Open]) -> str:
    why = [*against]
    if not proof.finished:
        why.append("time was up, or the number of boxes")
    if undecided:
        energies = [r.energy for r in undecided]
        many = "a region is" if len(undecided) == 1 else f"{len(undecided)} regions are"
        why.append(f"{many} left open, energies {min(energies):.6g} to {max(energies):.6g} J")
    if left:
        many = "a singular state is" if len(left) == 1 else f"{len(left)} singular states are"
        why.append(f"{many} not decided")
    return "; ".join(why)
