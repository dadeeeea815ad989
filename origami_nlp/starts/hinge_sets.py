"""Exact singular sets of states: book folds, half-closed nets and flat foldings, and their lowest states.

Where some creases lie at 0 or +-pi and all others on one line, those turn about it as the hinges of one
book: with sigma_i = +-1 the direction of hinge i along the line, the product of all folds is a turn by
sum sigma_i phi_i about the line, so that the states that close make up a polytope

    { sum sigma_i phi_i = c,  |phi_i| <= pi },      c a multiple of pi,

of one dimension less than there are hinges: a segment for two, a polygon for three.  The energy is a
convex quadratic on it, whose lowest point is found in closed form up to one number.  Such a set has
more dimensions than closure leaves elsewhere, or keeps creases at exactly +-pi; a solver that ends next to
one is not to be believed, so the sets are searched on purpose.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from origami_nlp.folding import fold_vertex
from origami_nlp.numerics import CLOSURE_TOL, LEVEL, OUTSIDE, ROUNDED, cross
from origami_nlp.problem import Model
from origami_nlp.starts.family import Listed

MOST_VARIABLES = 8
"""Sets are listed for up to this many variables (3^8 = 6,561 patterns)."""
MOST_STEPS = 300
"""Steps towards the lowest state of a set under forces in space."""
MOST_STATES = 2000
"""Lowest states of sets that are kept, those of lowest energy first."""


class HingeSets(Listed):
    """The lowest state of each polytope of states that hinge about one line.

    Only those strictly within the polytope: its faces belong to sets with fewer hinges, its corners to the
    flat foldings.  Candidates only: whether facets cross is not asked here.

    Parameters
    ----------
    model
        Of any scene.
    """

    name = "hinge sets"
    sentence = "lowest of all that hinge about one line"

    def states(self) -> list[np.ndarray]:
        """List them by energy."""
        model = self._model
        n = model.size
        if not model.has_limits or n > MOST_VARIABLES:
            return []
        states: list[np.ndarray] = []
        for fixed, moving, turn, c in _sets(model):
            x = _lowest_of(model, fixed, moving, turn, c)
            if x is None:
                continue
            lowest = x[moving]
            # a hinge at +-pi is fully folded: that state belongs to another set; one at its stop to this one
            inside = (math.pi - np.abs(lowest) > OUTSIDE).all()
            inside &= model.fold_limits.inside(fixed).all()
            if inside and np.abs(model.closure(x)[0]).max() <= CLOSURE_TOL:
                states.append(x)  # (a piece of a symmetric state may close once round, or wind)
        states.sort(key=model.energy)
        return states[:MOST_STATES]


def _sets(model: Model) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, float]]:
    """Yield the polytopes as (fixed fold angles, moving variables, their turn about the line, c)."""
    n, group = model.size, model.variable_of_crease
    for moving, at_limit, line, sigma, q in zip(*_books(model), strict=True):
        turn = np.bincount(group, sigma * moving[group], n)[moving]
        # hinges turn back what the fully folded folds turn about the line, modulo 4 pi: q = +1
        needed = -2 * math.atan2(q[1:] @ line, q[0])
        reach = float(np.abs(turn).sum()) * math.pi
        size = model.multiplicity[at_limit]
        for signs in itertools.product((1, -1), repeat=len(size)):
            # each fold by -pi in place of +pi changes the sign of q: half a turn of 4 pi
            flips = int(size[np.array(signs) < 0].sum()) if signs else 0
            fixed = np.zeros(n)
            fixed[at_limit] = math.pi * np.array(signs)
            for k in range(-n, n + 1):
                c = needed + 2 * math.pi * flips + 4 * math.pi * k
                if abs(c) < reach - CLOSURE_TOL:
                    yield fixed, np.flatnonzero(moving), turn, c


def _books(model: Model) -> tuple[np.ndarray, ...]:
    """Find the ways in which some variables turn about one line while the others stay flat or fully folded.

    Returns for each of K ways which variables move and which are fully folded at pi, [K, n] each, the line [K, 3], the
    direction of each crease along it [K, N] (rounded: +-1 for those that move), and the product of all folds [K, 4].
    """
    vertex, group = model.scene.vertex, model.variable_of_crease
    kinds = np.array(
        list(itertools.product((0, 1, 2), repeat=model.size))
    )  # flat, fully folded, moving
    kinds = kinds[(kinds[:, group] == 2).sum(axis=1) >= 2]
    n = model.size
    creases, q = fold_vertex(vertex, math.pi * np.indices((2,) * n).reshape(n, -1).T[:, group])
    which = (kinds == 1) @ 2 ** np.arange(n)[::-1]  # what moves is flat here: few different ones
    creases, q = creases[which], q[which]
    hinges, flat = kinds[:, group] == 2, kinds[:, group] == 0
    line = creases[np.arange(len(kinds)), hinges.argmax(axis=1)]
    on_line = np.linalg.norm(cross(creases, line[:, None]), axis=-1) <= CLOSURE_TOL
    # or hinges could not turn back what the fully folded folds turn
    about_it = np.linalg.norm(cross(q[:, 1:], line), axis=-1) <= CLOSURE_TOL
    # a flat crease on the line may turn as well: part of a larger set
    book = about_it & (on_line | ~hinges).all(axis=1) & ~(on_line & flat).any(axis=1)
    sigma = np.round(np.einsum("kni,ki->kn", creases, line))
    return tuple(a[book] for a in (kinds == 2, kinds == 1, line, sigma, q))


def _lowest_of(
    model: Model, fixed: np.ndarray, moving: np.ndarray, turn: np.ndarray, c: float
) -> np.ndarray | None:
    """Return the lowest state [n] of a polytope; under forces in space, one that is lowest near by.

    Springs alone: in one step.  Else that step is made again and again, with stiffer springs where it climbs.
    """
    p = model.parameters
    weight, free = p.stiffness[moving], p.rest[moving]
    x: np.ndarray | None = None
    for _ in range(1 if p.plain else MOST_STEPS):
        limits = model.fold_limits.low[moving], model.fold_limits.high[moving]
        lowest = _lowest(weight, free, turn, c, limits)
        if lowest is None:
            return None
        y = fixed.copy()
        y[moving] = lowest
        if x is not None and np.abs(y - x).max() <= ROUNDED:
            return y
        if x is not None and p.energy_change(x, y) > LEVEL * weight.sum():
            weight = 2 * weight
        else:
            x = y
        free = x[moving] - p.torque(x)[moving] / weight
    return x if p.plain else None  # a state that is nearly lowest would stand for the one that is


def _lowest(
    weight: np.ndarray,
    rest: np.ndarray,
    turn: np.ndarray,
    c: float,
    limits: tuple[np.ndarray, np.ndarray],
) -> np.ndarray | None:
    """Minimise sum weight (x - rest)^2 over turn . x = c and fold limits (low, high).

    x = clip(rest + s turn / weight) for the s at which turn . x, which grows with s, is c.
    """
    if not turn.any():
        return rest if abs(c) <= CLOSURE_TOL else None
    slope = turn / weight

    def at(s: float) -> np.ndarray:
        return np.clip(rest + s * slope, *limits)

    used = turn != 0
    # turn . at(s) is piecewise linear and does not fall: c lies between two bends, where hinges reach their limits
    bends = np.concatenate([(b[used] - rest[used]) / slope[used] for b in limits])
    bends = np.sort(bends)
    values = np.array([turn @ at(s) for s in bends])
    k = int(np.searchsorted(values, c))
    if k == 0 or k == len(bends):
        return at(float(bends[min(k, len(bends) - 1)]))
    low, high = bends[k - 1], bends[k]
    share = (c - values[k - 1]) / (values[k] - values[k - 1])
    return at(float(low + share * (high - low)))
