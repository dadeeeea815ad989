"""Is a state a local minimum on one smooth piece of the feasible set, {closure = 0, rows >= 0}?

Certificates, strongest first (numbers as in the report):
1. regular interior: reduced Hessian positive definite;
2. regular contact: multipliers positive, Hessian positive definite on the critical cone;
3. sharp: grad U . d > 0 for every d != 0 in the linearised feasible cone, which contains the
tangent cone, so that no
   constraint qualification is needed;
4. second order with a multiplier of the set (dependent contacts or singular closure): sufficient
without constraint
   qualification as well;
5. where closure loses rank: sharp in the directions that closure leaves to second order (`second_order`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from origami_nlp.kkt.multipliers import Multipliers
from origami_nlp.kkt.second_order import has_no_level_direction
from origami_nlp.kkt.state import State, Stratum
from origami_nlp.numerics import CURVED, INDEPENDENT, STATIONARY, nearest_in_cone, null_space
from origami_nlp.programme import Contact

BY_CLOSURE = "sharp: the energy grows in every direction that closure leaves to second order"

NO_MODES = np.zeros((0, 0))
MANY_ROWS = 12
"""Contacts above which a direction that opens all at once is looked for first."""
Verdict = Literal["minimum", "saddle", "not stationary", "undecided"]


@dataclass(frozen=True)
class BranchJudgement:
    """What one piece says.

    verdict, certificate: the decision and its reason in words.
    level: number of the certificate (module docstring), 0 for none.
    rows, multipliers: closed contacts of the piece and the set of their multipliers.
    regular: whether closure has full rank.  eigenvalues: of the Hessian of the Lagrangian on the
    subspace that keeps the
        loaded contacts closed, in the metric of all N fold angles, scaled energy.
    direction: a direction of descent of the linearised problem, or of negative curvature, if one
    was found.
    cone_dimension, tangent: dimension of the linearised feasible cone, and a direction in its
    relative interior [n].
    held: rows that the cone keeps closed (implicit equalities).
    modes: unit eigenvectors of `eigenvalues`, [n, e], in the metric.
    """

    verdict: Verdict
    certificate: str
    level: int
    rows: tuple[Contact, ...]
    multipliers: Multipliers
    regular: bool
    eigenvalues: np.ndarray
    direction: np.ndarray | None
    cone_dimension: int
    tangent: np.ndarray | None
    held: tuple[Contact, ...]
    modes: np.ndarray


def judge_branch(piece: Stratum, stationary: float = STATIONARY) -> BranchJudgement:
    """Judge a state on the piece of the feasible set where the contacts of `piece` (all closed) are the contacts."""
    state, rows, a = piece.state, piece.contacts, piece.slopes
    root, z, regular = state.programme.root, state.kernel, state.regular
    multipliers = piece.multiplier_set
    dimension, y, held = cone(a @ z, rows)
    tangent = None if y is None else z @ y / root
    size = 1.0 + np.abs(state.gradient).max()

    def say(  # type: ignore[no-untyped-def]
        verdict: Verdict, why: str, level: int, eig=(), direction=None, modes=NO_MODES
    ) -> BranchJudgement:
        return BranchJudgement(
            verdict,
            why,
            level,
            rows,
            multipliers,
            regular,
            np.asarray(eig, dtype=float),
            direction,
            dimension,
            tangent,
            held,
            modes,
        )

    if dimension == 0:
        return say("minimum", "isolated: the linearised feasible cone is a point", 3)
    if multipliers.residual > stationary * size:
        if not regular and _rises(piece):
            return say("minimum", BY_CLOSURE, 5)
        d = _descent(z, a, state.gradient)
        verdict: Verdict = "not stationary" if regular and not held else "undecided"
        return say(verdict, "no multipliers >= 0 balance the springs", 0, (), d / root)
    # one solution that presses on enough contacts does; all ranges are looked for only where none does
    loaded = multipliers.found > 10 * stationary * size
    s = null_space(a[loaded] @ z)
    if s.shape[1]:
        loaded = multipliers.upper > 10 * stationary * size
        s = z @ null_space(a[loaded] @ z)
    if s.shape[1] == 0:
        return say(
            "minimum", "sharp: the energy grows to first order in every feasible direction", 3
        )
    best: tuple[float, np.ndarray, np.ndarray] | None = None
    shifted = _shifts(state, s)
    for mu in multipliers.vertices:
        lam = np.linalg.lstsq(state.jacobian.T, state.gradient - a.T @ mu, rcond=INDEPENDENT)[0]
        h = s.T @ piece.hessian_with(np.concatenate([lam, mu])) @ s
        values, vectors = np.linalg.eigh(h + shifted)
        k = int(values[:, 0].argmax())
        if best is None or values[k, 0] > best[0]:
            best = (values[k, 0], values[k], s @ vectors[k])
    assert best is not None
    lowest, values, vectors = best
    scale = max(1e-300, np.abs(values).max())
    if lowest > CURVED * scale:
        if regular and multipliers.unique:
            why = "regular contact: " if rows else "regular interior: "
            where = "on the critical cone" if rows else "on the tangent space"
            return say(
                "minimum",
                why + f"Hessian positive definite {where}",
                2 if rows else 1,
                values,
                modes=vectors,
            )
        return say(
            "minimum",
            "second order: a multiplier of the set makes the Hessian positive definite",
            4,
            values,
            modes=vectors,
        )
    weak = a[~loaded]
    for column in range(vectors.shape[1]):
        if values[column] >= -CURVED * scale:
            break
        for sign in (1.0, -1.0):
            d = sign * vectors[:, column]
            if (weak @ d >= -INDEPENDENT).all() and regular and multipliers.unique:
                return say(
                    "saddle", "negative curvature along a feasible direction", 0, values, d / root
                )
    if not regular and _rises(piece):
        return say("minimum", BY_CLOSURE, 5, values)
    return say("undecided", "neither first nor second order decides", 0, values)


def _rises(piece: Stratum) -> bool:
    """Tell whether the energy grows in every direction that closure leaves to second order (all in the metric)."""
    state, z = piece.state, piece.state.kernel
    rows = np.vstack([piece.slopes @ z, -(state.gradient @ z)[None]])
    return has_no_level_direction(state.second_order, rows)


def cone(
    rows: np.ndarray, names: tuple[Contact, ...]
) -> tuple[int, np.ndarray | None, tuple[Contact, ...]]:
    """Describe the cone {y: rows y >= 0}, rows [r, t].

    Returns its dimension, a direction in its relative interior (None for a point), and the rows
    that it holds at zero.
    """
    r, t = rows.shape
    if t == 0:
        return 0, None, names
    if r == 0:
        return t, np.ones(t) / np.sqrt(t), ()
    if MANY_ROWS < r <= t:  # independent rows all open at once: no need to ask one by one
        y = np.linalg.lstsq(rows, np.ones(r), rcond=INDEPENDENT)[0]
        y /= np.linalg.norm(y)
        if (rows @ y > INDEPENDENT).all():
            return t, y, ()
    interior, closed = np.zeros(t), np.ones(r, dtype=bool)
    while closed.any():
        y = nearest_in_cone(rows[closed].sum(axis=0), rows)
        fastest = float(np.linalg.norm(y))  # how fast they open together, at unit speed
        opens = closed & (rows @ y > INDEPENDENT * fastest)
        if fastest <= INDEPENDENT or not opens.any():
            break  # none opens more than another closes, and none may close: they are held
        interior += y / fastest
        closed &= ~opens
    held = np.flatnonzero(closed).tolist()
    space = null_space(rows[held]) if held else np.eye(t)
    if space.shape[1] == 0:
        return 0, None, tuple(names[i] for i in held)
    if np.abs(interior).max() == 0:  # every row is held: any direction of the kernel
        interior = space[:, 0]
    return space.shape[1], interior / np.linalg.norm(interior), tuple(names[i] for i in held)


def _descent(z: np.ndarray, a: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """Return the steepest feasible direction of the linearised problem."""
    if a.shape[0] == 0:
        return -z @ (z.T @ gradient)
    return z @ nearest_in_cone(-z.T @ gradient, a @ z)


def _shifts(state: State, s: np.ndarray) -> np.ndarray:
    """Return what other multipliers of closure add to a Hessian on a basis s [n, t], [k, t, t]; the first adds nothing.

    Where J loses rank they are tried along each direction of its left kernel.
    """
    p, t = state.programme, s.shape[1]
    if state.regular:
        return np.zeros((1, t, t))
    left = null_space(state.jacobian.T).T
    sizes = np.concatenate([np.linspace(-4, 4, 33), [-64, -16, 16, 64]])
    scaled = s / p.root[:, None]  # from the metric to the variables
    each = [scaled.T @ p.lagrangian_hessian(state.x, w, (), 0.0) @ scaled for w in left]
    return np.concatenate([np.zeros((1, t, t)), *(sizes[:, None, None] * h for h in each)])
