"""Does a vertex with mountains and valleys fold flat?

Kawasaki's and Maekawa's conditions are necessary.  Of the smallest sectors one that lies between a mountain and a
valley may be crimped: folded away, so that two creases and two sectors fewer are left, which fold flat exactly when the
whole does.  Where none does, there is a run of equal smallest sectors between creases of one letter, which do not (Bern
and Hayes, "The complexity of flat origami", 1996; Demaine and O'Rourke, "Geometric Folding Algorithms", 12.2).
"""

from __future__ import annotations

from origami_nlp.numerics import NOISE
from origami_nlp.pattern import FoldVertex


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
    a, s, sure = [*v.sector_angles], v.assignment, True
    while len(a) > 2:
        if min(a) <= 0:
            return None
        n = len(a)
        small = [i for i in range(n) if a[i] <= min(a) + error]
        # smaller than both neighbours, whatever the error
        alone = [i for i in small if min(a[i - 1], a[(i + 1) % n]) > a[i] + error]
        crimps = [i for i in small if s[i] != s[(i + 1) % n]]
        if not crimps or any(i not in crimps for i in alone):
            # within what the error leaves open, equal sectors are no proof
            return False if sure and (alone or not explained(v)) else None
        i = crimps[0] - 1
        sure &= crimps[0] in alone or not explained(v)
        a, s = a[i:] + a[:i], s[i:] + s[:i]
        # three sectors become one, and its two creases cancel in the alternating sum and in the count
        a, s = [a[0] - a[1] + a[2], *a[3:]], s[0] + s[3:]
    return s[0] == s[1] or (False if sure else None)


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
