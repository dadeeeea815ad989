"""Sets of states that exist only while several contacts stay exactly closed: the paper's 1-handles.

A solver that needs an interior rarely ends on such a thin set, so they are looked for on purpose:
states with one or two fold angles held at +-pi are closed by Gauss-Newton; where the linearised
feasible cone has fewer dimensions than the model has freedoms, the state lies on a thin set.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.kkt.certificates import cone
from origami_nlp.kkt.projection import project
from origami_nlp.kkt.starts import BATCH
from origami_nlp.kkt.state import State
from origami_nlp.numerics import CLOSES, OUTSIDE
from origami_nlp.programme import Contact, Programme

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
    x = np.where(np.abs(np.abs(x) - math.pi) <= OUTSIDE, np.sign(x) * math.pi, x)
    good = (residual <= CLOSES) & (np.abs(x) <= math.pi).all(axis=1)
    return [state for state in x[good] if model.on_sheet(state)]


def thin_at(state: State) -> tuple[Contact, ...]:
    """Return the contacts that all neighbours of a state keep closed, or () where the feasible set is full."""
    contacts = state.contacts
    if len(contacts.base) + len(contacts.branches) < 2:
        return ()  # one smooth contact bounds a full-dimensional set
    z = state.kernel
    common: set[Contact] | None = None
    for rows in state.pieces:
        dimension, _, held = cone(state.on(rows).slopes @ z, rows)
        # a piece of full dimension, or a point
        if dimension == z.shape[1] or dimension == 0:
            return ()
        common = set(held) if common is None else common & set(held)
    return tuple(sorted(common or ()))
