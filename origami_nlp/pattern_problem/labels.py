"""An origami under other labels: creases numbered otherwise, turned in space, mirrored, seen from the other side.

None of this changes physics.  A search that draws random numbers by label would; they are drawn in an order of creases
that all labels agree on.  Seen from each side of each crease the others have places; the view whose list of places
and springs comes first in order is the one.  Views that agree in all places are symmetries of the paper: they carry
every curve of closed states to another one.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice, product
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import scipy as sp

from origami_nlp.numerics import DUPLICATE_TOL, PLACES, area_vectors, cross
from origami_nlp.pattern import Loop, Pattern, law_probes, same_laws, seen_laws

OFFSET = 0.37614159
"""Of the grid, so that places that are simple fractions lie in the middle of its cells."""
FINE = 1e-11
"""Of a second grid, which tells apart views that agree on the first, `PLACES`."""
MOST_VIEWS = 4_000
"""That are compared; of larger symmetric patterns some."""


View: TypeAlias = tuple[int, tuple[float, ...]]
"""A crease from which a sheet is looked at, and the signs of the three axes."""


class PaperSymmetry(NamedTuple):
    """A symmetry of the paper, its springs left aside.

    Attributes
    ----------
    to
        Variable to which each goes, [n].
    sign
        -1 where the paper is turned over: that of fold angles.
    mirrored
        Whether it is seen in a mirror that stands on the paper.
    """

    to: np.ndarray
    sign: float
    mirrored: bool


@dataclass(frozen=True, eq=False)
class CanonicalLabelling:
    """An order of the variables of an origami that does not depend on how creases are numbered.

    Attributes
    ----------
    order
        Variable that comes first, second, ... [n].
    creases
        The creases in this order, [N].
    sign
        -1 where fold angles count from the other side of the paper.
    mirrored
        Whether loops that run counter-clockwise run clockwise in that view.
    images
        Symmetries of the paper, but for that which changes nothing.
    symmetries
        Those of them that keep the springs as well.
    """

    order: np.ndarray
    creases: np.ndarray
    sign: float
    mirrored: bool
    images: tuple[PaperSymmetry, ...]
    symmetries: tuple[PaperSymmetry, ...]

    def drawn(self, values: np.ndarray) -> np.ndarray:
        """Return numbers [..., n] that were drawn in this order as variables."""
        out = np.empty_like(values)
        out[..., self.order] = self.sign * values
        return out

    @cached_property
    def rank(self) -> np.ndarray:
        """Place of each crease in the order, [N]."""
        return np.argsort(self.creases)

    def arranged(self, pattern: Pattern) -> Pattern:
        """Return a pattern with loops that begin where this order says, about its middle.

        Equations of closure are those of a loop's first facet: steps towards closure from afar depend on it.
        """

        def begun(loop: Loop) -> Loop:
            if loop.moved:  # round a tube it begins in the cell itself
                return loop
            first = int(self.rank[list(loop.creases)].argmin()) + self.mirrored
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
        """Return what states [n] are sorted by."""
        return tuple(np.floor(self.sign * phi[self.order] * 1e4 + OFFSET).astype(int).tolist())


class Views:
    """A sheet as it is seen from its creases.

    Parameters
    ----------
    pattern
        With its springs.
    load
        Torque on each crease besides, [N] [N m].

    Attributes
    ----------
    axes
        Of each crease its direction, the one across it and the normal, [N, 3, 3].
    middle
        Of each, [N, 3].
    """

    def __init__(self, pattern: Pattern, load: np.ndarray) -> None:
        self.pattern, n = pattern, pattern.creases
        ends = pattern.corners[pattern.ends]  # [N, 2, 3]
        self.size = float(
            np.linalg.norm(pattern.corners - pattern.corners.mean(axis=0), axis=1).max()
        )
        e1, normals = pattern.directions, _normals(pattern)
        # of both facets, so that it does not matter which way the crease runs
        normal = normals[pattern.left] + normals[pattern.right]
        long = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = np.where(long > PLACES, normal / np.maximum(long, PLACES), normals[pattern.left])
        self.axes = np.stack([e1, cross(normal, e1), normal], axis=1)
        self.middle, self.bars = ends.mean(axis=1), ends[:, 1] - ends[:, 0]
        mean = float(pattern.stiffness.mean())
        rest = pattern.rest
        if pattern.laws:  # which of two equal wells is named turns with the paper
            each = zip(pattern.laws, rest.tolist(), strict=True)
            rest = np.array([law.one_rest if law else angle for law, angle in each])
        self.even, self.odd = pattern.stiffness[:, None] / mean, np.stack([rest, load / mean], 1)
        self.limits = pattern.limit_angles if pattern.limits else np.zeros((2, n))
        self.laws = {side: law_probes(pattern.laws, side < 0, mean) for side in (1.0, -1.0)}

    def rarest(self) -> np.ndarray:
        """Return creases from which to look: of those alike in length and distance from the middle, the fewest."""
        far = np.linalg.norm(self.middle - self.middle.mean(axis=0), axis=1)
        kinds = _cells(np.column_stack([self.pattern.lengths, far]) / self.size, PLACES)
        _, kind, many = np.unique(kinds, axis=0, return_inverse=True, return_counts=True)
        # the fewest, and among as few the first kind: by its numbers, not by labels
        return np.flatnonzero(kind.ravel() == int(many.argmin()))

    def places(self, crease: int, signs: tuple[float, ...]) -> np.ndarray:
        """Return where creases are as seen from one, over the size of the sheet, and how they are folded, [N, 7]."""
        # a middle and both ends, whichever comes first: the sum of squares does not ask
        seen = (self.middle - self.middle[crease]) @ self.axes[crease].T * signs
        bars = np.abs(self.bars @ self.axes[crease].T)
        reference = self.pattern.reference[:, None] * signs[2]
        return np.hstack([seen / self.size, bars / self.size, reference])

    def springs(self, side: float) -> np.ndarray:
        """Return numbers of the hinges of all creases as seen from a side of the paper, [N, k]."""
        stops = self.limits if side > 0 else -self.limits[::-1]
        laws = self.laws[side] if len(self.laws[side]) else np.zeros((len(self.even), 0))
        return np.hstack([self.even, side * self.odd, stops.T, laws])

    def seen(self, look: View) -> tuple[np.ndarray, np.ndarray]:
        """Return places and springs of all creases in a view."""
        crease, signs = look
        return self.places(crease, signs), self.springs(signs[2])

    def keeps(self, one: PaperSymmetry) -> bool:
        """Return whether a symmetry of the paper, of all creases, keeps the springs as well."""
        laws = self.pattern.laws
        there = tuple(laws[k] for k in one.to.tolist()) if laws else ()
        many = self.even.shape[1] + self.odd.shape[1] + 2
        off = self.springs(one.sign)[one.to, :many] - self.springs(1.0)[:, :many]
        alike = float(np.abs(off).max(initial=0.0)) <= DUPLICATE_TOL
        return alike and (not laws or same_laws(seen_laws(there, one.sign < 0), laws))


def as_stated(creases: int, variables: int) -> CanonicalLabelling:
    """Return the labels that an origami has, without symmetries: of one under forces, which count from a facet."""
    return CanonicalLabelling(np.arange(variables), np.arange(creases), 1.0, False, (), ())


def find_labels(
    pattern: Pattern, load: np.ndarray | None = None, orbits: Any = None
) -> CanonicalLabelling:
    """Find the order of the creases that all labels of an origami agree on.

    Parameters
    ----------
    pattern
        With its springs.
    load
        Torque on each crease besides, [N] [N m].
    orbits
        Of states that keep a symmetry: variables are then fewer than creases.

    Returns
    -------
    CanonicalLabelling
        Where several views agree in springs as well, which is a symmetry of the sheet, that of the first.
    """
    n = pattern.creases
    if n == 0:
        return as_stated(0, 0)
    views = Views(pattern, np.zeros(n) if load is None else load)
    # the sheet as seen from each crease that is rarest, turned over or in a mirror too: the least view gives the order
    looks = product(views.rarest().tolist(), product((1.0, -1.0), repeat=3))
    ties: list[tuple[View, np.ndarray]] = []
    best: Any = None
    for look in islice(looks, MOST_VIEWS):
        places, springs = (_cells(x, PLACES) for x in views.seen(look))
        order = np.lexsort(places.T[::-1])
        places, springs = places[order], springs[order]
        way = -1 if best is None else _compared(places, best[0])
        if way < 0:
            best, ties = (places, springs), []
        elif way == 0 and _compared(springs, best[1]) < 0:
            best = places, springs
        if way <= 0:
            ties.append((look, order))
    same = [
        (look, order)
        for look, order in ties
        if not _compared(_cells(views.springs(look[1][2]), PLACES)[order], best[1])
    ]
    first = same[0]
    for one in same[1:]:
        if _compared(*(_cells(np.hstack(views.seen(k))[o], FINE) for k, o in (one, first))) < 0:
            first = one
    (_, signs), order = first
    here, images = views.seen(first[0])[0][order], list[PaperSymmetry]()
    if pattern.cell:
        images += _lattice_images(pattern, views.axes, views.middle)
    for look, other in () if pattern.cell else ties:
        sign, hand = look[1][2] * signs[2], look[1][0] * look[1][1] * signs[0] * signs[1]
        to = np.empty(n, int)
        to[order] = other
        trivial = sign > 0 and (to == np.arange(n)).all()
        if not trivial and np.abs(views.seen(look)[0][other] - here).max() <= DUPLICATE_TOL:
            images.append(PaperSymmetry(to, sign, hand < 0))
    moves = {(*one.to.tolist(), one.sign): one for one in images}.values()
    kept = [one for one in moves if views.keeps(one)]
    own = tuple(_of_variables(which, orbits) for which in (moves, kept))
    variables = (
        order if orbits is None else np.array([*dict.fromkeys(orbits.orbit[order].tolist())])
    )
    return CanonicalLabelling(variables, order, signs[2], signs[0] * signs[1] < 0, *own)


def _of_variables(moves: Iterable[PaperSymmetry], orbits: Any) -> tuple[PaperSymmetry, ...]:
    """Return symmetries of all creases as those of variables, where these are taken to such; those that move some."""
    if orbits is None:
        return tuple(moves)
    found, orbit = dict[tuple[float, ...], PaperSymmetry](), orbits.orbit
    for one in moves:
        to = np.empty(orbits.variables, int)
        to[orbit] = orbit[one.to]
        signs = one.sign * orbits.sign * orbits.sign[one.to]
        trivial = signs[0] > 0 and (to == np.arange(len(to))).all()
        if not trivial and (to[orbit] == orbit[one.to]).all() and (signs == signs[0]).all():
            found.setdefault((*to.tolist(), signs[0]), one._replace(to=to, sign=float(signs[0])))
    return tuple(found.values())


def _lattice_images(pattern: Pattern, axes: np.ndarray, middle: np.ndarray) -> list[PaperSymmetry]:
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
            images[(*to.tolist(), signs[2])] = PaperSymmetry(to, signs[2], signs[0] * signs[1] < 0)
    return [*images.values()]


def _keeps(tube: tuple[int, int], moved: np.ndarray) -> bool:
    """Return whether a symmetry that takes lattice vectors to rows of `moved` goes round a tube as before, or back."""
    to = np.array(tube) @ moved
    return bool((to == tube).all() or (-to == tube).all())


def _inside(share: np.ndarray) -> np.ndarray:
    """Return places in shares of lattice vectors as those of copies within one cell."""
    out = np.mod(share, 1.0)
    return np.where(out >= 1.0, 0.0, out)


def image(symmetry: PaperSymmetry, phi: np.ndarray) -> np.ndarray:
    """Return where a symmetry of the paper takes states [..., n]."""
    out = np.empty_like(phi)
    out[..., symmetry.to] = symmetry.sign * phi
    return out


def _cells(x: np.ndarray, size: float) -> np.ndarray:
    return np.floor(x / size + OFFSET).astype(np.int64)


def _compared(one: np.ndarray, other: np.ndarray) -> int:
    """Return -1, 0 or 1 as one array of whole numbers comes before another in order, is equal, or comes after."""
    differ = np.flatnonzero((one != other).ravel())
    return int(np.sign(one.flat[differ[0]] - other.flat[differ[0]])) if len(differ) else 0


def _normals(pattern: Pattern) -> np.ndarray:
    """Unit normals of the facets in the reference state, [F, 3]."""
    total = np.zeros((pattern.facets, 3))
    for piece, facet in zip(pattern.polygons, pattern.facet_of, strict=True):
        total[facet] += area_vectors(pattern.corners[list(piece)])
    return total / np.linalg.norm(total, axis=1, keepdims=True)
