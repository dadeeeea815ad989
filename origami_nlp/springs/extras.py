"""Minima that nobody asked for, cut away: rows that make the energy fall from them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from origami_nlp.kkt import State, project
from origami_nlp.numerics import CLOSES, SETTLED
from origami_nlp.springs.conic import POSITIVE, Rows
from origami_nlp.springs.equilibrium import Springs, energy_row, slope_row
from origami_nlp.springs.targets import Targets
from origami_nlp.springs.ways import curve_of

FALLS = 0.1
"""Slope that a cut asks for, over the margin."""
STEPS, FEW = 60, (9, 6)
"""Numbers of steps from a minimum that shall lead down: to a wanted state, or a few, fewer where that is too much."""
FIRST, GROWTH, STEP = 0.003, 1.8, 0.1
"""Length of the first step [rad], of each further one over the last, and of the longest: a minimum may stand in a
narrow basin, which longer steps would lead over."""
NEAR = 0.05
"""A curve passes a state where a sample comes this near [rad]."""


def cuts(targets: Targets, unwanted: np.ndarray) -> list[list[tuple[Rows, ...]]]:
    """Return rows each of which makes a state no minimum.

    With one freedom the energy falls at every sample from the state to the next wanted one (or to a singular state
    where curves meet); otherwise it falls along steps to a wanted one, or along a few steps in any direction.

    Parameters
    ----------
    targets
        The question.
    unwanted
        Fold angles of a minimum, shape [N].

    Returns
    -------
    list of list of tuple of Rows
        The choices there are, those first that leave least room for others like it.
    """
    model = targets.model
    places = Springs.of(int(targets.kinds.max()) + 1)
    kind = np.rint(model.reduce(targets.kinds.astype(float))).astype(int)
    x = model.reduce(unwanted)
    wanted = [p.state.x for p in targets.placed]
    words = "a minimum that nobody asked for is none"
    if model.freedom == 1 and (curve := curve_of(model, x)) is not None:
        out: list[tuple[Rows, ...]] = []
        i = int(np.abs(curve.states - x).max(axis=1).argmin())
        ends = ((curve.states[i:], curve.end), (curve.states[: i + 1][::-1], curve.start))
        for side, why in ends:
            rows = _falling(targets, side, why, wanted, kind, places)
            if rows is not None:
                out.append((Rows(POSITIVE, rows, np.zeros(len(rows)), words),))
        return [out]
    whole: list[tuple[Rows, ...]] = []
    few: list[list[tuple[Rows, ...]]] = [[] for _ in FEW]
    for walk, arrives in _downhill(targets, x, wanted):
        energies = [energy_row(model, y, kind, places) for y in walk]
        rows = np.array([a - b for a, b in itertools.pairwise(energies)])
        lengths = np.linalg.norm(model.root * np.diff(walk, axis=0), axis=1)
        rows[:, places.margin] -= FALLS * lengths
        if arrives:
            whole.append((Rows(POSITIVE, rows, np.zeros(len(rows)), words),))
        for some, count in zip(few, FEW, strict=True):
            part = rows[:count]
            some.append((Rows(POSITIVE, part, np.zeros(len(part)), words),))
    return [whole, *few]


def _falling(
    targets: Targets,
    side: np.ndarray,
    why: str,
    wanted: list[np.ndarray],
    kind: np.ndarray,
    places: Springs,
) -> np.ndarray | None:
    """Rows of the energy's fall from the first of some samples to a wanted state; None where there is none ahead."""
    model = targets.model
    rows: list[np.ndarray] = []
    for a, b in itertools.pairwise(side):
        step = b - a
        length = float(np.linalg.norm(model.root * step))
        if length < 1e-6:
            continue
        left = min(float(np.abs(b - w).max()) for w in wanted)
        row = energy_row(model, a, kind, places) - energy_row(model, b, kind, places)
        row[places.margin] -= FALLS * min(1.0, left) * length
        if left <= NEAR:
            return np.array(rows) if rows else None
        rows.append(row)
        corner = math.pi * np.round(b / math.pi)
        if np.abs(b - corner).max() <= NEAR and not State(model, corner).regular:
            # curves cross there: down to it, and up from it along this one
            back = b - corner
            back = back if np.abs(back).max() > SETTLED else a - corner
            back = back / float(np.linalg.norm(model.root * back))
            slope = slope_row(model, corner, back, kind, places)
            slope[places.margin] -= FALLS
            return np.array([*rows, slope])
    return np.array(rows) if rows and why.startswith("singular") else None


def _downhill(
    targets: Targets, x: np.ndarray, wanted: list[np.ndarray]
) -> Iterator[tuple[list[np.ndarray], bool]]:
    """Walks of admissible steps from a state, and whether they arrive: at wanted ones, or along its own directions."""
    model = targets.model
    z = State(model, x).kernel
    ways = [(w, STEPS) for w in wanted]
    ways += [(x + s * v / model.root, FEW[0]) for v in z.T for s in (1.0, -1.0)]
    for towards, most in ways:
        walk = _walk(targets, x, towards, most)
        if len(walk) > 1:
            yield walk, most == STEPS and _arrives(targets, walk, towards)
    flat = np.zeros(model.size)  # where both halves of the states meet
    first = _walk(targets, x, flat, STEPS)
    for w in wanted:
        second = _walk(targets, w, flat, STEPS)
        if _arrives(targets, first, flat) and _arrives(targets, second, flat):
            yield [*first, flat, *second[:0:-1]], True


def _walk(targets: Targets, x: np.ndarray, towards: np.ndarray, most: int) -> list[np.ndarray]:
    """Closed states from x towards another, as far as that comes nearer."""
    model = targets.model
    walk, step = [x], FIRST
    for _ in range(most):
        ahead = towards - walk[-1]
        size = float(np.linalg.norm(model.root * ahead))
        if size < 1.5 * step:
            break
        y, residual = project(model, walk[-1] + step / size * ahead)
        nearer = float(np.linalg.norm(model.root * (towards - y))) < size - step / 20
        if residual > CLOSES or model.refuses(y) or not (nearer or most == FEW[0]):
            break
        walk.append(y)
        step = min(GROWTH * step, STEP)
    return walk


def _arrives(targets: Targets, walk: list[np.ndarray], towards: np.ndarray) -> bool:
    return float(np.linalg.norm(targets.model.root * (towards - walk[-1]))) < 1.5 * STEP
