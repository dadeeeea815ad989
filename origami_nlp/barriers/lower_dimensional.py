"""Thin sets as polylines: the paper's 1-handles, from the end where they leave the full-dimensional body.

A growing graph steps over sets that exist only while some contacts stay exactly closed.  They are followed as
curves instead; where a curve stops being thin it has reached the body, and that state is located by bisection.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.continuation import follow_boundary
from origami_nlp.kkt import State, lower_dimensional_at, project
from origami_nlp.numerics import CLOSURE_TOL, ROUNDED, SAMPLED, SETTLED
from origami_nlp.problem import Contact, Model
from origami_nlp.starts import states_on_limits

SNAP = 2 * SETTLED
"""`lower_dimensional_at` distinguishes slopes from `INDEPENDENT` on, so that it finds an end to about this [rad]."""
SHORTEST = 10 * ROUNDED
"""Ends of a thin curve are bisected to this length [rad]."""


@dataclass(frozen=True)
class StratumCurve:
    """A curve of states all of whose neighbours keep `held` closed.

    states: [m, n] model variables, in order.  ends: for its first and last state, whether the
    curve goes on into a full-dimensional set there (True), or ends (False).
    """

    held: tuple[Contact, ...]
    states: np.ndarray = field(repr=False)
    ends: tuple[bool, bool]


def stratum_curves(
    model: Model, seed: int = 0, known: tuple[np.ndarray, ...] = ()
) -> list[StratumCurve]:
    """Find and follow every one-dimensional thin set that random states at phi = +-pi, or `known` states, lie on."""
    if not model.has_limits or model.dof != 2:
        return []
    curves: list[StratumCurve] = []
    for x in (*known, *states_on_limits(model, np.random.default_rng(seed))):
        state = State(model, x)
        held = lower_dimensional_at(state)
        if not held or state.refused:
            continue
        if any(c.held == held and _on(c.states, x) for c in curves):
            continue
        curve = follow_boundary(State(model, x).on(held), stop_at_release=False)
        if curve is None or curve.dimension != 1:
            continue
        curves += _thin_part(state, held, model.reduce(curve.fold_angles))
    return curves


def _on(states: np.ndarray, x: np.ndarray) -> bool:
    return float(np.abs(states - x).max(axis=1).min()) <= SAMPLED


def _thin_part(at: State, held: tuple[Contact, ...], states: np.ndarray) -> list[StratumCurve]:
    """Cut a followed curve [m, n] to the stretch around a state on which it is thin."""

    def is_lower_dimensional(state: State) -> bool:
        return lower_dimensional_at(state) == held

    here = int(np.abs(states - at.x).max(axis=1).argmin())
    thin = [is_lower_dimensional(at.at(y)) for y in states]
    if not thin[here]:
        return []
    parts, opens = [], []
    for step, stop in ((-1, -1), (1, len(states))):
        k = here
        while k + step != stop and thin[k + step]:
            k += step
        side = list(range(here, k + step, step))
        run = [states[i] for i in side]
        # the last sample of a curve may be the end itself, which is thick where the body begins
        opens.append(k + step != stop)
        if k + step != stop:
            low, high = last_stratum(at.at(states[k]), states[k + step], is_lower_dimensional, held)
            run.append(_snap(at.at(0.5 * (low + high)), held))
        else:
            run[-1] = _snap(at.at(run[-1]), held)
        parts.append(run)
    whole = np.array(parts[0][::-1] + parts[1][1:])
    return [StratumCurve(held, whole, (opens[0], opens[1]))]


def last_stratum(
    thin: State,
    thick: np.ndarray,
    is_lower_dimensional: Callable[[State], bool],
    held: tuple[Contact, ...],
) -> tuple[np.ndarray, np.ndarray]:
    """Bisect between a state where a set is thin and one [n] where it is not, both with `held` closed.

    Returns the last state seen on either side, as near to each other as projection separates them.
    """
    low, high = thin.x, thick
    while (apart := np.abs(high - low).max()) > SHORTEST:
        middle, residual = project(thin.problem, 0.5 * (low + high), held)
        if (
            residual > CLOSURE_TOL
            or max(np.abs(middle - end).max() for end in (low, high)) >= apart
        ):
            break
        # invariant: `low` is thin, `high` is not
        if is_lower_dimensional(thin.at(middle)):
            low = middle
        else:
            high = middle
    return low, high


def _snap(state: State, held: tuple[Contact, ...]) -> np.ndarray:
    """Set fold angles within the tolerance of `lower_dimensional_at` of a multiple of pi/2 to it, where that closes."""
    model, x = state.problem, state.x
    whole = 0.5 * math.pi * np.round(x / (0.5 * math.pi))
    snapped, residual = project(model, np.where(np.abs(x - whole) <= SNAP, whole, x), held)
    near = residual <= CLOSURE_TOL and np.abs(snapped - x).max() <= 2 * SNAP
    return snapped if near and not model.refuses(snapped) else x
