"""Closure to second order: where it loses rank, not every direction of its kernel is followed by states.

At a state where closure c loses rank (the flat state, flat foldings) there are w with w' J = 0.  States near
it leave in directions d with J d = 0, (closed contacts) . d >= 0 and

    d' Q d = 0,   Q = sum w_k Hess c_k,

since w . c vanishes along them.  Where the energy does not rise to first order for no such d, the state is a
strict local minimum (isolated, if there is no such d at all); no constraint qualification is needed.
"""

from __future__ import annotations

import numpy as np

from origami_nlp.numerics import INDEPENDENT, NONZERO, ROUNDED, null_space

MOST_RAYS = 1000
"""Extreme rays that a cone may have; beyond, nothing is decided."""


def has_no_level_direction(forms: list[np.ndarray], rows: np.ndarray) -> bool:
    """Return whether, for some form Q, d' Q d vanishes for no d != 0 with rows d >= 0.

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
    """Return the extreme rays [k, t] of the pointed cone rows d >= 0, or None if it is not, or has too many.

    Double description (Motzkin and others 1953): the rays of t independent rows, then one row after the other cuts
    off the rays beyond it and adds one on each edge that it cuts.  Each new ray is the kernel of its rows, so
    that rounding does not grow; None also where rounding hides which rows those are.
    """
    t = rows.shape[1]
    norms = np.linalg.norm(rows, axis=1)
    rows = rows[norms > INDEPENDENT] / norms[norms > INDEPENDENT, None]
    first = _independent(rows)
    if first is None:
        return None
    # columns of the inverse: each lies on all of these rows but one
    rays = np.linalg.inv(rows[first]).T
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    used = list(first)
    for k in range(len(rows)):
        if k in first:
            continue
        value = rays @ rows[k]
        beyond, inside = value < -INDEPENDENT, value > INDEPENDENT
        used.append(k)
        if not beyond.any():
            continue
        new = _on_cut_edges(rays, value, rows[used])
        if new is None:
            return None
        rays = np.vstack([rays[inside], rays[~inside & ~beyond], new])
        if len(rays) > MOST_RAYS:
            return None
    return rays.reshape(-1, t)


def _independent(rows: np.ndarray) -> list[int] | None:
    """Choose as many rows as there are columns, each as independent of those before as can be; None: rank too small."""
    left, chosen = rows.copy(), []
    for _ in range(rows.shape[1]):
        size = np.linalg.norm(left, axis=1)
        k = int(size.argmax()) if len(size) else 0
        if not len(size) or size[k] <= INDEPENDENT:
            return None
        chosen.append(k)
        unit = left[k] / size[k]
        left -= np.outer(left @ unit, unit)
    return chosen


def _on_cut_edges(rays: np.ndarray, value: np.ndarray, rows: np.ndarray) -> np.ndarray | None:
    """Return where the last of `rows`, worth `value` on the rays, cuts edges of the cone of the others.

    Two rays span an edge exactly when no third one lies on all the rows that hold both.
    """
    t = rows.shape[1]
    # which rows hold which ray; an edge of a cone in t dimensions lies on t - 2 of them
    on = np.abs(rays @ rows[:-1].T) <= INDEPENDENT
    one, other = np.flatnonzero(value > INDEPENDENT), np.flatnonzero(value < -INDEPENDENT)
    i, j = (m.ravel() for m in np.meshgrid(one, other, indexing="ij"))
    common = on[i] & on[j]
    many = common.sum(axis=1) >= t - 2
    i, j, common = i[many], j[many], common[many]
    edge = (common.astype(float) @ (~on).T.astype(float) == 0).sum(axis=1) == 2
    new = []
    for p, q, held in zip(i[edge], j[edge], common[edge], strict=True):
        between = value[p] * rays[q] - value[q] * rays[p]
        _, s, vt = np.linalg.svd(np.vstack([rows[:-1][held], rows[-1]]))
        if t > 1 and s[t - 2] <= INDEPENDENT:
            return None
        new.append(vt[-1] * np.copysign(1.0, vt[-1] @ between))
    return np.array(new).reshape(-1, t)


def generators(rows: np.ndarray) -> np.ndarray | None:
    """Return directions [k, t] whose sums with positive factors are the cone rows d >= 0; None if they are too many.

    The extreme rays, and where the cone holds lines, those of its part across them and the lines both ways.
    """
    # d and -d both in the cone: rows d = 0
    lines = null_space(rows, INDEPENDENT)
    across = null_space(lines.T, INDEPENDENT)
    if not lines.shape[1]:
        return extreme_rays(rows)
    if not across.shape[1]:
        return np.vstack([lines.T, -lines.T])
    rays = extreme_rays(rows @ across)
    return None if rays is None else np.vstack([rays @ across.T, lines.T, -lines.T])


def level_directions(form: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Return unit directions [k, t] of the cone that `rays` [., t] generate along which a form [t, t] vanishes.

    Those on the rays and between two of them: where d' Q d vanishes on a cone it need not be there, but there it is
    found by a quadratic equation.
    """
    q = form / max(float(np.abs(form).max(initial=0.0)), NONZERO)
    table = rays @ q @ rays.T
    a = np.diag(table)
    i, j = np.triu_indices(len(rays), 1)
    found = [rays[np.abs(a) <= INDEPENDENT]]
    with np.errstate(divide="ignore", invalid="ignore"):
        b = table[i, j]  # a_i + 2 b s + a_j s^2 = 0, without cancellation
        w = b + np.copysign(np.sqrt(b**2 - a[i] * a[j]), b)
        for s in (-a[i] / w, -w / a[j]):
            good = np.isfinite(s) & (s > 0)
            found.append(rays[i[good]] + s[good, None] * rays[j[good]])
    d = np.vstack(found)
    length = np.linalg.norm(d, axis=1)
    some = length > INDEPENDENT
    return d[some] / length[some, None]
