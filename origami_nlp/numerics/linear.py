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
MOST_PIVOTS = 200
"""Steps of the simplex method for one entry; the corner reached by then is one of the set all the same."""
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
    """Find corners of {mu >= 0: B mu = B inside} with the least and the largest of every entry: the simplex method.

    It starts at `inside`, whose positive entries belong to independent columns, and goes from one answer to the
    next question; Bland's rule (the first column that helps, the first of those it may replace) keeps it from running
    in circles.  A pivot after which the basis would be dependent to `INDEPENDENT` is no corner, here as in the list.
    """
    r = b.shape[1]
    c = b @ inside
    basis = _basis(b, inside)
    if not _independent(b[:, basis]):
        return np.zeros((0, r))
    found = []
    for k, sign in [(k, 1.0) for k in range(r)] + [(k, -1.0) for k in np.flatnonzero(bounded)]:
        for _ in range(MOST_PIVOTS):
            table = np.linalg.solve(b[:, basis], np.column_stack([b, c]))
            # reduced costs of the objective sign mu_k
            cost = -sign * (basis == k) @ table[:, :r]
            cost[k] += sign
            cost[basis] = 0.0
            pivots = (_pivot(b, basis, table, int(j)) for j in np.flatnonzero(cost < -INDEPENDENT))
            better = next((p for p in pivots if p is not None), None)
            if better is None:
                break
            basis = better
        mu = np.zeros(r)
        mu[basis] = np.maximum(np.linalg.solve(b[:, basis], c), 0.0)
        found.append(refined(b, c, mu))
    return _solving(b, c, np.array(found))


def _pivot(b: np.ndarray, basis: np.ndarray, table: np.ndarray, new: int) -> np.ndarray | None:
    """Return the basis after column `new` has entered; None where it is unbounded along it, or would be dependent."""
    column, level = table[:, new], np.maximum(table[:, -1], 0.0)
    falls = column > INDEPENDENT
    ratio = np.where(falls, level, np.inf) / np.where(falls, column, 1.0)
    least = np.flatnonzero(falls & (ratio <= ratio.min(initial=np.inf) * (1 + LEVEL)))
    for row in least[basis[least].argsort()]:
        after = basis.copy()
        after[row] = new
        if _independent(b[:, after]):
            return after
    return None


def _independent(columns: np.ndarray) -> bool:
    """Return whether columns [t, k] are a basis, by their smallest singular value."""
    t, k = columns.shape
    return t == k and bool(np.linalg.svd(columns, compute_uv=False).min(initial=1.0) > INDEPENDENT)


def _basis(b: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Choose independent columns, as many as B [t, r] has rows: those of the positive entries of `inside` first."""
    chosen: list[int] = []
    left = b.copy()
    for first in (inside > 0, np.ones(b.shape[1], dtype=bool)):
        while len(chosen) < len(b):
            size = np.where(first, np.linalg.norm(left, axis=0), 0.0)
            k = int(size.argmax())
            if size[k] <= INDEPENDENT:
                break
            chosen.append(k)
            unit = left[:, k] / size[k]
            left -= np.outer(unit, unit @ left)
    return np.array(chosen)


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
