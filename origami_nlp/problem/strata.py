"""Closed states with creases at their fold limits: all rigid ones, and random ones with degrees of freedom left.

Creases at +-pi and what closes them (`complete`) cut the closed states into strata; where most of them are closed,
minima hide that no start from the interior finds.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.numerics import OUTSIDE, ROUNDED, SETTLED, distinct
from origami_nlp.problem.completion import CreaseChain, at_limits, close_by, complete, within
from origami_nlp.problem.posed import PosedProblem

TRIES = 32
"""Batches of random strata that are drawn before fewer states than asked for are returned."""


def _numbers(model: PosedProblem) -> list[int]:
    """How many candidates there are with 0 to m variables to be solved; none without fold limits."""
    n, m = model.size, model.equation_count
    if not model.has_limits or n < m:
        return []
    return [math.comb(n, k) * 2 ** (n - k) for k in range(m + 1)]


def vertex_candidates(model: PosedProblem) -> int:
    """Count the candidates of `vertices`: with as many as this asked for, it lists all of its states.

    Parameters
    ----------
    model
        Any group.

    Returns
    -------
    int
        Choices of at most m = `equation_count` variables and of signs of the others; 0 without fold limits.
    """
    return sum(_numbers(model))


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


def random_strata(
    model: PosedProblem, rng: np.random.Generator, count: int, closed: int | None = None
) -> np.ndarray:
    """Draw closed states with random variables at +-pi.

    Which variables are at +-pi, on which side, and which m of the others are solved is drawn without preference; what
    is left is uniform.  A state and its image under x -> -x or another numbering are equally likely.

    Parameters
    ----------
    model
        Any group.  Without fold limits no variable is held, and fold angles are drawn from [-2 pi, 2 pi], the solved
        ones with a random choice of the whole turns that keep q = +1.
    rng
        Of the draws.
    count
        States wanted.
    closed
        How many variables are at +-pi, 0 to `dof`; None: equally many states of each number.

    Returns
    -------
    numpy.ndarray
        At most `count` states, shape [K, n], in random order; fewer where closed states are rare.
    """
    n, m = model.size, model.equation_count
    most = model.dof if model.has_limits else 0
    numbers = range(max(most, 0) + 1) if closed is None else (closed,)
    if n < m:
        return np.zeros((0, n))
    drawn = []
    for number, share in zip(numbers, np.array_split(np.arange(count), len(numbers)), strict=True):
        found = [np.zeros((0, n))]
        for _ in range(TRIES):
            missing = len(share) - sum(map(len, found))
            if missing <= 0:
                break
            found.append(_draw(model, rng, 2 * missing + 8, number))
        drawn.append(np.concatenate(found)[: len(share)])
    return rng.permutation(np.concatenate(drawn))


def _draw(model: PosedProblem, rng: np.random.Generator, count: int, closed: int) -> np.ndarray:
    """Draw `count` candidates and return a random completion of each that closes."""
    n, m = model.size, model.equation_count
    # the first m are solved, the next `closed` are at +-pi, the others stay uniform
    order = rng.permuted(np.tile(np.arange(n), (count, 1)), axis=1)
    limits = model.fold_limits
    x = rng.uniform(limits.low, limits.high, (count, n))
    held = np.zeros((count, n))
    np.put_along_axis(held, order[:, m : m + closed], _random_signs(rng, count, closed), axis=1)
    x = limits.hold(x, held)
    states, exists = complete(model, x, order[:, :m])
    side = np.where(exists.all(axis=1), rng.integers(2, size=count), exists.argmax(axis=1))
    rows = np.arange(count)
    some = exists.any(axis=1)
    x, solve = states[rows, side][some], order[some, :m]
    return x if model.has_limits else _whole_turns(model, x, solve, rng)


def _whole_turns(
    model: PosedProblem, x: np.ndarray, solve: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Turn random ones of the solved fold angles [K, m] by a whole turn that keeps |phi| <= 2 pi and q."""
    other = x - np.copysign(2 * math.pi, x)
    chosen = np.zeros(x.shape, dtype=bool)
    np.put_along_axis(chosen, solve, rng.random(solve.shape) < 0.5, axis=1)
    turned = np.where(chosen, other, x)
    closes = CreaseChain(model).misses(turned) <= 2 * ROUNDED
    return np.where(closes[:, None], turned, x)


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
