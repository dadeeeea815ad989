"""Walk along a contact boundary to both its ends: cheap steps first, the exact corner last.

Like `boundary_curve.follow_boundary`, whose steps it takes, but made to trace all boundaries of a chart: admissibility
is looked at for many points at once, energy plays no part, and ends are put on the corner by Newton.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.chart.chart import admissible
from origami_nlp.path import Point, advance, correct, evaluate
from origami_nlp.programme import (
    Contact,
    Model,
)

LONGEST, SHORTEST = 0.04, 1e-10
"""Longest step, and the step [rad] to which the end of a line is bisected."""
TURN = 0.06
"""The tangent turns by about this much [rad] a step."""
CHUNK = 12
"""Steps made before admissibility is looked at, for all of them at once."""
MOST_POINTS = 3000
CLOSED = 1e-6
"""Gap [rad] of the contact at the end of a walk, before Newton closes it."""


@dataclass(frozen=True)
class Walk:
    """States [m, n] in the model's variables, arclength [m] in all N fold angles from 0, and why it ends."""

    states: np.ndarray
    s: np.ndarray
    start: str
    end: str


def walk(model: Model, x: np.ndarray, rows: tuple[Contact, ...]) -> Walk | None:
    """Follow `rows` from the admissible state x [n] both ways.

    None where no motion, or more than one, keeps the rows closed, or where both ends come at once.
    """
    first = evaluate(model, x, rows)
    if first is None or first.dimension != 1:
        return None
    turned = evaluate(model, x, rows, -first.tangent)
    assert turned is not None
    ahead, why_end = _one_way(model, first, rows)
    behind: list[tuple[np.ndarray, float]] = []
    why_start = why_end
    if why_end != "closed curve":
        behind, why_start = _one_way(model, turned, rows)
    states = np.array([*(y for y, _ in reversed(behind)), x, *(y for y, _ in ahead)])
    if len(states) < 3:
        return None
    s = np.array([*(-v for _, v in reversed(behind)), 0.0, *(v for _, v in ahead)])
    return Walk(states, s - s[0], why_start, why_end)


def _one_way(
    model: Model, first: Point, rows: tuple[Contact, ...]
) -> tuple[list[tuple[np.ndarray, float]], str]:
    """Follow the tangent of `first`: states with their arclength, and why they end."""
    out: list[tuple[np.ndarray, float]] = []
    point, s, h = first, 0.0, 1e-2
    root = np.sqrt(model.multiplicity)
    while len(out) < MOST_POINTS:
        ahead: list[tuple[Point, float, float]] = []
        last, total, step = point, s, h
        why = ""
        while len(ahead) < CHUNK:
            moved = advance(model, last, rows, step)
            turn = math.inf
            if moved is not None:
                turn = float(np.linalg.norm(moved[0].tangent - last.tangent))
            if turn > 3 * TURN:
                if step <= 1e-5:
                    why = "singular: closure or contacts lose rank, or no solution beyond"
                    break
                step /= 2
                continue
            assert moved is not None
            last, total = moved[0], total + moved[1]
            ahead.append((last, total, step))
            step = min(LONGEST, step * min(2.0, TURN / max(turn, 1e-3 * TURN)))
        kept = _admissible_run(model, [p.x for p, _, _ in ahead])
        for p, value, _ in ahead[:kept]:
            out.append((p.x, value))
            back = float(np.linalg.norm(root * (p.x - first.x)))
            if len(out) > 5 and back <= LONGEST and p.tangent @ first.tangent > 0.9:
                out.append((first.x, value + back))
                return out, "closed curve"
        if kept:
            point, s, h = ahead[kept - 1][0], ahead[kept - 1][1], step
        if kept < len(ahead):
            return _last_stretch(model, point, s, ahead[kept][2], rows, out)
        if why:
            return _last_stretch(model, point, s, 1e-5, rows, out)
    return out, f"more than {MOST_POINTS} points"


def _admissible_run(model: Model, states: list[np.ndarray]) -> int:
    """How many of the states, from the first on, are admissible."""
    count = 0
    for x in states:
        beyond = _beyond(model, x)
        if beyond or any(not c.is_limit for c in model.beyond(x)):
            break
        count += 1
    if count:
        good = admissible(model.scene, model.expand(np.array(states[:count])))
        count = count if good.all() else int(np.argmin(good))
    # the order of layers is looked at where a run ends: it changes at corners, and then stays
    low, high = -1, count
    if count and model.refuses(states[count - 1]):
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if not model.refuses(states[middle]) else (low, middle)
    return high


def _beyond(model: Model, x: np.ndarray) -> bool:
    """Whether a fold angle exceeds pi, by however little."""
    return model.has_limits and bool((np.abs(x) > model.bound).any())


def _last_stretch(
    model: Model,
    point: Point,
    s: float,
    h: float,
    rows: tuple[Contact, ...],
    out: list[tuple[np.ndarray, float]],
) -> tuple[list[tuple[np.ndarray, float]], str]:
    """Bisect to the end of a line, put its last point on the corner, and say what closes there."""
    while h > SHORTEST:
        moved = advance(model, point, rows, h)
        if moved is None or _beyond(model, moved[0].x) or model.refuses(moved[0].x):
            h /= 2
            continue
        point, s = moved[0], s + moved[1]
        out.append((point.x, s))
        h *= 0.9
    found = model.closed(point.x, CLOSED)
    extra = dict.fromkeys(found.base)
    for options in found.branches:
        extra.update(dict.fromkeys(options[0]))
    new = tuple(row for row in extra if row not in rows)
    if not new:
        return out, "singular: closure or contacts lose rank, or no solution beyond"
    corner = correct(model, point.x.copy(), (*rows, *new))
    if corner is not None and np.abs(corner - point.x).max() < CLOSED:
        out.append((corner, s + float(np.linalg.norm(corner - point.x))))
    return out, "another contact closes (" + "; ".join(model.name(row) for row in new) + ")"
