"""A lower admissible state next to a given one: what settles that it is no minimum, before any certificate is tried."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt.certificates import BranchJudgement
from origami_nlp.kkt.projection import project
from origami_nlp.kkt.second_order import generators, level_directions
from origami_nlp.kkt.state import State, Stratum
from origami_nlp.numerics import FOLLOWED, INDEPENDENT, LEVEL, ROUNDED, nearest_in_cone
from origami_nlp.programme import Contact

STEPS = (1e-5, 1e-4, 1e-3)
"""How far [rad] a direction is followed; shorter ones hide in the snapping of contacts."""
FAR = (1e-2, 1e-1)
"""Further steps where pieces hold more than the feasible set, so that a lower state alone refutes."""
DRAWN, DOWN = 8, 1e-3
"""Directions of descent that are drawn there, and their slope over the steepest one that closure allows."""
MOST_PASSED = 6
"""Rounds in which contacts that a step has passed are closed."""
BATCH, MOST_LEVEL = 8, 128
"""Directions that are followed together, and in all."""


@dataclass(frozen=True)
class Lower:
    """An admissible state that is lower: the unit direction towards it [n], its distance [rad], the energy gained."""

    direction: np.ndarray
    step: float
    gain: float

    @property
    def words(self) -> str:
        """What it shows."""
        return f"an admissible state {self.step:g} rad away is lower by {self.gain:.2e}"


def follow_descent(state: State, branch: BranchJudgement) -> Lower | None:
    """Step along the directions of descent of a piece that were found, and where pieces are too large along others."""
    exact = state.contacts.complete
    piece = state.on(branch.rows)
    for d in (branch.direction, *branch.more, *(() if exact else _aside(piece, branch))):
        if d is None or not np.abs(d).max() > 0:
            continue
        d = d / np.linalg.norm(d)
        still = np.zeros((1, len(d)), dtype=bool)
        for step in STEPS if exact else STEPS + FAR:
            lower = _follow(state, d[None], still, branch.held, step, () if exact else branch.rows)
            if lower is not None:
                return lower
    return None


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
    inward = inward * (size / max(float(np.linalg.norm(inward)), 1e-300))
    drawn = size * np.random.default_rng(0).normal(size=(DRAWN, len(c)))
    for aside in (0.3 * inward, inward, *drawn):
        y = nearest_in_cone(aside - c, rows)
        if c @ y < -DOWN * size * float(np.linalg.norm(y)):
            yield z @ y / state.programme.root


def follow_level(state: State) -> Lower | None:
    """Step along descent directions that closure leaves to second order, where it loses rank; contacts: fold limits.

    Other directions of the linearised cone are followed by no states there.  The states are examined as a whole, so
    that it does no harm to ask for fewer contacts than there are; to find and order them all costs more.
    """
    limits = state.limits
    if state.regular or not limits:
        return None
    root, z = state.programme.root, state.kernel
    up = z.T @ state.gradient
    rays = generators(np.vstack([state.on(limits).slopes @ z, -up]))
    if rays is None or not len(rays):
        return None
    y = level_directions(state.second_order[0], rays)
    slope = y @ up
    falls = slope < -INDEPENDENT * (1.0 + np.abs(up).max())
    first = np.argsort(slope[falls], kind="stable")[:MOST_LEVEL]
    d = y[falls][first] @ z.T / root
    d = d / np.linalg.norm(d, axis=1, keepdims=True)
    shut = [row.index for row in limits]
    still = np.zeros(d.shape, dtype=bool)
    still[:, shut] = np.abs(d[:, shut]) <= INDEPENDENT
    for step in STEPS:
        for k in range(0, len(d), BATCH):  # steepest first
            lower = _follow(state, d[k : k + BATCH], still[k : k + BATCH], (), step)
            if lower is not None:
                return lower
    return None


def _follow(
    state: State,
    directions: np.ndarray,
    still: np.ndarray,
    held: tuple[Contact, ...],
    step: float,
    kept: tuple[Contact, ...] = (),
) -> Lower | None:
    """Follow unit directions [k, n], with contacts held and fold angles `still` [k, n], to a lower state.

    Contacts `kept` that a step passes are closed.  Where the energy is level along a direction it may fall further on.
    """
    model, x = state.programme, state.x
    slope = directions @ state.local.gradient * model.scale
    y, residual = project(model, x + step * directions, held, frozen=still)
    for k in range(len(y)) if kept else ():
        y[k], residual[k] = _put_back(state, x + step * directions[k], y[k], residual[k], kept)
    change = np.array([model.energy_change(x, end) for end in y])
    good = (residual <= FOLLOWED) & (np.linalg.norm(y - x, axis=1) < 3 * step)
    noise = LEVEL * max(model.energy(x), model.scale)
    level = np.abs(slope) * step <= noise if kept else np.zeros(len(y), dtype=bool)
    good &= np.where(level, change < -noise, (change < 0.1 * step * slope) & (slope < 0))
    good[good] = model.admissible(y[good])
    for k in np.flatnonzero(good):
        if not model.refuses(y[k]):
            return Lower(directions[k], step, -float(change[k]))
    return None


def _put_back(
    state: State, start: np.ndarray, y: np.ndarray, residual: float, kept: tuple[Contact, ...]
) -> tuple[np.ndarray, float]:
    """Close contacts that a state y [n], the projection of `start`, has passed."""
    model = state.programme
    held: tuple[Contact, ...] = ()
    for _ in range(MOST_PASSED):
        openings = model.local(y).openings(kept)[0]
        beyond = (c for c in model.beyond(y, ROUNDED) if c not in kept)
        passed = [c for c, gap in zip(kept, openings, strict=True) if gap < -ROUNDED]
        passed = [c for c in (*passed, *beyond) if c not in held]
        if not passed:
            break
        held = (*held, *passed)
        y, residual = project(model, start, held)
    return y, residual
