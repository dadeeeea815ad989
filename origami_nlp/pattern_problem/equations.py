"""A pattern as a nonlinear program: energy over fold angles, closure as equations, fold limits as bounds.

Closure rows are redundant as a rule (a Miura sheet of m x n facets has (m - 2)(n - 2) that say nothing new, and they
carry self-stress), so that no step here decides on a rank: linear systems are those of the proximal method,

    [ H   J' ] [ d       ]   [ -grad L ]
    [ J  -eps] [ d lambda] = [ -c      ],

whose solution does not notice dependent rows, and minima are certified by positive curvature on the kernel of J,
which is enough whether or not rows are dependent.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np
import scipy as sp

from origami_nlp.errors import OutOfTime
from origami_nlp.numerics import (
    CURVED,
    DUPLICATE_TOL,
    NONZERO,
    RANK,
    ROUNDED,
    SYMMETRIC,
    Matrix,
    Normal,
    NullSpaces,
    dense,
    null_space,
)
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem.closure import Closure
from origami_nlp.pattern_problem.compiled_closure import FALLS, LONGEST
from origami_nlp.pattern_problem.contact_pairs import FoldedGeometry
from origami_nlp.pattern_problem.crossings import PatternCrossings
from origami_nlp.pattern_problem.features import Features
from origami_nlp.pattern_problem.orbits import Orbits
from origami_nlp.pattern_problem.stacks import Stack
from origami_nlp.problem import FoldLimits, HingeLaws, Parameters

MOST_DENSE = 400
"""Creases up to which kernels are formed by a singular value decomposition; sparse factors beyond."""
MOST_KEPT = 3
"""States of which what was computed is kept: that of a step, and those which a line search tries."""


MOST_STACKS = 64
"""States whose pieces on each other, and rules of order, are kept."""


class PatternEquations:
    """Energy and closure of a pattern, and linear systems of them.

    Parameters
    ----------
    pattern
        With its springs.
    orbits
        Of states that keep a symmetry: variables are then fewer than creases.

    Attributes
    ----------
    closure
        Its equations.
    crossings
        Its test of facets that cross.
    fold_limits
        Of its creases: +-pi, or stops.
    scale
        Mean stiffness [N m/rad]: residuals of torques are over it.
    until
        Time of `time.monotonic` after which projections and factorisations raise `OutOfTime`; never by default.
    """

    def __init__(self, pattern: Pattern, orbits: Orbits | None = None) -> None:
        self.pattern, self.orbits = pattern, orbits
        self.closure = Closure(pattern, orbits)
        self.crossings = PatternCrossings(pattern, orbits)
        self.scale = float(pattern.stiffness.mean()) if pattern.creases else 1.0
        self.fold_limits = FoldLimits(*pattern.limit_angles)
        if orbits is not None:
            self.fold_limits = orbits.limits(self.fold_limits)
        self._end = [math.inf]
        self._last: tuple[bytes, list[int], Normal] | None = None
        self._seen: dict[str, dict[bytes, Any]] = {}
        self._stacks: dict[bytes, Stack] = {}
        # of closure alone: shared with the same pattern under other loads
        self._decomposed: dict[bytes, NullSpaces] = {}

    @property
    def until(self) -> float:
        """See above: one for a sheet and all that is made of it, under whatever load."""
        return self._end[0]

    @until.setter
    def until(self, end: float) -> None:
        self._end[0] = end

    @property
    def size(self) -> int:
        """Number of variables n."""
        return self.closure.variables

    @cached_property
    def multiplicity(self) -> np.ndarray:
        """How many creases follow each variable, [n]."""
        return np.ones(self.size, int) if self.orbits is None else self.orbits.multiplicity

    @cached_property
    def root(self) -> np.ndarray:
        """The metric of all fold angles: those of y = root x have its lengths, [n]."""
        return np.sqrt(self.multiplicity)

    def expand(self, x: np.ndarray) -> np.ndarray:
        """Return the fold angles [..., N] of variables [..., n]."""
        return np.asarray(x) if self.orbits is None else self.orbits.expand(np.asarray(x))

    def gathered(self, rows: np.ndarray) -> np.ndarray:
        """Return derivatives by variables [..., n] of those by fold angles [..., N]."""
        return rows if self.orbits is None else self.orbits.gather(rows)

    def reduce(self, fold_angles: np.ndarray) -> np.ndarray:
        """Return the variables [..., n] of fold angles [..., N] that keep the symmetry."""
        if self.orbits is None:
            return np.asarray(fold_angles)
        return self.orbits.reduce(fold_angles)

    def check_time(self) -> None:
        """Raise `OutOfTime` where the time is over: all that takes long goes through here every few milliseconds."""
        if (
            self.until < math.inf and time.monotonic() > self.until
        ):  # which takes microseconds to ask
            raise OutOfTime

    def kept(self, what: str, x: np.ndarray, make: Any) -> Any:
        """Return what is asked for several times of one state, and again after states beside it: of the last few."""
        key, seen = x.tobytes(), self._seen.setdefault(what, {})
        found = seen.pop(key) if key in seen else make()
        if len(seen) == MOST_KEPT:
            del seen[next(iter(seen))]
        seen[key] = found
        return found

    def placed(self, x: np.ndarray) -> FoldedGeometry:
        """Return the facets in space at a state."""
        placed: FoldedGeometry = self.kept(
            "placed", x, lambda: FoldedGeometry(self.crossings.poses, x)
        )
        return placed

    def stack(self, x: np.ndarray) -> Stack:
        """Return the pieces that lie on each other at a state, with the rules of their order."""
        stack: Stack = self.kept("stack", x, lambda: self._stacked(x))
        return stack

    def _stacked(self, x: np.ndarray) -> Stack:
        # which way creases are folded flat changes nothing of where paper lies
        key = (np.round(self.crossings.placed(x) / self.crossings.size, 12) + 0.0).tobytes()
        known = self._stacks.pop(key, None)
        found = Stack(self.crossings, x, self.check_time) if known is None else known.at(x)
        if len(self._stacks) >= MOST_STACKS:
            del self._stacks[next(iter(self._stacks))]
        self._stacks[key] = found
        return found

    @cached_property
    def features(self) -> Features:
        """Features of its facets that can meet."""
        return Features(self.crossings)

    @property
    def stiffness(self) -> np.ndarray:
        """Over `scale`, [n]."""
        return self.springs.stiffness

    @cached_property
    def springs(self) -> Parameters:
        """Springs and laws of the variables over `scale`, without load."""
        p, none = self.pattern, np.zeros(self.size)
        k, rest, laws, counts = p.stiffness, p.rest, p.laws, self.multiplicity
        if self.orbits is not None:
            k, rest = np.bincount(self.orbits.orbit, k), self.orbits.reduce(rest)
            laws = self.orbits.laws(laws) if laws else ()
        springs = HingeLaws.of(laws, counts / self.scale) if laws else None
        return Parameters(none[:0], k / self.scale, rest, none, None, springs)

    def torque(self, phi: np.ndarray) -> np.ndarray:
        """Gradient of the energy over `scale`, [n]."""
        return self.springs.torque(phi)

    def scaled_energy(self, phi: np.ndarray) -> float:
        """Elastic energy over `scale`."""
        return float(self.springs.energy(phi))

    def residual(self, phi: np.ndarray) -> float:
        """Largest entry of closure."""
        return float(np.abs(self.closure.values(phi)).max(initial=0.0))

    def project(
        self,
        phi: np.ndarray,
        held: np.ndarray | None = None,
        steps: int = 40,
        near: np.ndarray | None = None,
    ) -> tuple[np.ndarray, float]:
        """Move fold angles onto closure by steps of least length.

        Factors are kept from step to step as long as the residual falls fast with them.

        Parameters
        ----------
        phi
            Shape [n] [rad].
        held
            Of bool: those that stay, shape [n].
        steps
            Of Gauss-Newton at most.
        near
            A closed state nearby [n], whose factors are used to begin with.

        Returns
        -------
        phi : numpy.ndarray
            Where the steps ended.
        residual : float
            Largest entry of closure there: whether that is close enough is for the caller to say.

        Notes
        -----
        Where a factorization breaks down the steps end: this one state is not closed, whatever goes on beside it.
        """
        self.check_time()
        if self.closure.compiled.usable:
            phi, residual, lifts = self.closure.compiled.project(phi, held, steps, near)
            self.closure.lifted = phi.tobytes(), lifts
            return phi, residual
        phi = phi.copy()
        free = slice(None) if held is None or not held.any() else np.flatnonzero(~held)
        before, normal = math.inf, None
        if near is not None:
            normal = self.normal(near, () if held is None else np.flatnonzero(held))
        for _ in range(steps):
            at = self.closure.turned(phi)
            c = self.closure.values(phi, at)
            if np.abs(c).max(initial=0.0) <= ROUNDED:
                break
            size = float(np.linalg.norm(c))  # the same in every frame
            if normal is None or not size <= FALLS * before:
                try:
                    normal = Normal(self.closure.jacobian(phi, at)[:, free])
                except (np.linalg.LinAlgError, RuntimeError):  # the latter is what SuperLU says
                    break
            before = size
            d = normal.step(-c)
            phi[free] += d * min(1.0, LONGEST / max(float(np.abs(d).max(initial=0.0)), NONZERO))
        return phi, self.residual(phi)

    def multipliers(
        self, phi: np.ndarray, held: Iterable[int] = ()
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the Lagrange multipliers of closure, and of fold limits that are held.

        Parameters
        ----------
        phi
            A closed state, [n].
        held
            Creases at a fold limit.

        Returns
        -------
        closure : numpy.ndarray
            Multipliers of smallest norm, [m].
        limits : numpy.ndarray
            Moments over `scale` of the limits held, positive where they push, one each.
        imbalance : numpy.ndarray
            Torque that is left, [n].
        """
        held = list(held)
        normal, g = self.normal(phi, held), self.torque(phi)
        if held:
            free = np.setdiff1d(np.arange(self.size), held)
            lam = normal.multipliers(g[free])
            balance = g - self.closure.jacobian(phi).T @ lam
        else:
            lam = normal.multipliers(g)
            balance = g - normal.jacobian.T @ lam
        # grad U = J' lam + mu (-side): opening at - side phi has the slope -side, and mu >= 0 pushes the crease open
        limits = -self.fold_limits.side(phi)[held] * balance[held]
        balance[held] = 0.0
        return lam, limits, balance

    def hessian(self, phi: np.ndarray, multipliers: np.ndarray) -> Matrix:
        """Hessian of U - multipliers . closure over `scale`, [n, n]."""
        bent = self.closure.hessian(phi, multipliers)
        if isinstance(bent, np.ndarray):
            return np.diag(self.springs.curvature(phi)) - bent
        return sp.sparse.diags_array(self.springs.curvature(phi)).tocsr() - bent

    def along(self, phi: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return the part of v [n] that closure allows to first order at a state."""
        return self.normal(phi).along(v)

    def normal(self, phi: np.ndarray, held: Iterable[int] = ()) -> Normal:
        """Factorise J J' at a state, of the creases that are not held; the last factors are kept."""
        self.check_time()
        held = list(held)
        key = phi.tobytes()
        if self._last is None or self._last[1] != held or self._last[0] != key:
            j = self.closure.jacobian(phi)
            if held:
                j = j[:, np.setdiff1d(np.arange(self.size), held)]
            self._last = key, held, Normal(j)
        return self._last[2]

    def kernel(self, phi: np.ndarray, held: Iterable[int] = ()) -> np.ndarray:
        """Orthonormal basis, in the metric, of the null space of closure with creases held, [n, t]; dense."""
        self.check_time()
        held = list(held)
        if not held:
            return self.null_spaces(phi).kernel
        free = np.setdiff1d(np.arange(self.size), held)
        inside = null_space(dense(self.closure.jacobian(phi))[:, free] / self.root[free])
        z = np.zeros((self.size, inside.shape[1]))
        z[free] = inside
        return z

    def loose(self, phi: np.ndarray) -> bool:
        """Return whether a closed state is known to less than `DUPLICATE_TOL`: beside one where closure loses rank.

        At a smallest singular value s a residual of `ROUNDED` is a distance of ROUNDED / s, by which directions turn
        by some ROUNDED / s^2, and with them the torque along what is free.
        """
        if self.size > MOST_DENSE:
            return False
        return self.null_spaces(phi).any_between(RANK, math.sqrt(ROUNDED / DUPLICATE_TOL))

    def null_spaces(self, phi: np.ndarray) -> NullSpaces:
        """Return rank and null spaces of the Jacobian of closure in the metric; dense.

        The last ones are kept: rank, kernel and curvature of a state are asked for in turn.
        """
        key = phi.tobytes()
        if key not in self._decomposed:
            found = NullSpaces(dense(self.closure.jacobian(phi)) / self.root)
            self._decomposed.clear()
            self._decomposed[key] = found
        return self._decomposed[key]

    def rank(self, phi: np.ndarray, below: float = RANK) -> int:
        """Rank of the Jacobian of closure, singular values below a bound being zero.

        Beyond `MOST_DENSE` creases the bound is 1e-6 at least: squares of smaller ones drown in rounding.
        """
        if not self.closure.count:
            return 0
        if self.size <= MOST_DENSE:
            return self.null_spaces(phi).rank(below)
        j = self.closure.jacobian(phi)
        # on the side with fewer rows; eliminated without exchange, a symmetric matrix has as many positive pivots as
        # eigenvalues (Sylvester).  Lanczos' method would miss copies of zeros where there are many.
        # eigenvalues of J'J are squares of singular values
        square = j @ j.T if j.shape[0] < j.shape[1] else j.T @ j
        shift = max(CURVED, below**2)
        shifted = sp.sparse.csc_array(square - shift * sp.sparse.eye_array(square.shape[0]))
        lu = sp.sparse.linalg.splu(shifted, **SYMMETRIC)
        if np.array_equal(lu.perm_r, lu.perm_c):
            return int((lu.U.diagonal() > 0).sum())
        return int((np.linalg.svd(dense(j), compute_uv=False) > below).sum())
