"""A lower admissible state next to a given one: what settles that it is no minimum, before any certificate is tried."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt.certificates import BranchJudgement
from origami_nlp.kkt.neighbourhood import GOES
from origami_nlp.kkt.projection import project
from origami_nlp.kkt.second_order import generators, level_directions
from origami_nlp.kkt.state import State, Stratum
from origami_nlp.numerics import (
    FOLLOWED,
    HELD,
    INDEPENDENT,
    LEVEL,
    NONZERO,
    RANK,
    ROUNDED,
    coarse,
    left_out,
    nearest_in_cone,
)
from origami_nlp.problem import Contact

STEPS = (1e-5, 1e-4, 1e-3)
"""How far [rad] a direction is followed; what is lower at short ones must be admissible at `SHOWN` as well."""
BENDS = 0.3
"""Share of a distance by which a way bends at most, as far as `FAR` goes."""
KANTOROVICH = 10.0
"""Times the residual, less than the square of the smallest singular value: 2 times a bound of second derivatives."""
SHOWN = 1e-3
"""Step [rad] at which facets that cross do so by `DEEP`, to third order; beside the state they seem to touch only."""
FAR = (SHOWN, 1e-2, 1e-1)
"""Steps where pieces hold more than the feasible set, so that a lower state alone refutes: descents go on there."""
DRAWN, DOWN = 8, 1e-3
"""Directions of descent that are drawn there, and their slope over the steepest one that closure allows."""
MOST_PASSED, MOST_STEPS = 6, 6
"""Rounds in which contacts that a step has passed are closed, and steps of each projection: Newton needs five."""
STALLS = 0.5
"""Share of a residual that Newton leaves at most: a quarter beside a singular state, next to nothing elsewhere."""
DOWNHILL = (2.5e-4, 5e-4, 1e-3)
"""Steps [rad] along a line that first order leaves level: each is lower than the one before, beyond rounding."""
BATCH, MOST_LEVEL = 8, 128
"""Directions that are followed together, and in all."""


@dataclass(frozen=True)
class DescentWitness:
    """A lower admissible state [n]: the unit direction towards it [n], its distance [rad], the energy gained."""

    direction: np.ndarray
    step: float
    gain: float
    state: np.ndarray

    @property
    def words(self) -> str:
        """What it shows."""
        return f"an admissible state {self.step:g} rad away is lower by {self.gain:.2e}"


def follow_descent(
    state: State, branch: BranchJudgement, open_along: Callable[[np.ndarray], bool] = lambda d: True
) -> DescentWitness | None:
    """Step along the directions of descent of a piece that were found, and where pieces are too large along others.

    Of these only those are tried along which states are open as far as is known.
    """
    exact = state.contacts.complete
    aside = () if exact else filter(open_along, _aside(state.on(branch.rows), branch))
    for d in (branch.direction, *branch.more, *aside):
        if d is None or not np.abs(d).max() > 0:
            continue
        d = d / np.linalg.norm(d)
        if not exact:
            lower = _lower_along(state, d, branch)
        else:
            still = np.zeros((1, len(d)), dtype=bool)
            tries = (_follow(state, d[None], still, branch.held, step) for step in STEPS)
            lower = next(filter(None, tries), None)
        if lower is not None:
            return lower
    return None


def _lower_along(state: State, d: np.ndarray, branch: BranchJudgement) -> DescentWitness | None:
    """Go along a unit direction [n] until facets cross; contacts of the piece that a step passes are closed."""
    model, x = state.problem, state.x
    noise = LEVEL * max(abs(model.energy(x)), model.scale)
    for step in FAR:
        model.check_time()
        try:
            y, residual = _put_back(state, x + step * d, branch)
        except ArithmeticError:
            return None  # sides of facets that run along each other have no gap
        if FOLLOWED < residual <= HELD:
            # contacts that bend are not all closed: whether facets cross decides
            y, left = project(model, y)
            residual = float(left)
        if residual > FOLLOWED:
            return None  # what cannot be closed together misses by more further out
        if not 0.1 * step < np.linalg.norm(y - x) < 3 * step:
            continue
        if model.refuses(y):
            return None  # what lies further that way would be reached through facets
        change = model.energy_change(x, y)
        if change < -noise:
            return DescentWitness(d, step, -change, y) if _closes(state, y) else None
    return None


def _closes(state: State, y: np.ndarray, still: np.ndarray | None = None) -> bool:
    """Return whether a state beside a singular one closes, and not only to rounding; `still` [n] does not move.

    It does where Newton's method converges from there, by its residual and slopes (Kantorovich's theorem).  Where rows
    of closure depend on each other, or miss that by next to nothing, the way is to close further out as well: what
    angles miss a relation by, times the square of the distance, is lost in rounding near the state.
    """
    model, x = state.problem, state.x
    if state.regular:
        return True
    free = np.full(len(x), True) if still is None else ~still
    f, jac = model.constraints(y, ())
    values = np.linalg.svd(jac / model.root * free, compute_uv=False)
    least = values[-1] if len(values) == len(jac) and values[-1] > RANK else 0.0
    if KANTOROVICH * max(float(np.linalg.norm(f)), ROUNDED) <= least**2:
        return True
    for step in FAR:
        model.check_time()
        start = x + step * (y - x) / np.linalg.norm(y - x)
        y, residual = project(model, start, frozen=still)
        if not (residual <= FOLLOWED and np.linalg.norm(y - start) < BENDS * step):
            return False
    f, jac = model.constraints(y, ())
    return left_out(jac / model.root * free, f) < BENDS * step


def _put_back(state: State, start: np.ndarray, branch: BranchJudgement) -> tuple[np.ndarray, float]:
    """Project a state [n] with what the piece holds, and the contacts that it passes then: where, and the residual."""
    model, held = state.problem, branch.held
    y, residual = project(model, start, held, steps=MOST_STEPS, stalls=STALLS)
    for _ in range(MOST_PASSED):
        openings = model.local(y).openings(branch.rows)[0]
        passed = [c for c, gap in zip(branch.rows, openings, strict=True) if gap < -ROUNDED]
        passed = [c for c in (*passed, *model.beyond(y, ROUNDED)) if c not in held]
        if not passed or residual > FOLLOWED:
            break
        held = tuple(dict.fromkeys((*held, *passed)))
        y, residual = project(model, start, held, steps=MOST_STEPS, stalls=STALLS)
    return y, float(residual)


def _aside(piece: Stratum, branch: BranchJudgement) -> Iterator[np.ndarray]:
    """Go through more directions of descent [n] that contacts leave open, inward first, then any.

    Along the steepest one contacts stay closed that bend, or closure that loses rank is not kept to second order.
    """
    if branch.direction is None:
        return
    state, z = piece.state, piece.state.kernel
    c, rows = z.T @ state.gradient, piece.slopes @ z
    size = float(np.linalg.norm(c))
    inward = rows.sum(axis=0)
    inward = inward * (size / max(float(np.linalg.norm(inward)), NONZERO))
    drawn = size * np.random.default_rng(0).normal(size=(DRAWN, len(c)))
    for aside in (0.3 * inward, inward, *drawn):
        y = nearest_in_cone(aside - c, rows)
        if c @ y < -DOWN * size * float(np.linalg.norm(y)):
            yield z @ y / state.problem.root


def follow_level(state: State) -> DescentWitness | None:
    """Step along descent directions that closure leaves to second order, where it loses rank; contacts: fold limits.

    Other directions of the linearised cone are followed by no states there.  The states are examined as a whole, so
    that it does no harm to ask for fewer contacts than there are; to find and order them all costs more.
    """
    limits = state.limits
    if state.regular or not limits:
        return None
    root, z = state.problem.root, state.kernel
    up = z.T @ state.gradient
    rays = generators(np.vstack([state.on(limits).slopes @ z, -up]))
    if rays is None or not len(rays):
        return None
    # of several forms one is enough: what the others forbid does not close, and is dropped when it is followed
    y = level_directions(state.second_order[0], rays)
    slope = y @ up
    falls = slope < -INDEPENDENT * (1.0 + np.abs(up).max())
    first = np.argsort(slope[falls], kind="stable")[:MOST_LEVEL]
    d = y[falls][first] @ z.T / root
    d = d / np.linalg.norm(d, axis=1, keepdims=True)
    at_limit = [row.index for row in limits]
    still = np.zeros(d.shape, dtype=bool)
    still[:, at_limit] = np.abs(d[:, at_limit]) <= INDEPENDENT
    for step in STEPS:
        for k in range(0, len(d), BATCH):  # steepest first
            lower = _follow(state, d[k : k + BATCH], still[k : k + BATCH], (), step)
            if lower is not None:
                return lower
    return None


def follow_lines(state: State) -> DescentWitness | None:
    """Step along the lines of the tangent cone, where closure loses rank, as far as each step goes down.

    What contacts leave open is not asked: all states of a way down are admissible, or it shows nothing.
    """
    if state.regular:
        return None
    model, x = state.problem, state.x
    size = max(abs(state.energy), model.scale)
    steep = model.scale * float(np.linalg.norm(state.gradient))
    at_limit = np.zeros(len(x), dtype=bool)
    at_limit[[row.index for row in state.limits]] = True
    lines = [d / model.root for d in state.tangent_cone.open(x, model.fold_limits)]
    # in an order that rounding does not change: the first that leads down is reported
    for d in sorted((d / np.linalg.norm(d) for d in lines), key=lambda d: (-coarse(d)).tolist()):
        before = 0.0
        for step in DOWNHILL:
            model.check_time()
            still = at_limit & (np.abs(d) <= INDEPENDENT)
            y, residual = project(model, x + step * d, frozen=still)
            change = model.energy_change(x, y)
            # at this distance closure changes by step^2 at least: what is left of it moves y by so much over step
            noise = LEVEL * size + steep * max(float(residual), ROUNDED) / step
            near = GOES[0] * step < np.linalg.norm(y - x) < GOES[1] * step
            if not (residual <= FOLLOWED and near and change < before - noise) or model.refuses(y):
                break
            before = change
        else:
            if _closes(state, y, still):
                return DescentWitness(d, step, -change, y)
    return None


def _follow(
    state: State, directions: np.ndarray, still: np.ndarray, held: tuple[Contact, ...], step: float
) -> DescentWitness | None:
    """Follow unit directions [k, n], with contacts held and fold angles `still` [k, n], to a lower state."""
    model, x = state.problem, state.x
    slope = directions @ state.local.gradient * model.scale
    y, residual = project(model, x + step * directions, held, frozen=still)
    change = np.array([model.energy_change(x, end) for end in y])
    good = (residual <= FOLLOWED) & (np.linalg.norm(y - x, axis=1) < 3 * step)
    # a tenth of the decrease to first order: less may be what the projection changed
    good &= (change < 0.1 * step * slope) & (slope < 0)
    good[good] = model.admissible(y[good])
    for k in np.flatnonzero(good):
        if model.refuses(y[k]) or not _shows(state, directions[k], still[k], held, step):
            continue
        if _closes(state, y[k], still[k]):
            return DescentWitness(directions[k], step, -float(change[k]), y[k])
    return None


def _shows(
    state: State, d: np.ndarray, still: np.ndarray, held: tuple[Contact, ...], step: float
) -> bool:
    """Return whether a unit direction [n] is admissible as far as facets that cross would show, see `_follow`."""
    if step >= SHOWN:
        return True
    y, residual = project(state.problem, state.x + SHOWN * d, held, frozen=still)
    near = np.linalg.norm(y - state.x) < 3 * SHOWN
    return bool(residual <= FOLLOWED and near) and not state.problem.refuses(y)
