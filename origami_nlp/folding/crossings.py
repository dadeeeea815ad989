"""Which facets of many folded vertices cross, by which row each crossing is undone, and the stack rule.

A *row* (k, j) is ray k on facet j, the arc from ray j to the next: its value is det(c_j, c_{j+1}, c_k) / sin alpha_j,
0 where the ray lies in the plane of the facet.  For k - j in {0, 1, 2, N - 1} (mod N) there is none: the ray bounds
the facet, or its neighbour, and meets it only where the crease between is folded to +-pi.

Two arcs cross where their four ends alternate; each end is off the plane of the other arc by the sine of its distance
from the common point times that of the angle between the arcs.  So the smallest of the four belongs to the end nearest
to the common point, its foot lies on the other arc, and its row is the nearest exit.

Where a crease is folded to +-pi the tip of its narrower facet lies *on* the wider one, and the sines of a crossing
there vanish: the facet that goes on from the tip may leave only to the side that the fold left open (`stack_depths`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from origami_nlp.numerics import CONTACT_TOL, NONZERO, cross, first_largest


@dataclass(frozen=True, eq=False)
class CrossedPairs:
    """CrossedPairs of facet pairs at K states.

    Attributes
    ----------
    depth
        Sine of the smallest angle of an end off the other facet's plane, 0 where a pair does not cross, [K, P].
    row
        The row (k, j) that undoes the crossing by the smallest of these, [K, P, 2]; (-1, -1) where the pair has none.
    value
        The value of that row, [K, P]: where the pair crosses, the row must change its sign.
    """

    depth: np.ndarray
    row: np.ndarray
    value: np.ndarray


def find_crossings(
    rays: np.ndarray, pairs: Sequence[tuple[int, int]] | np.ndarray, real: np.ndarray | None = None
) -> CrossedPairs:
    """Return which pairs of facets cross at many states, how deep, and by which row each is undone.

    Parameters
    ----------
    rays
        Deformed unit rays of closed vertices in order, shape [K, N, 3].
    pairs
        Non-adjacent facets (positions of their first rays), shape [P, 2].
    real
        Which of `pair_rows` are rows, shape [P, 4]; None: those of a whole vertex.

    Returns
    -------
    CrossedPairs
        Depth as `pair_depths`, and a row of each pair.
    """
    n = rays.shape[1]
    ends = _ends(_pairs(pairs), n)
    table, v = ends[0], _off_planes(rays, *ends)
    a_row = _is_row(table, n) if real is None else real
    # the smallest of the four belongs to the end nearest to the common point
    nearest = first_largest(np.where(a_row, -np.abs(v), -np.inf))  # [K, P]
    at = np.arange(len(table))
    row = np.where(a_row.any(axis=-1, keepdims=True), table[at, nearest], -1)
    value = _SIGNS[nearest] * np.take_along_axis(v, nearest[..., None], axis=-1)[..., 0]
    return CrossedPairs(_depth(v), row, value)


def pair_depths(rays: np.ndarray, pairs: Sequence[tuple[int, int]] | np.ndarray) -> np.ndarray:
    """Return how deep pairs of facets cross, 0 where they do not; facet i is the arc from ray i to the next.

    Parameters
    ----------
    rays
        Unit vectors, shape [..., R, 3].
    pairs
        Positions of the facets, shape [P, 2].

    Returns
    -------
    numpy.ndarray
        Sine of the smallest angle of an end off the other facet's plane, of facets that cross, shape [..., P].
    """
    return _depth(_off_planes(rays, *_ends(_pairs(pairs), rays.shape[-2])))


def facet_heights(rays: np.ndarray, facets: np.ndarray | None = None) -> np.ndarray:
    """Return the sines of rays [..., R, 3] off the planes of facets (all, or [F] of them), [..., F, R]."""
    first = np.arange(rays.shape[-2]) if facets is None else facets
    normals = cross(rays[..., first, :], rays[..., (first + 1) % rays.shape[-2], :])
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), NONZERO)
    return np.asarray(normals @ rays.swapaxes(-1, -2))


def depths_at(heights: np.ndarray, pairs: Sequence[tuple[int, int]] | np.ndarray) -> np.ndarray:
    """Return `pair_depths` of a state where the heights of all rays off all facets are known, [N, N]."""
    table = _ends(_pairs(pairs), len(heights))[0]
    return _depth(heights[table[:, :, 1], table[:, :, 0]] * _SIGNS)


# of j and j + 1 on facet i, i and i + 1 on facet j: where ends alternate, heights times these have one sign
_SIGNS = np.array([1.0, -1.0, -1.0, 1.0])


Pairs = tuple[tuple[int, int], ...]


def _pairs(pairs: Sequence[tuple[int, int]] | np.ndarray) -> Pairs:
    return pairs if isinstance(pairs, tuple) else tuple((int(i), int(j)) for i, j in pairs)


@lru_cache(maxsize=256)
def _ends(pairs: Pairs, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return `pair_rows` [P, 4, 2], the facets that they are on, and which of these each end is on [P, 4]."""
    table = pair_rows(pairs, count)
    facets, on = np.unique(table[:, :, 1], return_inverse=True)
    return table, facets, on.reshape(table.shape[:2])


def _off_planes(
    rays: np.ndarray, table: np.ndarray, facets: np.ndarray, on: np.ndarray
) -> np.ndarray:
    """Sines of the ends of pairs (`_ends`) off the other facet, [..., P, 4]: of one sign where they cross."""
    return np.asarray(facet_heights(rays, facets)[..., on, table[:, :, 0]] * _SIGNS)


def _depth(v: np.ndarray) -> np.ndarray:
    # all of one sign: the ends alternate around a common point (mixed signs: they miss, or meet antipodally)
    return np.asarray(np.maximum(np.maximum(v.min(axis=-1), (-v).min(axis=-1)), 0.0))


def pair_rows(pairs: Sequence[tuple[int, int]] | np.ndarray, count: int) -> np.ndarray:
    """Return the ends of each pair (i, j) on the other facet: j on i, j + 1 on i, i on j, i + 1 on j.

    Parameters
    ----------
    pairs
        Facets, shape [P, 2].
    count
        Number of rays N.

    Returns
    -------
    numpy.ndarray
        (k, j) of each end, shape [P, 4, 2]; those with k - j in {2, N - 1} are fold limits, no rows.
    """
    i, j = np.asarray(pairs, dtype=int).reshape(-1, 2).T % count
    ends = ((j, i), (j + 1, i), (i, j), (i + 1, j))
    return np.stack([np.stack([k % count, on], axis=-1) for k, on in ends], axis=1)


def _is_row(rows: np.ndarray, count: int) -> np.ndarray:
    """Return which (k, j) are rows, shape [..., 2] -> [...]."""
    apart = (rows[..., 0] - rows[..., 1]) % count
    return np.asarray((apart >= 3) & (apart <= count - 2))


@dataclass(frozen=True, eq=False)
class StackRule:
    """What follows a closed crease, for the sector angles of one vertex.

    Attributes
    ----------
    end
        The crease e at the tip of the narrower facet at each crease i, [N]; -1 where both are equally wide.
    row
        The row (k, j) that is 0 where phi_e = 0, given that crease i is closed, [N, 2]; its open side is that to which
        crease i is folded.
    """

    end: np.ndarray
    row: np.ndarray


def stack_rule(sectors: Sequence[float] | np.ndarray) -> StackRule:
    """Return for each crease i which crease e may not turn on to its side once i is closed, and by which row.

    With crease i at a pi, a = +-1, its two facets lie on each other, the one that is entered later on the side a of the
    other.  The tip of the narrower one, crease e, lies on the wider one, and the facet that goes on from there
    passes through it unless a phi_e <= 0, or phi_e = a pi too.

    Parameters
    ----------
    sectors
        Sector angles, shape [N].

    Returns
    -------
    StackRule
        By crease.  Facets whose widths differ by `CONTACT_TOL` at most end on each other, and nothing is said of them.
    """
    alpha = np.asarray(sectors, dtype=float)
    n = len(alpha)
    i = np.arange(n)
    later, before = alpha, np.roll(alpha, 1)  # facets i and i - 1 meet at crease i
    forward = later < before
    end = np.where(forward, i + 1, i - 1) % n
    # the facet beyond the tip ends on the wide facet, or the wide facet's far end lies on it
    fits_forward = later + np.roll(alpha, -1) <= before
    fits_back = before + np.roll(alpha, 2) <= later
    k = np.where(forward, np.where(fits_forward, i + 2, i - 1), np.where(fits_back, i - 2, i + 1))
    j = np.where(forward, np.where(fits_forward, i - 1, i + 1), np.where(fits_back, i, i - 2))
    end[np.abs(later - before) <= CONTACT_TOL] = -1
    return StackRule(end, np.stack([k % n, j % n], axis=-1))


def stack_depths(rule: StackRule, fold_angles: np.ndarray, at_limit: np.ndarray) -> np.ndarray:
    """Return how deep facets cross that the stack rule keeps apart; crossings that `find_crossings` cannot see.

    It is a necessary condition on two facets and the one that follows; stacks of more layers are for
    `check_admissible`.

    Parameters
    ----------
    rule
        Of the vertex.
    fold_angles
        Closed states, shape [K, N] [rad].
    at_limit
        Which creases are closed, and to which side, shape [K, N], in {-1, 0, 1}.

    Returns
    -------
    numpy.ndarray
        By closed crease, [K, N]: sine of the angle by which the facet beyond the tip goes to the wrong side, 0 where it
        does not.  Two creases of one facet narrower than both its neighbours, closed to the same side, enclose
        the wider of them: 1.
    """
    e = rule.end
    depth = np.maximum(at_limit * np.sin(fold_angles[:, e]), 0.0)
    # folded on to the same side, the next facet is tucked in: that asks for room up to crease i
    mutual = rule.end[e] == np.arange(len(e))  # e's narrower facet is the same one
    depth[(at_limit * at_limit[:, e] > 0) & mutual] = 1.0
    depth[:, e < 0] = 0.0
    return depth


def row_values(rays: np.ndarray, k: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Return det(c_j, c_{j+1}, c_k) / sin alpha_j: how far ray k is off the plane of facet j, to its left.

    Parameters
    ----------
    rays
        Deformed unit rays in order, shape [K, N, 3].
    k, j
        Rows of each state, shape [K, R].

    Returns
    -------
    numpy.ndarray
        Sines of the angles, shape [K, R].
    """
    at = np.arange(len(rays))[:, None]
    normal = cross(rays[at, j], rays[at, (j + 1) % rays.shape[1]])
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), NONZERO)
    return (normal * rays[at, k]).sum(axis=-1)


def tip_depths(rays: np.ndarray, touches: np.ndarray) -> np.ndarray:
    """Return how far facets beside a crease that lies on another facet reach through that facet.

    Where the facets are in general position, `find_crossings` sees another crossing of the same facets' neighbours too;
    in a stack, where these lie in one plane, it may not.

    Parameters
    ----------
    rays
        Deformed unit rays of closed vertices in order, shape [K, N, 3].
    touches
        Rows (k, j, side) that are 0, with the ray on the arc, shape [K, S, 3]; side 0 for an empty slot.

    Returns
    -------
    numpy.ndarray
        Sine of the angle by which the far end of facet k - 1 or k is on the wrong side of facet j, shape [K, S].
    """
    n = rays.shape[1]
    k, j, side = np.moveaxis(touches, -1, 0)
    beside = [row_values(rays, (k + step) % n, j) for step in (-1, 1)]
    return np.maximum(np.maximum(-side * beside[0], -side * beside[1]), 0.0)
