"""A lower admissible state next to a given one: what settles that it is no minimum, before any certificate is tried."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt.certificates import BranchJudgement
from origami_nlp.kkt.projection import project
from origami_nlp.kkt.second_order import generators, level_directions
from origami_nlp.kkt.state import State
from origami_nlp.numerics import FOLLOWED, INDEPENDENT
from origami_nlp.programme import Contact

STEPS = (1e-5, 1e-4, 1e-3)
"""How far [rad] a direction is followed; shorter ones hide in the snapping of contacts."""
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
    """Step along the linearised descent direction of a piece, if it has one."""
    if branch.direction is None or not np.abs(branch.direction).max() > 0:
        return None
    d = branch.direction / np.linalg.norm(branch.direction)
    still = np.zeros((1, len(d)), dtype=bool)
    tries = (_follow(state, d[None], still, branch.held, step) for step in STEPS)
    return next(filter(None, tries), None)


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
) -> Lower | None:
    """Follow unit directions [k, n], with contacts held and fold angles `still` [k, n], to a lower state."""
    model, x = state.programme, state.x
    slope = directions @ state.local.gradient * model.scale
    y, residual = project(model, x + step * directions, held, frozen=still)
    change = np.array([model.energy_change(x, end) for end in y])
    good = (residual <= FOLLOWED) & (np.linalg.norm(y - x, axis=1) < 3 * step)
    good &= (change < 0.1 * step * slope) & (slope < 0)
    good[good] = model.admissible(y[good])
    for k in np.flatnonzero(good):
        if not model.refuses(y[k]):
            return Lower(directions[k], step, -float(change[k]))
    return None
