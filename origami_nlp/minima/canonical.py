"""A scene posed under labels that do not depend on how it was labelled: what is searched for there is the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import OUTSIDE, coarse
from origami_nlp.pattern import Relabelling, canonical_labels
from origami_nlp.problem import Model

DIGITS = 11
"""After the point [rad], of minima that ways begin at: ten times `OUTSIDE`."""


def canonical_model(model: Model) -> tuple[Model, Relabelling] | None:
    """Pose the scene of a model, its mean stiffness 1, under canonical labels.

    Steps of Newton's method onto closure depend on where a walk round the vertex begins, by the square of what is left.

    Parameters
    ----------
    model
        The problem.

    Returns
    -------
    tuple of Model and Relabelling, or None
        None where the scene is as well as it is: under symmetry, and under forces, which count from a facet.
    """
    scene = model.scene
    if not scene.group.is_trivial or scene.loads:
        return None
    labels = canonical_labels(scene)
    return Model(labels.relabelled(scene)), labels


@dataclass(frozen=True)
class CanonicalStates:
    """States of a model under canonical labels, without what rounding leaves of them.

    Attributes
    ----------
    scene_model, model
        As given, and under canonical labels, or the same.
    labels
        Those labels; None where the model is the same.
    minima, modes
        The states in the variables of `model`, [M, n], and soft modes of each.
    unit
        What energies of `model` are multiplied by.
    """

    scene_model: Model
    model: Model
    labels: Relabelling | None
    minima: np.ndarray
    modes: Sequence[list[np.ndarray]]
    unit: float

    def to(self, x: np.ndarray) -> np.ndarray:
        """Return states [..., n] of the scene in the variables of `model`."""
        return _to(self.scene_model, self.model, self.labels, x)

    def back(self, x: np.ndarray) -> np.ndarray:
        """Return states [..., n] in the variables of the scene's model."""
        if self.labels is None:
            return x
        return np.asarray(self.scene_model.reduce(self.labels.back(self.model.expand(x))))


def canonical_states(
    model: Model, states: np.ndarray, modes: Sequence[list[np.ndarray]]
) -> CanonicalStates:
    """Pose states [M, n] of a model, and soft modes of each, under labels that do not depend on the scene's."""
    posed = canonical_model(model)
    if posed is None:
        return CanonicalStates(model, model, None, states, modes, 1.0)
    other, labels = posed
    # to the last bit, whatever rounding left; creases that are flat or at a limit stay so
    exact = _to(model, other, labels, states)
    still = (other.fold_limits.near(exact, OUTSIDE) != 0) | (np.abs(exact) <= OUTSIDE)
    exact = project(other, np.where(still, exact, np.round(exact, DIGITS)), frozen=still)[0]
    kept = [[coarse(_to(model, other, labels, m)) for m in of] for of in modes]
    unit = float(np.mean(model.scene.stiffness))
    return CanonicalStates(model, other, labels, exact, kept, unit)


def _to(model: Model, other: Model, labels: Relabelling | None, x: np.ndarray) -> np.ndarray:
    if labels is None:
        return x
    return np.asarray(other.reduce(labels.sign * model.expand(x)[..., labels.creases]))
