"""Minima beside flat-folded states, to second order: descents from elsewhere seldom reach them.

At the flat state closure c loses rank.  Near it closed states x obey J x = 0 and x'Fx = 0 up to third order, F the
second derivative of s . c for the one s with s J = 0.  Where rest angles all but cancel on that cone, a minimum is
close to its tip, with a basin as small as its distance.  In the axes of F on the null space of J, stationary states of
the springs on the cone are y = -g / (1 + lam a), where y = sqrt(k) x, g is the torque at the flat state, a are the
curvatures of F, and the Lagrange multiplier lam solves

    h(lam) = sum_i a_i (g_i / (1 + lam a_i))^2 = 0,

which falls between the poles on both sides of lam = 0: the one root there is the lowest state of the cone.  Other
minima have one negative 1 + lam a at most: their lam lies one interval further.  Where symmetric springs do not pull
along an axis, lam may be its pole, and states lean to either side of it.

Where closure has several equations of second order beside a state, nothing is predicted.

Beside a state with creases fully folded it is the same with contacts closed.  Where a sheet is folded in half, closed
states leave along a cone in the null space of closure as far as active constraints allow, A y >= 0.  A minimum near the
folding keeps some of these rows active; on their null space it is one of the states above, with multipliers >= 0 of the
active rows.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from origami_nlp.kkt import State
from origami_nlp.numerics import NONZERO, RANK, SETTLED, dense, null_space
from origami_nlp.pattern_problem import PatternProblem

NEAR = 1.0
"""Largest fold angle of a state that second order says something about [rad]."""
PLACES = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 202)[1:-1])
"""Where h is looked at, as shares of an interval between poles: closer towards them."""
BEYOND = np.logspace(-4, 7, 200)
"""And beyond the last pole, in lengths of the interval about 0: lam grows as the state comes closer to flat."""
HALVINGS = 50


MOST_LOST = 3
"""Ranks that closure may lose: one loop has no more, and of several the equations of second order are several."""


class QuadraticCone(NamedTuple):
    """Closed states beside one at which closure loses one rank, to second order: y'Fy = 0 on the kernel.

    Attributes
    ----------
    root
        sqrt(k): y = root x, [n].
    kernel
        Of closure in y, orthonormal, [n, t].
    form, torque
        F, and the torque, on the kernel, [t, t] and [t].
    """

    root: np.ndarray
    kernel: np.ndarray
    form: np.ndarray
    torque: np.ndarray


def cone_at(problem: PatternProblem, x: np.ndarray) -> QuadraticCone | None:
    """Return the cone of closed states at one [n]; None where there is not one equation of second order."""
    root = np.sqrt(problem.parameters.stiffness)
    u, sizes, vt = np.linalg.svd(dense(problem.jacobian(x)) / root)
    rank = int((sizes > RANK * sizes.max(initial=NONZERO)).sum())
    kernel = vt[rank:].T
    if not 0 < len(u) - rank <= MOST_LOST or kernel.shape[1] < 2:
        return None
    # second derivatives of s . c without energy; of rows that depend on others by symmetry they vanish on the kernel
    each = (problem.lagrangian_hessian(x, s, (), 0.0) / np.outer(root, root) for s in u[:, rank:].T)
    forms = np.array([(kernel.T @ f @ kernel).ravel() for f in each])
    _, weights, forms = np.linalg.svd(forms, full_matrices=False)
    if (weights > RANK).sum() != 1:
        return None
    form = weights[0] * forms[0].reshape(len(kernel.T), -1)
    torque = kernel.T @ (problem.parameters.torque(x) / root)
    return QuadraticCone(root, kernel, form, torque)


def on_cone(form: np.ndarray, torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what may be minima of |y|^2 / 2 + torque . y on the cone y' form y = 0, its tip left out.

    Parameters
    ----------
    form, torque
        Shapes [t, t] and [t].

    Returns
    -------
    y, lam : numpy.ndarray
        Shapes [K, t] and [K]: y + torque + lam form y = 0.
    """
    a, axes = np.linalg.eigh(form)
    if not (len(a) > 1 and a[0] < -RANK and a[-1] > RANK):
        return np.zeros((0, len(a))), np.zeros(0)  # the cone is its tip alone
    g = axes.T @ torque
    # exactly 0 where symmetry makes it so: such an axis has no pole in h, see `_aside`
    g[np.abs(g) <= RANK * np.abs(g).max()] = 0.0
    found = [*_roots(a, g), *_aside(a, g)]
    y = np.array([y for y, _ in found]).reshape(-1, len(a)) @ axes.T
    return y, np.array([lam for _, lam in found])


def _poles(a: np.ndarray) -> list[np.ndarray]:
    """Return the poles of h below 0 and above, outwards, those that are double left out with what is beyond."""
    found = []
    for side in (a[a > RANK], a[a < -RANK]):
        poles = np.sort(np.abs(1.0 / side))[:2]
        if len(poles) == 2 and poles[1] - poles[0] <= RANK * poles[0]:
            poles = np.append(poles[:1], np.inf)
        found.append(-np.sign(side[0]) * poles)
    return found


def _roots(a: np.ndarray, g: np.ndarray) -> Iterator[tuple[np.ndarray, float]]:
    """Yield the states y with lam of the roots of h in the interval between poles about 0, and in those beside it."""
    below, above = _poles(a)
    wide = above[0] - below[0]
    grids = [below[0] + wide * PLACES]
    for side in (below, above):
        if len(side) == 1:
            grids.append(side[0] + np.sign(side[0]) * wide * BEYOND)
        elif np.isfinite(side[1]):
            grids.append(side[0] + (side[1] - side[0]) * PLACES)
    for lam in grids:
        h = _h(lam, a, g)
        change = np.flatnonzero(h[1:] * h[:-1] < 0)
        if not len(change):
            continue
        left, right, sign = lam[change], lam[change + 1], np.sign(h[change])
        for _ in range(HALVINGS):
            middle = 0.5 * (left + right)
            here = np.sign(_h(middle, a, g)) == sign
            left, right = np.where(here, middle, left), np.where(here, right, middle)
        middle = 0.5 * (left + right)
        yield from zip(-g / (1.0 + middle[:, None] * a), middle.tolist(), strict=True)


def _aside(a: np.ndarray, g: np.ndarray) -> Iterator[tuple[np.ndarray, float]]:
    """Yield states with lam, in pairs that lean to either side of an axis that nothing pulls along: lam is its pole."""
    poles = np.concatenate(_poles(a))
    for lam in poles[np.isfinite(poles)]:
        factor = 1.0 + lam * a
        at = np.abs(factor) <= RANK
        if at.sum() != 1 or g[at].any():
            continue
        y = np.where(at, 0.0, -g / np.where(at, 1.0, factor))
        # what y'Fy = 0 leaves for the component along the axis
        square = -float((a * y**2).sum()) / float(a[at][0])
        if square > 0:
            yield y + np.where(at, np.sqrt(square), 0.0), float(lam)
            yield y - np.where(at, np.sqrt(square), 0.0), float(lam)


def _h(lam: np.ndarray, a: np.ndarray, g: np.ndarray) -> np.ndarray:
    return np.asarray((a * (g / (1.0 + lam[:, None] * a)) ** 2).sum(axis=1))


MOST_FOLDED = 2
"""Variables fully folded in a folding: with more there are more contacts than a state beside it could leave."""
MOST_PIECES, MOST_ROWS = 8, 8
"""Pieces of what contacts allow at a folding, and rows of each."""
INSIDE = (1e-3, 2e-2)
"""Starts are moved off the contacts held by these shares of their distance: closing them may push them beyond."""


def beside_folded(
    problem: PatternProblem,
    states: Sequence[np.ndarray],
    moves: Sequence[Callable[[np.ndarray], np.ndarray]],
) -> Iterator[np.ndarray]:
    """Yield starts beside flat-folded states where second order says that the springs have a minimum.

    Parameters
    ----------
    problem
        The problem.
    states
        Flat-folded states, [n] each.
    moves
        Symmetries of states: of images the first is looked at.

    Yields
    ------
    numpy.ndarray
        A state that closes to second order, [n] [rad].
    """
    done: list[np.ndarray] = []
    for x in states:
        if np.count_nonzero(x) > MOST_FOLDED or _known(done, [x, *(move(x) for move in moves)]):
            continue
        done.append(x)
        state = State(problem, x)
        if not state.refused:
            yield from _beside(state)


def _known(done: list[np.ndarray], images: list[np.ndarray]) -> bool:
    return any(np.abs(image - other).max() < SETTLED for image in images for other in done)


def _beside(state: State) -> Iterator[np.ndarray]:
    """Yield starts beside one state."""
    problem: PatternProblem = state.problem  # type: ignore[assignment]
    cone = cone_at(problem, state.x)
    pieces = None if cone is None else state.contacts.combinations()
    if cone is None or pieces is None or len(pieces) > MOST_PIECES:
        return
    root, kernel, form, torque = cone
    for rows in pieces:
        if len(rows) > MOST_ROWS:
            continue
        a = state.local.openings(tuple(rows))[1] / root @ kernel
        for held in _subsets(len(rows)):
            for y in _held(form, torque, a, held):
                yield state.x + kernel @ y / root


def _subsets(count: int) -> Iterator[list[int]]:
    for size in range(count + 1):
        yield from map(list, itertools.combinations(range(count), size))


def _held(
    form: np.ndarray, torque: np.ndarray, a: np.ndarray, held: list[int]
) -> Iterator[np.ndarray]:
    """Yield minima on the cone with rows of a held, which push, and others open."""
    z = null_space(a[held]) if held else np.eye(len(form))
    if z.shape[1] < 2:
        return
    some, lam = on_cone(z.T @ form @ z, z.T @ torque)
    for y, multiplier in zip(some @ z.T, lam, strict=True):
        size = float(np.linalg.norm(y))
        # gradient of the Lagrangian: moments >= 0 of the rows held must balance it
        left = y + torque + multiplier * (form @ y)
        push = np.linalg.lstsq(a[held].T, left, rcond=None)[0]
        opens = np.delete(a @ y, held)
        if RANK < size <= NEAR and (push > 0).all() and (opens > -RANK * size).all():
            # opens every row held at the same rate and leaves the others as they are
            off = np.linalg.lstsq(a, np.isin(np.arange(len(a)), held).astype(float), rcond=None)[0]
            yield from (y + share * size * off for share in (INSIDE if held else (0.0,)))
