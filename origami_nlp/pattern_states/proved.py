"""A list of minima, held against the proof of all of them: what it lacks is added, what is wrong is said."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from origami_nlp.errors import OutOfTime
from origami_nlp.kkt import Solve, exact_beside, polish, project
from origami_nlp.minima import Added, Completeness, JudgedState, Open
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, NEAR_SINGULAR_TOL
from origami_nlp.pattern import Pattern, Scene
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states.judgement import judge_end
from origami_nlp.proof import (
    Proof,
    ProofOptions,
    ProvedState,
    ReducedVertex,
    Region,
    as_sheet,
    gaps_of,
    prove,
    prove_sheet,
    why_no_contact,
    why_not,
)

FEW_DOF = 2
"""Degrees of freedom up to which a vertex is tried unasked; 1 where facets may touch and there is no symmetry."""
FEW_FLAT, FEW = 2, 4
"""Vertices of a sheet up to which it is tried unasked: where it folds flat, and where it need not."""
BOXES, INTERVALS = 50_000, 20_000
"""After which a proof that nobody asked for gives up, of a vertex and of a sheet: two seconds."""
MOST_JUDGED, MOST_SINGULAR = 20, 100
"""Regions that are judged where a list is not proved anyway, other ones and singular ones of least energy: along
creases that are one line there are hundreds."""
ONE_STATE = "no other critical point is there, judged by its cone"
"""What is shown of a singular state whose place holds one state at most."""


@dataclass(frozen=True)
class Provable:
    """How the list of an origami is proved.

    Attributes
    ----------
    prove
        Proves it, in so many `boxes`, `until` a time.
    why
        Why that is not possible; "" where it is.
    unasked
        Boxes that it may take unasked; 0: it is not tried.
    alone
        Whether a proof that is complete is the whole answer.
    short
        Why what is proved within fold limits is not so with contact; "" where it is, or is not asked for.
    """

    prove: Callable[..., Proof]
    why: str
    unasked: int
    alone: bool = False
    short: str = ""


def provable_of(stated: Scene | Pattern, problem: PatternProblem) -> Provable:
    """Return how the list of an origami is proved, of all its windings."""
    if isinstance(stated, Pattern):
        return of_sheet(stated, problem.contact)
    return of_vertices([ReducedVertex(one, problem) for one in stated.of_each_winding])


def of_vertices(vertices: Sequence[ReducedVertex]) -> Provable:
    """Return how the list of a vertex is proved, of all its windings."""
    first = vertices[0]
    why = why_not(first)
    touching = (
        bool(first.scene.contact == "full" and gaps_of(first)[0]) and first.scene.group.is_trivial
    )
    cheap = not why and 0 < first.dof <= (1 if touching else FEW_DOF)
    return Provable(partial(prove, *vertices), why, BOXES if cheap else 0)


def of_sheet(pattern: Pattern, contact: bool) -> Provable:
    """Return how the list of a sheet is proved."""
    sheet, why = as_sheet(pattern)
    many, flat = len(pattern.vertices), sheet is not None and sheet.folds_flat
    short = why_no_contact(pattern) if contact and not why else ""
    few = not (why or short) and many <= (FEW_FLAT if flat else FEW)
    # curves of sheets that need not fold flat say what it takes to leave a state: they are searched as well
    alone = flat and not contact
    return Provable(partial(prove_sheet, pattern), why, INTERVALS if few else 0, alone, short)


def prove_list(
    provable: Provable,
    problem: PatternProblem,
    known: Sequence[JudgedState],
    wanted: bool | float | ProofOptions | None,
) -> tuple[Completeness | None, list[JudgedState]]:
    """Try to prove that the minima that are known are all.

    Parameters
    ----------
    provable
        How.
    problem
        As it was searched, with its limit of time.
    known
        All that was judged.
    wanted
        True, or options: in at most as many boxes as they say; or the seconds that it may take; None: where it is
        cheap; False: not at all.

    Returns
    -------
    completeness : Completeness or None
        What is proved; None where it was not tried.
    added : list of JudgedState
        What the proof found, and was judged.
    """
    if wanted is False or (wanted is None and not provable.unasked):
        return None, []
    if provable.why:
        return Completeness("not-proved", provable.why), []
    options = wanted if isinstance(wanted, ProofOptions) else ProofOptions()
    timed = isinstance(wanted, float | int) and not isinstance(wanted, bool)
    until = min(problem.until, time.monotonic() + (float(wanted) if timed else math.inf))  # type: ignore[arg-type]
    boxes = provable.unasked if wanted is None else options.boxes
    try:
        proof = provable.prove(boxes=boxes, until=until)
        return hold_against(proof, problem, known, provable.short)
    except (np.linalg.LinAlgError, ArithmeticError) as error:
        return Completeness("not-proved", f"linear algebra failed on the way: {error}"), []


def hold_against(
    proof: Proof,
    problem: PatternProblem,
    known: Sequence[JudgedState],
    short: str = "",
) -> tuple[Completeness, list[JudgedState]]:
    """Hold what a search knows against a proof; what the proof has and the search lacks is judged and added.

    Parameters
    ----------
    proof
        Of the same origami.
    problem, known
        As for `prove_list`.
    short
        As of `Provable`.

    Returns
    -------
    completeness : Completeness
        A minimum counts as missing where none that is known is that state, to `DUPLICATE_TOL` and the proof's own
        radius.
    added : list of JudgedState
        What was judged on the way.
    """
    states, against = _States(problem, known), list[str]()
    undecided, singular, shown = list[Open](), list[Open](), list[np.ndarray]()
    hopeless = bool(proof.undecided or not proof.finished or short)
    try:
        for point in proof.points:
            undecided += _disagreement(states, point, short, against, shown)
        singular = _merged(
            [*_judged(states, proof.singular, MOST_SINGULAR if hopeless else len(proof.singular))]
        )
        undecided += _judged(states, proof.undecided, MOST_JUDGED)
    except OutOfTime:  # what was judged is listed
        against.append("time was over before all that is proved was judged")
    for state in states.all:
        if state.verdict == "minimum" and not _is_covered(state.phi, proof, shown):
            if not (short and any(not c.is_limit for c in state.contacts)):
                against.append(f"a listed minimum ({state.energy:.9g} J) is none of the proof")
    left = [s for s in singular if _is_open(s)]
    still = [p for p in proof.points if not _leaves(p)]
    why = [*against]
    if not proof.finished:
        why.append("time was up, or the number of boxes")
    for some, what in ((undecided, "regions left open"), (left, "singular states not decided")):
        if some:
            energies = [r.energy for r in some]
            why.append(f"{len(some)} {what}, {min(energies):.6g} to {max(energies):.6g} J")
    if short:
        why.append(
            f"all minima within fold limits are proved, {len(proof.minima)}; {short}: states that touching facets hold "
            "are not enumerated"
        )
    isolated = all(s.isolated for s in singular)
    added = [s for s in states.new if s.verdict == "minimum"]
    completeness = Completeness(
        "not-proved" if why else "proved" if isolated else "proved-except-singular",
        "; ".join(why),
        proof.boxes,
        proof.seconds,
        dict(sorted(Counter(map(_index, still)).items())),
        len(proof.points) - len(still),
        sum(s.verdict == "minimum" for s in states.all),
        tuple(undecided),
        tuple(singular),
        tuple(Added(s.energy, s.fold_angles) for s in added),
        proof.over,
    )
    return completeness, states.new


class _States:
    """States that a search judged, and those that a proof adds."""

    def __init__(self, problem: PatternProblem, known: Sequence[JudgedState]) -> None:
        self.problem = problem
        self.all, self.new = [*known], list[JudgedState]()

    def near(self, phi: np.ndarray, within: float) -> JudgedState | None:
        """Return the nearest state within a distance (largest entry), one that is decided if there is."""
        far = [(s.verdict == "undecided", float(np.abs(s.phi - phi).max())) for s in self.all]
        least = min(range(len(far)), key=lambda k: (far[k][1] > within, *far[k]), default=None)
        return self.all[least] if least is not None and far[least][1] <= within else None

    def judged(self, phi: np.ndarray, within: float = DUPLICATE_TOL) -> JudgedState:
        """Return the state that is known, or judge and keep it."""
        state = self.near(phi, within)
        if state is None or state.verdict == "undecided":
            self.problem.check_time()
            state = judge_end(self.problem, self.problem.reduce(phi))
            self.new.append(state)
            self.all.append(state)
        return state

    def polished(self, phi: np.ndarray) -> JudgedState | None:
        """Judge the state that Newton finds beside one: the middle of a box is none; None where there is none."""
        problem = self.problem
        x = problem.reduce(phi)
        state = polish(problem, Solve(x, "", 0, math.nan, np.ones(len(x))))
        if not state.converged:
            state = exact_beside(problem, state)
        closes = problem.residual(state.x) <= CLOSURE_TOL
        return self.judged(problem.expand(state.x)) if state.converged and closes else None

    def refuted(self, phi: np.ndarray) -> JudgedState | None:
        """Return a state that is judged to be no minimum, None where it is not; it is not kept."""
        self.problem.check_time()
        state = judge_end(self.problem, self.problem.reduce(phi))
        return None if state.verdict in ("minimum", "undecided") else state

    def energy(self, phi: np.ndarray) -> float:
        """Return the energy of a state."""
        return float(self.problem.energy(self.problem.reduce(phi)))

    def region(self, region: Region, verdict: str = "", isolated: str = "") -> Open:
        """Return a region as it is reported."""
        ends = tuple(region.lower.tolist()), tuple(region.upper.tolist())
        energy = self.energy(0.5 * (region.lower + region.upper))
        return Open(*ends, energy, region.reason, verdict, isolated)


def _disagreement(
    states: _States,
    point: ProvedState,
    short: str,
    against: list[str],
    shown: list[np.ndarray],
) -> Iterator[Open]:
    """Describe what stays open at a critical point: unclear to proof and judgement, or judged differently by them."""
    x, where = point.fold_angles, f"at {states.energy(point.fold_angles):.9g} J"
    # the point is the only critical one within its radius: what is known there is it
    within = point.radius + DUPLICATE_TOL
    refuted = point.is_minimum is False
    state = states.near(x, within) if not point.is_minimum else states.judged(x, within)
    if (
        point.is_minimum is None and state is None
    ):  # Newton has to find what the proof does not decide
        state = states.refuted(x) or states.polished(x)
    # sectors as they are typed make a singular state of one beside it
    if state is not None and np.abs(state.phi - x).max() > point.radius + NEAR_SINGULAR_TOL:
        state = None
    verdict = "" if state is None else state.verdict
    if state is not None and point.is_minimum:
        if any(np.array_equal(state.phi, y) for y in shown):
            against.append(f"two proved minima {where} are not distinguished by the list")
        shown.append(state.phi)
    # facets of a proof within fold limits may cross
    confirmed = ("minimum", "not admissible") if short else ("minimum",)
    if refuted and verdict == "minimum":
        against.append(f"the proof refutes a listed minimum {where}")
    elif point.is_minimum and verdict not in confirmed:
        against.append(f"a proved minimum {where} is judged: {verdict or 'not found'}")
    elif point.is_minimum is None and verdict in ("", "undecided"):
        r = point.unique_radius
        yield states.region(Region(x - r, x + r, "a critical point that is not decided"))


def _index(point: ProvedState) -> str:
    """Name the index of a critical state, if it is certain."""
    unclear = any(s and not sign for s, sign in zip(point.stratum, point.pinned_signs, strict=True))
    return "unclear" if unclear or point.index is None else str(point.index)


def _leaves(point: ProvedState) -> bool:
    """Return whether a point is critical only while contacts are held that it would leave."""
    return 1 in point.pinned_signs or min(point.forces, default=0.0) < 0


def _judged(states: _States, regions: Sequence[Region], most: int) -> Iterator[Open]:
    """Judge the states in regions that are small, up to so many, those of least energy first."""
    energies = [states.energy(0.5 * (r.lower + r.upper)) for r in regions]
    # those of one energy stay in the order of the proof
    order = np.argsort(np.round(energies, 9), kind="stable").tolist()
    small = [np.max(r.upper - r.lower) <= NEAR_SINGULAR_TOL for r in regions]
    worth = set([k for k in order if small[k]][:most])
    for k, region in enumerate(regions):
        yield _judged_one(states, region) if k in worth else states.region(region)


def _judged_one(states: _States, region: Region) -> Open:
    """Judge the state in a small region: what is known there, else the polished middle."""

    def inside(phi: np.ndarray) -> bool:
        return _is_within(phi, region)

    middle = 0.5 * (region.lower + region.upper)
    verdicts: set[str] = {s.verdict for s in states.all if inside(s.phi)}
    exact = _singular(states.problem, middle)
    if exact is not None and inside(exact):
        verdicts.add(states.judged(exact).verdict)
    elif not verdicts:
        state = states.polished(middle)
        if state is not None and inside(state.phi):
            verdicts = {state.verdict}
    alone = ONE_STATE if region.alone and len(verdicts) == 1 else ""
    return states.region(region, ", ".join(sorted(verdicts)), alone)


def _singular(problem: PatternProblem, phi: np.ndarray) -> np.ndarray | None:
    """Return the state beside one whose fold angles next to 0 and +-pi are these; None where none closes."""
    x = problem.reduce(phi)
    flat = math.pi * np.round(x / math.pi)
    frozen = np.abs(x - flat) <= NEAR_SINGULAR_TOL
    y, residual = project(problem, np.where(frozen, flat, x), frozen=frozen)
    return problem.expand(y) if residual <= CLOSURE_TOL else None


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


def _is_within(phi: np.ndarray, region: Region) -> bool:
    low, high = region.lower - DUPLICATE_TOL, region.upper + DUPLICATE_TOL
    return bool(((low <= phi) & (phi <= high)).all())


def _is_covered(phi: np.ndarray, proof: Proof, shown: Sequence[np.ndarray]) -> bool:
    """Return whether a state is a critical point of the proof, or in what it leaves open."""
    # what is certainly no minimum covers none
    points = (p for p in proof.points if p.is_minimum is not False)
    return (
        any(np.abs(p.fold_angles - phi).max() <= p.radius + DUPLICATE_TOL for p in points)
        or any(np.abs(x - phi).max() <= DUPLICATE_TOL for x in shown)
        or any(_is_within(phi, r) for r in proof.regions)
    )
