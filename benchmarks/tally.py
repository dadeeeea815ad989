"""Numbers of one method on one problem, from its single attempts: what it found, how exactly, how fast."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.judging import Outcome
from origami_nlp.starts import EFFORTS

FEWEST_STARTS = 128
"""Starts before a method is taken to have found what it can."""
LEVELS = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
"""Errors of fold angles [rad] at which methods are compared."""
NOT_RUN, FAILED, FALSE = -4, -2, -1
ERRORS = ("angle", "energy", "multiplier", "eigenvalue")


@dataclass
class Attempts:
    """Every attempt of one method on one problem, [rounds, starts].

    seconds: of each, NaN where it did not run.  minimum: position of the minimum it reached, `FALSE`, `FAILED` or
    `NOT_RUN`.  errors: of those that reached one, [4, rounds, starts] in the order of `ERRORS`.
    false: distinct false states and what they are.
    """

    rounds: int
    starts: int
    seconds: np.ndarray = field(init=False)
    minimum: np.ndarray = field(init=False)
    errors: np.ndarray = field(init=False)
    iterations: list[int] = field(default_factory=list)
    false: dict[int, str] = field(default_factory=dict)
    reasons: Counter[str] = field(default_factory=Counter)
    building: float = 0.0

    def __post_init__(self) -> None:
        shape = (self.rounds, self.starts)
        self.seconds = np.full(shape, math.nan)
        self.minimum = np.full(shape, NOT_RUN)
        self.errors = np.full((len(ERRORS), *shape), math.nan)

    def record(self, r: int, s: int, seconds: float, outcome: Outcome | None) -> None:
        """Enter one attempt; no outcome means that the method claimed nothing."""
        self.seconds[r, s] = seconds
        self.minimum[r, s] = FAILED if outcome is None else outcome.minimum
        if outcome is None:
            return
        if outcome.minimum < 0:
            self.reasons[outcome.reason] += 1
        self.errors[:, r, s] = [getattr(outcome, name) for name in ERRORS]

    def found(self, r: int, starts: np.ndarray, level: float) -> int:
        """Return how many distinct minima these starts of a round reached to `level`."""
        good = (self.minimum[r] >= 0) & starts & (self.errors[0, r] <= level)
        return len(set(self.minimum[r][good].tolist()))


def ratios(method: Attempts, ours: Attempts, level: float) -> list[float]:
    """Return, for each round, seconds per minimum correct to `level`: method over ours, on the same starts.

    Infinite where only ours reached any; NaN where neither did.
    """
    out = []
    for r in range(ours.rounds):
        both = np.isfinite(method.seconds[r]) & np.isfinite(ours.seconds[r])
        theirs, mine = method.found(r, both, level), ours.found(r, both, level)
        if not both.any() or not (theirs or mine):
            out.append(math.nan)
        elif not theirs:
            out.append(math.inf)
        elif not mine:
            out.append(0.0)
        else:
            a = method.seconds[r][both].sum() / theirs
            out.append(float(a / (ours.seconds[r][both].sum() / mine)))
    return out


def until_the_rule(attempts: Attempts, fewest: int) -> dict[str, Any]:
    """Return what a search finds that stops when every minimum was reached often enough (as the package's does), starts
    of all rounds one after the other."""
    seconds, minimum = attempts.seconds.ravel(), attempts.minimum.ravel()
    done = np.isfinite(seconds)
    seconds, minimum = seconds[done], minimum[done]
    stop, stopped = len(seconds), False
    for k in range(1, len(seconds) + 1):
        reached = minimum[:k][minimum[:k] >= 0]
        often = np.unique(reached, return_counts=True)[1]
        if k >= fewest and len(often) and often.min() >= EFFORTS["normal"].hits:
            stop, stopped = k, True
            break
    errors = attempts.errors[0].ravel()[done][:stop]
    best: dict[int, float] = {}
    for index, error in zip(minimum[:stop].tolist(), errors.tolist(), strict=True):
        if index >= 0:
            best[index] = min(best.get(index, math.inf), error if math.isfinite(error) else 1.0)
    return {
        "starts": stop,
        "stopped": stopped,
        "seconds": float(seconds[:stop].sum()),
        "found": {str(k): v for k, v in sorted(best.items())},
    }


def summary(attempts: Attempts, ours: Attempts, fewest: int) -> dict[str, Any]:
    """Return the numbers of one cell of the tables, ready for JSON (infinite ratios are null)."""
    ran = np.isfinite(attempts.seconds)
    hit = attempts.minimum >= 0
    return {
        "starts": int(ran.sum()),
        "correct": int(hit.sum()),
        "failed": int((attempts.minimum == FAILED).sum()),
        "false": int((attempts.minimum == FALSE).sum()),
        "false_states": len(attempts.false),
        "false_reasons": dict(attempts.reasons.most_common()),
        "seconds_per_start": [
            float(np.mean(row[np.isfinite(row)])) if np.isfinite(row).any() else None
            for row in attempts.seconds
        ],
        "building": attempts.building,
        "iterations": float(np.median(attempts.iterations)) if attempts.iterations else 0.0,
        "errors": {
            name: quantiles(attempts.errors[k][hit]) for k, name in enumerate(ERRORS) if hit.any()
        },
        "until_the_rule": until_the_rule(attempts, fewest),
        "ratios": {f"{level:.0e}": _json(ratios(attempts, ours, level)) for level in LEVELS},
    }


def quantiles(values: Sequence[float] | np.ndarray) -> list[float] | None:
    """Return quartiles, median and largest of the finite values: [q25, q50, q75, max]."""
    v = np.asarray(values, dtype=float)
    v = v[np.isfinite(v)]
    if not len(v):
        return None
    return [float(q) for q in (*np.percentile(v, [25, 50, 75]), v.max())]


def _json(values: list[float]) -> list[float | str | None]:
    """NaN (nothing to compare) to null, infinity to "inf"."""
    return ["inf" if math.isinf(v) else None if math.isnan(v) else v for v in values]
