"""Closed states with one or two creases at their fold limits: beside sets that exist only while these stay closed.

A solver that needs an interior rarely ends on such a thin set (the paper's 1-handles), so they are looked for on
purpose; `kkt.thin_at` tells which they are.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import CLOSES, OUTSIDE
from origami_nlp.programme import Programme
from origami_nlp.starts.projected import BATCH

MOST_BATCHES = 4
SAMPLES_ON_A_LIMIT = 8


def states_on_limits(model: Programme, rng: np.random.Generator) -> list[np.ndarray]:
    """Return closed states within the fold limits that have one or two fold angles at +-pi."""
    n = model.size
    single = [((v, s),) for v in range(n) for s in (-1, 1)] * SAMPLES_ON_A_LIMIT
    faces = [(v, s) for v in range(n) for s in (-1, 1)]
    double = [pair for pair in itertools.combinations(faces, 2) if pair[0][0] != pair[1][0]] * 3
    patterns = (single[:BATCH] + double)[: MOST_BATCHES * BATCH] if n > 4 else single + double
    patterns = patterns[: MOST_BATCHES * BATCH]
    x = rng.uniform(-math.pi, math.pi, (len(patterns), n))
    frozen = np.zeros_like(x, dtype=bool)
    for row, pattern in enumerate(patterns):
        for v, s in pattern:
            x[row, v], frozen[row, v] = s * math.pi, True
    x, residual = project(model, x, frozen=frozen)
    # what closing moved onto a limit, to rounding, is at the limit
    x = np.where(np.abs(np.abs(x) - math.pi) <= OUTSIDE, np.sign(x) * math.pi, x)
    good = (residual <= CLOSES) & (np.abs(x) <= math.pi).all(axis=1)
    return [state for state in x[good] if model.on_sheet(state)]
