"""What the dual of a problem proves, in rational numbers: no rounding, no eigenvalues.

For any point v of the problem and y in the dual cones, 0 <= y . (A v + b).  So t <= b . y + (c + A' y) . v where the
problem was solved, and 0 <= b . y + (A' y) . v where it has no point.  What is left of A' y, rounding of the solver,
is multiplied by how large the unknowns can be at all, with a margin t from 0 to its cap.
"""

from fractions import Fraction

import numpy as np

from origami_nlp.numerics import DEFINITE, EQUAL, POSITIVE, smatrix

CAP = 10
ROOM = 2
"""Sizes of moments come of a least singular value in floating point, which is good to far more than a factor of 2."""


def is_positive(m):
    """Whether a symmetric matrix of rational numbers is positive semidefinite: pivots of its LDL'."""
    m = [list(row) for row in m]
    for k in range(len(m)):
        if m[k][k] < 0:
            return False
        if m[k][k] == 0:
            if any(m[i][k] for i in range(k + 1, len(m))):
                return False
            continue
        for i in range(k + 1, len(m)):
            share = m[i][k] / m[k][k]
            for j in range(k, len(m)):
                m[i][j] -= share * m[k][j]
    return True


def in_dual_cone(cone, y):
    """The rational vector next to y that is certainly in the dual cone; of a matrix all its entries."""
    if cone == EQUAL:
        return [Fraction(float(v)) for v in y]
    if cone == POSITIVE:
        return [max(Fraction(float(v)), Fraction(0)) for v in y]
    assert cone == DEFINITE, cone
    m = [[Fraction(float(v)) for v in row] for row in smatrix(np.asarray(y))]
    step = max(abs(v) for row in m for v in row) / 10**15
    while not is_positive(m):
        for k in range(len(m)):
            m[k][k] += step
        step *= 2
    return [v for row in m for v in row]


def entries(problem, rows):
    """What the slack of some rows is made of, a [r, V] and b [r]; of matrices all their entries."""
    a, b = problem.matrix(rows), rows.b
    if rows.cone == DEFINITE:
        return np.array([smatrix(column).ravel() for column in a.T]).T, smatrix(b).ravel()
    return a, b


def largest(posed):
    """How large each unknown can be where 0 <= t <= CAP, [V]; the moments by their balance."""
    t, places = posed.targets, posed.places
    n = int(posed.count.sum())
    most = max(abs(t.rest[0]), abs(t.rest[1]))
    size = np.zeros(posed.problem.size)
    size[places.stiffness] = n
    size[places.torque] = most * n
    size[places.scale] = n / t.stiffness[0]
    size[places.margin] = CAP
    for _, balance, where in posed.balances:
        assert balance.regular
        x = balance.stratum.state.x
        torque = (np.abs(x).max() + most) * n * np.sqrt(len(x))
        if balance.lost.shape[1]:  # one w, with H - w C >= 0 and C of both signs
            lam = np.linalg.norm(balance.to_closure, 2) * torque
            bent = n + lam * sum(np.linalg.norm(c, 2) for c in balance.curvatures)
            values = balance.lost_modes[0]
            size[where] = ROOM * bent / min(values[-1], -values[0])
        elif len(balance.stratum.contacts):
            along = balance.stratum.slopes @ balance.kernel
            size[where] = ROOM * torque / np.linalg.svd(along)[1][-1]
    return size


def proved(posed):
    """What is proved of the margin, as a rational number: an upper bound; None where it is that there is no point."""
    p, answer = posed.problem, posed.answer
    total = [Fraction(0)] * p.size
    if answer.solved:
        total[posed.places.margin] = Fraction(1)
    work = Fraction(0)
    for rows, y in zip(p.rows, answer.duals, strict=True):
        for a, b, v in zip(*entries(p, rows), in_dual_cone(rows.cone, y), strict=True):
            work += Fraction(float(b)) * v
            for j in np.flatnonzero(a):
                total[j] += Fraction(float(a[j])) * v
    rest = sum(abs(s) * Fraction(float(m)) for s, m in zip(total, largest(posed), strict=True))
    if answer.solved:
        return work + rest
    assert answer.infeasible and work + rest < 0, (float(work), float(rest))
    return None
