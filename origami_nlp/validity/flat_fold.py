"""Does a vertex with mountains and valleys fold flat?

Kawasaki's and Maekawa's conditions are necessary.  A sector smaller than both neighbours must have one mountain
and one valley, and may then be crimped: folded away, so that two creases and two sectors fewer are left, which
fold flat exactly when the whole does (Bern and Hayes, "The complexity of flat origami", 1996).  Where equal
sectors leave no such choice, the layers are ordered (`check_admissible`).
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from origami_nlp.errors import OrigamiError
from origami_nlp.numerics import NOISE
from origami_nlp.pattern import FoldVertex, make_vertex
from origami_nlp.pattern_problem import check_admissible

GRAIN = NOISE / 1000
"""Places of creases [rad] are rounded to this before layers are ordered: vertices equal but for noise are one."""


def folds_flat(v: FoldVertex) -> bool | None:
    """Return whether a vertex of a crease pattern folds flat with its mountains and valleys.

    Parameters
    ----------
    v
        Of `fold_vertices`.

    Returns
    -------
    bool or None
        None where not every crease is a mountain or a valley, the vertex cannot be analysed, or its answer hangs on
        digits that its file does not have.

    Examples
    --------
    >>> from origami_nlp.validity import folds_flat
    >>> from origami_nlp.pattern import fold_vertices, parse_fold
    >>> text = '''{"vertices_coords": [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]],
    ...     "edges_vertices": [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]],
    ...     "edges_assignment": ["M", "V", "V", "V", "B", "B", "B", "B"]}'''
    >>> folds_flat(fold_vertices(*parse_fold(text))[0][0])
    True
    """
    if v.reason or v.maekawa is None:
        return None
    if v.maekawa or v.kawasaki is None or (v.kawasaki >= NOISE / 2 and not explained(v)):
        return False
    error = v.kawasaki_error if explained(v) else NOISE
    a = _balanced(np.array(v.sector_angles))
    if a.min() <= 0:
        return None
    answer = crimped(tuple(a.tolist()), v.assignment, error)
    if answer is not None:
        return answer
    answer = _ordered(_alike(a, error), v.assignment)
    # within what the error leaves open, no order of the nearest vertex is no proof
    return answer or (None if explained(v) else answer)


def explained(v: FoldVertex) -> bool:
    """Return whether a vertex misses Kawasaki's condition by no more than its coordinates leave open.

    Parameters
    ----------
    v
        Of `fold_vertices`.

    Returns
    -------
    bool
        False also where it misses it by noise only.
    """
    return v.kawasaki is not None and NOISE / 2 <= v.kawasaki <= v.kawasaki_error


def _balanced(a: np.ndarray) -> np.ndarray:
    """Return sectors whose alternating sums are equal, each moved alike."""
    signs = np.where(np.arange(len(a)) % 2, -1.0, 1.0)
    moved: np.ndarray = a - signs * (a @ signs) / len(a)
    return moved * (2 * math.pi / moved.sum())


def _alike(a: np.ndarray, error: float) -> tuple[float, ...]:
    """Return the sectors of a vertex whose creases, folded flat, coincide exactly where they do to the error."""
    at = np.cumsum(np.where(np.arange(len(a)) % 2, -a, a))
    order = np.argsort(at, kind="stable")
    for alike in np.split(order, np.flatnonzero(np.diff(at[order]) > error) + 1):
        at[alike] = at[alike].mean()
    at = np.round(at / GRAIN) * GRAIN
    return tuple(np.abs(at - np.roll(at, 1)).tolist())


def crimped(sectors: tuple[float, ...], letters: str, error: float = NOISE) -> bool | None:
    """Crimp smallest sectors until two are left; None where ones equal to within the error leave no smallest.

    Sector i lies between creases i and i + 1; the conditions of Kawasaki and Maekawa hold.
    """
    a, s = list(sectors), letters
    while len(a) > 2:
        i = a.index(min(a)) - 1
        a, s = a[i:] + a[:i], s[i:] + s[:i]  # the smallest is the second
        if a[1] > min(a[0], a[2]) - error:
            return None
        # Big-Little-Big: with one letter both neighbours lie on the same side of the small sector, and collide
        if s[1] == s[2]:
            return False
        # the crimp: three sectors become one, and its two creases cancel in the alternating sum and in the count
        a, s = [a[0] - a[1] + a[2], *a[3:]], s[0] + s[3:]
    return s[0] == s[1]


@lru_cache(maxsize=100_000)
def _ordered(sectors: tuple[float, ...], letters: str) -> bool | None:
    phi = np.array([math.pi if letter == "V" else -math.pi for letter in letters])
    whole = 2 * math.pi / math.fsum(sectors)
    try:
        vertex = make_vertex(tuple(whole * a for a in sectors))
    except OrigamiError:  # such as a sector smaller than the grain
        return None
    return check_admissible(vertex, phi).admissible
