"""Times of the parts of this package's work on patterns, against their size."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from origami_nlp.kkt import smallest_curvature
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import EPS
from origami_nlp.pattern import Pattern, examples
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import descend, judge

T = TypeVar("T")
RESTS = {
    "miura:8x8": 1.2,
    "miura:16x16": 1.2,
    "miura:32x32": 1.2,
    "waterbomb:13x13": 0.4,
    "yoshimura:22x23": 0.2,
}
"""Patterns, and rest angles at which their facets do not cross; all stiffnesses are 1 [rad]."""
QUICK = ("miura:8x8",)
GUESS = 0.4
"""Fold angle of mountains and valleys of the first start, of its share at the others [rad]."""
STARTS = 3
"""Further states."""
REPEATS = 5
"""Of short parts."""
NUDGE = 1e-4
"""A polish begins this far off [rad]."""


@dataclass(frozen=True)
class PatternScale:
    """One size; processor seconds, medians.

    Attributes
    ----------
    name, facets, creases, rows
        The pattern; rows of closure.
    drawn
        From the name to the pattern: FOLD data written, read and checked.
    built
        The problem: closure, poses, test of crossings.
    first, another
        A state from its start, judged: with the problem built, and without.
    polish
        A descent from a state that is 1e-4 off.
    stability
        The smallest curvature along the sheet.
    crossings
        The test for facets that cross.
    pairs
        Of facets whose boxes overlap, which it looked at.
    verdict
        Of the state.
    closure, torque
        Its residuals: of closure, and torque without balance over the largest.
    """

    name: str
    facets: int
    creases: int
    rows: int
    drawn: float
    built: float
    first: float
    another: float
    polish: float
    stability: float
    crossings: float
    pairs: int
    verdict: str
    closure: float
    torque: float

    def cells(self) -> list[str]:
        """Return its row of a table."""
        seconds = self.drawn, self.built, self.first, self.another, self.polish, self.stability
        return [
            self.name,
            *(f"{k:,}" for k in (self.facets, self.creases, self.rows)),
            *(f"{s:.2g}" for s in (*seconds, self.crossings)),
            f"{self.pairs:,}",
            f"{self.closure:.0e}",
            f"{self.torque:.0e}",
        ]


def measure_scales(
    quick: bool = False, progress: Callable[[str], object] = lambda text: None
) -> list[PatternScale]:
    """Time every part of the work on patterns of growing size.

    Parameters
    ----------
    quick
        The smallest alone.
    progress
        Called with the name of each.

    Returns
    -------
    list of PatternScale
    """
    found = []
    for name in QUICK if quick else RESTS:
        progress(f"parts of the work: {name}")
        found.append(measure_scale(name))
    return found


def measure_scale(name: str) -> PatternScale:
    """Time every part of the work on one of `RESTS`."""
    kind, _, size = name.partition(":")
    rows, columns = map(int, size.split("x"))

    def draw() -> Pattern:
        return examples.pattern(kind, rows, columns).with_springs(1.0, RESTS[name])

    drawn, pattern = _timed(draw, 1)
    built, sheet = _timed(lambda: PatternProblem(pattern), 1)
    shares = np.random.default_rng(0).uniform(0.5, 1.5, STARTS)
    first, state = _timed(lambda: _state(sheet, GUESS), 1)
    others = [_timed(lambda s=share: _state(sheet, GUESS * s), 1)[0] for share in shares]  # type: ignore[misc]
    off, _ = sheet.project(state.phi + NUDGE * np.sign(pattern.signs))
    polish, _ = _timed(lambda: descend(sheet, off), REPEATS)
    lam, _, _ = sheet.multipliers(state.phi)
    hessian = sheet.hessian(state.phi, lam)
    # states that differ by rounding: what is kept of the last one is not to be timed
    near = (state.phi * (1.0 + k * EPS) for k in itertools.count(1))
    stability, _ = _timed(lambda: smallest_curvature(hessian, sheet.jacobian(next(near))), REPEATS)
    crossings, _ = _timed(lambda: sheet.crossings.find(next(near)), REPEATS)
    pairs = sheet.crossings.candidates(sheet.crossings.placed(state.phi))
    return PatternScale(
        name,
        pattern.facets,
        pattern.creases,
        sheet.closure.count,
        drawn,
        built,
        drawn + built + first,
        float(np.median(others)),
        polish,
        stability,
        crossings,
        len(pairs),
        state.verdict,
        state.closure_residual,
        state.kkt_residual if math.isfinite(state.kkt_residual) else math.inf,
    )


def _state(sheet: PatternProblem, guess: float) -> JudgedState:
    phi, _ = sheet.project(guess * sheet.pattern.signs)
    return judge(sheet, descend(sheet, phi).phi)


def _timed(work: Callable[[], T], repeats: int) -> tuple[float, T]:
    """Return the median of processor seconds, and what the work gave."""
    seconds = []
    for _ in range(repeats):
        begin = time.process_time()
        out = work()
        seconds.append(time.process_time() - begin)
    return float(np.median(seconds)), out
