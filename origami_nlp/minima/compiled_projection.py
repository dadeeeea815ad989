"""Many states projected onto closure: in C where that is well conditioned, elsewhere by singular values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp.kkt import PROJECTED, project
from origami_nlp.minima.descents import Descents
from origami_nlp.problem import Contact, held
from origami_nlp.starts import SLOTS, Samples


def project_many(
    descents: Descents,
    x: np.ndarray,
    contacts: Sequence[Contact] = (),
    frozen: np.ndarray | None = None,
    steps: int = PROJECTED,
) -> tuple[np.ndarray, np.ndarray]:
    """Move states onto closure with contacts held, see `kkt.project`.

    Parameters
    ----------
    descents
        Of the model, compiled or not.
    x
        States, shape [K, n] [rad].
    contacts, frozen, steps
        As for `kkt.project`.

    Returns
    -------
    x, residual
        As those of `kkt.project`.
    """
    gaps = [c for c in contacts if not c.is_limit]
    if descents.compiled is None or len(gaps) > SLOTS:
        return project(descents.model, x, contacts, frozen=frozen, steps=steps)
    s = Samples.on(held(x, contacts), None if frozen is None else frozen)
    s.at_limit[:, [c.index for c in contacts if c.is_limit]] = 1
    for k, gap in enumerate(gaps):
        s.slots[:, k], s.sides[:, k] = gap.index, gap.side
    y, residual, known = descents.compiled.project(s, steps)
    left = np.flatnonzero(~known)
    if len(left):
        still = None if frozen is None else frozen[left]
        y[left], residual[left] = project(
            descents.model, x[left], contacts, frozen=still, steps=steps
        )
    return y, residual
