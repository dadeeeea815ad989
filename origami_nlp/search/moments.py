"""Starts from moment vectors: Newton in three unknowns, whatever the number of creases, for thousands of moments.

Stationary states of all strata are zeros of `MomentMap`, which is smooth but for corners where creases reach
their limits (Newton is semismooth there: L. Qi and J. Sun, Math. Programming 58, 1993).  Moments are drawn with random
directions and lengths uniform in their logarithm, from what turns all creases together a little to what shuts the
stiffest: low states have short moments, states with many creases fully folded long ones.  Newton is damped until the
miss falls.  Where it finds no zero, the folds of its last moment are near balance on their stratum; closed there they
are a start.
"""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, DECREASE, NONZERO, OUTSIDE
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search.descend import StartState
from origami_nlp.search.moment_map import MomentMap
from origami_nlp.search.starts import StartKind

STEPS = 30
"""Steps of Newton; most of those that converge do so in ten."""
SHORTEST_SHARE = 1e-3
"""Share of Newton's step below which a moment is given up."""
FEWER, MORE = 0.3, 3.0
"""By how much the share changes after a step that was not taken, and after one that was."""
SPREAD = (0.3, 10.0)
"""Moments are drawn from this times the smallest to this times the largest that matters."""


TOGETHER = 64
"""Moments that Newton goes on from at once: a step of so many takes hardly longer than of one."""
FEWEST_CREASES = 16
"""Creases from which moments are started from: with 10 and 12 they found no more in the same time."""


def is_chain(problem: PatternProblem) -> bool:
    """Return whether a problem is a long vertex without symmetry at which fold limits are all that can touch."""
    pattern = problem.pattern
    alone = len(pattern.vertices) == 1 and not (pattern.holes or pattern.cell or problem.contact)
    long = pattern.creases == len(pattern.vertices[0].creases) >= FEWEST_CREASES if alone else False
    return long and problem.orbits is None and problem.parameters.dead is None


class Moments(StartKind):
    """States near stationary ones, from random moments; of a problem that `is_chain`."""

    name = "moments"
    sentence = "where creases balance a random moment"
    cost = 40

    def __init__(self, problem: PatternProblem) -> None:
        super().__init__(problem)
        self.map, self._ready = MomentMap(problem, problem.labels), list[StartState]()

    def moments(self, rng: np.random.Generator, many: int) -> np.ndarray:
        """Draw moments over the problem's scale, shape [many, 3]."""
        u = rng.normal(size=(many, 3))
        low, high = SPREAD[0] * self.map.smallest, SPREAD[1] * self.map.largest
        length = np.exp(rng.uniform(math.log(low), math.log(high), (many, 1)))
        return np.asarray(u * (length / np.linalg.norm(u, axis=1, keepdims=True)))

    def draw(self, rng: np.random.Generator, count: int) -> list[StartState]:
        """Return states from as many moments, the creases held that are at their limits."""
        if len(self._ready) < count:
            m, _ = find_zeros(self.map, self.moments(rng, TOGETHER))
            x = np.empty((len(m), self.problem.size))
            x[:, self.map.order] = self.map.sign * self.map.shoot(m, slope=False).x
            sides = self.problem.fold_limits.near(x, OUTSIDE)
            self._ready += [StartState(*pair, drawn=True) for pair in zip(x, sides, strict=True)]
        drawn, self._ready = self._ready[:count], self._ready[count:]
        return drawn


def find_zeros(chain: MomentMap, m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Run damped Newton from moments [K, 3]; returns where it ended [K, 3], and how far each misses [K] [rad]."""
    m, shot = m.copy(), chain.shoot(m)
    assert shot.slope is not None
    vector, slope = shot.miss, shot.slope
    miss, share = np.linalg.norm(vector, axis=1), np.ones(len(m))
    for _ in range(STEPS):
        live = np.flatnonzero((miss > CLOSURE_TOL) & (share > SHORTEST_SHARE))
        if not len(live):
            break
        step = -_solved(slope[live], vector[live])
        # no step may be longer than the moment, or than what turns everything by one radian
        longest = np.maximum(np.linalg.norm(m[live], axis=1), chain.smallest)
        length = np.maximum(np.linalg.norm(step, axis=1), NONZERO)
        part = np.minimum(share[live], longest / length)
        new = m[live] + part[:, None] * step
        shot = chain.shoot(new)
        assert shot.slope is not None
        now = np.linalg.norm(shot.miss, axis=1)
        # sufficient decrease of |miss|, in proportion to the share of the step
        good = now < miss[live] * (1 - DECREASE * part)
        share[live] = np.where(good, np.minimum(1.0, MORE * share[live]), FEWER * part)
        taken = live[good]
        m[taken], miss[taken] = new[good], now[good]
        vector[taken], slope[taken] = shot.miss[good], shot.slope[good]
    return m, miss


def _solved(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a^-1 b of matrices [K, 3, 3] and vectors [K, 3] by cofactors; not finite where a is singular."""
    # Cramer's rule: columns of the adjugate are cross products of two rows
    rows = [np.cross(a[:, i - 2], a[:, i - 1]) for i in range(3)]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        determinant = (a[:, 0] * rows[0]).sum(axis=1, keepdims=True)
        x = sum(row * b[:, i : i + 1] for i, row in enumerate(rows)) / determinant
    return np.where(np.isfinite(x).all(axis=1, keepdims=True), x, 0.0)
