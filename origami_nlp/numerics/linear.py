"""Nearest points of small polyhedra, and the extremes of their coordinates.

The problems of a few contacts are small and decide what a state is, so they are solved to rounding by finite
methods: the active-set method of Lawson and Hanson (1974, chapter 23), the list of all corners, and the simplex method
where there are too many corners to list.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.numerics.compiled_linear import nonnegative_in_c
from origami_nlp.numerics.tolerances import (
    CONTACT_TOL,
    CURVED,
    INDEPENDENT,
    LEVEL,
    NONZERO,
    RANK,
    ROUNDED,
)

MOST_CORNERS = 1000
"""Choices of columns up to which corners are listed."""
SMALL = 24
"""Rows or columns up to which systems are solved by singular values: they take no longer."""


def nonnegative_least_squares(b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Minimise |B mu - c| over mu >= 0 to rounding relative to the sizes of B [t, r] and c [t].

    The columns of B that carry a positive entry of the answer are independent.  A linear program would only
    balance the springs to a solver's tolerance, which hides whether a state is stationary.
    """
    if (made := nonnegative_in_c(b, c)) is not None:
        return made
    r = b.shape[1]
    largest, size = float(np.abs(b).max(initial=0.0)), float(np.abs(c).max(initial=0.0))
    mu = np.zeros(r)
    if largest == 0.0 or size == 0.0:
        return mu
    b, c = b / largest, c / size
    free, barred = np.zeros(r, dtype=bool), np.zeros(r, dtype=bool)
    for _ in range(10 * r + 10):
        # negative gradient of |B mu - c|^2 / 2: complementary to mu at the answer (Kuhn and Tucker)
        pull = b.T @ (c - b @ mu)
        pull[free | barred] = -np.inf
        new = int(pull.argmax())
        if pull[new] <= ROUNDED:
            break
        free[new] = True
        while True:
            trial = np.zeros(r)
            trial[free] = np.linalg.lstsq(b[:, free], c, rcond=CURVED)[0]
            blocked = free & (trial <= 0)
            if not blocked.any():
                mu = trial
                break
            # go towards the trial until the first entry vanishes
            share = mu[blocked] / np.maximum(mu[blocked] - trial[blocked], NONZERO)
            mu = mu + float(share.min()) * (trial - mu)
            mu[blocked & (mu <= ROUNDED * mu.max())] = 0.0
            still = free & (mu > 0)
            if (still == free).all():
                still[np.flatnonzero(blocked)[int(share.argmin())]] = False
            free = still
        # a column that rounding alone let in is not tried again before another has changed something
        barred = barred | (np.arange(r) == new) if not free[new] else np.zeros(r, dtype=bool)
    return mu * (size / largest)


def nearest_in_cone(point: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return the point of {y: rows y >= 0} nearest to `point` [n]: what the polar cone leaves of it (Moreau).

    Of all directions d of the cone with |d| = 1 it has the largest product with `point`, which is its length.
    """
    # y = point + rows' mu with mu >= 0, rows y >= 0 and mu . rows y = 0
    return point + rows.T @ nonnegative_least_squares(rows.T, -point)


def nearest(point: np.ndarray, rows: np.ndarray, lower: np.ndarray) -> np.ndarray | None:
    """Return the point of {y: rows y >= lower} nearest to `point` [n]; None if rounding leaves none.

    Least distance programming (Lawson and Hanson 1974, chapter 23).
    """
    missing = lower - rows @ point
    size = float(missing.max(initial=0.0))
    if size <= 0.0:
        return point.copy()
    e = np.vstack([rows.T, missing / size])
    f = np.zeros(len(e))
    f[-1] = 1.0
    forces = nonnegative_least_squares(e, f)
    left = e @ forces - f
    if abs(left[-1]) <= CURVED:
        return None
    # least distance programming: the residual of the least-squares problem is the answer, but for a factor
    y = point - size * (left[:-1] / left[-1])
    on = forces > 0  # where rows meet at sharp angles, the rows that hold say it more precisely
    return y + np.linalg.lstsq(rows[on], lower[on] - rows[on] @ y, rcond=CURVED)[0]


def unbounded(b: np.ndarray) -> np.ndarray:
    """Return for which i some d >= 0 has B d = 0 and d_i > 0, [r]: along which {mu >= 0: B mu = c} is unbounded.

    Where there is such a d it settles all of its positive entries; where there is none, what the other columns leave
    of column i, left, has left . B >= 0, and settles all entries where that is positive (Farkas).
    """
    r = b.shape[1]
    out, unknown = np.zeros(r, dtype=bool), np.ones(r, dtype=bool)
    while unknown.any():
        i = int(unknown.argmax())
        others = np.delete(np.arange(r), i)
        d = np.zeros(r)
        d[others], d[i] = nonnegative_least_squares(b[:, others], -b[:, i]), 1.0
        left = b @ d
        along = bool(np.abs(left).max(initial=0.0) <= INDEPENDENT)
        settled = (d if along else left @ b) > INDEPENDENT
        settled[i] = True
        out |= settled & unknown & along
        unknown &= ~settled
    return out


def extremes(b: np.ndarray, inside: np.ndarray, bounded: np.ndarray) -> list[np.ndarray]:
    """Return points of {mu >= 0: B mu = B inside} with the least of each entry, and the largest where bounded.

    Parameters
    ----------
    b
        Orthonormal rows, shape [t, r].
    inside
        A point of the set, shape [r]; it is among those returned.
    bounded
        Whether entry i is bounded above, shape [r].
    """
    t, r = b.shape
    size = float(inside.max(initial=0.0))
    if size == 0.0:  # a cone: its tip is the least, and nothing is bounded but by 0
        return [inside]
    if math.comb(r, t) <= MOST_CORNERS:
        corners = np.vstack([inside / size, _corners(b, b @ inside / size)])
    else:
        corners = np.vstack([inside / size, _programme(b, inside / size, bounded)])
    chosen = {0, *corners.argmin(axis=0), *corners.argmax(axis=0)[bounded]}
    return [size * corners[k] for k in sorted(map(int, chosen))]


def _corners(b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """List the corners of {mu >= 0: B mu = c}: for each choice of t independent columns its one solution."""
    t, r = b.shape
    choices = np.array(list(itertools.combinations(range(r), t)), dtype=int)
    u, s, vt = np.linalg.svd(b[:, choices].transpose(1, 0, 2))
    good = s.min(axis=1, initial=1.0) > INDEPENDENT
    u, s, vt, choices = u[good], s[good], vt[good], choices[good]
    part = np.einsum("kji,kj->ki", vt, np.einsum("kji,j->ki", u, c) / s)
    mu = np.zeros((len(part), r))
    np.put_along_axis(mu, choices, np.maximum(part, 0.0), axis=1)
    return _solving(b, c, mu)


def _solving(b: np.ndarray, c: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Return those of points mu >= 0, [K, r], that solve B mu = c to rounding."""
    missed = np.abs(mu @ b.T - c).max(axis=1, initial=0.0)
    return mu[missed <= LEVEL * np.maximum(1.0, mu.max(axis=1, initial=0.0))]


def _programme(b: np.ndarray, inside: np.ndarray, bounded: np.ndarray) -> np.ndarray:
    """Find corners of {mu >= 0: B mu = B inside} with the least and the largest of every entry: the simplex method."""
    from scipy.optimize import linprog  # heavy

    c, unit = b @ inside, np.eye(b.shape[1])
    costs = [*unit, *-unit[bounded]]
    ends = (linprog(cost, A_eq=b, b_eq=c, method="highs-ds").x for cost in costs)
    found = [refined(b, c, mu) for mu in ends if mu is not None]
    return _solving(b, c, np.array(found).reshape(-1, b.shape[1]))


def refined(b: np.ndarray, c: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Take a solver's solution to rounding by a least-squares correction of its positive entries."""
    support = mu > CONTACT_TOL * mu.max(initial=0.0)
    better = np.where(support, mu, 0.0)
    for _ in range(2):
        better[support] += np.linalg.lstsq(b[:, support], c - b @ better, rcond=CURVED)[0]
    improved = np.linalg.norm(b @ better - c) < np.linalg.norm(b @ mu - c)
    return better if improved and better.min() >= 0 else np.maximum(mu, 0.0)


def shortest_solution(matrix: np.ndarray, right: np.ndarray, below: float) -> np.ndarray:
    """Return the shortest x that minimises the length of A x - b.

    By singular values of small A; a complete orthogonal factorisation of larger ones takes a quarter of the time (Golub
    and Van Loan, Matrix Computations, section 5.5).

    Parameters
    ----------
    matrix, right
        A, [m, n], and b, [m].
    below
        Singular values below this share of the largest are left out.

    Returns
    -------
    numpy.ndarray
        Shape [n].

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp.numerics import shortest_solution
    >>> shortest_solution(np.array([[1.0, 1.0]]), np.array([2.0]), 1e-10).round(12).tolist()
    [1.0, 1.0]
    """
    m, n = matrix.shape
    if min(m, n) <= SMALL:
        small: np.ndarray = np.linalg.lstsq(matrix, right, rcond=below)[0]
        return small
    import scipy as sp  # heavy

    b = np.zeros((max(m, n), 1))
    b[:m, 0] = right
    work = 64 * (m + n)
    _, x, _, _, _ = sp.linalg.lapack.dgelsy(matrix, b, np.zeros(n, np.int32), below, work)
    return np.ascontiguousarray(x[:n, 0])


def null_space(a: np.ndarray, tolerance: float = RANK) -> np.ndarray:
    """Return an orthonormal basis of the null space (kernel) of a, shape [n, n - rank]."""
    if a.shape[0] == 0:
        return np.eye(a.shape[1])
    _, s, vt = np.linalg.svd(a, full_matrices=a.shape[0] < a.shape[1])
    return vt[int((s > tolerance).sum()) :].T
