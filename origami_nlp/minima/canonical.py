"""A scene posed under labels that do not depend on how it was labelled: what is searched for there is the same."""

from __future__ import annotations

from origami_nlp.pattern import Relabelling, canonical_labels
from origami_nlp.problem import Model


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
