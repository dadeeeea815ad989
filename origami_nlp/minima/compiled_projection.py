"""Many states projected onto closure, and which are admissible: in C where well conditioned, else by NumPy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp.kkt import PROJECTED, project
from origami_nlp.minima.descents import Descents
from origami_nlp.numerics import CLOSURE_TOL, FOLLOWED
from origami_nlp.problem import Contact, held
from origami_nlp.starts import SLOTS, Samples


def project_many(
    descents: Descents,
    x: np.ndarray,
    choices: Sequence[tuple[Contact, ...]],
    of: np.ndarray,
    frozen: np.ndarray | None = None,
    steps: int = PROJECTED,
) -> tuple[np.ndarray, np.ndarray]:
    """Move states onto closure with contacts held, see `kkt.project`, and within fold limits.

    Parameters
    ----------
    descents
        Of the model, compiled or not.
    x
        States, shape [K, n] [rad].
    choices, of
        Contacts, and for each state the number of those that it holds, shape [K].
    frozen, steps
        As for `kkt.project`.

    Returns
    -------
    x
        Where they end, within fold limits, shape [K, n].
    good
        Which of them are closed, to `FOLLOWED` before they are moved to fold limits, and `Model.admissible`, shape [K].
    """
    model, y, residual = descents.model, np.array(x, dtype=float), np.zeros(len(x))
    good, known = np.zeros((2, len(x)), dtype=bool)
    kinds = [(choices[c], np.flatnonzero(of == c)) for c in sorted(set(of.tolist()))]
    few = all(sum(not c.is_limit for c in rows) <= SLOTS for rows, _ in kinds)
    if descents.usable and few:
        s = Samples.on(y, frozen)
        for rows, which in kinds:
            for slot, gap in enumerate(c for c in rows if not c.is_limit):
                s.slots[which, slot], s.sides[which, slot] = gap.index, gap.side
            s.at_limit[which[:, None], [c.index for c in rows if c.is_limit]] = 1
            s.x[which] = held(y[which], rows)
        y, residual, good, known = descents.project(s, steps)
    for rows, which in kinds:
        left = which[~known[which]]
        if len(left):
            still = None if frozen is None else frozen[left]
            y[left], residual[left] = project(model, x[left], rows, frozen=still, steps=steps)
    left = np.flatnonzero(~known)
    if len(left):
        y[left] = model.fold_limits.clip(y[left])
        closes = np.abs(model.closure(y[left])[0]).max(axis=1, initial=0.0) <= CLOSURE_TOL
        good[left] = closes & model.admissible(y[left])
    return y, good & (residual <= FOLLOWED)
