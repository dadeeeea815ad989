"""Branch points as regular solutions: Newton on an extended system, where the KKT system alone has no rank.

At a branch point the derivative A of the KKT system F over (x, multipliers, s) has dependent rows: p'A = 0.  The system

    F(z) + b q = 0,    A(z)'p = 0,    p'p = 1

in z = (x, multipliers, s), p and b is regular at a simple one, with b = 0 there (Kuznetsov, Elements of Applied
Bifurcation Theory, 10.2; Moore 1980).  Along a curve a branch point is known to the square or cube root of rounding;
of this system it is known to rounding.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import block_diag

from origami_nlp.continuation.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.numerics import DUPLICATE_TOL, EPS, RANK, STATIONARY

STEPS = 8
"""Of Newton: it converges quadratically, or is beside another kind of point."""
DIFFERENCE = EPS ** (1 / 3)
"""Of central differences: their error is its square."""
FAR = 0.05
"""A solution lies no further away [rad]."""


def refined(curve: EquilibriumCurve, frame: Equilibrium) -> Equilibrium:
    """Return the branch point beside a point of a curve, known to rounding; the point itself where Newton finds none.

    Its tangent is that of `frame`.  Where several eigenvalues vanish together, as symmetry makes them, the extended
    system has no rank either: then nothing is gained.
    """
    system = frame.system
    n, root = len(system.imbalance), curve.root
    # constraints projected on their row space here: rows that depend on each other all along say nothing
    u, values, _ = np.linalg.svd(system.jacobian)
    rows = u[:, : int((values > RANK).sum())]
    left, right_of = (block_diag(np.eye(n), rows, *more) for more in ((), (1.0,)))
    z = np.concatenate([frame.x, rows.T @ system.multipliers])
    q = np.linalg.svd((left.T @ system.matrix @ right_of).T)[2][-1]
    p, b, many = q, 0.0, len(q)
    scale = np.concatenate([root[:-1], np.ones(many - n), root[-1:]])  # of (x, multipliers, s)

    def seen(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        at = curve.system(z[: n + 1], rows @ z[n + 1 :])
        return left.T @ np.concatenate([at.imbalance, at.values]), left.T @ at.matrix @ right_of

    def moved(z: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Add a step over (y, multipliers, w s)."""
        step = step / scale
        return z + np.concatenate([step[:n], step[-1:], step[n:-1]])

    for _ in range(STEPS):
        values, matrix = seen(z)
        ways = DIFFERENCE * np.eye(many + 1)
        curved = [(seen(moved(z, e))[1] - seen(moved(z, -e))[1]).T @ p for e in ways]
        whole = np.zeros((2 * many + 2,) * 2)
        whole[:many, : many + 1], whole[:many, -1] = matrix, q
        whole[many:-1, : many + 1] = np.array(curved).T / (2 * DIFFERENCE)
        whole[many:-1, many + 1 : -1], whole[-1, many + 1 : -1] = matrix.T, p
        right = np.concatenate([values + b * q, matrix.T @ p, [0.5 * (p @ p - 1.0)]])
        try:
            step = np.linalg.solve(whole, -right)
        except np.linalg.LinAlgError:
            return frame
        if not np.abs(step[:n]).max() <= FAR:
            return frame
        z, p, b = moved(z, step[: many + 1]), p + step[many + 1 : -1], b + float(step[-1])
        if np.abs(step[: many + 1]).max() <= DUPLICATE_TOL:  # its square is rounding
            break
    else:
        return frame
    found = curve.system(z[: n + 1], rows @ z[n + 1 :])
    near = float(np.linalg.norm(root * (z[: n + 1] - frame.x))) <= FAR
    known = abs(b) <= STATIONARY and found.residual <= STATIONARY
    return Equilibrium(z[: n + 1], frame.tangent, found) if near and known else frame
