"""How many random errors of what was made a minimum survives: followed from the exact scene, not searched for again."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.kkt import Solve, State, classify, follow, polish, project
from origami_nlp.minima.full_space import full_scene
from origami_nlp.minima.minimum import TRIALS, JudgedState, Survival
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import canonical_labels
from origami_nlp.problem import Model, Parameters

M = TypeVar("M")

MOST_NOISE = 10.0
"""Degrees: with more, errors are no longer small beside sector angles."""
GROWTH = 0.25, 0.5, 0.75, 1.0
"""Shares of the errors: from one to the next states are followed."""
FARTHEST = 0.2
"""A state that moves further in one of these steps [rad] has jumped."""


def check_noise(noise: float | None) -> None:
    """Check the size of random errors.

    Parameters
    ----------
    noise
        In degrees, or None for none.

    Raises
    ------
    OptionError
        If it is no number from 0 to `MOST_NOISE`.
    """
    if noise is not None:
        check_number("noise", noise, 0.0, MOST_NOISE)


def drawn_errors(trial: int, kinds: int, size: int) -> np.ndarray:
    """Return standard normal numbers, the same for every state: for rest angles, stiffnesses, and what is measured.

    Parameters
    ----------
    trial
        Which draw.
    kinds
        Of errors.
    size
        Numbers of each, in an order of creases that labels do not change.

    Returns
    -------
    numpy.ndarray
        Shape [kinds, size].
    """
    return np.random.default_rng(trial).normal(size=(kinds, size))


def count_survivals(
    states: Sequence[np.ndarray],
    way: Callable[[int], Sequence[M]],
    beside: Callable[[M, np.ndarray], np.ndarray | None],
) -> list[int]:
    """Follow states as errors grow, and count the draws in which each is a minimum to the end.

    Parameters
    ----------
    states
        Of the exact problem, [N] each.
    way
        Problems of a draw, by its number, the errors of which grow by `GROWTH`.
    beside
        The certified minimum of a problem beside a state, or None.

    Returns
    -------
    list of int
        Of `TRIALS` draws, for each state.
    """
    kept = [0] * len(states)
    for trial in range(TRIALS):
        problems = way(trial)
        for k, x in enumerate(states):
            kept[k] += _survives(problems, x, beside)
    return kept


def survival_words(degrees: float, measured: str) -> str:
    """Describe what was counted.

    Parameters
    ----------
    degrees
        Size of the errors.
    measured
        What is measured and has errors, beside stiffnesses, in words.

    Returns
    -------
    str
        A sentence below the table.
    """
    return (
        f"survives: those of {TRIALS} draws of random errors, {degrees:g} deg (standard deviation) of {measured} "
        f"and {math.radians(degrees):.2g} of stiffnesses, in which the state could be followed, as the errors grow, to "
        "a certified minimum"
    )


def with_survival(model: Model, minima: Sequence[JudgedState], degrees: float) -> list[JudgedState]:
    """Follow minima into scenes with random errors.

    The errors are the same for all minima, drawn by labels that do not depend on how creases are numbered, and break
    every symmetry: a minimum among symmetric states that is not one beside them does not survive.

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
    list of JudgedState
        With `survival`.
    """
    exact = Model(full_scene(model.scene))
    size = math.radians(degrees)
    states = [np.array(m.fold_angles) for m in minima]
    kept = count_survivals(states, lambda trial: _noisy(exact, size, trial), _beside)
    return [
        replace(m, survival=Survival(degrees, many, TRIALS))
        for m, many in zip(minima, kept, strict=True)
    ]


def _noisy(exact: Model, size: float, trial: int) -> list[Model]:
    """Return problems with one draw of errors, which grow from one to the next."""
    labels = canonical_labels(exact.scene)
    rest, stiffness, sectors = drawn_errors(trial, 3, exact.scene.degree)
    # a rest angle turns with the sheet when labels are of its other side
    rest = size * labels.back(rest)
    stiffness = size * labels.sign * labels.back(stiffness)
    sectors = sectors[np.argsort(labels.facets)]
    # the sum of sector angles stays
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
                p.laws and p.laws.along(replace(p.laws, weight=stiffness, shift=rest), t),
            ),
            at + t * sectors,
        )
        for t in GROWTH
    ]


def _survives(
    way: Sequence[M], x: np.ndarray, beside: Callable[[M, np.ndarray], np.ndarray | None]
) -> bool:
    """Return whether a state [N] can be followed, and is a minimum at the end."""
    for problem in way:
        new = beside(problem, x)
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
    if residual > CLOSURE_TOL:
        start, residual = project(model, x)
    try:
        down = follow(model, model.fold_limits.clip(start))
    except ValueError:
        return None
    return down.end if down.what.verdict == "minimum" else None
