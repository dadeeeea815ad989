"""What a search is asked: a problem, the order in which its variables are drawn, its symmetries, and given starts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.kkt import passing_moment
from origami_nlp.minima import Completeness, JudgedState, full_scene, moves_of, with_full_space
from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.pattern import Pattern, Scene, canonical_labels
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem, find_labels, image, pose
from origami_nlp.pattern_states.proved import covers, is_tried, prove_list
from origami_nlp.pattern_states.vertex_proof import prove_each
from origami_nlp.problem import Model
from origami_nlp.proof import ProofOptions
from origami_nlp.search import StartKind, given
from origami_nlp.starts import FlatFoldings, HingeSets, Moments, NearFlat, NearFolded, is_chain

Wanted: TypeAlias = bool | float | ProofOptions | None
"""A proof, see `find_states`."""
Proved: TypeAlias = tuple[Completeness | None, list[JudgedState]]
GIVEN = "what the pattern gives"
FEWEST_FOR_MOMENTS = 16
"""Creases from which moments are started from: with 10 and 12 they found no more in the same time."""


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
    exact
        States that are judged where they are, listed likewise: no descent need end there.
    whole
        The problem without an imposed symmetry, and its labels: what has random errors.
    families
        Of random starts, of this problem alone.
    starts
        That are listed: a name, and how to list them [n].
    winding
        How often a closed state [n] winds round the axis of an imposed symmetry; 0 where it is no state that is asked
        for.
    told
        Adds to a judged state what only a vertex has.
    lists_all
        Whether a proof that is complete is the whole answer.
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
    families: Sequence[StartKind] = ()
    exact: Sequence[tuple[str, Callable[[], Iterable[np.ndarray]]]] = ()
    winding: Callable[[np.ndarray], int] = lambda x: 1
    told: Callable[[JudgedState], JudgedState] = lambda state: state
    lists_all: Callable[[], bool] = lambda: False
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

    def prove(known: Sequence[JudgedState], wanted: Wanted) -> Proved:
        if not is_tried(pattern, wanted, contact):
            return None, []
        return prove_list(pattern, problem, known, contact, wanted)

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
        lists_all=lambda: covers(pattern, contact),
    )


def _families(scene: Scene, model: Model, labels: CanonicalLabelling) -> list[StartKind]:
    """Return families of random starts of a vertex alone: drawn under labels that do not depend on its own."""
    if model.size < FEWEST_FOR_MOMENTS or not is_chain(model):
        return []
    if scene.loads:
        return [Moments(model)]
    return [Moments(Model(canonical_labels(scene).relabelled(scene)), labels)]


def _of_vertex(scene: Scene) -> Question:
    models = [Model(one) for one in scene.of_each_winding]
    first, n = models[0], models[0].size

    def named(scene: Scene) -> CanonicalLabelling:
        labels = canonical_labels(scene)
        return CanonicalLabelling(labels.creases, labels.sign, labels.backward, ())

    # forces count from a facet
    trivial = scene.group.is_trivial and not scene.loads
    labels = named(scene) if trivial else CanonicalLabelling(np.arange(n), 1.0, False, ())
    problem = pose(scene, labels if trivial else None)

    def whole() -> tuple[PatternProblem, CanonicalLabelling]:
        full = full_scene(scene)
        return pose(full), named(full)

    def winding(x: np.ndarray) -> int:
        missed = [float(np.abs(model.closure(x)[0]).max()) for model in models]
        k = int(np.argmin(missed))
        # folds beyond whole turns are not modelled
        beyond = not problem.has_limits and np.abs(x).max() >= problem.bound
        return 0 if beyond or missed[k] > DUPLICATE_TOL else models[k].structure.winding

    def told(state: JudgedState) -> JudgedState:
        state = replace(state, winding=winding(problem.reduce(state.phi)))
        passing = passing_moment(scene, state.phi) if state.verdict == "minimum" else None
        if passing is None:
            return state
        return replace(state, moment=passing.vector, moment_residual=passing.residual)

    def each(kind: type[Any]) -> Iterator[np.ndarray]:
        for model in models:
            yield from kind(model).states()

    def beside_folded() -> Iterator[np.ndarray]:
        for model in models:
            yield from NearFolded(model, list(FlatFoldings(model).states())).states()

    starts: list[tuple[str, Callable[[], Iterable[np.ndarray]]]] = [
        (GIVEN, lambda: (problem.reduce(x) for x in given(problem.pattern))),
        (NearFlat.name, partial(each, NearFlat)),
        (NearFolded.name, beside_folded),
    ]
    return Question(
        scene,
        scene.contact,
        problem,
        labels,
        [] if scene.loads else moves_of(problem, scene),
        partial(prove_each, models, problem),
        starts,
        whole,
        _families(scene, first, labels),
        [(kind.name, partial(each, kind)) for kind in (FlatFoldings, HingeSets)],
        winding,
        told,
        in_full_space=partial(with_full_space, scene, problem),
    )
