"""Newton on the KKT system: from IPOPT's answer to rounding, with the active set made definite.

IPOPT parks weakly active contacts at O(sqrt(mu)) and cannot say whether they are closed.  The
polish guesses the active set, solves the equality-constrained KKT system by Newton, and repairs the
guess (a contact that would open the wrong way is added, one that pulls is dropped) until it is
consistent.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.kkt.projection import project
from origami_nlp.kkt.state import State, Stratum
from origami_nlp.numerics import (
    ANSWERED,
    CARRIES,
    CLOSURE_TOL,
    DEPENDENT,
    EPS,
    FOLLOWED,
    NEAR_CONTACT,
    NEAR_SINGULAR_TOL,
    NONZERO,
    RANK,
    ROUNDED,
    STATIONARY,
    SUMMED,
    UNPOLISHED,
    KernelBasis,
    first_largest,
    solve_symmetric,
)
from origami_nlp.problem import Contact, Local, Problem, held

MOST_STEPS = 12
MANY = 24
"""Variables above which those at their limits are left out of the KKT system."""
LARGE = 100
"""Variables above which what closure leaves has its basis as reflections: products take n^2, not n^3."""
MOST_REPAIRS = 8
RESOLVED = 0.1
"""A state is distinguished from a singular one at a distance of which its uncertainty is at most this share."""
MOST_GUESSES = 8
"""Sets of closed contacts that are tried when the end of a path is polished."""
LONGEST_STEP = 0.5
"""A Newton step longer than this [rad] has left the neighbourhood of IPOPT's answer."""


@dataclass(frozen=True)
class Solve:
    """What IPOPT answered.

    x: fold angles [n].  status: IPOPT's return status.  residual: largest violation of closure,
    bounds and inequality rows.  pull: for each variable IPOPT's bound multiplier (scaled energy),
    for the active-set guess.
    """

    x: np.ndarray
    status: str
    iterations: int
    residual: float
    pull: np.ndarray

    @property
    def succeeded(self) -> bool:
        """Whether IPOPT reports convergence."""
        return self.status == "Solve_Succeeded"


@dataclass(frozen=True)
class Polished:
    """A state after the polish.

    x: fold angles [n].  rows: active contacts held.  closure_residual, kkt_residual: largest entry
    of loop closure, and of stationarity, contacts and sign conditions (energy divided by the mean
    stiffness).
    converged: whether Newton reached rounding, at a state that rounding distinguishes from a singular one; if
    not, x is IPOPT's answer or the nearest closed state.
    uncertainty: largest distance [rad] to the exact state that rounding of closure and torques allows.
    """

    x: np.ndarray
    rows: tuple[Contact, ...]
    closure_residual: float
    kkt_residual: float
    converged: bool
    uncertainty: float = 0.0


def polish(model: Problem, answer: Solve, guess: tuple[Contact, ...] | None = None) -> Polished:
    """Polish one answer of IPOPT; `guess` gives the active set to try first, where it is known."""
    guess = model.guess(answer.x, answer.pull) if guess is None else guess
    firm = tuple(row for row in guess if not row.is_limit or abs(answer.pull[row.index]) > ANSWERED)
    fallback: Polished | None = None
    for first in dict.fromkeys((guess, firm, ())):
        result, consistent = _repair(model, answer.x, first)
        if result is not None and consistent:
            return _at_singular_folding(model, result)
        if result is not None and fallback is None:
            fallback = result
    if fallback is not None:
        return fallback
    return Polished(answer.x, (), float(np.abs(model.closure(answer.x)[0]).max()), math.nan, False)


def exact_beside(model: Problem, state: Polished) -> Polished:
    """Return the exact singular state within `NEAR_SINGULAR_TOL` of an unpolished one, or the latter where there is
    none.

    The fold angles next to 0 and +-pi are taken for these, and the others closed; where there are others, Newton
    has to find the energy stationary along them.
    """
    flat = math.pi * np.round(state.x / math.pi)
    frozen = np.abs(state.x - flat) <= NEAR_SINGULAR_TOL
    if not frozen.any():
        return state
    y, residual = project(model, np.where(frozen, flat, state.x), frozen=frozen)
    exact = Polished(y, (), float(residual), math.nan, True)
    if frozen.all() and residual <= CLOSURE_TOL:
        return exact
    # a crease put at 0 is free to turn; only at its limit is it held
    limits = model.fold_limits
    at_limit = frozen & (limits.near(flat, 0.0) != 0) & model.has_limits
    rows = limits.contacts(flat, at_limit)
    along, _ = newton(model, exact.x, rows)
    if along is None or not along.converged or np.abs(along.x - state.x).max() > NEAR_SINGULAR_TOL:
        return state
    return along


def _at_singular_folding(model: Problem, state: Polished) -> Polished:
    """Move a state beside a flat folding where closure loses rank onto it.

    There any state at distance d closes to d^2, so that Newton stops short of the folding, or next to it.
    A state of lower energy stays where it is if closed states really lead there from the folding.
    """
    flat = math.pi * np.round(state.x / math.pi)
    y = np.where(np.abs(state.x - flat) <= UNPOLISHED, flat, state.x)
    if (y == state.x).all():
        return state
    residual, jacobian = model.closure(y)
    singular = np.linalg.svd(jacobian, compute_uv=False).min() <= RANK
    if not singular or np.abs(residual).max() > ROUNDED:
        return state
    if state.converged and model.energy_change(y, state.x) < 0 and _leads_on(model, y, state.x - y):
        return state
    return replace(state, x=y, closure_residual=float(np.abs(residual).max()))


def _leads_on(model: Problem, y: np.ndarray, direction: np.ndarray) -> bool:
    """Return whether closed states go on from y in `direction`, seen 1e-3 rad away, where d^2 is no rounding."""
    far = NEAR_SINGULAR_TOL
    guess = y + far * direction / np.linalg.norm(direction)
    x, residual = project(model, guess, steps=8)
    return bool(residual <= FOLLOWED and np.linalg.norm(x - guess) < far / 10)


def _repair(
    model: Problem, x: np.ndarray, rows: tuple[Contact, ...]
) -> tuple[Polished | None, bool]:
    """Run Newton, adding violated contacts and dropping pulling ones, until the active set is consistent."""
    best: Polished | None = None
    seen: set[tuple[Contact, ...]] = set()
    for _ in range(MOST_REPAIRS):
        key = tuple(sorted(rows))
        if key in seen:
            break
        seen.add(key)
        result, multipliers = newton(model, x, key)
        if result is None:
            break
        if result.converged and best is None:
            best = result
        violated = [c for c in model.beyond(result.x, CLOSURE_TOL) if c not in key]
        if violated:
            rows = tuple(dict.fromkeys((*key, *violated)))
        elif len(multipliers) and multipliers.min() < -ROUNDED * max(1, np.abs(multipliers).max()):
            # it pulls, however little it would open
            drop = int(first_largest(-multipliers))
            rows = key[:drop] + key[drop + 1 :]
        else:
            return _with_all_limits(model, result), result.converged
    return best, False


def _with_all_limits(model: Problem, state: Polished) -> Polished:
    """Polish once more with every crease held that may be at its limit, where the state is known better so.

    A crease that others force to its fold limit pulls by no more than rounding over their levers, so that no row holds
    it; without its row the state is known to that quotient only, with it to rounding.
    """
    if not model.has_limits or not state.converged or state.uncertainty <= CLOSURE_TOL:
        return state
    at_limit = model.fold_limits.room(state.x) <= state.uncertainty
    limits = model.fold_limits.contacts(state.x, at_limit)
    rows = tuple(sorted({*state.rows, *limits}))
    if rows == tuple(sorted(state.rows)):
        return state
    other, _ = newton(model, state.x, rows)
    if other is None or not other.converged or other.uncertainty >= state.uncertainty:
        return state
    one = float(np.abs(other.x - state.x).max()) <= state.uncertainty
    return replace(other, rows=state.rows) if one else state


def newton(
    model: Problem, start: np.ndarray, rows: tuple[Contact, ...]
) -> tuple[Polished | None, np.ndarray]:
    """Solve stationarity, closure and `rows` = 0 by Newton (least squares where they are
    dependent).

    Returns the state, or None if the steps leave the neighbourhood, and the multipliers of `rows`.
    """
    x = held(start, rows)
    many = model.size > MANY and all(c.is_limit for c in rows)
    rounded = max(ROUNDED, model.size * EPS)
    best: tuple[float, Polished, np.ndarray] | None = None
    for _ in range(MOST_STEPS):
        local = model.local(x)
        try:
            values, gradients = local.openings(rows)
        except ArithmeticError:  # where sides run along each other there is no gap between them
            return None, np.zeros(0)
        system = (_limits_out if many else _with_rows)(model, local, rows, gradients)
        multipliers, stationarity = system.multipliers, system.stationarity
        m = len(local.closure)
        # relative to the size of the terms that cancel
        size = 1.0 + np.abs(local.gradient).max()
        kkt = max(float(np.abs(stationarity).max()) / size, float(np.abs(values).max(initial=0.0)))
        closure = float(np.abs(local.closure).max(initial=0.0))
        step = system.step(np.append(local.closure, values))
        length = float(np.linalg.norm(step))
        if not math.isfinite(length) or length > LONGEST_STEP:
            return None, np.zeros(0)
        # a soft spring moves far under a residual that is small beside the stiff ones: the step shows it
        reached = kkt <= STATIONARY and closure <= rounded and length <= model.parameters.step_noise
        merit = max(kkt, closure, length)
        if best is None or merit < best[0]:
            u = _uncertainty(system) if reached else math.inf
            resolved = bool(reached) and u <= RESOLVED * _distance_to_singular(system)
            y = _closed_exactly(model, x)
            if (y != x).any():
                closure = float(np.abs(model.closure(y)[0]).max(initial=0.0))
            state = Polished(y, rows, closure, float(kkt), resolved, u)
            best = (merit, state, multipliers[m:])
        elif best[1].converged:
            break
        if length <= EPS / 2:
            break
        x = held(x + step, rows)
    assert best is not None
    merit, state, row_multipliers = best
    if not state.converged and merit > UNPOLISHED:
        return None, np.zeros(0)
    return state, row_multipliers


@dataclass(frozen=True, eq=False)
class _System:
    """The KKT system of a state: multipliers [m + r], what they leave [n], and matrices over the variables `free`.

    `factors` are singular vectors and values of the Jacobian.
    """

    multipliers: np.ndarray
    stationarity: np.ndarray
    hessian: np.ndarray
    jacobian: np.ndarray
    factors: tuple[np.ndarray, np.ndarray, np.ndarray]
    free: np.ndarray | None = None

    def step(self, values: np.ndarray) -> np.ndarray:
        """Return Newton's step [n] for values [m + r] of closure and rows."""
        count = len(self.jacobian)
        left = self.stationarity if self.free is None else self.stationarity[self.free]
        # null-space method for the Newton-KKT system (Nocedal & Wright, 16.2 and 18.1): a small singular value s of the
        # Jacobian is one of s^2 over the Hessian in the whole system, beside singular states below rounding
        large = self.jacobian.shape[1] > LARGE
        u, singular, vt = self.factors
        rank = int((singular > DEPENDENT).sum())
        move = -vt[:rank].T @ ((u[:, :rank].T @ values[:count]) / singular[:rank])
        z = vt[rank:].T
        if large and rank < self.jacobian.shape[1]:
            basis = KernelBasis(vt[:rank])
            cost = basis.coordinates((left + self.hessian @ move)[:, None])
            move = move - basis.spread(solve_symmetric(basis.within(self.hessian), cost))[:, 0]
        elif z.shape[1]:
            cost = z.T @ (left + self.hessian @ move)
            move = move - z @ np.linalg.lstsq(z.T @ self.hessian @ z, cost, rcond=ROUNDED)[0]
        if self.free is None:
            return move
        step = np.zeros(len(self.free))
        step[self.free] = move
        return step


def _with_rows(
    model: Problem, local: Local, rows: tuple[Contact, ...], gradients: np.ndarray
) -> _System:
    jacobian = np.vstack([local.closure_jacobian, gradients])
    # least-squares multipliers: a function of x alone, right to first order off the KKT point
    multipliers = np.linalg.lstsq(jacobian.T, local.gradient, rcond=DEPENDENT)[0]
    hessian = model.lagrangian_hessian(local.x, multipliers, rows)
    left = local.gradient - jacobian.T @ multipliers
    return _System(multipliers, left, hessian, jacobian, _factors(jacobian))


def _limits_out(
    model: Problem, local: Local, rows: tuple[Contact, ...], gradients: np.ndarray
) -> _System:
    """Leave out the creases at their limits: they do not move, and take what torque is left."""
    free = np.ones(len(local.x), dtype=bool)
    free[[c.index for c in rows]] = False
    jacobian = local.closure_jacobian[:, free]
    u, singular, vt = factors = _factors(jacobian)
    rank = int((singular > DEPENDENT * singular.max(initial=0.0)).sum())
    lam = u[:, :rank] @ ((vt[:rank] @ local.gradient[free]) / singular[:rank])
    left = local.gradient - local.closure_jacobian.T @ lam
    multipliers = np.concatenate([lam, gradients @ left])  # gradients are unit rows, -1 or 1
    hessian = model.lagrangian_hessian(local.x, multipliers, rows)[np.ix_(free, free)]
    return _System(multipliers, np.where(free, left, 0.0), hessian, jacobian, factors, free)


def _factors(jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Singular vectors and values, of large matrices without vectors of the null space."""
    return np.linalg.svd(jacobian, full_matrices=jacobian.shape[1] <= LARGE)


def _uncertainty(system: _System) -> float:
    """Bound how far [rad] the exact KKT point lies, given rounding of sector angles and torques.

    Special relations of the sector angles hold to `SUMMED`, and so does closure.  Beside a singular state, at
    distance s, closure has a singular value s and multipliers grow as 1/s: closure knows the state across its
    set to r / s, which turns the tangent by r / s^2, and the balance along the set is known to |torque| r / s^2
    only.
    """
    hessian, jacobian, multipliers = system.hessian, system.jacobian, system.multipliers
    large = jacobian.shape[1] > LARGE
    _, singular, vt = system.factors
    rank = int((singular > DEPENDENT).sum())
    across = vt[:rank].T / singular[:rank]  # moves by one unit of each independent constraint
    along = vt[rank:].T
    torque = 1.0 + float(np.abs(multipliers).max(initial=0.0))
    error = SUMMED * float(np.abs(across).sum(axis=1).max(initial=0.0))
    if rank < jacobian.shape[1]:
        if large:
            basis = KernelBasis(vt[:rank])
            inside, beside = basis.within(hessian), basis.coordinates(hessian @ across)
        else:
            inside, beside = along.T @ hessian @ along, along.T @ hessian @ across
        stiffness = np.abs(np.linalg.eigvalsh(inside)).min()
        tilt = SUMMED * np.abs(beside).sum() + EPS * torque
        error += float(tilt / max(stiffness, NONZERO))
    return error


def _distance_to_singular(system: _System) -> float:
    """Estimate the distance [rad] to a state where closure and contacts lose (more) rank.

    Singular values change by at most about the distance; those within rounding of 0 belong to contacts that
    are dependent all along the set.
    """
    singular = system.factors[1]
    return float(singular[singular > DEPENDENT].min(initial=math.inf))


def _closed_exactly(model: Problem, x: np.ndarray) -> np.ndarray:
    """Set fold angles within rounding of their limits to these (contacts can hold a crease there without a row).

    A crease that contacts force to its fold limit is known to the rounding of these over their levers: beyond the limit
    it is at it where the state closes there as well; elsewhere it stays beyond, for the active set to see.
    """
    y = np.where(np.abs(np.abs(x) - math.pi) <= 9 * EPS, np.copysign(math.pi, x), x)
    limits = model.fold_limits
    y = limits.hold(y, limits.near(y, 9 * EPS) * model.has_limits)
    at_limits = limits.clip(y)
    if not model.has_limits or (at_limits == y).all():
        return y
    return at_limits if np.abs(model.closure(at_limits)[0]).max() <= CLOSURE_TOL else y


def polished_nearby(
    model: Problem, x: np.ndarray, tolerance: float = NEAR_CONTACT
) -> Iterator[Polished]:
    """Return stationary states that Newton reaches within `NEAR_SINGULAR_TOL` of x [n], contacts that are closed there
    held first.

    Parameters
    ----------
    model
        The problem.
    x
        A state, shape [n] [rad].
    tolerance
        Opening [rad] up to which a contact counts as closed.

    Returns
    -------
    iterator of Polished
        One for each set of closed contacts from which Newton converges.
    """
    state = State(model, x, tolerance)
    pull = np.zeros(model.size)
    for contact in state.contacts.base:
        if contact.is_limit:
            pull[contact.index] = 1.0
    answer = Solve(x, "followed", 0, 0.0, pull)
    # the contacts that are closed first: a guess from near gaps may close one that the path never met
    if state.few:
        guesses = state.pieces[:MOST_GUESSES]
    else:  # those that push
        guesses = [_pushing(state.on(state.contacts.base))]
    for guess in (*guesses, None):
        done = polish(model, answer, guess)
        if not done.converged:
            done = exact_beside(model, done)
        if done.converged and np.abs(done.x - x).max() <= NEAR_SINGULAR_TOL:
            yield done


def _pushing(piece: Stratum) -> tuple[Contact, ...]:
    """Return the contacts with a positive multiplier."""
    forces = piece.multiplier_set.found
    return tuple(c for c, f in zip(piece.contacts, forces, strict=True) if f > CARRIES)
