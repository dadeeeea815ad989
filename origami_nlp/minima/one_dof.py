"""All minima with one degree of freedom: every curve of closed states, every root of the energy's slope on it."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.kkt import project
from origami_nlp.minima.curve import NODES, SLOW, TO_SERIES, Branches, ConfigurationCurves
from origami_nlp.minima.law_sections import slopes_with_laws
from origami_nlp.numerics import (
    ANSWERED,
    CLOSURE_TOL,
    EPS,
    FOLLOWED,
    LEVEL,
    NONZERO,
    RANK,
    RESOLVED,
    ROUNDED,
    SETTLED,
    UNPOLISHED,
    distinct,
)
from origami_nlp.problem import Contact, Model, vertices

MOST_VERTICES = 10_000
"""More candidates than a model with one degree of freedom has."""
ASIDE, FALLS = 1e-4, 1e-2
"""Distance [rad] at which curves are looked at beside a crossing, and slope of the energy there, over the torque, that
falls."""
EXACT = ("limit", "crossing")
"""Origins of candidates that are closed to rounding as they are found."""
BATCH = 256
"""States that the compiled functions take at once."""


@dataclass(frozen=True, eq=False)
class CandidateMinima:
    """Where the minima of a model with one degree of freedom can be.

    Attributes
    ----------
    states
        Candidates [K, n] [rad], closed to rounding, those with contacts and stationary ones to about 1e-8.
    contacts
        Contacts that each closes and that may hold it, as far as its origin says.
    origins
        ``stationary`` (the slope of the energy changes sign), ``limit`` (an end at |phi| = pi), ``contact`` (an
        end at a mirror, the axis or a facet) or ``crossing`` (curves cross, or a state stands alone).
    pieces
        Pieces of curves that were resolved.
    complete
        Whether every piece was resolved.
    reason
        What that rests on, or where it failed.
    curves, branches
        What was resolved.
    """

    states: np.ndarray
    contacts: tuple[tuple[Contact, ...], ...]
    origins: tuple[str, ...]
    pieces: int
    complete: bool
    reason: str
    curves: ConfigurationCurves
    branches: Branches


def trace(model: Model) -> CandidateMinima:
    """Find every state of a model with one degree of freedom that can be a minimum.

    All closed states lie on curves over the fold angle of one crease, given in closed form.  Each piece is resolved as
    a Chebyshev series, with each variable as the driver where it is the fastest; all roots of the energy's slope are
    those of a matrix.  To these come the ends of the curves: fold limits, contacts, crossings.

    Parameters
    ----------
    model
        With `dof` 1, any group and contact.

    Returns
    -------
    CandidateMinima
        Candidates, for `polish` and `classify` to decide on: not all are minima, nor admissible.

    Raises
    ------
    OptionError
        If the model has more degrees of freedom, or none.
    """
    if model.dof != 1:
        raise OptionError(
            f"a model with {model.dof} degrees of freedom has no curves to trace: need 1"
        )
    curves = ConfigurationCurves(model)
    branches, failures = curves.resolved()
    found = _CandidateList()
    for some, lift in lifts(model, curves, branches):
        _add_stationary(curves, some, lift, found)
    if model.has_limits:
        for x in vertices(model, MOST_VERTICES, np.random.default_rng(0)):
            found.add(x, model.fold_limits.contacts(x, model.fold_limits.room(x) == 0), "limit")
    for x in _crossings(curves):
        found.add(x, (), "crossing")
    if model.gaps:
        _add_contacts(curves, branches, found)
    return found.result(curves, branches, failures + found.failures)


class _CandidateList:
    """Candidates, one after the other."""

    def __init__(self) -> None:
        self.states: list[np.ndarray] = []
        self.contacts: list[tuple[Contact, ...]] = []
        self.origins: list[str] = []
        self.failures: list[str] = []

    def add(self, x: np.ndarray, contacts: tuple[Contact, ...], origin: str) -> None:
        self.states.append(x)
        self.contacts.append(contacts)
        self.origins.append(origin)

    def result(
        self, curves: ConfigurationCurves, branches: Branches, failures: list[str]
    ) -> CandidateMinima:
        """Drop what is not admissible, and what is listed twice."""
        model, pieces = curves.model, len(branches.side)
        x = np.array(self.states).reshape(-1, model.size)
        x = x[:0] if not len(x) else x
        good = np.flatnonzero(model.admissible(x, ANSWERED))
        keep = good[distinct(x[good], RESOLVED)]
        reason = (
            f"one degree of freedom: each of {pieces} pieces of the curves of closed states was resolved, and every "
            f"root of the energy's slope taken; states nearer than {SETTLED:g} rad to a crossing are not distinguished"
        )
        if failures:
            reason = "not resolved: " + "; ".join(failures[:3])
        return CandidateMinima(
            x[keep],
            tuple(self.contacts[k] for k in keep),
            tuple(self.origins[k] for k in keep),
            pieces,
            not failures,
            reason,
            curves,
            branches,
        )


def lifts(
    model: Model, curves: ConfigurationCurves, branches: Branches
) -> list[tuple[Branches, np.ndarray]]:
    """Split branches by the whole turns [L, n] [rad] that lead to states of the model, with q = +1."""
    out = []
    keys = np.concatenate([branches.odd[:, None], branches.pinned], axis=1)
    for key in np.unique(keys, axis=0):
        some = branches.take((keys == key).all(axis=1))
        odd, pinned = bool(key[0]), key[1:]
        # a variable that stands at +-pi is written as +pi or -pi by rounding
        # whole turns that lead to other fold angles within the bound
        more = pinned | (curves.period < 2 * curves.whole)
        options = [(-1.0, 0.0, 1.0) if many else (0.0,) for many in more]
        turns = np.array(list(itertools.product(*options)))
        if curves.two_lifts:
            # each whole turn changes the sign of q: as many as lead to q = +1
            turns = turns[turns.sum(axis=1) % 2 == odd]
        turns = curves.period * turns
        if len(turns):
            out.append((some, turns))
    return out


def _add_stationary(
    curves: ConfigurationCurves, b: Branches, lift: np.ndarray, found: _CandidateList
) -> None:
    """Add all states where the slope of the energy rises through zero, or touches it."""
    model = curves.model
    if model.parameters.laws is not None:
        for turns in lift:
            some, of = slopes_with_laws(model, b, turns)
            _add_roots(curves, some, turns[None], of.series[:, None], of.size[:, None], found)
            if of.left:
                found.failures.append(f"the energy's slope with hinge laws in {of.left} sections")
        return
    # dE/ds = sum_i G_i t_i along the unit tangent; springs are linear, so that a turn adds stiffness * turn
    torque = model.parameters.torque(b.x) * b.tangents
    more = model.parameters.stiffness * b.tangents
    series = np.einsum("kj,bj->bk", TO_SERIES, torque.sum(axis=2))
    steps = np.einsum("kj,bjn->bkn", TO_SERIES, more)
    series = series[:, None] + np.einsum("bkn,ln->blk", steps, lift)
    scale = (
        np.abs(torque).sum(axis=2).max(axis=1)[:, None] + LEVEL * model.parameters.stiffness.max()
    )
    _add_roots(curves, b, lift, series, scale, found)


def _add_roots(
    curves: ConfigurationCurves,
    b: Branches,
    lift: np.ndarray,
    series: np.ndarray,
    scale: np.ndarray,
    found: _CandidateList,
) -> None:
    """Add roots of slopes [B, L, NODES] at which the energy does not fall; lift: [L, n]; scale: sizes [B, 1]."""
    model = curves.model
    # |T_k| <= 1: no root where the constant is larger than the sum of all other coefficients
    may = np.abs(series[..., 0]) <= np.abs(series[..., 1:]).sum(axis=2) + LEVEL * scale
    level = np.abs(series).max(axis=2) <= LEVEL * scale  # all along: one state stands for all
    which, lifts = np.nonzero(may & ~level)
    k, where, slope = roots(series[which, lifts])
    which, lifts = (
        np.append(a[k], b) for a, b in zip((which, lifts), np.nonzero(level), strict=True)
    )
    where, slope = (np.append(a, np.zeros(level.sum())) for a in (where, slope))
    driver = b.sections.driver[which]
    way = np.sign(np.take_along_axis(b.tangents[which, NODES // 2], driver[:, None], 1)[:, 0])
    # position runs with the driver, s with the tangent: `way` is the sign between them
    rising = way * slope > -UNPOLISHED * np.broadcast_to(scale, may.shape)[which, lifts]
    which, lifts, where = which[rising], lifts[rising], where[rising]
    for x in _at(curves, b.take(which), where, lift[lifts]):
        held = (np.abs(model.fold_limits.room(x)) <= FOLLOWED) & model.has_limits
        found.add(x, model.fold_limits.contacts(x, held), "stationary")


def _at(
    curves: ConfigurationCurves, b: Branches, where: np.ndarray, lift: np.ndarray
) -> np.ndarray:
    """States of branches at positions [B] in [-1, 1], turned by [B, n], within the model's bound."""
    if not len(where):
        return np.zeros((0, curves.model.size))
    angle = b.sections.angle(where[:, None])[:, 0]
    x, _, _ = curves.states(b.sections.driver, angle)
    x = x[np.arange(len(where)), b.side]
    nodes = np.cos(np.outer(np.arccos(np.clip(where, -1, 1)), np.arange(NODES)))
    # the series only says which whole turns the exact state takes
    near = np.einsum("bk,kj,bjn->bn", nodes, TO_SERIES, b.x)
    x = x + curves.period * np.round((near - x) / curves.period)
    x = np.where(b.pinned, np.copysign(curves.period / 2, near), x) + lift
    tangents, size = curves.tangents(x)
    speed = np.abs(tangents)
    fastest = speed[np.arange(len(x)), b.sections.driver] >= SLOW * speed.max(axis=1)
    fastest &= size > RANK  # (crossings are listed by themselves)
    limits = curves.model.fold_limits
    inside = limits.inside(x, CLOSURE_TOL).all(axis=1)
    return limits.clip(x[inside & fastest])


def roots(series: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Find roots in [-1, 1] of Chebyshev series [B, NODES]: whose, where, and the slope there.

    Eigenvalues of the colleague matrix; a pair of complex ones is a double root where rounding can have split it.
    """
    if not len(series):
        return np.zeros(0, dtype=int), np.zeros(0), np.zeros(0)
    size = np.abs(series).max(axis=1, keepdims=True)
    c = series / np.maximum(size, NONZERO)
    small = np.abs(c[:, -1]) < EPS  # the matrix divides by the last one
    c[small, -1] = EPS
    n = NODES - 1
    matrix = np.zeros((len(c), n, n))
    k = np.arange(n - 1)
    matrix[:, k, k + 1] = matrix[:, k + 1, k] = 0.5
    matrix[:, 0, 1] = 1.0
    matrix[:, -1, :] -= c[:, :-1] / (2 * c[:, -1:])
    roots = np.linalg.eigvals(matrix)
    real = (np.abs(roots.imag) <= SETTLED * 100) & (np.abs(roots.real) <= 1 + SETTLED)
    which, column = np.nonzero(real)
    where = np.clip(roots[which, column].real, -1.0, 1.0)
    slopes = np.array([_slope(series[w], x) for w, x in zip(which, where, strict=True)])
    return which, where, slopes


def _slope(series: np.ndarray, where: float) -> float:
    return float(np.polynomial.chebyshev.chebval(where, np.polynomial.chebyshev.chebder(series)))


def _crossings(curves: ConfigurationCurves) -> list[np.ndarray]:
    """States where completions touch and closure is singular, in the model's bound, with no neighbour clearly lower."""
    model, shift = curves.model, ASIDE
    near, at = [np.zeros((0, model.size))], [np.zeros((0, model.size))]
    for v, angle in curves.crossings:
        x, exists, _ = curves.states(np.full(3, v), angle + np.array([0.0, shift, -shift]))
        near.append(x[1:][exists[1:]])
        at.append(x[0][exists[0]])
    beside, states = np.concatenate(near), np.concatenate(at)
    for exact in (0.0, *curves.period / 2):
        states = np.where(
            np.abs(np.abs(states) - exact) <= RESOLVED, np.copysign(exact, states), states
        )
    # no tangent where the rows of closure depend on each other
    states = states[curves.tangents(states)[1] <= RANK]
    turns = curves.period * np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=model.size)))
    out = []
    for state in states[distinct(states, RESOLVED)]:
        every = state + turns
        every = every[model.fold_limits.inside(every, CLOSURE_TOL).all(axis=1)]
        steps = beside - state
        steps -= curves.period * np.round(steps / curves.period)
        steps = steps[np.abs(steps).max(axis=1) < 1e2 * shift]
        for y in every[curves.piece.misses(every) <= 2 * ROUNDED]:
            # (without fold limits the bound is none of the energy's)
            inside = model.fold_limits.inside(y + steps, CLOSURE_TOL).all(axis=1)
            inside |= not model.has_limits
            # no minimum where the energy falls along a branch that leaves it
            torque = model.parameters.torque(y)
            if not (steps[inside] @ torque < -FALLS * shift * np.abs(torque).max()).any():
                out.append(y)
    return out


def _add_contacts(curves: ConfigurationCurves, branches: Branches, found: _CandidateList) -> None:
    """Add the states at which a gap closes."""
    model = curves.model
    for b, lift in lifts(model, curves, branches):
        inside = (np.abs(b.x) <= math.pi + SETTLED).all(axis=(1, 2))
        b = b.take(inside)
        if not len(b.side):
            continue
        for turns in lift:
            x = b.x + turns
            values = gaps_of(model, x.reshape(-1, model.size)).reshape(*x.shape[:2], -1)
            for contact in model.gaps:
                series = np.einsum("kj,bj->bk", TO_SERIES, values[..., contact.index])
                size = np.abs(series).sum(axis=1)
                # as for the slope; gaps that stay closed along a piece (size 0) have no end there
                may = np.flatnonzero(
                    (2 * np.abs(series[:, 0]) <= size + SETTLED) & (size > CLOSURE_TOL)
                )
                k, where, _ = roots(series[may])
                which = may[k]
                states = _at(curves, b.take(which), where, np.tile(turns, (len(which), 1)))
                for state in states:
                    _add_contact(model, state, contact, found)


def _add_contact(model: Model, x: np.ndarray, contact: Contact, found: _CandidateList) -> None:
    """Add the state beside x at which a gap is closed exactly, if it touches there."""
    y, residual = project(model, x, [contact])
    if residual > FOLLOWED or np.abs(y - x).max() > SETTLED * 100:
        return
    if not model.admissible(y[None], ANSWERED)[0]:
        return
    closed = model.closed(y)
    rows = dict.fromkeys(itertools.chain(closed.base, *(r for c in closed.branches for r in c)))
    held = next((r for r in rows if (r.kind, r.index) == (contact.kind, contact.index)), None)
    if held is not None:  # the row knows the side on which its gap is open
        found.add(y, (held,), "contact")


def gaps_of(model: Model, x: np.ndarray) -> np.ndarray:
    """Gaps of states [K, n], in batches of one size: the compiled functions are made once."""
    count = len(x)
    spare = np.zeros((-count % BATCH, model.size))
    x = np.concatenate([x, spare])
    return np.concatenate([model.local(part).gaps for part in np.split(x, len(x) // BATCH)])[:count]
