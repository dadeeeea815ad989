"""What a state asks of the springs that are to hold it: linear equations, and one matrix that must be positive.

At fixed fold angles x the KKT conditions are linear in the stiffness k and the torque tau = k phi0 + preload of each
crease, the moments mu of its closed contacts and the forces w of closure equations that are dependent there:

    Z_J' (root (k x - tau) - A' mu) = 0,    mu >= m t (pressed), mu >= 0 (touching),
    Z' (diag k - sum lam_i C_i - sum mu_j G_j) Z >= m t 1,    lam = (J')^+ (root (k x - tau) - A' mu) + W w.

J is the Jacobian of closure, A the gradients of the openings of the closed contacts, C and G their Hessians, all in the
metric of all fold angles; Z_J spans the kernel of J, Z that of J and of A of the pressed contacts, W the left kernel of
J.  A state that closes regularly has no w; flat and flat-folded states do, and any w that makes the matrix positive
proves a minimum.  Contacts that touch may carry moments or none: the state is in equilibrium without them.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.kkt import Stratum
from origami_nlp.numerics import (
    DEFINITE,
    EQUAL,
    INDEPENDENT,
    POSITIVE,
    RANK,
    ConeRows,
    ConicProgram,
    svector,
)
from origami_nlp.problem import Contact


@dataclass(frozen=True)
class Springs:
    """Where the springs are among the unknowns of a problem.

    Attributes
    ----------
    stiffness, torque
        Of each kind of crease (creases that the symmetry makes equal are one kind), n each.
    scale
        Of 1 / mean stiffness [rad/(N m)].
    margin
        Of t.
    """

    stiffness: slice
    torque: slice
    scale: int
    margin: int

    @classmethod
    def of(cls, kinds: int) -> Springs:
        """Return the places of n kinds of creases: k, tau, scale, t."""
        return cls(slice(0, kinds), slice(kinds, 2 * kinds), 2 * kinds, 2 * kinds + 1)

    @property
    def size(self) -> int:
        """Number of unknowns that belong to the springs."""
        return self.margin + 1

    def slopes(self, kind: np.ndarray, columns: int) -> np.ndarray:
        """Stiffness of variables [n] of these kinds, linear in the unknowns, [n, columns]."""
        return np.eye(columns)[self.stiffness.start + kind]

    def torques(self, x: np.ndarray, kind: np.ndarray, columns: int) -> np.ndarray:
        """Torques k x - tau of variables [n] of these kinds, [n, columns]."""
        return x[:, None] * self.slopes(kind, columns) - np.eye(columns)[self.torque.start + kind]


class Balance:
    """The conditions of one state on one smooth piece of the feasible set.

    Parameters
    ----------
    stratum
        The state with the contacts of the piece held.
    kind
        Which kind of crease each variable of its model is, shape [n].
    touching
        Contacts that need not press.
    loose
        Ask no contact to press, and still for stiffness only where all contacts stay closed: what every minimum
        fulfils, whichever of its contacts press.
    """

    def __init__(
        self,
        stratum: Stratum,
        kind: np.ndarray,
        touching: Collection[Contact] = (),
        loose: bool = False,
    ) -> None:
        self.stratum, self.kind = stratum, kind
        pressed = [not loose and c not in touching for c in stratum.contacts]
        self.pressed = np.array(pressed, dtype=float)
        state = stratum.state
        model, self.root = state.problem, state.problem.root
        j, self.kernel = state.jacobian, state.kernel
        u, values, vt = np.linalg.svd(j)
        rank = int((values > RANK).sum())
        # (J')^+ by the singular vectors of J that are not lost
        self.to_closure = u[:, :rank] @ (vt[:rank] / values[:rank, None])
        held = stratum.contacts if loose else [c for c in stratum.contacts if c not in touching]
        self.tangent = state.on(tuple(held)).tangent
        unit = np.outer(self.root, self.root)
        m, r = len(j), len(stratum.contacts)
        bent = [model.lagrangian_hessian(state.x, e, stratum.contacts, 0.0) for e in np.eye(m + r)]
        self.curvatures = -np.array(bent).reshape(m + r, len(state.x), len(state.x)) / unit
        self.lost = self._bent(u[:, rank:])

    def _bent(self, lost: np.ndarray) -> np.ndarray:
        """Return the part of the left kernel of J, in columns, whose equations say something to second order.

        Rows of a pattern depend on each other all along its states: their forces are self-stress, and bend nothing.
        """
        if not lost.shape[1]:
            return lost
        forms = np.tensordot(lost.T, self.curvatures[: len(lost)], 1)
        along = np.einsum("pi,kpq,qj->kij", self.kernel, forms, self.kernel)
        u, values, _ = np.linalg.svd(along.reshape(len(along), -1), full_matrices=False)
        says = int((values > RANK).sum())
        return lost if says == lost.shape[1] else lost @ u[:, :says]

    @property
    def regular(self) -> bool:
        """Whether every minimum there fulfils the conditions.

        It does where closure keeps its rank and contacts are independent along it, so that there are multipliers.  And
        it does in a state like the flat one: no contact, one equation lost, whose curvature C along the kernel of J is
        not singular and of both signs.  Closed motions then leave along all v with v C v = 0; these span the kernel,
        and an energy that does not fall along them has some w with H - w C >= 0 (Finsler's lemma).
        """
        along = self.stratum.slopes @ self.kernel
        if not self.lost.shape[1]:
            return not len(along) or int(np.linalg.matrix_rank(along, INDEPENDENT)) == len(along)
        if self.lost.shape[1] > 1 or len(along):
            return False
        # v C v = 0 needs both signs; Finsler's lemma then gives w with H - w C >= 0 where H >= 0 on these v
        values = self.lost_modes[0]
        return bool(values[0] < 0 < values[-1] and np.abs(values).min() > RANK)

    @property
    def lost_modes(self) -> tuple[np.ndarray, np.ndarray]:
        """Curvatures of the one equation that is lost, ascending, and their directions in `kernel`, in columns."""
        c = np.tensordot(self.lost[:, 0], self.curvatures[: len(self.lost)], 1)
        values, vectors = np.linalg.eigh(self.kernel.T @ c @ self.kernel)
        return values, vectors

    def pose(self, problem: ConicProgram, places: Springs, share: float, name: str) -> slice:
        """Add the conditions to a problem.

        Parameters
        ----------
        problem
            It gets unknowns and rows.
        places
            Of the springs.
        share
            m: the margin of this state is m t.
        name
            Of the state, for the words.

        Returns
        -------
        slice
            Where moments and forces w are.
        """
        r = len(self.stratum.contacts)
        own = problem.more(r + self.lost.shape[1])
        moments, forces = (slice(own.start, own.start + r), slice(own.start + r, own.stop))
        model, x = self.stratum.state.problem, self.stratum.state.x
        # a variable stands for root^2 creases, and the metric divides by root
        balance = self.root[:, None] * places.torques(x, self.kind, problem.size)
        balance[:, moments] -= self.stratum.slopes.T
        # along the kernel of J alone: multipliers of closure need not be among the unknowns
        rows = _independent(self.kernel.T @ balance)
        problem.add(EQUAL, rows, np.zeros(len(rows)), f"{name} balances")
        pull = np.eye(r, problem.size, moments.start)
        if r:
            push = pull.copy()
            push[:, places.margin] = -share * self.pressed
            words = tuple(
                f"{name} {'presses on' if p else 'does not pull at'} {model.words(c, x).text}"
                for c, p in zip(self.stratum.contacts, self.pressed, strict=True)
            )
            problem.add(POSITIVE, push, np.zeros(r), words)
        z = self.tangent
        if z.shape[1]:
            lam = self.to_closure @ balance  # J'^+ (grad - A' mu) + W w, [m, V]
            lam[:, forces] += self.lost
            along = np.einsum("pi,kpq,qj->kij", z, self.curvatures, z)
            # Z' H Z as a matrix-valued linear function of the unknowns: lam is linear in them where x is fixed
            matrix = -np.einsum("kv,kij->vij", np.vstack([lam, pull]), along)
            matrix += np.einsum("pv,pi,pj->vij", places.slopes(self.kind, problem.size), z, z)
            matrix[places.margin] -= share * np.eye(z.shape[1])
            packed = svector(matrix).T
            problem.add(DEFINITE, packed, np.zeros(len(packed)), f"{name} is stiff")
        return own


def _independent(rows: np.ndarray) -> np.ndarray:
    """Return orthogonal rows of the same span: symmetric states balance in most directions of themselves."""
    _, values, vt = np.linalg.svd(rows, full_matrices=False)
    rank = int((values > INDEPENDENT).sum())
    return values[:rank, None] * vt[:rank]


class SpringRows:
    """Rows over the springs, the scale and the margin: energies and slopes at states of a model, linear in these.

    Parameters
    ----------
    model
        Of the states.
    kinds
        Which kind each crease is, shape [N].
    """

    def __init__(self, model: Any, kinds: np.ndarray) -> None:
        self.model, self.places = model, Springs.of(int(kinds.max()) + 1)
        self.kind = np.rint(model.reduce(kinds.astype(float))).astype(int)

    def _of(self, stiffness: np.ndarray, torque: np.ndarray) -> np.ndarray:
        out = np.zeros(self.places.size)
        np.add.at(out, self.places.stiffness.start + self.kind, stiffness)
        np.add.at(out, self.places.torque.start + self.kind, torque)
        return out

    def energy(self, x: np.ndarray) -> np.ndarray:
        """Return the row whose product with the unknowns is the energy of x less that of phi = 0."""
        # sum k/2 (x - phi0)^2 less sum k/2 phi0^2 = sum k x^2 / 2 - tau x: the square of phi0 would not be linear
        return self._of(0.5 * self.model.multiplicity * x**2, -self.model.multiplicity * x)

    def slope(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return the row whose product with the unknowns is the slope of the energy at x along a step [n]."""
        step = self.model.multiplicity * step
        return self._of(x * step, -step)


def bounded(
    rows: np.ndarray, scale: np.ndarray, least: float, most: float, words: str
) -> list[ConeRows]:
    """Return what keeps energies [J], given by rows, between two bounds, which may be infinite."""
    if least == most:
        return [ConeRows.of(EQUAL, rows - least * scale, f"{words} is {least:g} J")]
    out = []
    if np.isfinite(least):
        out.append(ConeRows.of(POSITIVE, rows - least * scale, f"{words} at least {least:g} J"))
    if np.isfinite(most):
        out.append(ConeRows.of(POSITIVE, most * scale - rows, f"{words} at most {most:g} J"))
    return out
