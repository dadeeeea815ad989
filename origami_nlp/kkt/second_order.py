"""Closure to second order: where it loses rank, not every direction of its kernel is followed by states.

At a state where closure c loses rank (the flat state, flat foldings) there are w with w' J = 0.  States near
it leave in directions d with J d = 0, (closed contacts) . d >= 0 and

    d' Q d = 0,   Q = sum w_k Hess c_k,

since w . c vanishes along them.  Where the energy does not rise to first order for no such d, the state is a
strict local minimum (isolated, if there is no such d at all); no constraint qualification is needed.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.numerics import INDEPENDENT, ROUNDED

MOST_SUBSETS = 20_000
"""Candidates for extreme rays of a cone that are looked at; beyond, nothing is decided."""


def has_no_level_direction(forms: list[np.ndarray], rows: np.ndarray) -> bool:
    """Tell whether, for some form Q, d' Q d vanishes for no d != 0 with rows d >= 0.

    Parameters
    ----------
    forms
        Quadratic forms Q on the kernel of closure, each of shape [t, t].
    rows
        Shape [r, t]: closed contacts and the descent of the energy, all on the kernel.

    Returns
    -------
    bool
        True is proved (up to rounding); False says that it was not shown.
    """
    rays = extreme_rays(rows)
    for form in forms:
        size = float(np.abs(form).max(initial=0.0))
        if size <= INDEPENDENT:
            continue
        q = form / size
        values = np.linalg.eigvalsh(q)
        if values[0] > INDEPENDENT or values[-1] < -INDEPENDENT:
            return True
        if rays is None:
            continue
        if not len(rays):
            return True  # the cone is a point
        table = rays @ q @ rays.T
        for sign in (1.0, -1.0):
            # positive on each ray, and on none of their pairs negative: positive on the cone that they span
            if (sign * np.diag(table) > INDEPENDENT).all() and (sign * table >= -ROUNDED).all():
                return True
    return False


def extreme_rays(rows: np.ndarray) -> np.ndarray | None:
    """Return the extreme rays [k, t] of the pointed cone rows d >= 0, or None if it is not, or has too many."""
    t = rows.shape[1]
    norms = np.linalg.norm(rows, axis=1)
    rows = rows[norms > INDEPENDENT] / norms[norms > INDEPENDENT, None]
    if (
        np.linalg.matrix_rank(rows, tol=INDEPENDENT) < t
        or math.comb(len(rows), t - 1) > MOST_SUBSETS
    ):
        return None
    found: list[np.ndarray] = []
    if t == 1:
        candidates = [np.ones(1), -np.ones(1)]
    else:
        candidates = []
        for subset in itertools.combinations(range(len(rows)), t - 1):
            _, s, vt = np.linalg.svd(rows[list(subset)])
            if s[-1] > INDEPENDENT:
                candidates += [vt[-1], -vt[-1]]
    for d in candidates:
        inside = (rows @ d >= -INDEPENDENT).all()
        if inside and all(np.abs(d - known).max() > INDEPENDENT for known in found):
            found.append(d)
    return np.array(found).reshape(-1, t)
