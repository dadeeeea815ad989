"""Closed states with creases on their fold limits: all those that these leave no freedom, and random ones with some.

Creases at +-pi and what closes them (`complete`) cut the closed states into strata; where most of them are closed,
minima hide that no start from the interior finds.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.numerics import ROUNDED, SETTLED, distinct
from origami_nlp.programme.completion import Piece, complete
from origami_nlp.programme.posed import Posed

TRIES = 32
"""Batches of random strata that are drawn before fewer states than asked for are returned."""


def vertices(model: Posed, most: int, rng: np.random.Generator) -> np.ndarray:
    """List the closed states at which all but m = `equation_count` variables are at +-pi.

    All of them where there are at most `most` candidates, else those of a sample of this size.  A candidate is m
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
        Different states (`SETTLED`), shape [V, n], in a fixed order.  States with more fold angles at +-pi are among
        them, with every choice of signs of the solved ones that closes on the sheet: all flat foldings, therefore, in
        which at least n - m creases are folded and a choice of m variables closes alone.  The flat state is not.
        Not admissible in general: facets may cross.
    """
    n, m = model.size, model.equation_count
    if not model.has_limits or n < m:
        return np.zeros((0, n))
    if math.comb(n, m) * 2 ** (n - m) <= most:
        subsets = np.array(list(itertools.combinations(range(n), m)))
        signs = np.array(list(itertools.product((-1.0, 1.0), repeat=n - m)))
        solve = np.repeat(subsets, len(signs), axis=0)
        signs = np.tile(signs, (len(subsets), 1))
    else:
        solve, signs = _random_subsets(rng, most // 2, n, m), _random_signs(rng, most // 2, n - m)
        solve, signs = np.tile(solve, (2, 1)), np.concatenate([signs, -signs])
    x = np.zeros((len(solve), n))
    x[_others(solve, n)] = math.pi * signs.ravel()
    states, exists = complete(model, x, solve)
    solve = np.repeat(solve[:, None, :], 2, axis=1)
    return _different(_all_signs(model, states[exists], solve[exists]))


def random_strata(
    model: Posed, rng: np.random.Generator, count: int, closed: int | None = None
) -> np.ndarray:
    """Draw closed states with random variables at +-pi.

    Which variables are at +-pi, on which side, and which m of the others are solved is drawn without preference; what
    is left is uniform.  A state and its image under x -> -x or another numbering are equally likely.

    Parameters
    ----------
    model
        Any group.  Without fold limits no variable is held, and fold angles are drawn from [-2 pi, 2 pi], the solved
        ones with a random choice of the whole turns that keep the sheet.
    rng
        Of the draws.
    count
        States wanted.
    closed
        How many variables are at +-pi, 0 to `freedom`; None: equally many states of each number.

    Returns
    -------
    numpy.ndarray
        At most `count` states, shape [K, n], in random order; fewer where closed states are rare.
    """
    n, m = model.size, model.equation_count
    most = model.freedom if model.has_limits else 0
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


def _draw(model: Posed, rng: np.random.Generator, count: int, closed: int) -> np.ndarray:
    """Draw `count` candidates and return a random completion of each that closes."""
    n, m = model.size, model.equation_count
    order = rng.permuted(np.tile(np.arange(n), (count, 1)), axis=1)
    x = rng.uniform(-model.bound, model.bound, (count, n))
    held = math.pi * _random_signs(rng, count, closed)
    np.put_along_axis(x, order[:, m : m + closed], held, axis=1)
    states, exists = complete(model, x, order[:, :m])
    side = np.where(exists.all(axis=1), rng.integers(2, size=count), exists.argmax(axis=1))
    rows = np.arange(count)
    some = exists.any(axis=1)
    x, solve = states[rows, side][some], order[some, :m]
    return x if model.has_limits else _whole_turns(model, x, solve, rng)


def _whole_turns(
    model: Posed, x: np.ndarray, solve: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Turn random ones of the solved fold angles [K, m] by a whole turn that keeps |phi| <= 2 pi and the sheet."""
    other = x - np.copysign(2 * math.pi, x)
    chosen = np.zeros(x.shape, dtype=bool)
    np.put_along_axis(chosen, solve, rng.random(solve.shape) < 0.5, axis=1)
    turned = np.where(chosen, other, x)
    closes = Piece(model).misses(turned) <= 2 * ROUNDED
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


def _all_signs(model: Posed, x: np.ndarray, solve: np.ndarray) -> np.ndarray:
    """Add to states [K, n] those that close with other signs of solved fold angles [K, m] at +-pi."""
    solved = np.take_along_axis(x, solve, axis=1)
    at_limit = np.abs(solved) == math.pi
    more = at_limit.any(axis=1)
    out = [x]
    for signs in itertools.product((-1.0, 1.0), repeat=solve.shape[1]):
        other = x[more]
        turned = np.where(at_limit[more], signs * solved[more], solved[more])
        np.put_along_axis(other, solve[more], turned, axis=1)
        out.append(other[Piece(model).misses(other) <= 2 * ROUNDED])
    return np.concatenate(out)


def _different(x: np.ndarray) -> np.ndarray:
    """Return one of each group of equal states, ordered: only neighbours along a line are compared."""
    if not len(x):
        return x
    along = x @ np.sqrt(np.arange(2.0, 2.0 + x.shape[1]))
    order = np.argsort(along, kind="stable")
    groups = np.split(x[order], np.flatnonzero(np.diff(along[order]) > x.shape[1] * SETTLED) + 1)
    return np.concatenate([g if len(g) == 1 else g[distinct(g, SETTLED)] for g in groups])
