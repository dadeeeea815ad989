"""One-dimensional sets of closed states, at even distances, straight through the states where they cross.

Not by `continuation.trace`: at a crossing (the flat state is one for every vertex) closure loses rank, there is no one
tangent, and steps that are halved onto the singular state never pass it.  Here every step has the same length, and a
tangent is what of the last direction closure leaves, so that a curve jumps over the crossing and each branch keeps its
own way. Evenly spaced states are also what a landscape draws.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import CLOSURE_TOL, CROSSING, NONZERO, OUTSIDE
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model, Problem
from origami_nlp.starts import Projected

STARTS = 96
"""Projected random states from which curves are looked for; the same every time."""
SHORTEST = 8
"""Pieces with fewer points are dropped."""
LONGEST = 6000
"""Points after which a curve is given up as endless."""
NEWTON = 12
"""Steps of the corrector; from the predicted point it needs two to four."""


def trace_curves(scene: Scene, step: float) -> list[np.ndarray]:
    """Trace the closed states of a scene with one degree of freedom, inside |phi| <= pi.

    Parameters
    ----------
    step
        Distance of successive points in the space of the model's variables [rad].

    Returns
    -------
    curves
        Each a list of states [m, n] in the model's variables, in order along the curve.  Curves
        may cross (at the flat state they do): each goes straight through.  For contact ``"full"``
        states beyond a mirror or axis contact, or on the lift q = -1, are cut away.
    """
    model = Model(scene)
    curves: list[np.ndarray] = []
    for start in itertools.islice(Projected(model).starts(np.random.default_rng(0)), STARTS):
        x, residual = _correct(model, start.x)
        if residual > CLOSURE_TOL or np.abs(x).max() > math.pi + OUTSIDE:
            continue
        if any(np.linalg.norm(c - x, axis=1).min() < step for c in curves):
            continue
        tangent = _tangent(model, x, None)
        if tangent is None:  # a singular point: some other start finds its curves
            continue
        ahead, loop = _walk(model, x, tangent, step)
        behind = [] if loop else _walk(model, x, -tangent, step)[0]
        curves.append(np.array([*behind[::-1], x, *ahead]))
    # next to flat-folded states the tangent is ambiguous, and stubs of a few points can appear
    return [piece for c in curves for piece in _keep(model, c) if len(piece) > SHORTEST]


def _correct(model: Problem, x: np.ndarray, still: int | None = None) -> tuple[np.ndarray, float]:
    """Move a state onto closure; variable `still` stays.  Returns state and residual."""
    frozen = None if still is None else np.arange(model.size) == still
    y, residual = project(model, x, frozen=frozen, steps=NEWTON)
    return y, float(residual)


def _tangent(model: Problem, x: np.ndarray, before: np.ndarray | None) -> np.ndarray | None:
    """Unit tangent at x; where curves cross, the one most nearly along `before`."""
    _, s, vt = np.linalg.svd(model.closure(x)[1])
    null = vt[int((s > CROSSING).sum()) :]
    if before is None:
        return null[0] if len(null) == 1 else None
    # before a crossing the kernel is a plane that holds both tangents: the old direction, projected, picks one
    t = null.T @ (null @ before)
    length = float(np.linalg.norm(t))
    return t / length if length > 0.1 else before


def _walk(
    model: Problem, x: np.ndarray, tangent: np.ndarray, step: float
) -> tuple[list[np.ndarray], bool]:
    """Follow the curve from x until it leaves |phi| <= pi; return whether it came back to x."""
    start, points = x, []
    for count in range(LONGEST):
        for stretch in (1.0, 2.0, 0.5, 4.0):  # a crossing point can spoil one Newton step, not all
            y, residual = _correct(model, x + stretch * step * tangent)
            moved = y - x
            if residual <= CLOSURE_TOL and 0.2 * step < np.linalg.norm(moved) < 8 * step:
                break
        else:
            break
        beyond = np.abs(y) - math.pi
        if beyond.max() > 0:
            last = _end_point(model, x, y)
            if last is not None:
                points.append(last)
            break
        points.append(y)
        if count > 3 and np.linalg.norm(y - start) < 0.75 * step:
            return points, True
        tangent = _tangent(model, y, moved / np.linalg.norm(moved))  # type: ignore[assignment]
        x = y
    return points, False


def _end_point(model: Problem, x: np.ndarray, y: np.ndarray) -> np.ndarray | None:
    """Where the curve from x to y meets |phi| = pi, or None if Newton does not say."""
    # share of the step at which each fold angle reaches the limit that it is moving to
    room = (math.pi - np.sign(y) * x) / np.maximum(np.abs(y - x), NONZERO)
    room[np.abs(y) <= math.pi] = math.inf
    k = int(np.argmin(room))
    z = x + room[k] * (y - x)
    z[k] = math.copysign(math.pi, y[k])
    z, residual = _correct(model, z, k)
    if residual > CLOSURE_TOL or np.abs(z).max() > math.pi + OUTSIDE:
        return None
    return np.clip(z, -math.pi, math.pi)


def _keep(model: Problem, curve: np.ndarray) -> list[np.ndarray]:
    """Cut a curve where it leaves the lift q = +1 or passes a mirror or axis contact."""
    good = [model.lifts_to_one(x) and all(c.is_limit for c in model.beyond(x)) for x in curve]
    pieces = []
    for value, run in itertools.groupby(range(len(curve)), key=lambda k: good[k]):
        indices = list(run)
        if value and len(indices) > 1:
            pieces.append(curve[indices])
    return pieces
