"""A lower admissible state next to a given one: what settles that it is no minimum, before any certificate is tried."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt.certificates import BranchJudgement
from origami_nlp.kkt.projection import project
from origami_nlp.kkt.second_order import extreme_rays, level_directions
from origami_nlp.kkt.state import State
from origami_nlp.numerics import FOLLOWED, INDEPENDENT
from origami_nlp.programme import Contact

STEPS = (1e-5, 1e-4, 1e-3)
"""How far [rad] a direction is followed; shorter ones hide in the snapping of contacts."""
BATCH, MOST_LEVEL, MOST_EXAMINED = 64, 192, 8
"""Directions that are followed together, in all, and states of a batch whose layers are ordered."""


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
    return _follow(state, d[None], np.zeros((1, len(d)), dtype=bool), branch.held)


def follow_level(state: State) -> Lower | None:
    """Step along descent directions that closure leaves to second order, where it loses rank; contacts: `base` alone.

    A direction of the linearised cone alone is followed by no states there.
    """
    if state.regular or not state.contacts.base:
        return None
    root, z = state.programme.root, state.kernel
    up = z.T @ state.gradient
    rays = extreme_rays(np.vstack([state.on(state.contacts.base).slopes @ z, -up]))
    if rays is None or not len(rays):
        return None
    directions = [level_directions(form, rays) for form in state.second_order[:1]]
    y = np.vstack([*directions, np.zeros((0, z.shape[1]))])
    slope = y @ up
    falls = slope < -INDEPENDENT * (1.0 + np.abs(up).max())
    first = np.argsort(slope[falls], kind="stable")[:MOST_LEVEL]
    d = y[falls][first] @ z.T / root
    d = d / np.linalg.norm(d, axis=1, keepdims=True)
    shut = [row.index for row in state.contacts.base if row.is_limit]
    still = np.zeros(d.shape, dtype=bool)
    still[:, shut] = np.abs(d[:, shut]) <= INDEPENDENT
    for k in range(0, len(d), BATCH):
        lower = _follow(state, d[k : k + BATCH], still[k : k + BATCH], ())
        if lower is not None:
            return lower
    return None


def _follow(
    state: State, directions: np.ndarray, still: np.ndarray, held: tuple[Contact, ...]
) -> Lower | None:
    """Follow unit directions [k, n], with contacts held and fold angles `still` [k, n], to a lower state."""
    model, x = state.programme, state.x
    slope = directions @ state.local.gradient * model.scale
    for step in STEPS:
        y, residual = project(model, x + step * directions, held, frozen=still)
        change = np.array([model.energy_change(x, end) for end in y])
        good = (residual <= FOLLOWED) & (np.linalg.norm(y - x, axis=1) < 3 * step)
        good &= (change < 0.1 * step * slope) & (slope < 0)
        good[good] = model.admissible(y[good])
        for k in np.flatnonzero(good)[:MOST_EXAMINED]:
            if not model.refuses(y[k]):
                return Lower(directions[k], step, -float(change[k]))
    return None
