"""Which torques start one branch of the flat state alone, and on how few creases: linear algebra of flat velocities.

Torques f start a branch with flat velocity v if they work on it to first order, f . v != 0: a branch leaves the flat
state in either sense, v and -v, and on one of them the work is positive.  A unique fold therefore needs torques that
do no work on any other branch (Tachi and Hull, J. Mech. Robot. 9, 021008, 2017): there are such exactly if the
velocity is no linear combination of those of the others.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, islice

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import SAME_DIRECTION, coarse, first_largest

MOST_SETS = 20_000
"""Sets of creases that are gone through."""
TOGETHER = 2_000
"""Of them at a time."""
DIGITS = 12
"""Decimals of torques over the largest: more are rounding."""


@dataclass(frozen=True, repr=False)
class DrivenSet(ShortRepr):
    """Creases, and torques on them, that start one branch of the flat state and no other.

    Attributes
    ----------
    branch
        Number (1-based) of the branch.
    creases
        Numbers (1-based).
    torques
        On each, over the largest.
    work
        Of these torques for a unit motion along the branch: small where the branch all but is a combination of others.
    fewest
        Whether no set of fewer creases does; otherwise none of these can be left out, and other sets were not tried.

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp.actuation import driven_set
    >>> one, other = np.array([[0.8], [0.6]]), np.array([[0.6], [0.8]])
    >>> found = driven_set(1, one, other)
    >>> found.creases, [round(t, 3) for t in found.torques], found.fewest
    ((1, 2), [1.0, -0.75], True)
    """

    branch: int
    creases: tuple[int, ...]
    torques: tuple[float, ...]
    work: float
    fewest: bool


def driven_set(
    branch: int, target: np.ndarray, others: np.ndarray, most: int = MOST_SETS
) -> DrivenSet | None:
    """Find the fewest creases on which torques start one branch alone.

    Parameters
    ----------
    branch
        Its number (1-based).
    target
        Orthonormal basis of its flat velocities, [n, k].
    others
        Flat velocities of all others, [n, r].
    most
        Sets of creases that are gone through; 0: all creases are taken.

    Returns
    -------
    DrivenSet or None
        Of the smallest sets that with most work for the largest torque, of equal ones the first; None where no torques
        do, on however many creases.
    """
    n = len(target)
    base = _span(others)
    if not _works(_torques(target, base, np.arange(n)[None])[0]):
        return None
    if not most:
        whole = np.arange(n)
        return _found(branch, target, whole, _torques(target, base, whole[None])[0], False)
    left = most
    for size in range(1, n + 1):
        sets, best = combinations(range(n), size), None
        if math.comb(n, size) > left:
            break
        left -= math.comb(n, size)
        for some in _some(sets):
            torques = _torques(target, base, some)
            worth = np.round((torques**2).sum(axis=1) / _largest(torques), DIGITS // 2)
            worth[~_works(torques)] = 0.0
            k = int(worth.argmax())
            if worth[k] > (0.0 if best is None else best[0]):
                best = worth[k], some[k], torques[k]
        if best is not None:
            return _found(branch, target, best[1], best[2], True)
    return _irreducible(branch, target, base)


def signed_set(
    branch: int, target: np.ndarray, others: np.ndarray, signs: Sequence[int]
) -> DrivenSet | None:
    """Find sizes of torques with given signs that start one branch alone.

    Parameters
    ----------
    branch
        Its number (1-based).
    target, others
        Flat velocities, as `driven_set` takes them.
    signs
        1 or -1 on each crease that bears a torque, 0 on the others, [n].

    Returns
    -------
    DrivenSet or None
        Those with the largest least size, over the largest; None where no sizes do.

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp.actuation import signed_set
    >>> one, other = np.array([[0.8], [0.6]]), np.array([[0.6], [0.8]])
    >>> signed_set(1, one, other, (1, -1)).torques, signed_set(1, one, other, (1, 1))
    ((1.0, -0.75), None)
    """
    from scipy.optimize import linprog  # heavy: where signs alone are stated

    creases = np.flatnonzero(signs)
    sign = np.array(signs, float)[creases]
    rest, best = _span(others)[creases], None
    size = len(creases)
    for way in (*target.T, *-target.T):
        work = way[creases] * sign
        rows = np.vstack([np.c_[-np.eye(size), np.ones(size)], np.r_[-work, 1.0]])
        equal = np.c_[rest.T * sign, np.zeros(rest.shape[1])] if rest.size else None
        zero = None if equal is None else np.zeros(len(equal))
        goal, bounds = np.r_[np.zeros(size), -1.0], [(0, 1)] * (size + 1)
        found = linprog(goal, rows, np.zeros(size + 1), equal, zero, bounds, method="highs-ds")
        if found.status == 0 and found.x[-1] > max(
            SAME_DIRECTION, 0.0 if best is None else best[-1]
        ):
            best = found.x
    if best is None:
        return None
    torques = np.round(best[:-1] * sign / best[:-1].max(), DIGITS)
    work = float(np.linalg.norm(target[creases].T @ torques))
    return DrivenSet(branch, tuple((creases + 1).tolist()), tuple(torques.tolist()), work, False)


def _irreducible(branch: int, target: np.ndarray, base: np.ndarray) -> DrivenSet:
    """Leave out one crease after the other, those with the smallest torques first, as long as the others do."""
    kept = np.arange(len(target))
    while True:
        torques = np.abs(_torques(target, base, kept[None])[0])
        for k in np.argsort(coarse(torques), kind="stable"):
            fewer = np.delete(kept, k)
            if len(fewer) and _works(_torques(target, base, fewer[None])[0]):
                kept = fewer
                break
        else:
            return _found(branch, target, kept, _torques(target, base, kept[None])[0], False)


def _found(
    branch: int, target: np.ndarray, creases: np.ndarray, torques: np.ndarray, fewest: bool
) -> DrivenSet:
    largest = torques[first_largest(np.abs(torques))]
    torques = np.round(torques / largest, DIGITS)
    which = tuple((creases + 1).tolist())
    work = float(np.linalg.norm(target[creases].T @ torques))
    return DrivenSet(branch, which, tuple(torques.tolist()), work, fewest)


def _span(vectors: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of what columns span, [n, r]."""
    u, values, _ = np.linalg.svd(vectors, full_matrices=False)
    return u[:, values > SAME_DIRECTION * max(float(values.max(initial=0.0)), 1.0)]


def _torques(target: np.ndarray, base: np.ndarray, sets: np.ndarray) -> np.ndarray:
    """Return torques on each set of creases [S, m] that do no work on the others and most on the target, [S, m].

    What is left of a velocity, restricted to the creases, when those of the others are taken out of it.
    """
    rows = base[sets]  # [S, m, r]
    u, values, _ = np.linalg.svd(rows, full_matrices=False)
    u = u * (values > SAME_DIRECTION)[:, None, :]
    goal = target[sets]
    left = goal - u @ (u.swapaxes(1, 2) @ goal)
    # of a family the direction in which most is left
    which, sizes, _ = np.linalg.svd(left, full_matrices=False)
    out: np.ndarray = which[:, :, 0] * sizes[:, :1]
    return out


def _works(torques: np.ndarray) -> np.ndarray:
    """Return whether torques [..., m] work on their target: what is left of it is no rounding."""
    out: np.ndarray = np.linalg.norm(torques, axis=-1) > SAME_DIRECTION
    return out


def _largest(torques: np.ndarray) -> np.ndarray:
    out: np.ndarray = np.maximum(np.abs(torques).max(axis=1), SAME_DIRECTION)
    return out


def _some(sets: Iterator[Sequence[int]]) -> Iterator[np.ndarray]:
    while some := [*islice(sets, TOGETHER)]:
        yield np.array(some)
