"""What closure carries at a state, and how much of it is not unique: states of self-stress.

Multipliers lam of closure balance the springs, torque = J' lam + contacts.  Round vertex v they are a vector: half of
it is a moment that goes round the vertex from facet to facet, and half lam_v . c_i, summed over both ends of crease i,
is the torque that its spring balances.  These torques are unique; where rows of closure depend on each other,
stresses z with J' z = 0 can be added: moments across creases that springs do not feel, that bend and shear facets.
Rigid facets leave them open, elastic or thick ones would settle them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt.state import State
from origami_nlp.numerics import RANK


@dataclass(frozen=True, eq=False)
class Stress:
    """Multipliers of closure at a state.

    Attributes
    ----------
    multipliers
        Those of smallest norm, [m] [N m]: of a pattern three a vertex and six a hole.
    basis
        Orthonormal stresses that balance nothing: any sum of them may be added, [m, s].
    torque
        What the multipliers carry about each crease, J' lam [N m], [n]: unique where `unique`.
    unique
        Whether contacts leave the torques no choice either.
    left
        Largest torque that nothing balances [N m], at creases that no contact holds.
    """

    multipliers: np.ndarray
    basis: np.ndarray
    torque: np.ndarray
    unique: bool
    left: float

    @property
    def states(self) -> int:
        """Number s of independent states of self-stress: equations less rank."""
        return self.basis.shape[1]


def find_stress(state: State, held: Iterable[int] = ()) -> Stress:
    """Find the multipliers of closure at a stationary state.

    Parameters
    ----------
    state
        A closed state.
    held
        Creases that fold limits hold.

    Returns
    -------
    Stress
        The multipliers, and what may be added to them.

    Examples
    --------
    >>> import math, numpy as np, origami_nlp as o
    >>> from origami_nlp.pattern_problem import PatternProblem
    >>> from origami_nlp.kkt import find_stress
    >>> problem = PatternProblem(o.examples.pattern("miura", 4, 4))
    >>> phi, _ = problem.project(0.5 * problem.pattern.signs)
    >>> find_stress(o.State(problem, phi)).states
    4
    >>> vertex = o.Vertex((1.0, 2.0, 1.5, 2 * math.pi - 4.5))
    >>> scene = o.Scene(vertex, (1.0,) * 4, (0.5,) * 4, "none", "fold-limits")
    >>> find_stress(o.State(o.pose(scene), np.zeros(4))).states
    1
    """
    held = sorted(held)
    free = np.setdiff1d(np.arange(len(state.x)), held)
    local = state.local
    j, g = local.closure_jacobian, state.problem.scale * local.gradient
    u, values, vt = np.linalg.svd(j[:, free])
    rank = int((values > RANK).sum())
    lam = u[:, :rank] @ ((vt[:rank] @ g[free]) / values[:rank])
    torque = j.T @ lam
    basis, unique = u[:, rank:], True
    if held and basis.shape[1]:
        # of stresses that free creases do not feel, those count that held ones do not feel either
        _, felt, way = np.linalg.svd(j[:, held].T @ basis)
        many = int((felt > RANK).sum())
        basis, unique = basis @ way[many:].T, many == 0
    left = float(np.abs((g - torque)[free]).max(initial=0.0))
    return Stress(lam, basis, torque, unique, left)
