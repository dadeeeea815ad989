"""Minima beside the flat state, to second order: where descents from elsewhere seldom arrive.

At the flat state closure c loses rank.  Near it closed states x obey J x = 0 and x'Fx = 0, F the second derivative of
s . c for the one s with s J = 0, up to terms of third order.  Where rest angles all but cancel on that cone, a
minimum is close to its tip, with a basin as small as its distance.  In the axes of F on the kernel of J, stationary
states of the springs on the cone are y = -g / (1 + lam a), where y = sqrt(k) x, g is the torque at the flat state and
a are the curvatures of F; lam solves one equation,

    h(lam) = sum_i a_i (g_i / (1 + lam a_i))^2 = 0,

which falls between the poles on both sides of lam = 0, so that it has one root there, the lowest state of the cone.
Other minima have one negative 1 + lam a at most: their lam lies one interval further on either side.
"""

from __future__ import annotations

import numpy as np

from origami_nlp.numerics import RANK
from origami_nlp.programme import Model

NEAR = 1.0
"""Largest fold angle of a state that second order says something about [rad]."""
PLACES = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 202)[1:-1])
"""Where h is looked at, as shares of an interval between poles: closer towards them."""
BEYOND = np.logspace(-4, 7, 200)
"""And beyond the last pole, in lengths of the interval about 0: lam grows as the state comes closer to flat."""
HALVINGS = 50


def flat_minima(model: Model) -> np.ndarray:
    """Return the minima of a scene's springs on the second-order cone of closed states at the flat state.

    Parameters
    ----------
    model
        Of any scene; none are returned where the flat state is no state of it, or has more than one second-order
        equation.

    Returns
    -------
    numpy.ndarray
        Closed to second order, [K, n] [rad]; the tip of the cone is not among them.
    """
    flat, n = np.zeros(model.size), model.size
    value, jacobian = model.closure(flat)
    none = np.zeros((0, n))
    if np.abs(value).max(initial=0.0) > RANK or not model.on_sheet(flat):
        return none
    root = np.sqrt(model.parameters.stiffness)
    u, sizes, vt = np.linalg.svd(jacobian / root)
    rank = int((sizes > RANK * sizes.max(initial=1e-300)).sum())
    if len(u) - rank != 1 or n - rank < 2:
        return none
    no_gaps = np.zeros(len(model.structure.gaps))
    form = model.hessian(flat, u[:, rank], no_gaps, 0.0) / np.outer(root, root)
    kernel = vt[rank:].T
    a, axes = np.linalg.eigh(kernel.T @ form @ kernel)
    axes = kernel @ axes
    g = axes.T @ (model.parameters.torque(flat) / root)
    if not (a[0] < -RANK and a[-1] > RANK):
        return none  # the cone is its tip alone
    lam = _multipliers(a, g)
    x = (-g / (1.0 + lam[:, None] * a)) @ axes.T / root
    size = np.abs(x).max(axis=1)
    return np.asarray(x[(size > RANK) & (size <= NEAR)])


def _multipliers(a: np.ndarray, g: np.ndarray) -> np.ndarray:
    """Return the roots of h in the interval between poles about 0, and in those beside it."""
    poles = np.sort(-1.0 / a[np.abs(a) > RANK])
    below, above = poles[poles < 0], poles[poles > 0]
    wide = above[0] - below[-1]
    grids = [below[-1] + wide * PLACES]
    for side in (below[::-1], above):
        far = side[1] - side[0] if len(side) > 1 else 0.0
        beyond = np.sign(side[0]) * wide * BEYOND
        grids.append(side[0] + (far * PLACES if far else beyond))
    found = []
    for lam in grids:
        h = _h(lam, a, g)
        change = np.flatnonzero(h[1:] * h[:-1] < 0)
        left, right, sign = lam[change], lam[change + 1], np.sign(h[change])
        for _ in range(HALVINGS):
            middle = 0.5 * (left + right)
            here = np.sign(_h(middle, a, g)) == sign
            left, right = np.where(here, middle, left), np.where(here, right, middle)
        found.append(0.5 * (left + right))
    return np.concatenate(found)


def _h(lam: np.ndarray, a: np.ndarray, g: np.ndarray) -> np.ndarray:
    return np.asarray((a * (g / (1.0 + lam[:, None] * a)) ** 2).sum(axis=1))
