"""Closed states that creases at their fold limits leave no degree of freedom.

Creases at +-pi and what closes them (`close_by`) cut the closed states into strata; where most of them are closed,
minima hide that no start from the interior finds.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.numerics import OUTSIDE, ROUNDED, SETTLED, distinct
from origami_nlp.problem.completion import CreaseChain, at_limits, close_by, within
from origami_nlp.problem.posed import PosedProblem


def _numbers(model: PosedProblem) -> list[int]:
    """How many candidates there are with 0 to m variables to be solved; none without fold limits."""
    n, m = model.size, model.equation_count
    if not model.has_limits or n < m:
        return []
    return [math.comb(n, k) * 2 ** (n - k) for k in range(m + 1)]


def vertices(model: PosedProblem, most: int, rng: np.random.Generator) -> np.ndarray:
    """List the closed states that the creases at +-pi leave no degree of freedom.

    At most m = `equation_count` variables are not at +-pi, and closure determines these.  All such states are listed
    where there are at most `most` candidates, else those of a sample of this size.  A candidate is a choice of 0 to m
    variables to be solved and the signs of the others; the sample holds with a candidate the one of opposite signs.
    So the list is the same under x -> -x, always; it is the same however creases are numbered where it is all of
    them, and else in distribution.

    Parameters
    ----------
    model
        Any group; without fold limits there are no such states.
    most
        Candidates at most.
    rng
        Of the sample; nothing is drawn from it where all candidates are taken.

    Returns
    -------
    numpy.ndarray
        Different states (`SETTLED`), shape [V, n], in a fixed order.  Not admissible in general: facets may cross.
        Flat foldings are among them unless creases that lie on each other can turn against each other, and so is the
        flat state of a model without degrees of freedom.

    Notes
    -----
    Where the solved creases can move (a family) there is no such state with these, but its ends are: there fewer
    variables are not at +-pi.  So these are solved too, from the first equations; the others then hold or not.
    """
    n, many = model.size, _numbers(model)
    found = [np.zeros((0, n))]
    if not many:
        return found[0]
    piece = CreaseChain(model)
    for k, number in enumerate(many):
        # half of the sample: the other half are the opposite signs
        share = most * number // (2 * sum(many))
        solve, signs = _candidates(n, k, rng, share if sum(many) > most else None)
        x = np.zeros((len(solve), n))
        x[_others(solve, n)] = signs.ravel()
        x = model.fold_limits.hold(x, x)
        states, exists, family = _solved(model, piece, x, solve)
        found.append(states[exists & ~family])
    return _different(np.concatenate(found))


def _candidates(
    n: int, k: int, rng: np.random.Generator, half: int | None
) -> tuple[np.ndarray, np.ndarray]:
    """Choose k variables to be solved [K, k] and signs of the others [K, n - k]: all, or `half` and their opposites."""
    if half is not None:
        solve, signs = _random_subsets(rng, half, n, k), _random_signs(rng, half, n - k)
        return np.tile(solve, (2, 1)), np.concatenate([signs, -signs])
    subsets = np.array(list(itertools.combinations(range(n), k)), dtype=int)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=n - k)))
    return np.repeat(subsets, len(signs), axis=0), np.tile(signs, (len(subsets), 1))


def _solved(
    model: PosedProblem, piece: CreaseChain, x: np.ndarray, solve: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Close states at fold limits by k <= m fold angles: states, which exist, which are of a family."""
    k = solve.shape[1]
    if k == piece.equation_count:
        states, exists, family = close_by(piece, True, x, solve)
        if not model.fold_limits.are_flat:
            states, exists = within(model, states, exists, solve)
        return states, exists, family
    turns, family = piece.fewer_turns(x, np.sort(solve, axis=1))
    np.put_along_axis(x, np.sort(solve, axis=1), turns, axis=1)
    # fewer unknowns than equations: solved from the first ones, the others hold or do not
    inside = model.fold_limits.inside(x, OUTSIDE).all(axis=1)
    x = at_limits(piece, x[:, None], inside[:, None], solve)[:, 0]
    if not model.fold_limits.are_flat:
        x = within(model, x[:, None], inside[:, None], solve)[0][:, 0]
    return x, inside & (piece.misses(x) <= ROUNDED), family


def _random_subsets(rng: np.random.Generator, count: int, n: int, m: int) -> np.ndarray:
    return rng.permuted(np.tile(np.arange(n), (count, 1)), axis=1)[:, :m]


def _random_signs(rng: np.random.Generator, count: int, many: int) -> np.ndarray:
    return rng.choice((-1.0, 1.0), (count, many))


def _others(solve: np.ndarray, n: int) -> np.ndarray:
    """Mask [K, n] of the variables that are not solved."""
    mask = np.ones((len(solve), n), dtype=bool)
    np.put_along_axis(mask, solve, False, axis=1)
    return mask


def _different(x: np.ndarray) -> np.ndarray:
    """Return one of each group of equal states, ordered: only neighbours along a line are compared."""
    if not len(x):
        return x
    along = x @ np.sqrt(np.arange(2.0, 2.0 + x.shape[1]))
    order = np.argsort(along, kind="stable")
    groups = np.split(x[order], np.flatnonzero(np.diff(along[order]) > x.shape[1] * SETTLED) + 1)
    return np.concatenate([g if len(g) == 1 else g[distinct(g, SETTLED)] for g in groups])
