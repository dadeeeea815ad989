"""Is a state a local minimum on one smooth branch of the feasible set, {closure = 0, rows >= 0}?

Certificates, strongest first (numbers as in the report):
1. regular interior: reduced Hessian (on the null space of closure) positive definite;
2. regular contact: Lagrange multipliers not negative, Hessian positive definite on the span of the critical cone, which
   under strict complementarity is the null space of closure and active constraints;
3. sharp: grad U . d > 0 for every d != 0 in the linearised feasible cone, which contains the tangent cone, so that no
   constraint qualification is needed;
4. second order with a multiplier of the set (dependent contacts or singular closure): sufficient without constraint
   qualification as well;
5. where closure loses rank: sharp in the directions that closure leaves to second order (`second_order`,
   `tangent_cone`), or level along each of them and curved (`level`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Literal

import numpy as np

from origami_nlp.kkt.level import curves_up
from origami_nlp.kkt.multipliers import Multipliers
from origami_nlp.kkt.second_order import has_no_level_direction
from origami_nlp.kkt.state import State, Stratum
from origami_nlp.numerics import (
    CURVED,
    INDEPENDENT,
    NONZERO,
    STATIONARY,
    nearest_in_cone,
    null_space,
    shortest_solution,
)
from origami_nlp.problem import Contact

BY_CURVES = "flat: the energy is level along every curve of states that leaves, and curves up"
BY_CLOSURE = "sharp: the energy grows in every direction that closure leaves to second order"
BY_SECOND_ORDER = "isolated: contact closes every direction that closure leaves to second order, whatever the springs"
SLIDES = "facets face to face press at borders alone, where they may slide off"

MANY_ROWS = 12
"""Contacts above which a direction that opens all at once is looked for first."""
Verdict = Literal["minimum", "saddle", "not stationary", "undecided"]


@dataclass(frozen=True)
class BranchJudgement:
    """What is shown on one smooth branch of the feasible set.

    verdict, certificate: the decision and its reason in words.
    level: number of the certificate (module docstring), 0 for none.
    rows, multipliers: active constraints of the branch and the set of their multipliers.
    regular: whether closure has full rank.
    eigenvalues: of the Hessian of the Lagrangian on the subspace that keeps the loaded contacts closed, in the metric
        of all N fold angles, scaled energy.
    direction: a direction of descent of the linearised problem, or of negative curvature, if one was found.
    cone_dimension, tangent: dimension of the linearised feasible cone, and a direction in its relative interior [n].
    held: rows that the cone keeps closed (implicit equalities).
    more: further directions [n] along which the energy falls, or curves down.
    modes: unit eigenvectors of `eigenvalues`, [n, e], in the metric.
    """

    verdict: Verdict
    certificate: str
    level: int
    rows: tuple[Contact, ...]
    multipliers: Multipliers
    cone_dimension: int
    regular: bool = True
    eigenvalues: np.ndarray = field(default_factory=lambda: np.zeros(0))
    direction: np.ndarray | None = None
    tangent: np.ndarray | None = None
    held: tuple[Contact, ...] = ()
    modes: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    more: tuple[np.ndarray, ...] = ()


def judge_branch(piece: Stratum, stationary: float = STATIONARY) -> BranchJudgement:
    """Judge a state on the piece of the feasible set where the contacts of `piece` (all closed) are the contacts."""
    found = _judge(piece, stationary)
    if found.verdict != "minimum" or found.level in (3, 5):
        return found
    # of some contacts only others that stay open to second order may press in a proof by curvature
    problem = piece.state.problem
    inner = problem.to_second_order(piece.contacts)
    if inner == piece.contacts:
        return found
    again = _judge(piece.state.on(inner), stationary)
    if again.verdict == "minimum":
        return found
    return replace(found, verdict="undecided", level=0, certificate=SLIDES)


def _judge(piece: Stratum, stationary: float) -> BranchJudgement:
    """Judge a state on a piece whose contacts stay open to second order."""
    state, rows, a = piece.state, piece.contacts, piece.slopes
    root, z, regular = state.problem.root, state.kernel, state.regular
    multipliers = piece.multiplier_set
    # linearised feasible directions, in coordinates of the kernel (Nocedal and Wright, definition 12.3)
    dimension, y, held = cone(a @ z, rows)
    tangent = None if y is None else z @ y / root
    size = 1.0 + np.abs(state.gradient).max()

    say = partial(
        BranchJudgement,
        rows=rows,
        multipliers=multipliers,
        cone_dimension=dimension,
        regular=regular,
        tangent=tangent,
        held=held,
    )

    if dimension == 0:
        # the tangent cone lies in the linearised one, whatever constraints do (Nocedal & Wright, lemma 12.2)
        return say("minimum", "isolated: the linearised feasible cone is a point", 3)
    if multipliers.residual > stationary * size:
        why = "" if regular else _rises(piece)
        if why:
            return say("minimum", why, 5)
        # Farkas: some direction of the linearised cone descends.  It is followed by states where closure has full rank
        # and one direction opens all contacts at once (no row held): the constraint qualification of Mangasarian and
        # Fromovitz; elsewhere it may lead nowhere
        d = _descent(z, a, state.gradient)
        verdict: Verdict = "not stationary" if regular and not held else "undecided"
        more = [] if regular else state.tangent_cone.slopes(state.gradient, a)[1]
        why = "no multipliers >= 0 balance the springs"
        return say(verdict, why, 0, direction=d / root, more=tuple(m / root for m in more))
    # one solution that presses on enough contacts does; all ranges are looked for only where none does
    # critical cone (Nocedal & Wright, 12.53): mu_i > 0 keeps contact i closed
    loaded = multipliers.found > 10 * stationary * size
    y = null_space(a[loaded] @ z)
    if y.shape[1]:
        loaded = multipliers.upper > 10 * stationary * size
        y = null_space(a[loaded] @ z)
    s = z @ y if loaded.any() else z
    if s.shape[1] == 0:
        return say(
            "minimum", "sharp: the energy grows to first order in every feasible direction", 3
        )
    best: tuple[float, np.ndarray, np.ndarray] | None = None
    shifted = _shifts(state, y)
    # theorem 12.6 holds with any one multiplier that balances; each is tried, with each shift of closure's own
    for mu in multipliers.vertices:
        # mu fixes the multipliers of closure up to the left kernel of J
        lam = shortest_solution(state.jacobian.T, state.gradient - a.T @ mu, INDEPENDENT)
        h = s.T @ piece.hessian_with(np.concatenate([lam, mu])) @ s
        values, vectors = np.linalg.eigh(h + shifted)
        k = int(values[:, 0].argmax())
        if best is None or values[k, 0] > best[0]:
            best = (values[k, 0], values[k], s @ vectors[k])
    assert best is not None
    lowest, values, vectors = best
    scale = max(NONZERO, np.abs(values).max())
    if lowest > CURVED * scale:
        if regular and multipliers.unique:
            why = "regular contact: " if rows else "regular interior: "
            where = "on the critical cone" if rows else "on the tangent space"
            why, level = f"{why}Hessian positive definite {where}", 2 if rows else 1
        else:
            why = "second order: a multiplier of the set makes the Hessian positive definite"
            level = 4
        return say("minimum", why, level, eigenvalues=values, modes=vectors)
    # curvature was asked for on the span of the critical cone; only a direction of the cone itself makes a saddle, and
    # the necessary condition (theorem 12.5) needs independent gradients: full rank, one multiplier
    weak = a[~loaded]
    for column in range(vectors.shape[1]):
        if values[column] >= -CURVED * scale:
            break
        for sign in (1.0, -1.0):
            d = sign * vectors[:, column]
            if (weak @ d >= -INDEPENDENT).all() and regular and multipliers.unique:
                why = "negative curvature along a feasible direction"
                return say("saddle", why, 0, eigenvalues=values, direction=d / root)
    why = "" if regular else _rises(piece)
    if why:
        return say("minimum", why, 5, eigenvalues=values)
    down = [vectors[:, k] / root for k in range(len(values)) if values[k] < -CURVED * scale]
    both = tuple(s * d for d in down for s in (1.0, -1.0))
    why = "neither first nor second order decides"
    return say("undecided", why, 0, eigenvalues=values, more=both)


def _rises(piece: Stratum) -> str:
    """Return why the energy grows in every direction that closure leaves to second order; "" if not shown."""
    state, z = piece.state, piece.state.kernel
    rows = np.vstack([piece.slopes @ z, -(state.gradient @ z)[None]])
    if has_no_level_direction(state.second_order, rows):
        return BY_CLOSURE
    if state.tangent_cone.slopes(state.gradient, piece.slopes)[0]:
        return BY_CLOSURE
    return BY_CURVES if not piece.contacts and curves_up(state) else ""


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
    # each round opens what can be opened; the sum of such directions opens all of them, and is in the relative interior
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


def _shifts(state: State, y: np.ndarray) -> np.ndarray:
    """Return what other multipliers of closure add to a Hessian on part of its kernel [., t], [k, t, t]; the first adds
    nothing.

    Where J loses rank they are tried along each direction of its left kernel.
    """
    t = y.shape[1]
    sizes = np.concatenate([np.linspace(-4, 4, 33), [-64, -16, 16, 64]])
    # w' J = 0: lam + s w balances as well, and takes s w . Hess c off the Hessian of the Lagrangian
    forms = (y.T @ q @ y for q in state.second_order)
    return np.concatenate([np.zeros((1, t, t)), *(-sizes[:, None, None] * q for q in forms)])
