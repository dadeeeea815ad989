"""A `Proof` over the whole box of fold angles, held against what a search found."""

from __future__ import annotations

import math
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.kkt import Solve, exact_beside, polish, project
from origami_nlp.minima import Added, Completeness, JudgedState, Open
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, NEAR_SINGULAR_TOL
from origami_nlp.pattern import Scene
from origami_nlp.pattern_states.judgement import judge_end
from origami_nlp.proof import (
    Cluster,
    Proof,
    ProofOptions,
    ProvedCriticalPoint,
    ReducedVertex,
    prove,
    why_not as not_by_boxes,
)

MOST_DOF = 4
"""Degrees of freedom up to which a proof is tried where it is asked for: each multiplies boxes by about 11."""
FEW_DOF = 2
"""Degrees of freedom up to which it is tried without being asked; 1 where facets may touch and there is no symmetry."""
UNASKED = 50_000
"""Boxes after which a proof that nobody asked for gives up: two seconds; panels and degree 5 take at most 17,000."""


class KnownStates:
    """States of one winding that a search judged, and those that a proof adds.

    Parameters
    ----------
    vertex
        With its winding.
    states
        Judged.
    """

    def __init__(self, vertex: ReducedVertex, states: Sequence[JudgedState]) -> None:
        self.vertex, self.problem = vertex, vertex.problem
        self.states = [s for s in states if s.winding == vertex.winding]
        self.at = [self.problem.reduce(s.phi) for s in self.states]
        self.new = list[JudgedState]()

    @property
    def minima(self) -> list[np.ndarray]:
        """The states [n] that are minima."""
        return [x for x, s in zip(self.at, self.states, strict=True) if s.verdict == "minimum"]

    def nearest(self, x: np.ndarray, within: float = DUPLICATE_TOL) -> JudgedState | None:
        """Return the state nearest to one [n], None where none is within a distance (largest entry)."""
        far = [float(np.abs(y - x).max()) for y in self.at]
        return self.states[int(np.argmin(far))] if min(far, default=math.inf) <= within else None

    def judged(self, x: np.ndarray) -> JudgedState:
        """Return a state [n] that is known, or judge and keep it."""
        state = self.nearest(x)
        if state is None:
            state = replace(
                judge_end(self.problem, x, self.problem.contact),
                winding=self.vertex.winding,
            )
            self.new.append(state)
            self.states.append(state)
            self.at.append(self.problem.reduce(state.phi))
        return state

    def polished(self, x: np.ndarray) -> JudgedState | None:
        """Judge the state that Newton finds beside x: the middle of a box is no state; None where there is none."""
        state = polish(self.problem, Solve(x, "", 0, math.nan, np.ones(len(x))))
        if not state.converged:
            state = exact_beside(self.problem, state)
        closes = self.problem.residual(state.x) <= CLOSURE_TOL
        return self.judged(state.x) if state.converged and closes else None


def prove_each(
    vertices: Sequence[ReducedVertex],
    states: Sequence[JudgedState],
    wanted: bool | float | ProofOptions | None,
) -> tuple[Completeness | None, list[JudgedState]]:
    """Try to prove that the minima among judged states are all, of every winding; arguments as of `prove_complete`.

    Returns
    -------
    completeness : Completeness or None
        None where it was not tried.
    new : list of JudgedState
        What the proofs found, judged.
    """
    each = [KnownStates(vertex, states) for vertex in vertices]
    if len(each) == 1 or (wanted is None and not is_cheap(vertices[0])):
        return prove_complete(each[0], wanted, vertices[0].problem.until), each[0].new
    until = math.inf
    if wanted is not None and not isinstance(wanted, bool | ProofOptions):
        until = time.monotonic() + wanted
    found: list[Completeness] = []
    for known in each:
        if until < math.inf:
            wanted = max(until - time.monotonic(), 0.0)
        one = prove_complete(known, wanted, vertices[0].problem.until)
        if one is None:
            return None, []
        found.append(one)
    windings = [vertex.winding for vertex in vertices]
    return _joined(windings, found), [state for known in each for state in known.new]


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


def prove_complete(
    known: KnownStates, wanted: bool | float | ProofOptions | None, until: float = math.inf
) -> Completeness | None:
    """Try to prove that the minima that are known are all; what is missing is added to them.

    Parameters
    ----------
    known
        Of the search.
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
    vertex = known.vertex
    once = vertex.winding == 1  # other windings are tried where this one is
    if wanted is False or (wanted is None and once and not is_cheap(vertex)):
        return None
    refused = why_not(vertex)
    if refused:
        return Completeness("not-proved", refused)
    try:
        if isinstance(wanted, ProofOptions):
            boxes = wanted.boxes
        else:
            boxes = UNASKED if wanted is None else ProofOptions().boxes
            if wanted is not None and wanted is not True:
                boxes, until = sys.maxsize, min(until, time.monotonic() + float(wanted))
        return hold_against(known, prove(vertex, until=until, boxes=boxes), until)
    except (np.linalg.LinAlgError, ArithmeticError) as error:
        return Completeness("not-proved", f"linear algebra failed on the way: {error}")


MOST_JUDGED = 20
"""Of regions that a proof leaves open: in so many it is asked whether there is a minimum that the search lacks.  There
are hundreds where whole sets of states are level."""

ONE_STATE = "no other critical point is there, judged by its cone"
"""What is shown of a singular state whose place holds one state at most."""
MOST_SINGULAR = 100
"""Of singular states that are judged where a proof has failed for other reasons, those of least energy: along creases
that are one line there are hundreds."""


def why_not(vertex: ReducedVertex) -> str:
    """Return why a scene is not tried to be proved complete; "" where it is."""
    if vertex.dof > MOST_DOF:
        return f"{vertex.dof} degrees of freedom (at most {MOST_DOF})"
    return not_by_boxes(vertex)


def is_cheap(vertex: ReducedVertex) -> bool:
    """Return whether a proof is tried without being asked for."""
    touching = bool(vertex.gaps) and vertex.scene.group.is_trivial
    return not why_not(vertex) and 0 < vertex.dof <= (1 if touching else FEW_DOF)


def hold_against(known: KnownStates, proof: Proof, until: float = math.inf) -> Completeness:
    """Hold what a search knows against a proof; what the proof has and the search lacks is judged and added.

    Parameters
    ----------
    known
        Of the search.
    proof
        Of the same vertex.
    until
        When the time is over (`time.monotonic`): what is not judged by then stays open.

    Returns
    -------
    Completeness
        A minimum counts as missing where none that is known is that state, to `DUPLICATE_TOL` and the proof's own
        radius.
    """
    against: list[str] = []
    undecided: list[Open] = []
    vertex = known.vertex
    for point in proof.points:
        undecided += _disagreement(vertex, point, _state_at(known, point), against)

    def open_region(cluster: Cluster) -> Open:
        return _region(vertex, np.array(cluster.lower), np.array(cluster.upper), OUT_OF_TIME)

    least = _worth_judging(vertex, proof)
    singular = _merged(
        [
            open_region(cluster)
            if time.monotonic() > until
            else _judged(known, cluster)
            if k in least
            else _region(vertex, np.array(cluster.lower), np.array(cluster.upper), cluster.reason)
            for k, cluster in enumerate(proof.singular)
        ]
    )
    if proof.flat_radius and proof.flat_is_minimum is None:
        flat = np.zeros(vertex.size)
        singular.append(
            _region(
                vertex,
                flat,
                flat,
                "the flat state",
                known.judged(flat).verdict,
                proof.flat,
            )
        )
    undecided += [
        open_region(cluster)
        if time.monotonic() > until
        else _judged(known, cluster)
        if k < MOST_JUDGED
        else _region(vertex, np.array(cluster.lower), np.array(cluster.upper), cluster.reason)
        for k, cluster in enumerate(proof.undecided)
    ]
    # each listed minimum must be a root of the proof, or lie in a region that it leaves open
    for x in known.minima:
        if not _covered(x, proof):
            against.append(
                f"a listed minimum ({vertex.problem.energy(x):.9g} J) is in no region that is left"
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
        len(known.minima),
        tuple(undecided),
        tuple(singular),
        tuple(Added(s.energy, s.fold_angles) for s in known.new if s.verdict == "minimum"),
        over=_ranges_over(vertex.scene),
    )


def _worth_judging(vertex: ReducedVertex, proof: Proof) -> set[int]:
    """Return which singular states are judged: all, unless the list stays without proof whatever they are."""
    if (proof.finished and not proof.undecided) or len(proof.singular) <= MOST_SINGULAR:
        return set(range(len(proof.singular)))
    middles = np.array([0.5 * np.add(c.lower, c.upper) for c in proof.singular])
    # those of one energy stay in the order of the proof
    order = np.argsort(np.round(vertex.problem.parameters.energy(middles), 9), kind="stable")
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


def _state_at(known: KnownStates, point: ProvedCriticalPoint) -> JudgedState | None:
    """Return the state at a certified critical point; a possible minimum that is not known is judged and added."""
    x = np.array(point.x)
    # the point is the only critical one within its radius: what is known there is it
    near = known.nearest(x, point.radius + DUPLICATE_TOL)
    return near if near is not None or point.is_minimum is False else known.polished(x)


def _index(point: ProvedCriticalPoint) -> str:
    """Name the index of a critical state, if it is certain."""
    unclear = any(s and not sign for s, sign in zip(point.stratum, point.pinned_signs, strict=True))
    return "unclear" if unclear or point.index is None else str(point.index)


def _leaves(point: ProvedCriticalPoint) -> bool:
    """Return whether a point is critical only while contacts are held that it would leave."""
    return 1 in point.pinned_signs or min(point.forces, default=0.0) < 0


def _singular(vertex: ReducedVertex, x: np.ndarray) -> np.ndarray | None:
    """Return the state beside x whose fold angles next to 0 and +-pi are these; None where none closes."""
    flat = math.pi * np.round(x / math.pi)
    frozen = np.abs(x - flat) <= NEAR_SINGULAR_TOL
    y, residual = project(vertex.problem, np.where(frozen, flat, x), frozen=frozen)
    return y if residual <= CLOSURE_TOL else None


def _disagreement(
    vertex: ReducedVertex, point: ProvedCriticalPoint, state: JudgedState | None, against: list[str]
) -> Iterator[Open]:
    """Describe what stays open at a critical point: unclear to proof and judgement, or judged differently by them."""
    verdict = "" if state is None else state.verdict
    where = f"at {vertex.problem.energy(np.array(point.x)):.9g} J"
    moved = (
        state is not None
        and np.abs(vertex.problem.reduce(state.phi) - point.x).max()
        > point.radius + NEAR_SINGULAR_TOL
    )
    if point.is_minimum is False and verdict == "minimum":
        against.append(f"the proof refutes a listed minimum {where}")
    elif point.is_minimum and (verdict != "minimum" or moved):
        against.append(
            f"the judge does not confirm a proved minimum {where}: {verdict or 'not found'}"
        )
    elif point.is_minimum is None and (moved or verdict in ("", "undecided")):
        lower, upper = (np.array(point.x) + s * point.unique_radius for s in (-1, 1))
        yield _region(
            vertex, lower, upper, "a critical point of which it is not certain what it is"
        )


def _judged(known: KnownStates, cluster: Cluster) -> Open:
    """Judge the state in a small cluster: what is known there, else the polished middle."""
    vertex, lower, upper = known.vertex, np.array(cluster.lower), np.array(cluster.upper)
    if (upper - lower).max() > NEAR_SINGULAR_TOL:
        return _region(vertex, lower, upper, cluster.reason)
    middle = 0.5 * (lower + upper)
    inside = [k for k, x in enumerate(known.at) if _within(x, lower, upper)]
    verdicts: set[str] = {known.states[k].verdict for k in inside}
    exact = _singular(vertex, middle)
    if exact is not None and _within(exact, lower, upper):
        verdicts.add(known.judged(exact).verdict)
    elif not inside:
        state = known.polished(middle)
        if state is not None and _within(vertex.problem.reduce(state.phi), lower, upper):
            verdicts = {state.verdict}
    alone = ONE_STATE if cluster.alone and len(verdicts) == 1 else ""
    return _region(vertex, lower, upper, cluster.reason, ", ".join(sorted(verdicts)), alone)


def _region(
    vertex: ReducedVertex,
    lower: np.ndarray,
    upper: np.ndarray,
    reason: str,
    verdict: str = "",
    isolated: str = "",
) -> Open:
    low, high = vertex.problem.expand(lower), vertex.problem.expand(upper)
    energy = vertex.problem.energy(0.5 * (lower + upper))
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
