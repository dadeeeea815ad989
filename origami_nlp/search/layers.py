"""The order of facets that lie on each other, as gaps that a descent holds: so they do not pass through each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp.numerics import INSIDE, OUTSIDE, groups, unit_normals
from origami_nlp.pattern_problem import ContactPair, Faces, PatternProblem
from origami_nlp.search.descend import Slot

Order = tuple[int, int, float]
"""Facets f and g, and the sign with which gaps of g over f are positive."""
AJAR = 0.05
"""By how much creases are opened to see how facets would lie where several orders are possible [rad]."""
MOST_KINDS = 500
"""Ways of being folded flat whose layers are kept: the last ones."""


def ajar(problem: PatternProblem, x: np.ndarray, aside: np.ndarray) -> np.ndarray:
    """Return a state beside one at which facets lie on each other, in a direction [n] that labels do not change."""
    beside: np.ndarray = problem.project(leant(problem, x, aside))[0]
    return beside


def leant(problem: PatternProblem, x: np.ndarray, aside: np.ndarray) -> np.ndarray:
    """Return fold angles within their limits some way off others [n], in a direction [n]."""
    largest = float(np.abs(aside).max(initial=0.0)) or 1.0
    off: np.ndarray = problem.fold_limits.clip(x + AJAR / largest * aside)
    return off


class LevelFaces:
    """Facets that lie face to face at states of a problem, once for all states that are folded flat alike.

    Facets that hang together at fully folded creases lie on each other as the signs of these say, wherever they are in
    space; two of them by themselves are kept apart by the fold limit.  Only where others come to lie level with them,
    each state is asked by itself.
    """

    def __init__(self, problem: PatternProblem) -> None:
        self.problem, self._known = problem, dict[bytes, Faces]()
        self._blocks = dict[bytes, np.ndarray]()

    def __call__(self, x: np.ndarray) -> Faces | None:
        """Return the facets that lie face to face at a state [n], or at one that is folded flat alike.

        None where those are only such as a fold limit keeps apart.
        """
        key, block, alone = self._blocks_at(x)
        if not alone:
            return self.problem.faces(x)
        if np.bincount(block).max() <= 2:
            return None
        faces = self._known.pop(key, None) or self.problem.faces(x)
        if faces.reason:  # other paper may run through this fold here, and elsewhere not
            return faces
        if len(self._known) == MOST_KINDS:
            del self._known[next(iter(self._known))]
        self._known[key] = faces
        return faces

    def kind(self, x: np.ndarray) -> bytes | None:
        """Return what the order of layers at a state [n] hangs on where facets do not cross: to which sides folds go.

        Facets that hang together at fully folded creases are one rigid body, and others that leave it do so to the side
        of their fold.  None where others lie level with it.
        """
        phi = self.problem.crossings.poses.copied(x)
        flat = np.abs(phi) <= OUTSIDE
        key, _, alone = self._blocks_at(x)
        return key + np.where(flat, 0.0, np.sign(phi)).tobytes() if alone else None

    def _blocks_at(self, x: np.ndarray) -> tuple[bytes, np.ndarray, bool]:
        """Return which creases are fully folded, the body of each facet, and whether only facets of one are level."""
        crossings = self.problem.crossings
        phi, pattern = crossings.poses.copied(x), crossings.pattern
        folded = np.abs(np.abs(phi) - np.pi) <= OUTSIDE
        key = np.where(folded, np.sign(phi), 0.0).tobytes()
        block = self._blocks.get(key)
        if block is None:
            if len(self._blocks) == MOST_KINDS:
                self._blocks.clear()
            joined = np.column_stack([pattern.left, pattern.right])[folded]
            block = self._blocks[key] = groups(pattern.facets, joined)
        of_pieces = block[crossings.facet]
        place = crossings.placed(x)
        normal = unit_normals(place)
        off = normal @ place[:, 0].T
        level = np.abs(off - np.diagonal(off)[:, None]) <= INSIDE * crossings.size
        level &= 1 - np.abs(normal @ normal.T) <= INSIDE**2
        return key, block, not (level & (of_pieces[:, None] != of_pieces)).any()


def ordered_slots(
    level: LevelFaces,
    x: np.ndarray,
    before: np.ndarray | None,
    known: set[Order],
    aside: np.ndarray,
) -> tuple[Slot, ...] | None:
    """Return gaps that keep an order of the facets that lie on each other at a state; None where there is no order.

    Parameters
    ----------
    level, x
        Facets that lie face to face, and a closed state whose facets do not pierce each other, [n].
    before
        A state beside it at which they do not lie on each other: they lie as they do there, if they can.  None: one in
        the direction `aside` [n].
    known
        Orders that hold already; what holds here is added.
    """
    problem, faces = level.problem, level(x)
    if faces is None:
        return ()
    if faces.reason:
        return None
    chosen, gaps = dict(faces.known), dict[int, float]()
    if faces.open:
        place = problem.placed(ajar(problem, x, aside) if before is None else before)
        for k in faces.open:
            each = (t.gap(place) for t in faces.touches(k, True))
            gaps[k] = max(each, key=abs, default=0.0)
    for k in sorted(faces.open, key=lambda k: -abs(gaps[k])):  # the plainest first
        if k in chosen:
            continue
        held = _held(faces.touches(k, True), known)
        above = gaps[k] > 0 if held is None else held
        given = {j: v for j, v in chosen.items() if j in gaps}
        found = faces.follow(given | {k: above}) or faces.follow(given | {k: not above})
        if found is None:
            return None
        chosen |= {k: above} | found
    corners, out = problem.crossings.pattern.corners, list[Slot]()
    for k, above in chosen.items():
        for t in faces.touches(k, above):
            known.add((*t.facets, t.sign))
            out.append(Slot.of(t, corners, orders=True))
    return tuple(out)


def _held(touches: Sequence[ContactPair], known: set[Order]) -> bool | None:
    """Return whether a pair lies as its gaps have it by what holds already; None where that says nothing."""
    for t in touches:
        for sign in (1.0, -1.0):
            if (*t.facets, sign * t.sign) in known:
                return sign > 0
    return None
