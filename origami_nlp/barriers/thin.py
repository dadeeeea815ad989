"""Thin sets as polylines: the paper's 1-handles, from the end where they leave the full-dimensional body.

A growing graph steps over sets that exist only while some contacts stay exactly closed.  They are followed as
curves instead; where a curve stops being thin it has reached the body, and that state is located by bisection.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.kkt import State, project, states_on_limits, thin_at
from origami_nlp.path import follow_boundary
from origami_nlp.programme import Contact, Model

SAME = 0.02
"""A state this close [rad] to a curve with the same closed contacts lies on it."""
SNAP = 2e-6
"""`thin_at` tells slopes from 1e-9 on, so that it finds an end to about this [rad]."""
SHORTEST = 1e-13
"""Ends of a thin curve are bisected to this length [rad]."""


@dataclass(frozen=True)
class ThinCurve:
    """A curve of states all of whose neighbours keep `held` closed.

    states: [m, n] model variables, in order.  ends: for its first and last state, whether the
    curve goes on into a full-dimensional set there (True), or ends (False).
    """

    held: tuple[Contact, ...]
    states: np.ndarray = field(repr=False)
    ends: tuple[bool, bool]


def thin_curves(model: Model, seed: int = 0, known: tuple[np.ndarray, ...] = ()) -> list[ThinCurve]:
    """Find and follow every one-dimensional thin set that random states at phi = +-pi, or `known` states, lie on."""
    if not model.has_limits or model.freedom != 2:
        return []
    curves: list[ThinCurve] = []
    for x in (*known, *states_on_limits(model, np.random.default_rng(seed))):
        held = thin_at(State(model, x))
        if not held or model.refuses(x):
            continue
        if any(c.held == held and _on(c.states, x) for c in curves):
            continue
        curve = follow_boundary(State(model, x).on(held), stop_at_release=False)
        if curve is None or curve.dimension != 1:
            continue
        curves += _thin_part(model, x, held, model.reduce(curve.fold_angles))
    return curves


def _on(states: np.ndarray, x: np.ndarray) -> bool:
    return float(np.abs(states - x).max(axis=1).min()) <= SAME


def _thin_part(
    model: Model, x: np.ndarray, held: tuple[Contact, ...], states: np.ndarray
) -> list[ThinCurve]:
    """Cut a followed curve to the stretch around x on which it is thin."""
    here = int(np.abs(states - x).max(axis=1).argmin())
    thin = [thin_at(State(model, y)) == held for y in states]
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
            run.append(_last_thin(model, states[k], states[k + step], held))
        else:
            run[-1] = _snap(model, run[-1], held)
        parts.append(run)
    whole = np.array(parts[0][::-1] + parts[1][1:])
    return [ThinCurve(held, whole, (opens[0], opens[1]))]


def _last_thin(
    model: Model, thin: np.ndarray, thick: np.ndarray, held: tuple[Contact, ...]
) -> np.ndarray:
    """Bisect between a thin state and one where the set is thick."""
    low, high = thin, thick
    while np.abs(high - low).max() > SHORTEST:
        middle, residual = project(model, 0.5 * (low + high), held)
        if residual > 1e-12 or max(np.abs(middle - low).max(), np.abs(middle - high).max()) >= (
            np.abs(high - low).max()
        ):
            break
        if thin_at(State(model, middle)) == held:
            low = middle
        else:
            high = middle
    return _snap(model, 0.5 * (low + high), held)


def _snap(model: Model, state: np.ndarray, held: tuple[Contact, ...]) -> np.ndarray:
    """Set fold angles within the tolerance of `thin_at` of a multiple of pi/2 to it, where that closes."""
    whole = 0.5 * math.pi * np.round(state / (0.5 * math.pi))
    snapped, residual = project(model, np.where(np.abs(state - whole) <= SNAP, whole, state), held)
    near = residual <= 1e-12 and np.abs(snapped - state).max() <= 2 * SNAP
    return snapped if near and not model.refuses(snapped) else state
