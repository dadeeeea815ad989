"""The set of Lagrange multipliers of contacts at a state: unique, a polyhedron, or empty.

At a stationary state grad U = J' lam + A' mu with mu >= 0 (the KKT conditions), where J is the Jacobian of loop closure
and A holds the gradients of the active constraints, the closed contacts.  Projected on the null space Z of J this is
B mu = c with B = Z' A', c = Z' grad U: multipliers of closure, which are arbitrary where J loses rank, drop out.  Where
contacts are dependent the set is a polyhedron (contact forces are statically indeterminate); we report its point of
smallest norm and the range of each multiplier, never a solver's raw number.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from origami_nlp.numerics import (
    INDEPENDENT,
    ROUNDED,
    STATIONARY,
    UNBALANCED,
    extremes,
    nearest,
    nonnegative_least_squares,
    refined,
    unbounded,
)


class Multipliers:
    """Solutions mu >= 0 of B mu = c; ranges and corners are looked for when they are first asked for.

    Parameters
    ----------
    residual
        Smallest |B mu - c| over mu >= 0; the state is stationary when it vanishes.
    unique
        Whether mu is unique.
    found
        A solution; its positive entries belong to independent columns of B, shape [r].
    equations
        Where it is not unique and balances: B [t, r] of full row rank, and orthonormal rows of the same kernel.
    tiny
        What counts as zero.
    """

    def __init__(
        self,
        residual: float,
        unique: bool,
        found: np.ndarray,
        equations: tuple[np.ndarray, np.ndarray] | None = None,
        tiny: float = 0.0,
    ) -> None:
        self.residual, self.unique, self.found = residual, unique, found
        self._equations, self._tiny = equations, tiny

    @cached_property
    def smallest(self) -> np.ndarray:
        """The solution of smallest norm, [r]."""
        return (
            self.found if self._equations is None else smallest_norm(self._equations[0], self.found)
        )

    @cached_property
    def _bounded(self) -> np.ndarray:
        r = len(self.found)
        if self._equations is None:
            return np.full(r, self.unique)
        return ~unbounded(self._equations[1])

    @cached_property
    def _corners(self) -> np.ndarray:
        if self._equations is None:
            return self.found[None]
        return np.array(extremes(self._equations[1], self.found, self._bounded))

    @cached_property
    def lower(self) -> np.ndarray:
        """Smallest value of each entry, [r]."""
        if self._equations is None:
            return self.found if self.unique else np.zeros(len(self.found))
        least = self._corners.min(axis=0)
        return np.where(least <= self._tiny, 0.0, least)

    @cached_property
    def upper(self) -> np.ndarray:
        """Largest value of each entry, [r]; inf where unbounded."""
        if self.unique:
            return self.found
        most = np.where(self._bounded, self._corners.max(axis=0), np.inf)
        return np.where(most <= self._tiny, 0.0, most)

    @cached_property
    def vertices(self) -> np.ndarray:
        """Some extreme solutions, shape [v, r], for second-order tests."""
        if self._equations is None:
            return self._corners
        # mu enters the Hessian of the Lagrangian linearly, so that corners show more than the inside; rays are left out
        return np.vstack([self.smallest, self._corners])


def find_multipliers(b: np.ndarray, c: np.ndarray, tolerance: float = STATIONARY) -> Multipliers:
    """Describe {mu >= 0: B mu = c}, shapes [t, r] and [t]."""
    r = b.shape[1]
    size = 1.0 + float(np.abs(c).max(initial=0.0))
    if r == 0:
        return Multipliers(float(np.abs(c).max(initial=0.0)), True, np.zeros(0))
    # full column rank of B is linear independence of closure and contacts (LICQ; Nocedal & Wright, definition 12.4)
    b = np.where(np.linalg.norm(b, axis=0) > INDEPENDENT, b, 0.0)  # what does not push anywhere
    u, singular, vt = np.linalg.svd(b, full_matrices=False)
    rank = int((singular > INDEPENDENT).sum())
    if rank == r:
        mu = np.linalg.lstsq(b, c, rcond=None)[0]
        # the residual is that of max(mu, 0): a contact that pulls is missing balance, not a negative push
        clipped = np.where(np.abs(mu) <= 0.1 * tolerance * size, 0.0, mu)
        residual = float(np.abs(b @ np.maximum(mu, 0.0) - c).max())
        return Multipliers(residual, True, clipped)
    # dependent rows: keep the part of the equations that is more than rounding
    basis, rows = u[:, :rank], vt[:rank]
    missed = float(np.abs(c - basis @ (basis.T @ c)).max(initial=0.0))
    b, c = basis.T @ b, basis.T @ c
    found = nonnegative_least_squares(b, c)
    residual = max(missed, float(np.abs(b @ found - c).max(initial=0.0)))
    most = float(np.abs(c).max(initial=0.0))
    if INDEPENDENT * float(found.max(initial=0.0)) > most > tolerance * size:
        # contacts that press so hard balance by slopes that count as zero
        return Multipliers(max(residual, most), False, found)
    if residual > UNBALANCED * size:
        return Multipliers(residual, False, found)
    return Multipliers(residual, False, found, (b, rows), tolerance * size)


def smallest_norm(b: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Minimise |mu| over {mu >= 0: B mu = B found}, to rounding relative to the size of `found`.

    mu = p + N z with p of smallest norm and N the kernel of B; |z| is smallest under N z >= -p.  `found` >= 0
    is returned where rounding leaves no better point.
    """
    _, singular, vt = np.linalg.svd(b)
    rank = int((singular > INDEPENDENT).sum())
    kernel = vt[rank:].T
    size = float(np.abs(found).max(initial=0.0))
    if size == 0.0 or kernel.shape[1] == 0:
        return found
    unit = found / size
    # the part of a solution that lies in the row space is the same for all of them
    p = unit - kernel @ (kernel.T @ unit)
    z = nearest(np.zeros(kernel.shape[1]), kernel, -p)
    if z is None:
        return found
    mu = p + kernel @ z
    mu = refined(b, b @ unit, np.where(mu <= 10 * ROUNDED, 0.0, mu))
    closer = np.abs(b @ (mu - unit)).max() <= 100 * ROUNDED
    return mu * size if closer and np.linalg.norm(mu) <= np.linalg.norm(unit) else found
