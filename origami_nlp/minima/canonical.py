"""A scene posed under labels that do not depend on how it was labelled: what is searched for there is the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from origami_nlp.escapes import Move
from origami_nlp.kkt import project
from origami_nlp.numerics import OUTSIDE
from origami_nlp.pattern import Pattern, Relabelling, Scene, canonical_labels, symmetries
from origami_nlp.pattern_problem import PatternProblem, find_labels, image, pose


@dataclass(frozen=True)
class CanonicalStates:
    """States of a scene under canonical labels, without what rounding leaves of them.

    Attributes
    ----------
    stated, problem
        As it is stated, and under canonical labels, posed; the same where labels are as they are.
    moves
        Symmetries of creases and springs, of states [..., n] of `problem`.
    labels
        These; None where they are as stated.
    minima
        The states in the variables of `problem`, [M, n].
    unit
        What energies of `problem` are multiplied by.
    """

    stated: PatternProblem
    problem: PatternProblem
    moves: Sequence[Move]
    labels: Relabelling | None
    minima: np.ndarray
    unit: float

    def back(self, x: np.ndarray) -> np.ndarray:
        """Return states [..., n] in the variables of the problem as it is stated."""
        if self.labels is None:
            return x
        return np.asarray(self.stated.reduce(self.labels.back(self.problem.expand(x))))


def canonical_states(
    stated: PatternProblem, scene: Scene | Pattern, states: np.ndarray
) -> CanonicalStates:
    """Pose states [M, n] of a scene under labels that do not depend on its own; of a pattern as they are."""
    if isinstance(scene, Pattern) or scene.is_symmetric or scene.loads:
        return CanonicalStates(stated, stated, moves_of(stated, scene), None, states, 1.0)
    labels = canonical_labels(scene)
    other = labels.relabelled(scene)
    problem = pose(other)
    # to the last bit, whatever rounding left; creases that are flat or at a limit stay so
    phi = stated.expand(states)
    exact = np.asarray(problem.reduce(labels.sign * phi[..., labels.creases]))
    still = (problem.fold_limits.near(exact, OUTSIDE) != 0) | (np.abs(exact) <= OUTSIDE)
    # digits [rad]: ten times `OUTSIDE`
    exact = project(problem, np.where(still, exact, np.round(exact, 11)), frozen=still)[0]
    unit = float(np.mean(scene.stiffness))
    return CanonicalStates(stated, problem, moves_of(problem, other), labels, exact, unit)


def moves_of(problem: PatternProblem, origami: Scene | Pattern) -> list[Move]:
    """Return the symmetries of an origami with its springs, imposed or not, of states [..., n] of its problem."""
    if isinstance(origami, Pattern):
        return [partial(image, one) for one in find_labels(origami).symmetries(origami)]
    return [partial(_moved, problem, move) for move in symmetries(origami)]


def _moved(problem: PatternProblem, move: Relabelling, x: np.ndarray) -> np.ndarray:
    """Return the states, in the problem's variables [..., n], to which a symmetry takes others."""
    return np.asarray(problem.reduce(move.back(problem.expand(x))))
