"""How many random errors of what was made a minimum survives: followed from the exact scene, not searched for again."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.kkt import Solve, State, classify, follow, polish, project
from origami_nlp.minima.full_space import full_scene
from origami_nlp.minima.minimum import TRIALS, Minimum, Survival
from origami_nlp.numerics import CLOSES
from origami_nlp.pattern import canonical_labels
from origami_nlp.programme import Model, Parameters

STEPS = 4
"""In which errors grow from nothing to their size."""
FARTHEST = 0.2
"""A state that moves further in one of these steps [rad] has jumped."""


def with_survival(model: Model, minima: Sequence[Minimum], degrees: float) -> list[Minimum]:
    """Follow minima into scenes with random errors.

    The errors are the same for all minima, drawn by labels that do not depend on how creases are numbered, and break
    every symmetry: a minimum among symmetric states that is none beside them does not survive.

    Parameters
    ----------
    model
        Of the exact scene.
    minima
        Of it.
    degrees
        Size of the errors.

    Returns
    -------
    list of Minimum
        With `survival`.
    """
    exact = Model(full_scene(model.scene))
    kept = np.zeros(len(minima), dtype=int)
    states = [np.array(m.fold_angles) for m in minima]
    ways = [_noisy(exact, math.radians(degrees), trial) for trial in range(TRIALS)]
    for k, x in enumerate(states):
        kept[k] = sum(_survives(way, x) for way in ways)
    return [
        replace(m, survival=Survival(degrees, int(many), TRIALS))
        for m, many in zip(minima, kept, strict=True)
    ]


def _noisy(exact: Model, size: float, trial: int) -> list[Model]:
    """Return programmes with one draw of errors, which grow from one to the next."""
    labels = canonical_labels(exact.scene)
    rng, n = np.random.default_rng(trial), exact.scene.degree
    # a rest angle turns with the sheet when labels are of its other side
    rest = size * labels.back(rng.normal(size=n))
    stiffness = size * labels.sign * labels.back(rng.normal(size=n))
    sectors = rng.normal(size=n)[np.argsort(labels.facets)]
    sectors = size * (sectors - sectors.mean())
    p = exact.parameters
    at = np.array(exact.scene.vertex.sector_angles)
    return [
        exact.varied(
            Parameters(
                p.sectors + t * sectors,
                p.stiffness * np.exp(t * stiffness),
                p.rest + t * rest,
                p.load,
                p.dead,
            ),
            at + t * sectors,
        )
        for t in np.arange(1, STEPS + 1) / STEPS
    ]


def _survives(way: Sequence[Model], x: np.ndarray) -> bool:
    """Tell whether a state [N] can be followed, and is a minimum at the end."""
    for model in way:
        new = _beside(model, x)
        if new is None or np.abs(new - x).max() > FARTHEST:
            return False
        x = new
    return True


def _beside(model: Model, x: np.ndarray) -> np.ndarray | None:
    """Return the certified minimum beside a state of a slightly different scene: by Newton, or downhill."""
    closed = State(model, x).contacts.base
    guess = tuple(c for c in closed)
    pull = np.zeros(model.size)
    pull[[c.index for c in guess if c.is_limit]] = 1.0
    done = polish(model, Solve(x, "", 0, 0.0, pull, None), guess)
    if done.converged and np.abs(done.x - x).max() <= FARTHEST:
        if classify(State(model, done.x)).verdict == "minimum":
            return done.x
    start, residual = project(model, x, [c for c in guess if c.is_limit])
    if residual > CLOSES:
        start, residual = project(model, x)
    try:
        down = follow(model, np.clip(start, -model.bound, model.bound))
    except ValueError:
        return None
    return down.end if down.what.verdict == "minimum" else None
