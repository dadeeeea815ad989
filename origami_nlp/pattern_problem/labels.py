"""A pattern under other labels: creases numbered otherwise, turned in space, mirrored, seen from the other side.

None of this changes physics.  A search that draws random numbers by label would; they are drawn in an order of creases
that all labels agree on.  Seen from each side of each crease the others have places; the view whose list of places
and springs comes first in order is the one.  Views that agree in all places are symmetries of the paper: they carry
every curve of closed states to another one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import scipy as sp

from origami_nlp.numerics import DUPLICATE_TOL, PLACES, area_vectors, cross
from origami_nlp.pattern import HingeLaw, Loop, Pattern, law_probes, same_laws, seen_laws

OFFSET = 0.37614159
"""Of the grid, so that places that are simple fractions lie in the middle of its cells."""
MOST_VIEWS = 4_000
"""That are compared; of larger symmetric patterns some."""


@dataclass(frozen=True, eq=False)
class CanonicalLabelling:
    """An order of the creases of a pattern that does not depend on how they are numbered.

    Attributes
    ----------
    order
        Crease of the pattern that comes first, second, ... [n].
    sign
        -1 where fold angles count from the other side of the paper.
    mirrored
        Whether loops that run counter-clockwise run clockwise in that view.
    images
        Symmetries of the paper, its springs left aside: crease to which each goes, and the sign of fold angles; that
        which changes nothing is not among them.
    """

    order: np.ndarray
    sign: float
    mirrored: bool
    images: tuple[tuple[np.ndarray, float], ...]

    def drawn(self, values: np.ndarray) -> np.ndarray:
        """Return numbers [..., n] that were drawn in this order as fold angles of the pattern."""
        out = np.empty_like(values)
        out[..., self.order] = self.sign * values
        return out

    def symmetries(self, pattern: Pattern) -> list[tuple[np.ndarray, float]]:
        """Return those of the images that keep the springs as well."""
        k, rest = pattern.stiffness / pattern.stiffness.mean(), _rest(pattern)
        return [
            (to, sign)
            for to, sign in self.images
            if np.abs(k[to] - k).max() <= DUPLICATE_TOL
            and np.abs(rest[to] - sign * rest).max() <= DUPLICATE_TOL
            and (not pattern.laws or _keep_laws(pattern.laws, to, sign))
            and np.abs(_turned(pattern.limit_angles[:, to], sign) - pattern.limit_angles).max()
            <= DUPLICATE_TOL
        ]

    def arranged(self, pattern: Pattern) -> Pattern:
        """Return a pattern with loops that begin where this order says, about its middle.

        Equations of closure are those of a loop's first facet: steps towards closure from afar depend on it.
        """
        rank = np.empty(len(self.order), int)
        rank[self.order] = np.arange(len(self.order))

        def begun(loop: Loop) -> Loop:
            if loop.moved:  # round a tube it begins in the cell itself
                return loop
            first = int(rank[list(loop.creases)].argmin()) + self.mirrored
            turn = [*range(first, len(loop.creases)), *range(first)]
            creases, signs = (tuple(x[i] for i in turn) for x in (loop.creases, loop.signs))
            return Loop(creases, signs, loop.vertex)

        middle = pattern.corners.mean(axis=0)
        return replace(
            pattern,
            # of a cell its neighbours would have to move as well
            corners=pattern.corners if pattern.cell else pattern.corners - middle,
            vertices=tuple(map(begun, pattern.vertices)),
            holes=tuple(map(begun, pattern.holes)),
        )

    def key(self, phi: np.ndarray) -> tuple[int, ...]:
        """Return what fold angles [n] are sorted by."""
        return tuple(np.floor(self.sign * phi[self.order] * 1e4 + OFFSET).astype(int).tolist())


def find_labels(pattern: Pattern) -> CanonicalLabelling:
    """Find the order of the creases that all labels of a pattern agree on.

    Parameters
    ----------
    pattern
        With its springs.

    Returns
    -------
    CanonicalLabelling
        Where several views agree in springs as well, which is a symmetry of the sheet, that of the first.
    """
    n = pattern.creases
    if n == 0:
        return CanonicalLabelling(np.zeros(0, int), 1.0, False, ())
    ends = pattern.corners[pattern.ends]  # [n, 2, 3]
    out = np.linalg.norm(pattern.corners - pattern.corners.mean(axis=0), axis=1)
    size = float(out.max()) * PLACES
    e1, normals = pattern.directions, _normals(pattern)
    # of both facets, so that it does not matter which way the crease runs
    normal = normals[pattern.left] + normals[pattern.right]
    long = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.where(long > PLACES, normal / np.maximum(long, PLACES), normals[pattern.left])
    axes = np.stack([e1, cross(normal, e1), normal], axis=1)  # [n, 3, 3]
    middle = ends.mean(axis=1)
    mean = float(pattern.stiffness.mean())
    k, rest = pattern.stiffness / mean, _rest(pattern)
    springs = np.column_stack([k, rest]) / PLACES
    limits = pattern.limit_angles if pattern.limits else np.zeros((2, n))
    reference = pattern.reference[:, None] / PLACES
    views = []
    for c in _rarest(middle, pattern, size):
        # a middle and both ends, whichever comes first: the sum of squares does not ask
        seen = (middle - middle[c]) @ axes[c].T
        bars = np.abs((ends[:, 1] - ends[:, 0]) @ axes[c].T)
        for signs in product((1.0, -1.0), repeat=3):
            places = _cells(np.hstack([seen * signs / size, bars / size, reference * signs[2]]))
            stops = _turned(limits, signs[2]).T / PLACES
            probes = law_probes(pattern.laws, signs[2] < 0, mean) / PLACES
            laws = [probes] if pattern.laws else []
            of_springs = _cells(np.hstack([springs * (1.0, signs[2]), stops, *laws]))
            order = np.lexsort(places.T[::-1])
            views.append((places[order].tolist(), of_springs[order].tolist(), order, signs))
        if len(views) >= MOST_VIEWS:
            break
    # the sheet as seen from each crease that is rarest, turned over or in a mirror too: the least view gives the order
    best = min(views, key=lambda v: v[:2])
    order, sign = best[2], best[3][2]
    if pattern.cell:
        return CanonicalLabelling(
            order, sign, best[3][0] * best[3][1] < 0, _lattice_images(pattern, axes, middle)
        )
    images = {}
    for places, _, other, (_, _, side) in views:
        if places == best[0] and not (side == sign and (other == order).all()):
            to = np.empty(n, int)
            to[order] = other
            images[(*to.tolist(), side)] = to, sign * side
    return CanonicalLabelling(order, sign, best[3][0] * best[3][1] < 0, tuple(images.values()))


def _lattice_images(
    pattern: Pattern, axes: np.ndarray, middle: np.ndarray
) -> tuple[tuple[np.ndarray, float], ...]:
    """Return the symmetries of a sheet that repeats, which take creases to copies of creases, translations included.

    axes: of each crease its direction, the one across it and the normal, [n, 3, 3]; middle: of each, [n, 3].
    """
    assert pattern.cell is not None
    lattice, n = pattern.cell.lattice, pattern.creases
    back = np.linalg.pinv(lattice)
    tree = sp.spatial.cKDTree(_inside(middle @ back), boxsize=1.0)
    near = PLACES * float(np.linalg.norm(lattice, axis=1).max())
    bars = pattern.directions * pattern.lengths[:, None]
    images = {}
    for c, signs in product(range(min(n, MOST_VIEWS // 8)), product((1.0, -1.0), repeat=3)):
        turn = axes[c].T @ np.diag(signs) @ axes[0]
        moved = lattice @ turn.T @ back
        if np.abs(moved - np.round(moved)).max() > PLACES:
            continue
        if (tube := pattern.cell.tube) and not _keeps(tube, np.round(moved)):
            continue
        places = (middle - middle[0]) @ turn.T + middle[c]
        off, to = tree.query(_inside(places @ back))
        along = bars @ turn.T
        apart = np.minimum(
            np.abs(along - bars[to]).max(axis=1), np.abs(along + bars[to]).max(axis=1)
        )
        one_to_one = len(np.unique(to)) == n
        trivial = signs[2] > 0 and (to == np.arange(n)).all()
        if off.max() <= PLACES and apart.max() <= near and one_to_one and not trivial:
            images[(*to.tolist(), signs[2])] = to, signs[2]
    return tuple(images.values())


def _keeps(tube: tuple[int, int], moved: np.ndarray) -> bool:
    """Return whether a symmetry that takes lattice vectors to rows of `moved` goes round a tube as before, or back."""
    to = np.array(tube) @ moved
    return bool((to == tube).all() or (-to == tube).all())


def _inside(share: np.ndarray) -> np.ndarray:
    """Return places in shares of lattice vectors as those of copies within one cell."""
    out = np.mod(share, 1.0)
    return np.where(out >= 1.0, 0.0, out)


def _rest(pattern: Pattern) -> np.ndarray:
    """Rest angles [n]; 0 for laws with several wells: which of two equal ones is named turns with the paper."""
    if not pattern.laws:
        return pattern.rest
    each = zip(pattern.laws, pattern.rest.tolist(), strict=True)
    return np.array([law.one_rest if law else rest for law, rest in each])


def _keep_laws(laws: tuple[HingeLaw | None, ...], to: np.ndarray, sign: float) -> bool:
    """Return whether a symmetry of the paper takes each law to an equal one."""
    return same_laws(seen_laws(tuple(laws[k] for k in to.tolist()), sign < 0), laws)


def _turned(limits: np.ndarray, sign: float) -> np.ndarray:
    """Return fold limits [2, n] as they are seen from the other side of the paper where the sign is -1."""
    return limits if sign > 0 else -limits[::-1]


def image(symmetry: tuple[np.ndarray, float], phi: np.ndarray) -> np.ndarray:
    """Return where a symmetry of the paper takes states [..., n]."""
    to, sign = symmetry
    out = np.empty_like(phi)
    out[..., to] = sign * phi
    return out


def _cells(x: np.ndarray) -> np.ndarray:
    return np.floor(x + OFFSET).astype(np.int64)


def _normals(pattern: Pattern) -> np.ndarray:
    """Unit normals of the facets in the reference state, [F, 3]."""
    total = np.zeros((pattern.facets, 3))
    for piece, facet in zip(pattern.polygons, pattern.facet_of, strict=True):
        total[facet] += area_vectors(pattern.corners[list(piece)])
    return total / np.linalg.norm(total, axis=1, keepdims=True)


def _rarest(middle: np.ndarray, pattern: Pattern, size: float) -> np.ndarray:
    """Return creases from which to look: of those alike in length and distance from the middle, the fewest."""
    far = np.linalg.norm(middle - middle.mean(axis=0), axis=1)
    kinds = _cells(np.column_stack([pattern.lengths, far]) / size)
    _, kind, many = np.unique(kinds, axis=0, return_inverse=True, return_counts=True)
    # the fewest, and among as few the first kind: by its numbers, not by labels
    return np.flatnonzero(kind.ravel() == int(many.argmin()))
