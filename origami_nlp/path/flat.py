"""Where a curve of equilibria passes a flat or flat-folded state: multipliers pass infinity there.

At such a state x0 closure and held contacts C lose one rank, w' C = 0.  On the curve x = x0 + h d + ..., and the
multipliers are eta w / h + ...; torques balance on the kernel Z of C at h = 0 only if, with Q the second derivative of
w' (closure, openings) on Z,

    Z' grad U(x0; s) = eta Q d,        d' Q d = 0 (closure to second order),

so that g' Q^-1 g = 0 with g = Z' grad U(x0; s): one equation for s, without the curve.
"""

from __future__ import annotations

import numpy as np

from origami_nlp.numerics import CLOSES, RANK, bracketed_roots
from origami_nlp.path.equilibrium import EquilibriumCurve, System

FLAT = 0.1
"""Fold angles [rad] from a flat state up to which a curve may be about to pass it."""


def flat_passage(
    curve: EquilibriumCurve, near: np.ndarray, low: float, high: float
) -> tuple[np.ndarray, float, float] | None:
    """Locate the flat state that a curve passes.

    Parameters
    ----------
    curve
        With what it holds.
    near
        A point (x, s) of it close to the state, [n + 1].
    low, high
        Values of s between which it passes.

    Returns
    -------
    point : numpy.ndarray
        State and parameter, [n + 1].
    value, residual : float
        g' Q^-1 g there over the sizes of g and Q^-1, and the largest entry of closure and openings.
        None is returned instead of the three where no such state is near, or where more than one rank is lost.
    """
    x = np.pi * np.round(near[:-1] / np.pi)
    if np.abs(x - near[:-1]).max() > FLAT:
        return None
    first: list[np.ndarray] = []

    def value(s: np.ndarray) -> np.ndarray:
        return np.array([_balance(curve.system(np.append(x, float(v))), first) for v in s])

    at = [low, high]
    ends = value(np.array(at))
    if not np.isfinite(ends).all() or ends[0] * ends[1] > 0:
        return None
    s = float(bracketed_roots(value, at[:1], at[1:])[0])
    point = np.append(x, s)
    return point, float(value(np.array([s]))[0]), float(np.abs(curve.system(point).values).max())


def _balance(system: System, first: list[np.ndarray]) -> float:
    """Return g' Q^-1 g over the sizes of g and Q^-1; nan where it does not decide.  first: w, for its sign."""
    c = system.jacobian
    u, values, vt = np.linalg.svd(c)
    rank = int((values > RANK).sum())
    if len(c) - rank != 1 or np.abs(system.values).max() > CLOSES:
        return np.nan
    w, z = u[:, -1], vt[rank:].T
    first[:] = first or [w]
    w = w * np.copysign(1.0, w @ first[0])
    p, hold, m = system.programme, system.hold, len(system.hold.closure)
    weights = np.zeros(p.equation_count + len(hold.contacts))
    weights[list(hold.closure)], weights[p.equation_count :] = w[:m], w[m:]
    hessian = p.lagrangian_hessian(system.x, -weights, hold.contacts, 0.0)
    q = z.T @ (hessian / np.outer(p.root, p.root)) @ z
    size = np.abs(np.linalg.eigvalsh(q))
    if not len(size) or size.min() <= RANK * size.max():
        return np.nan
    g = z.T @ system.imbalance
    return float(g @ np.linalg.solve(q, g) / (g @ g) * size.min())
