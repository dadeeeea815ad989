"""A proof of all minima of a mesh of vertices of degree four, held against what a search found."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.errors import OutOfTime
from origami_nlp.kkt import singular_beside
from origami_nlp.minima import Added, Completeness, JudgedState, Open
from origami_nlp.numerics import BESIDE_SINGULAR, DUPLICATE_TOL
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states.judgement import judge, judge_end
from origami_nlp.proof import (
    ProofOptions,
    SheetProof,
    as_sheet,
    prove_sheet,
    why_no_contact,
    why_no_sheet,
)

FEW = 2
"""Vertices of a mesh that folds flat up to which a proof is tried unasked."""
FEW_ROUND = 4
"""Vertices of a mesh that need not fold flat up to which a proof is tried unasked, within fold limits."""
UNASKED = 20_000
"""Boxes of a proof that nobody asked for: it costs about as much as the search."""


def is_tried(pattern: Pattern, wanted: bool | float | ProofOptions | None, contact: bool) -> bool:
    """Return whether a proof is tried: where it is asked for, or of a small mesh."""
    if wanted is not None:
        return wanted is not False
    many = len(pattern.vertices)
    # before its sectors are read, which takes seconds for thousands of vertices
    if many > FEW_ROUND:
        return False
    sheet, _ = as_sheet(pattern)
    if sheet is None or (contact and why_no_contact(pattern)):
        return False
    return many <= (FEW if sheet.folds_flat else FEW_ROUND)


def covers(pattern: Pattern, contact: bool) -> bool:
    """Return whether a proof of a pattern lists all that is asked by itself.

    Meshes that need not fold flat are searched as well: their curves say what it takes to leave a state.
    """
    sheet, _ = as_sheet(pattern)
    return sheet is not None and sheet.folds_flat and not contact


def prove_list(
    pattern: Pattern,
    problem: PatternProblem,
    known: Sequence[JudgedState],
    contact: bool,
    wanted: bool | float | ProofOptions | None,
) -> tuple[Completeness, list[JudgedState]]:
    """Try to prove that the minima of a pattern that are known are all.

    Parameters
    ----------
    pattern
        With springs.
    problem
        As it was searched, with its limit of time.
    known
        All that was judged.
    contact
        Whether facets must not cross.
    wanted
        As for `find_minima`.

    Returns
    -------
    completeness : Completeness
        What is proved.
    added : list of JudgedState
        What the proof found, and was judged.
    """
    if why := why_no_sheet(pattern):
        return Completeness("not-proved", why), []
    options = wanted if isinstance(wanted, ProofOptions) else ProofOptions()
    if wanted is None:
        options = replace(options, boxes=UNASKED)
    seconds = math.inf
    if isinstance(wanted, float | int) and not isinstance(wanted, bool):
        seconds = float(wanted)
    until = min(problem.until, time.monotonic() + seconds)
    proof = prove_sheet(pattern, boxes=options.boxes, until=until)
    return hold_against(proof, problem, known, contact)


def hold_against(
    proof: SheetProof, problem: PatternProblem, known: Sequence[JudgedState], contact: bool
) -> tuple[Completeness, list[JudgedState]]:
    """Compare minima that are known with those that are proved; what is missing is judged.

    Parameters
    ----------
    proof
        Of the pattern of the problem.
    problem, known, contact
        As for `prove_list`.

    Returns
    -------
    completeness : Completeness
        What is proved.
    added : list of JudgedState
        What was judged on the way.
    """
    against: list[str] = []
    judged: list[JudgedState] = []
    why = why_no_contact(problem.pattern) if contact else ""
    shown = [m.fold_angles for m in proof.minima]
    try:
        for minimum in proof.minima:
            problem.check_time()
            within = minimum.radius + DUPLICATE_TOL
            near = [s for s in known if np.abs(s.phi - minimum.fold_angles).max() <= within]
            if all(s.verdict == "undecided" for s in near):
                found = _where_rank_is_lost(proof, problem, minimum.fold_angles, known, contact)
                shown += [s.phi for s in found]
                new = [s for s in found if not any(s is k for k in known)]
                if not found:
                    new = [judge_end(problem, minimum.fold_angles, contact)]
                near, judged = [*near, *found, *new], [*judged, *new]
            # facets of a proof within fold limits may cross
            confirmed = ("minimum", "not admissible") if why else ("minimum",)
            if not any(s.verdict in confirmed for s in near):
                against.append(
                    f"a proved minimum ({near[0].energy:.9g} J) is judged: {near[0].verdict}"
                )
    except OutOfTime:  # what was judged is listed
        against.append("time was over before all proved minima were judged")
    for one, other in itertools.combinations([m.fold_angles for m in proof.minima], 2):
        if np.abs(one - other).max() <= 2 * DUPLICATE_TOL:
            against.append("two proved minima are not distinguished by the list")
    listed = [s for s in (*known, *judged) if s.verdict == "minimum"]
    for state in listed:
        if min((np.abs(state.phi - x).max() for x in shown), default=math.inf) > DUPLICATE_TOL:
            if not (why and any(not c.is_limit for c in state.contacts)):
                against.append(f"a listed minimum ({state.energy:.9g} J) is none of the proof")
    reasons = [*against]
    if proof.undecided:
        many = len(proof.undecided)
        reasons.append(f"{many} interval{'s' * (many != 1)} of the curves not decided")
    if why:
        reasons.append(
            f"all minima within fold limits are proved, {len(proof.minima)} on {proof.curves} curves; "
            f"{why}: states that touching facets hold are not enumerated"
        )
    added = [s for s in judged if s.verdict == "minimum"]
    completeness = Completeness(
        "not-proved" if reasons else "proved",
        "; ".join(reasons),
        proof.boxes,
        proof.seconds,
        {"0": len(proof.minima)} | ({"1": proof.maxima} if proof.maxima else {}),
        0,
        len(listed),
        tuple(_region(problem.pattern, *interval) for interval in proof.undecided),
        (),
        tuple(Added(s.energy, s.fold_angles) for s in added),
        proof.over,
    )
    return completeness, judged


def _where_rank_is_lost(
    proof: SheetProof,
    problem: PatternProblem,
    phi: np.ndarray,
    known: Sequence[JudgedState],
    contact: bool,
) -> list[JudgedState]:
    """Judge the state beside a proved minimum at which closure loses rank, if it is beside no other one.

    The sectors of the file are such that creases come to rest all but at their limits; of the two the kernel decides
    on the one that is at them, which closes to rounding as well.
    """
    there = singular_beside(problem.with_contact(contact), phi)
    if there is None:
        return []
    beside = [m for m in proof.minima if np.abs(m.fold_angles - there).max() <= BESIDE_SINGULAR]
    if len(beside) != 1:
        return []
    listed = [s for s in known if np.abs(s.phi - there).max() <= DUPLICATE_TOL]
    state = listed[0] if listed else judge(problem, there, contact)
    return [] if state.verdict == "undecided" else [state]


def _region(pattern: Pattern, lower: np.ndarray, upper: np.ndarray, why: str) -> Open:
    energy = float(pattern.energy(0.5 * (lower + upper)))
    return Open(tuple(lower.tolist()), tuple(upper.tolist()), energy, why)
