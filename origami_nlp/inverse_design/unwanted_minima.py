"""Minima that nobody asked for, cut away: rows that make the energy fall from them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from origami_nlp.inverse_design.equilibrium import Balance, SpringRows
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.inverse_design.transition_paths import curve_of, outward
from origami_nlp.kkt import State, project
from origami_nlp.numerics import CLOSURE_TOL, EQUAL, POSITIVE, RANK, SAMPLED, SETTLED, ConeRows
from origami_nlp.problem import Model

FALLS = 0.1
"""Slope that a cut asks for, over the margin and the way that is left (at most 1 rad): a tenth of the slope in a well
of that stiffness, which therefore fulfils it down to its bottom."""
STEPS, FEW = 60, (9, 6)
"""Numbers of steps from a minimum that shall lead down: to a wanted state, or a few, fewer where that is too much."""
FIRST, GROWTH, STEP = 0.003, 1.8, 0.1
"""Length of the first step [rad], of each further one over the last, and of the longest: a minimum may stand in a
narrow basin, which longer steps would lead over."""
SHORT = 1e-3
"""Steps that are shorter [rad] say nothing of a fall: they are rounding of the one before."""
WORDS = "an unwanted minimum ceases to be one"


def cuts(targets: Targets, unwanted: np.ndarray) -> list[list[tuple[ConeRows, ...]]]:
    """Return rows each of which makes a state no minimum.

    With one degree of freedom the energy falls at every sample from the state to the next wanted one (or to a singular
    state where curves meet); otherwise it falls along steps to a wanted one, or along a few steps in any direction.

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
    springs = SpringRows(model, targets.kinds)
    x = model.reduce(unwanted)
    wanted = [p.state.x for p in targets.placed]
    if model.dof == 1 and (curve := curve_of(model, x)) is not None:
        i = int(np.abs(curve.states - x).max(axis=1).argmin())
        ends = ((curve.states[i:], curve.end), (curve.states[: i + 1][::-1], curve.start))
        every = (_falling(springs, side, why, wanted) for side, why in ends)
        return [[falls for falls in every if falls is not None]]
    whole: list[tuple[ConeRows, ...]] = []
    few: list[list[tuple[ConeRows, ...]]] = [[] for _ in FEW]
    for walk, arrives in _downhill(targets, x, wanted):
        energies = [springs.energy(y) for y in walk]
        # energies of states are linear in k and tau: "the energy falls at every step" is a set of linear rows
        rows = np.array([a - b for a, b in itertools.pairwise(energies)])
        lengths = np.linalg.norm(model.root * np.diff(walk, axis=0), axis=1)
        rows[:, springs.places.margin] -= FALLS * lengths
        if arrives:
            whole.append((ConeRows.of(POSITIVE, rows, WORDS),))
        for some, count in zip(few, FEW, strict=True):
            some.append((ConeRows.of(POSITIVE, rows[:count], WORDS),))
    return [whole, *few]


def _falling(
    springs: SpringRows, side: np.ndarray, why: str, wanted: list[np.ndarray]
) -> tuple[ConeRows, ...] | None:
    """Rows of the energy's fall from the first of some samples to a wanted state; None where there is none ahead.

    It falls in proportion to the way that is left: wells and level crossings are level at their bottom.
    """
    model = springs.model
    goal, last, corner = side[-1], len(side) - 1, None
    for k, b in enumerate(side[1:], start=1):
        near = min(wanted, key=lambda w: float(np.abs(b - w).max()))
        if np.abs(b - near).max() <= SAMPLED:
            goal, last = near, k - 1
            break
        other = math.pi * np.round(b / math.pi)
        if np.abs(b - other).max() <= SAMPLED and not State(model, other).regular:
            goal, last, corner = other, k, other  # curves cross there
            break
    else:
        if not why.startswith("singular"):
            return None
    rows: list[np.ndarray] = []
    for a, b in itertools.pairwise(side[: last + 1]):
        length = float(np.linalg.norm(model.root * (b - a)))
        if length >= SHORT:
            row = springs.energy(a) - springs.energy(b)
            row[springs.places.margin] -= FALLS * min(1.0, float(np.abs(b - goal).max())) * length
            rows.append(row)
    out = [ConeRows.of(POSITIVE, rows, WORDS)] if rows else []
    if corner is not None:
        back = side[last] if np.abs(side[last] - corner).max() > SETTLED else side[last - 1]
        out += _across(springs, corner, back - corner, wanted)
    return tuple(out) or None


def _across(
    springs: SpringRows, corner: np.ndarray, back: np.ndarray, wanted: list[np.ndarray]
) -> list[ConeRows]:
    """Rows at a state where two curves cross, for energy that is to fall to it along one arm, `back` from it.

    Where a wanted state lies on the other arm of the same curve, the energy falls on.  Where one lies on the other
    curve it falls along that one and is level along this one: a slope towards one arm leaves a minimum in it,
    and none rises towards both.
    """
    model = springs.model
    step = back / float(np.linalg.norm(model.root * back))
    tangents = _crossing(model, corner, springs.kind)
    along = [abs(float(np.sum(model.root**2 * v * step))) for v in tangents]
    ahead: list[float] = []
    if tangents:
        own = int(np.argmax(along))
        forward = float(np.sum(model.root**2 * tangents[own] * step))
        step = math.copysign(1.0, forward) * tangents[own]
        other = tangents[1 - own]
        for w in wanted:
            for arm in outward(curve_of(model, w), w):
                way = arm[-1] - corner if len(arm) > 1 else np.zeros_like(corner)
                size = float(np.linalg.norm(model.root * way))
                if not SETTLED < size <= 2 * SAMPLED * math.sqrt(len(way)):
                    way = arm[-2] - corner
                    size = float(np.linalg.norm(model.root * way))
                if not SETTLED < size <= 4 * SAMPLED * math.sqrt(len(way)):
                    continue
                cosines = [float(np.sum(model.root**2 * v * way)) / size for v in (step, other)]
                if abs(cosines[1]) > abs(cosines[0]):
                    ahead.append(math.copysign(1.0, cosines[1]))
                # 0: wanted beyond the crossing on the same curve
                elif cosines[0] < 0:
                    ahead.append(0.0)
    slope = springs.slope(corner, step)
    if not ahead or 0.0 in ahead:
        slope[springs.places.margin] -= FALLS
        return [ConeRows.of(POSITIVE, slope, WORDS)]
    out = [ConeRows.of(EQUAL, slope, f"{WORDS}: level across")]
    if len(set(ahead)) == 1:
        fall = -ahead[0] * springs.slope(corner, other)
        fall[springs.places.margin] -= FALLS
        out.append(ConeRows.of(POSITIVE, fall, WORDS))
    return out


def _crossing(model: Model, corner: np.ndarray, kind: np.ndarray) -> list[np.ndarray]:
    """Return unit tangents [n] of the two curves that cross at a singular state; none where it is not like that.

    One equation is lost; along the kernel of the others its curvature C is indefinite: v C v = 0 on two lines.
    """
    at = Balance(State(model, corner).on(()), kind)
    if at.lost.shape[1] != 1 or at.kernel.shape[1] != 2:
        return []
    values, vectors = at.lost_modes
    if not values[0] < -RANK or not values[1] > RANK:
        return []
    # v = sqrt(l_2) e_1 +- sqrt(-l_1) e_2: v C v = l_2 l_1 - l_1 l_2 = 0
    first, second = math.sqrt(values[1]) * vectors[:, 0], math.sqrt(-values[0]) * vectors[:, 1]
    ways = [at.kernel @ (first + s * second) for s in (1.0, -1.0)]
    return [v / float(np.linalg.norm(v)) / model.root for v in ways]


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
        if residual > CLOSURE_TOL or model.refuses(y) or not (nearer or most == FEW[0]):
            break
        walk.append(y)
        step = min(GROWTH * step, STEP)
    return walk


def _arrives(targets: Targets, walk: list[np.ndarray], towards: np.ndarray) -> bool:
    return float(np.linalg.norm(targets.model.root * (towards - walk[-1]))) < 1.5 * STEP
