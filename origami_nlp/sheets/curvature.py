"""Curvature along motions that closure allows, shown to be positive without a decision on ranks."""

from __future__ import annotations

import math

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import ArpackNoConvergence, eigsh

from origami_nlp.facets import MOST_DENSE, Matrix, Sheet, dense
from origami_nlp.numerics import CURVED, EPS, RANK, null_space

PENALTIES = 1e2, 1e4, 1e6, 1e8, 1e10, 1e12
"""Weights rho with which positivity on the kernel is tried."""


def lowest_curvature(sheet: Sheet, phi: np.ndarray, hessian: Matrix) -> float:
    """Return the smallest curvature on the kernel of closure at a state; inf if there is none."""
    if sheet.size > MOST_DENSE:
        return _smallest(hessian, sheet.closure.jacobian(phi), np.arange(sheet.size))[0]
    z = sheet.kernel(phi)
    return float(np.linalg.eigvalsh(z.T @ (hessian @ z))[0]) if z.shape[1] else math.inf


def curvature(
    sheet: Sheet,
    phi: np.ndarray,
    hessian: Matrix,
    held: np.ndarray,
    extra: np.ndarray | None = None,
) -> tuple[float, np.ndarray, bool]:
    """Examine curvature along motions that closure allows with creases held.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state.
    hessian
        Of the Lagrangian, [n, n].
    held
        Creases that stay.
    extra
        Further rows that must stay 0 to first order, [r, n]; of no sheet beyond `MOST_DENSE`.

    Returns
    -------
    smallest : float
        Curvature; inf where nothing is free.
    way : numpy.ndarray
        Its direction, [n].
    proved : bool
        Whether it is positive, shown without a rank decision.
    """
    free = np.setdiff1d(np.arange(sheet.size), held)
    j = sheet.closure.jacobian(phi)[:, free]
    h = hessian[free][:, free]
    way = np.zeros(sheet.size)
    if not len(free):
        return math.inf, way, True
    if sheet.size > MOST_DENSE:
        smallest, vector = _smallest(h, j, free)
        way[free] = vector
        return smallest, way, smallest > CURVED
    j, h = dense(j), dense(h)
    if extra is not None and len(extra):
        j = np.vstack([j, extra[:, free]])
    z = sheet.kernel(phi) if j.shape == (sheet.closure.count, sheet.size) else null_space(j)
    smallest = math.inf
    if z.shape[1]:
        curvatures, vectors = np.linalg.eigh(z.T @ h @ z)
        smallest = float(curvatures[0])
        way[free] = z @ vectors[:, 0]
    if smallest <= CURVED:
        return smallest, way, False
    size, exact = float(np.abs(h).max()), 10 * len(h) * EPS  # rows of J have entries up to 1/2
    # beside a singular state rows of J are short, those across the kernel and what seems to be are not
    for square, off in (
        (j.T @ j, exact),
        (np.eye(len(h)) - z @ z.T, exact + (len(h) * EPS / RANK) ** 2),
    ):
        for rho in PENALTIES:
            margin = CURVED * size + off * rho
            try:
                linalg.cholesky(h + rho * square - margin * np.eye(len(h)))
            except linalg.LinAlgError:
                continue
            return smallest, way, True
    return smallest, way, False


def _smallest(h: Matrix, j: Matrix, free: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the smallest eigenvalue of H + rho J'J and its vector: a lower bound of the curvature on the kernel."""
    whole = (sparse.csc_array(h) + 1e4 * sparse.csc_array(j).T @ sparse.csc_array(j)).tocsc()
    # below every eigenvalue (Gershgorin; J'J adds none below), the closest one is the smallest
    below = -float(np.abs(sparse.csr_array(h)).sum(axis=1).max()) - 1.0
    try:
        values, vectors = eigsh(whole, k=1, sigma=below, which="LM", v0=np.ones(len(free)))
    except ArpackNoConvergence:
        return math.nan, np.zeros(len(free))
    vector = vectors[:, 0]
    left = float(np.linalg.norm(whole @ vector - values[0] * vector))
    return float(values[0] - left), vector
