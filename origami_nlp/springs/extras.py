"""Minima that nobody asked for, cut away: rows that make the energy fall from them."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from origami_nlp.kkt import State, project
from origami_nlp.numerics import CLOSES
from origami_nlp.springs.conic import POSITIVE, Rows
from origami_nlp.springs.equilibrium import Springs, energy_row
from origami_nlp.springs.targets import Targets
from origami_nlp.springs.ways import curve_of

FALLS = 0.1
"""Slope that a cut asks for, over the margin."""
STEPS, STEP = 3, 0.1
"""Number and length [rad] of the steps from a minimum that shall lead down."""
NEAR = 0.05
"""A curve passes a state where a sample comes this near [rad]."""


def cuts(targets: Targets, unwanted: np.ndarray) -> list[tuple[Rows, ...]]:
    """Return rows each of which makes a state no minimum.

    With one freedom the energy falls at every sample from the state to the next wanted one (or to a singular state
    where curves meet); otherwise it falls along a few steps towards a wanted one, or along a soft direction.

    Parameters
    ----------
    targets
        The question.
    unwanted
        Fold angles of a minimum, shape [N].

    Returns
    -------
    list of tuple of Rows
        The choices there are.
    """
    model = targets.model
    places = Springs.of(int(targets.kinds.max()) + 1)
    kind = np.rint(model.reduce(targets.kinds.astype(float))).astype(int)
    x = model.reduce(unwanted)
    wanted = [p.state.x for p in targets.placed]
    words = "a minimum that nobody asked for is none"
    if model.freedom == 1 and (curve := curve_of(model, x)) is not None:
        out = []
        i = int(np.abs(curve.states - x).max(axis=1).argmin())
        ends = ((curve.states[i:], curve.end), (curve.states[: i + 1][::-1], curve.start))
        for side, why in ends:
            rows = _falling(targets, side, why, wanted, kind, places)
            if rows is not None:
                out.append((Rows(POSITIVE, rows, np.zeros(len(rows)), words),))
        return out
    out = []
    for steps in _downhill(targets, x, wanted):
        energies = [energy_row(model, y, kind, places) for y in steps]
        rows = np.array([a - b for a, b in zip(energies, energies[1:], strict=False)])
        rows[:, places.margin] -= FALLS * STEP**2
        out.append((Rows(POSITIVE, rows, np.zeros(len(rows)), words),))
    return out


def _falling(
    targets: Targets,
    side: np.ndarray,
    why: str,
    wanted: list[np.ndarray],
    kind: np.ndarray,
    places: Springs,
) -> np.ndarray | None:
    """Rows of the energy's fall from the first of some samples to a wanted state; None where there is none ahead."""
    model, rows = targets.model, []
    for a, b in zip(side, side[1:], strict=False):
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
            return np.array(rows)  # curves cross there
    return np.array(rows) if rows and why.startswith("singular") else None


def _downhill(
    targets: Targets, x: np.ndarray, wanted: list[np.ndarray]
) -> Iterator[list[np.ndarray]]:
    """Walks of a few admissible steps from a state: towards wanted ones, and along its own directions."""
    model = targets.model
    z = State(model, x).kernel
    soft = [s * v / model.root for v in z.T for s in (1.0, -1.0)]
    for towards in [*wanted, *(x + 2.0 * d for d in soft)]:
        walk = [x]
        for _ in range(STEPS):
            ahead = towards - walk[-1]
            size = float(np.linalg.norm(model.root * ahead))
            if size < STEP:
                break
            y, residual = project(model, walk[-1] + STEP / size * ahead)
            if residual > CLOSES or model.refuses(y) or np.abs(y - walk[-1]).max() < STEP / 20:
                break
            walk.append(y)
        if len(walk) > 1:
            yield walk
