"""A state of a problem, and a stratum: a state with contacts held.  What is asked twice is computed once.

Everything is in the metric of all N fold angles, y = root x with root = sqrt(multiplicity), so that a state says the
same within its symmetry and without; energies are divided by the problem's scale.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.kkt.choices import Choices
from origami_nlp.kkt.multipliers import Multipliers, find_multipliers
from origami_nlp.kkt.tangent_cone import TangentCone, cone_of
from origami_nlp.numerics import (
    CONTACT_TOL,
    DEPENDENT,
    OUTSIDE,
    RANK,
    ROUNDED,
    null_space,
    shortest_solution,
)
from origami_nlp.problem import ClosedContacts, Contact, Local, Problem

FEW = 3
"""Dependent rows of closure up to which second order is asked for row by row."""


class State:
    """A closed state x [n] of a problem.  What is asked twice is computed once.

    Parameters
    ----------
    problem
        Anything with energy, closure, contacts and their derivatives: `problem.Problem`.
    x
        Values of its variables [rad], shape [n].
    tolerance
        Opening [rad] up to which a contact counts as closed.

    Attributes
    ----------
    problem, tolerance
        As given.
    x
        Shape [n], not writable.

    Examples
    --------
    >>> from origami_nlp import State, examples, pose
    >>> flat = State(pose(examples.degree6("pi/3", ratio=1)), [0.0, 0.0, 0.0, 0.0])
    >>> flat.regular, flat.refused, flat.contacts.base
    (False, '', ())
    """

    def __init__(
        self, problem: Problem, x: Sequence[float] | np.ndarray, tolerance: float = CONTACT_TOL
    ) -> None:
        self.problem = problem
        self.x = np.array(x, dtype=float)
        self.x.setflags(write=False)
        self.tolerance = tolerance

    @cached_property
    def local(self) -> Local:
        """Values and first derivatives in the problem's variables."""
        return self.problem.local(self.x)

    @cached_property
    def gradient(self) -> np.ndarray:
        """Of the energy, in the metric, [n]."""
        return self.local.gradient / self.problem.root

    @cached_property
    def jacobian(self) -> np.ndarray:
        """Of loop closure, in the metric, [m, n]."""
        return self.local.closure_jacobian / self.problem.root

    @cached_property
    def _factors(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Singular values and vectors of `jacobian`."""
        u, values, vt = np.linalg.svd(self.jacobian)
        return u, values, vt

    @cached_property
    def kernel(self) -> np.ndarray:
        """Orthonormal basis of the null space of closure, the infinitesimal motions, in the metric, [n, t]."""
        p: Any = self.problem
        if not p.sparse:
            return np.asarray(p.kernel(self.x))
        _, values, vt = self._factors
        # paper, eq. A6: C dphi = 0, of dimension N - 3 at a regular state of a vertex without symmetry
        return vt[int((values > RANK).sum()) :].T

    @property
    def _lost(self) -> np.ndarray:
        """Orthonormal rows w with w' J = 0, [m - rank, m]."""
        p: Any = self.problem
        if not p.sparse:
            return np.asarray(p.null_spaces(self.x).lost)
        u, values, _ = self._factors
        return u.T[int((values > RANK).sum()) :]

    @cached_property
    def regular(self) -> bool:
        """Whether closed states beside this one are a manifold to second order: closure loses no rank.

        Rows that depend on each other all along the set say nothing more to second order either: their forms vanish.
        """
        return not self.second_order

    @cached_property
    def second_order(self) -> list[np.ndarray]:
        """Forms Q [t, t] on `kernel` where closure loses rank: d' Q d = 0 in every direction that states follow."""
        p: Any = self.problem
        # w with w' J = 0: rank C < 3, the singular states that the paper's appendix A does not classify
        lost = self._lost
        z = self.kernel / p.root[:, None]
        forms: Iterable[np.ndarray]
        if len(lost) > FEW:
            forms = np.einsum("lm,mtu->ltu", lost, p.closure.second(self.x, z))
        else:
            forms = (z.T @ p.lagrangian_hessian(self.x, -w, (), 0.0) @ z for w in lost)
        return [q for q in forms if float(np.abs(q).max(initial=0.0)) > RANK]

    @cached_property
    def tangent_cone(self) -> TangentCone:
        """Subspaces, in the metric, that contain the directions which states follow, where closure loses rank."""
        p: Any = self.problem
        return cone_of(p, self.x).within(p.root)

    @cached_property
    def residual(self) -> float:
        """Largest entry of loop closure."""
        return float(np.abs(self.local.closure).max(initial=0.0))

    @cached_property
    def contacts(self) -> ClosedContacts:
        """Active constraints: contacts that are closed to `tolerance`."""
        return self.problem.closed(self.x, self.tolerance)

    @property
    def limits(self) -> tuple[Contact, ...]:
        """Fold limits that are closed to `tolerance`: known without a look at facets."""
        rows = self.problem.limits
        return tuple(c for c in rows if c.at - c.side * self.x[c.index] <= self.tolerance)

    @cached_property
    def choices(self) -> Choices:
        """Choices between closed contacts, to first order."""
        return Choices(self)

    @cached_property
    def _pieces(self) -> list[tuple[Contact, ...]] | None:
        exact = self.contacts.complete
        return self.contacts.combinations() if exact else self.choices.pieces()

    @property
    def few(self) -> bool:
        """Whether the pieces that meet are few enough to be listed."""
        return self._pieces is not None

    @property
    def pieces(self) -> list[tuple[Contact, ...]]:
        """Smooth pieces of the feasible set that meet here, as contacts; where too many, only those of all of them.

        Of contacts that say the same to first order one is named.
        """
        return self._pieces or [self.contacts.base]

    @cached_property
    def refused(self) -> str:
        """Why the state is not admissible; "" where it is."""
        return self.problem.refuses(self.x, OUTSIDE)

    @property
    def energy(self) -> float:
        """Elastic energy in the scene's units."""
        return self.problem.energy(self.x)

    @property
    def fold_angles(self) -> np.ndarray:
        """All N fold angles, [N]."""
        return self.problem.expand(self.x)

    def at(self, x: np.ndarray) -> State:
        """Return another state of the same problem.

        Parameters
        ----------
        x
            Shape [n] [rad].

        Returns
        -------
        State
            With the same tolerance.
        """
        return State(self.problem, x, self.tolerance)

    def on(self, contacts: Sequence[Contact] = ()) -> Stratum:
        """Return the state with contacts held closed.

        Parameters
        ----------
        contacts
            Those held; none by default.

        Returns
        -------
        Stratum
            The state on the set where they stay closed.
        """
        return Stratum(self, tuple(contacts))

    def __repr__(self) -> str:
        angles = ", ".join(f"{v:.6g}" for v in self.fold_angles)
        return f"State([{angles}] rad, closure {self.residual:.1e})"


class Stratum:
    """A state on the set where closure holds and some contacts stay closed.

    Parameters
    ----------
    state
        The state.
    contacts
        Contacts held, r of them.

    Attributes
    ----------
    state, contacts
        As given.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> state = result.state_of(result.minima[0])
    >>> stratum = state.on(state.contacts.base)
    >>> stratum.dimension, stratum.jacobian.shape, bool((abs(stratum.imbalance) < 1e-9).all())
    (2, (3, 4), True)
    """

    def __init__(self, state: State, contacts: tuple[Contact, ...]) -> None:
        self.state, self.contacts = state, contacts

    @cached_property
    def _openings(self) -> tuple[np.ndarray, np.ndarray]:
        return self.state.local.openings(self.contacts)

    @property
    def openings(self) -> np.ndarray:
        """How far the contacts are open, [r]."""
        return self._openings[0]

    @cached_property
    def slopes(self) -> np.ndarray:
        """Gradients of the openings, in the metric, [r, n]."""
        return self._openings[1] / self.state.problem.root

    @cached_property
    def jacobian(self) -> np.ndarray:
        """Of closure and the contacts together, in the metric, [m + r, n]."""
        own = self.state.jacobian
        return np.vstack([own, self.slopes]) if self.contacts else own

    @cached_property
    def tangent(self) -> np.ndarray:
        """Orthonormal basis of the null space of closure and active constraints, in the metric, [n, t]."""
        return null_space(self.jacobian) if self.contacts else self.state.kernel

    @property
    def dimension(self) -> int:
        """Number of these directions."""
        return self.tangent.shape[1]

    @property
    def softest(self) -> np.ndarray | None:
        """Direction of lowest curvature among them, in the problem's variables, [n]; None where nothing moves."""
        z = self.tangent
        if not z.shape[1]:
            return None
        soft: np.ndarray = z @ np.linalg.eigh(z.T @ self.hessian @ z)[1][:, 0]
        return soft / self.state.problem.root

    @cached_property
    def multipliers(self) -> np.ndarray:
        """Lagrange multipliers of closure and contacts that balance the springs best, of smallest norm, [m + r]."""
        return shortest_solution(self.jacobian.T, self.state.gradient, DEPENDENT)

    @property
    def forces(self) -> np.ndarray:
        """Those of the contacts alone, positive where they push, [r]."""
        return self.multipliers[len(self.state.jacobian) :]

    @cached_property
    def multiplier_set(self) -> Multipliers:
        """All Lagrange multipliers >= 0 of the active constraints that balance the springs along closure."""
        z = self.state.kernel
        return find_multipliers((self.slopes @ z).T, z.T @ self.state.gradient)

    @cached_property
    def imbalance(self) -> np.ndarray:
        """Torque that closure and contacts leave without balance, in the metric, [n]."""
        return self.state.gradient - self.jacobian.T @ self.multipliers

    @cached_property
    def hessian(self) -> np.ndarray:
        """Hessian of the Lagrangian with `multipliers`, in the metric, [n, n]."""
        return self.hessian_with(self.multipliers)

    def hessian_with(self, multipliers: np.ndarray) -> np.ndarray:
        """Hessian of the Lagrangian with other multipliers than `multipliers`, in the metric.

        Parameters
        ----------
        multipliers
            Of closure and contacts, shape [m + r].

        Returns
        -------
        numpy.ndarray
            Shape [n, n].
        """
        p = self.state.problem
        h = p.lagrangian_hessian(self.state.x, multipliers, self.contacts)
        # y = root x is linear: derivatives by y are those by x over root
        return h / np.outer(p.root, p.root)

    @cached_property
    def stiffness(self) -> float:
        """Smallest eigenvalue of the Hessian along `tangent`; inf where nothing moves."""
        z = self.tangent
        return float(np.linalg.eigvalsh(z.T @ self.hessian @ z)[0]) if z.shape[1] else math.inf

    def response(self) -> tuple[np.ndarray, np.ndarray]:
        """Differentiate the KKT system by a load, in the metric.

        Returns
        -------
        forces : numpy.ndarray
            Of the contacts, shape [r, n].
        states : numpy.ndarray
            Shape [n, n].
        """
        n, count = len(self.state.x), len(self.jacobian)
        system = np.block(
            [[self.hessian, -self.jacobian.T], [self.jacobian, np.zeros((count,) * 2)]]
        )
        # H dx - C' dnu = dload and C dx = 0: the implicit function theorem on the KKT system
        right = np.vstack([np.eye(n), np.zeros((count, n))])
        solution = np.linalg.lstsq(system, right, rcond=ROUNDED)[0]
        return solution[n + len(self.state.jacobian) :], solution[:n]
