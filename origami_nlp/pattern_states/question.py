"""What a search is asked: a problem, the order in which its variables are drawn, its symmetries, and given starts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TypeAlias

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.minima import Completeness, JudgedState, full_scene, moves_of, with_full_space
from origami_nlp.numerics import DUPLICATE_TOL, OUTSIDE
from origami_nlp.pattern import Pattern, Relabelling, Scene, canonical_labels, winding_number
from origami_nlp.pattern_problem import (
    CanonicalLabelling,
    PatternProblem,
    find_labels,
    image,
    passing_moment,
    pose,
)
from origami_nlp.pattern_states.proved import FEW, Provable, of_sheet, of_vertices, prove_list
from origami_nlp.proof import ProofOptions, ReducedVertex
from origami_nlp.search import given

Wanted: TypeAlias = bool | float | ProofOptions | None
"""A proof, see `find_states`."""
Proved: TypeAlias = tuple[Completeness | None, list[JudgedState]]
GIVEN = "what the pattern gives"


@dataclass(frozen=True)
class Question:
    """What is asked of an origami, however it is stated.

    Attributes
    ----------
    stated
        The origami.
    contact
        ``"full"``, ``"fold-limits"`` or ``"none"``.
    problem
        Posed.
    labels
        In their order variables are drawn.
    symmetries
        Of the origami and its springs, of states [n].
    prove
        Tries to prove that the minima among judged states are all, as `prove` of `find_states` says: what is proved,
        None where it is not tried, and states that were judged on the way.
    whole
        The problem without an imposed symmetry, and its labels: what has random errors.
    starts
        That are listed: a name, and how to list them [n].
    winding
        How often a closed state [n] winds round the axis of an imposed symmetry; 0 where it is no state that is asked
        for.
    told
        Adds to a judged state what only a vertex has.
    proves
        Whether a proof is tried unasked.
    lists_all
        Whether a proof that is complete is the whole answer.
    canonical
        Posed under labels that all its labels agree on, where descents go down; None: as it is stated.
    in_full_space
        Adds the verdicts without an imposed symmetry to judged states, as `full` of `find_states` says.
    """

    stated: Scene | Pattern
    contact: str
    problem: PatternProblem
    labels: CanonicalLabelling
    symmetries: Sequence[Callable[[np.ndarray], np.ndarray]]
    prove: Callable[[Sequence[JudgedState], Wanted], Proved]
    starts: Sequence[tuple[str, Callable[[], Iterable[np.ndarray]]]]
    whole: Callable[[], tuple[PatternProblem, CanonicalLabelling]]
    winding: Callable[[np.ndarray], int] = lambda x: 1
    told: Callable[[JudgedState], JudgedState] = lambda state: state
    proves: Callable[[], bool] = lambda: False
    lists_all: Callable[[], bool] = lambda: False
    canonical: PatternProblem | None = None
    in_full_space: Callable[[list[JudgedState], bool | None], list[JudgedState]] = (
        lambda states, full: states
    )


def question_of(stated: Scene | Pattern, contact: bool) -> Question:
    """Return what is asked of an origami; contact: whether facets of a pattern must not cross."""
    return _of_vertex(stated) if isinstance(stated, Scene) else _of_sheet(stated, contact)


def _of_sheet(pattern: Pattern, contact: bool) -> Question:
    if not pattern.creases:
        raise OptionError("the pattern has no crease: there is nothing to fold")
    if contact:
        pattern.check_wide()
    labels = find_labels(pattern)
    problem = PatternProblem(labels.arranged(pattern), contact)
    problem.origin = pattern.corners.mean(axis=0) * (pattern.cell is None)

    few = len(pattern.vertices) <= FEW  # to read the sectors of thousands takes seconds

    @cache
    def provable() -> Provable:
        return of_sheet(pattern, contact)

    def prove(known: Sequence[JudgedState], wanted: Wanted) -> Proved:
        if wanted is None and not few:
            return None, []
        return prove_list(provable(), problem, known, contact, wanted)

    def whole() -> tuple[PatternProblem, CanonicalLabelling]:
        pattern.check_alone("the survival of states under errors")
        return problem, labels

    return Question(
        pattern,
        "full" if contact else "fold-limits",
        problem,
        labels,
        [partial(image, one) for one in labels.symmetries(pattern)],
        prove,
        [(GIVEN, lambda: given(problem.pattern))],
        whole,
        proves=lambda: few and bool(provable().unasked),
        lists_all=lambda: provable().alone,
    )


def _of_vertex(scene: Scene) -> Question:
    def as_order(seen: Relabelling) -> CanonicalLabelling:
        return CanonicalLabelling(seen.creases, seen.sign, seen.backward, ())

    # forces count from a facet
    seen = None if scene.loads or not scene.group.is_trivial else canonical_labels(scene)
    problem = pose(scene, as_order(seen) if seen else None)
    stated = CanonicalLabelling(np.arange(problem.size), 1.0, False, ())
    labels = as_order(seen) if seen else stated

    def whole() -> tuple[PatternProblem, CanonicalLabelling]:
        full = full_scene(scene)
        return pose(full), as_order(canonical_labels(full))

    def winding(x: np.ndarray) -> int:
        # folds beyond whole turns are not modelled
        beyond = not problem.has_limits and np.abs(x).max() > problem.bound + OUTSIDE
        if beyond or problem.residual(x) > DUPLICATE_TOL:
            return 0
        often = winding_number(scene.vertex, scene.group, problem.expand(x))
        return often if often in scene.windings else 0

    def told(state: JudgedState) -> JudgedState:
        state = replace(state, winding=winding(problem.reduce(state.phi)))
        minimum = state.verdict == "minimum"
        passing = passing_moment(scene, problem, state.phi) if minimum else None
        if passing is None:
            return state
        return replace(state, moment=passing.vector, moment_residual=passing.residual)

    provable = of_vertices([ReducedVertex(one, problem) for one in scene.of_each_winding])
    return Question(
        scene,
        scene.contact,
        problem,
        labels,
        [] if scene.loads else moves_of(problem, scene),
        lambda known, wanted: prove_list(provable, problem, known, problem.contact, wanted),
        [(GIVEN, lambda: (problem.reduce(x) for x in given(problem.pattern)))],
        whole,
        winding=winding,
        told=told,
        proves=lambda: bool(provable.unasked),
        canonical=pose(seen.relabelled(scene)) if seen else None,
        in_full_space=partial(with_full_space, scene, problem),
    )
