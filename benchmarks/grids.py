"""The grid method of the published code: points lower than their eight neighbours, excluded ones ignored.

The grid is that of `chart.landscape`: closed forms, vectorised, admissibility included; only points that the published
code would report are looked at.  A grid minimum counts for an exact one within one and a half cells of the chart;
the closest in fold angles is its best answer, others near it are duplicates, and the rest are false.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.judging import Judge
from benchmarks.problems import Problem
from benchmarks.tally import quantiles
from origami_nlp.chart import landscape
from studies import chart_distance, grid_points

SIZES = (65, 129, 257, 513, 1025)
CELLS = 1.5
"""A grid minimum this many cells from an exact one, in the chart, belongs to it."""


def run_grid(problem: Problem, judge: Judge, size: int, rounds: int) -> dict[str, Any] | None:
    """Run the grid method on one problem at one size; None where the scene has no two-dimensional chart."""
    seconds = []
    for _ in range(rounds):
        begin = time.process_time()
        chart = landscape(problem.scene, size)
        if chart.kind != "area":
            return None
        found = grid_points(chart)
        seconds.append(time.process_time() - begin)
    states = [chart.branches[b].fold_angles[r, c] for b, r, c, _ in found]
    axes = chart.branches[0].axes
    step = float(max(a[1] - a[0] for a in axes))
    return {
        "problem": problem.name,
        "size": size,
        "seconds": seconds,
        **judge_grid(judge, states, step, chart_distance),
    }


def judge_grid(
    judge: Judge, states: list[np.ndarray], step: float, distance: Callable[..., float]
) -> dict[str, Any]:
    """Return which exact minima the grid minima are; `distance(model, x, y)` is that of the chart."""
    model = judge.model
    best: dict[int, float] = {}
    duplicates = false = 0
    for phi in states:
        x = model.reduce(phi)
        gaps = [distance(model, x, k.x) for k in judge.known]
        near = [i for i, gap in enumerate(gaps) if gap <= CELLS * step]
        if not near:
            false += 1
            continue
        errors = {i: float(np.abs(x - judge.known[i].x).max()) for i in near}
        i = min(errors, key=errors.__getitem__)
        duplicates += i in best
        best[i] = min(best.get(i, np.inf), errors[i])
    return {
        "reported": len(states),
        "found": {str(k): v for k, v in sorted(best.items())},
        "duplicates": duplicates,
        "false": false,
        "missed": len(judge.known) - len(best),
        "error": quantiles(list(best.values())),
    }
