"""Does a folded vertex close, and may its facets be where they are?

A folded vertex is a closed spherical polygon with vertices c_i.  It is admissible when it is weakly
simple: no two arcs cross, and where arcs lie on top of each other some order of the layers lets the
paper avoid itself, with every closed crease (phi = +-pi) turning to its own side.  Weakly simple
polygons are the limits of simple ones, so this also rejects states that pass a pairwise test only
because touching facets have no order there.

Written with NumPy from the fold angles alone, independent of the CasADi model.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from origami_nlp.arguments import check_angles, check_number, check_type, shown
from origami_nlp.errors import OptionError
from origami_nlp.folding.crossings import depths_at, facet_heights
from origami_nlp.folding.layers import layer_problem
from origami_nlp.numerics import CONTACT_TOL, first_largest, quaternion as quat
from origami_nlp.pattern import Vertex

LARGEST_TOLERANCE = 0.01
"""Wider, and facets that stand apart would be ordered as if they touched [rad]."""


@dataclass(frozen=True)
class Embedding:
    """What is wrong with a state as a piece of paper, if anything.

    Attributes
    ----------
    admissible
        Whether it closes on the lift q = +1, keeps |phi| <= pi and its facets do not cross.
    reason
        Why not, in words; empty when admissible.
    closure_residual
        |vec q| of the product of all folds (2 |vec q| is the angle that fails to close).
    touching
        Whether non-adjacent parts touch (then layers were ordered).
    """

    admissible: bool
    reason: str
    closure_residual: float
    touching: bool


def fold_vertex(vertex: Vertex, fold_angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fold a vertex with its last facet held fixed (paper, eq. 2.1, fold-map).

    Parameters
    ----------
    vertex
        The vertex.
    fold_angles
        States, shape [..., N] [rad], valley positive; they need not close.

    Returns
    -------
    creases : numpy.ndarray
        Deformed unit creases c_i = F_{i-1} b_i, shape [..., N, 3].
    q : numpy.ndarray
        Product of all folds, and of the turn by `Vertex.excess` about e3 that closes the unrolled sheet of a
        vertex that is not flat, as a quaternion, shape [..., 4]; (1, 0, 0, 0) when the sheet closes.
        Every embedded vertex has +1: simple spherical polygons are deformed into each other through simple
        ones, along which the sign cannot change.

    Examples
    --------
    >>> from origami_nlp import Vertex
    >>> from origami_nlp.folding import fold_vertex
    >>> creases, q = fold_vertex(Vertex(("pi/2",) * 4), [3.141592653589793, 0, 3.141592653589793, 0])
    >>> creases.shape, q.round(12).tolist()
    ((4, 3), [1.0, 0.0, 0.0, 0.0])
    """
    phi = np.asarray(fold_angles, dtype=float)
    half = phi / 2
    if phi.ndim == 1:  # one state: plain numbers are ten times faster than arrays of one
        return _fold_one(vertex, np.cos(half).tolist(), np.sin(half).tolist())
    q = tuple(np.full(phi.shape[:-1], v, dtype=float) for v in quat.IDENTITY)
    creases = []
    for i, b in enumerate(vertex.creases):
        # c_i = F_{i-1} b_i, the folds before it (paper, section 2)
        creases.append(np.stack(quat.rotate(q, b), axis=-1))
        q = quat.multiply(q, quat.fold(np.cos(half[..., i]), np.sin(half[..., i]), b))
    if not vertex.flat:
        turn = vertex.excess / 2
        q = quat.multiply(q, (math.cos(turn), 0.0, 0.0, math.sin(turn)))
    return np.stack(creases, axis=-2), np.stack(q, axis=-1)


def _fold_one(
    vertex: Vertex, cosines: list[float], sines: list[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Fold one state given the cosines and sines of its half angles: `fold_vertex`, to the bit."""
    q: tuple[float, ...] = quat.IDENTITY
    creases = []
    for b, c, s in zip(vertex.creases.tolist(), cosines, sines, strict=True):
        creases.append(quat.rotate(q, b))
        q = quat.multiply(q, quat.fold(c, s, b))
    if not vertex.flat:
        turn = vertex.excess / 2
        q = quat.multiply(q, (math.cos(turn), 0.0, 0.0, math.sin(turn)))
    return np.array(creases, dtype=float), np.array(q, dtype=float)


def _check_elements(elements: object) -> None:
    if not isinstance(elements, tuple | list) or not all(
        isinstance(e, tuple) and len(e) == 2 and isinstance(e[0], int) and isinstance(e[1], bool)
        for e in elements
    ):
        raise OptionError(
            f"elements = {shown(elements)} must be pairs (shift, mirrored) such as scene.group.elements"
        )


@lru_cache(maxsize=64)
def _not_adjacent(count: int) -> tuple[tuple[int, int], ...]:
    """List the pairs of facets that share no crease."""
    every = itertools.combinations(range(count), 2)
    return tuple((i, j) for i, j in every if 2 <= j - i <= count - 2)


@lru_cache(maxsize=64)
def _not_ends(count: int) -> np.ndarray:
    """Return which creases are not ends of a facet, [facet, crease]."""
    own = np.eye(count, dtype=bool)
    return ~(own | np.roll(own, 1, axis=1))


def check_admissible(
    vertex: Vertex,
    fold_angles: np.ndarray,
    *,
    tolerance: float = CONTACT_TOL,
    elements: tuple[tuple[int, bool], ...] = (),
) -> Embedding:
    """Return whether a state of a vertex is admissible with full contact, and why not if not.

    Parameters
    ----------
    vertex
        The vertex.
    fold_angles
        Of one state, shape [N] [rad], valley positive.
    tolerance
        Distance on the unit sphere below which features touch [rad], 0 to 0.01.
    elements
        Of a group (`Symmetry.elements`) that the fold angles have.  Touching layers must then have an order with that
        symmetry as well: equal fold angles do not make a stack symmetric.

    Returns
    -------
    Embedding
        Whether it is admissible, the reason why not, how well it closes, and whether parts touch.

    Raises
    ------
    AngleError
        If `fold_angles` are not N finite numbers.
    OptionError
        If another argument is not what it must be.

    Examples
    --------
    >>> from origami_nlp import Vertex, check_admissible
    >>> check_admissible(Vertex(("pi/2",) * 4), [1, 0, 1, 0]).admissible
    True
    >>> check_admissible(Vertex(("pi/2",) * 4), [1, 0, 1, 0.5]).reason
    'does not close: |vec q| = 2.5e-01'
    """
    check_type("vertex", vertex, Vertex)
    phi = check_angles("fold_angles", fold_angles, vertex.degree, one=True)
    check_number("tolerance", tolerance, 0.0, LARGEST_TOLERANCE)
    _check_elements(elements)
    creases, q = fold_vertex(vertex, phi)
    residual = float(np.linalg.norm(q[1:]))

    def bad(reason: str) -> Embedding:
        return Embedding(False, reason, residual, False)

    if residual > tolerance:
        return bad(f"does not close: |vec q| = {residual:.1e}")
    if q[0] < 0:
        return bad("closes with q = -1: not a sheet of paper")
    over = np.abs(phi) - math.pi
    if over.max() > tolerance:
        crease = int(first_largest(over)) + 1
        return bad(
            f"adjacent facets cross at crease {crease}: |phi| exceeds pi by {over.max():.1e}"
        )
    # what crosses by more than the tolerance is refused; where facets only touch, the order of layers decides
    n = len(phi)
    pairs, heights = _not_adjacent(n), facet_heights(creases)
    depth = depths_at(heights, pairs)
    if depth.max(initial=0.0) > tolerance:
        m = int(first_largest(depth))
        i, j = pairs[m]
        return bad(f"facets {i + 1} and {j + 1} cross, {depth[m]:.1e} deep")
    if np.abs(heights[_not_ends(n)]).min(initial=math.inf) > 2 * tolerance:
        return Embedding(
            True, "", residual, False
        )  # no crease near a facet that does not end there
    problem = layer_problem(creases, phi, tolerance)
    if problem is None:
        return Embedding(True, "", residual, False)
    if not problem.solvable():
        return Embedding(
            False, "touching facets have no layer order without crossing", residual, True
        )
    if len(elements) > 1 and not problem.with_symmetry(elements, n).solvable():
        return Embedding(
            False, "touching facets have a layer order, but none with the symmetry", residual, True
        )
    return Embedding(True, "", residual, True)
