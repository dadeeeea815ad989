"""Facets that bend: diagonals as creases with a stiffness per length."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.errors import SceneError
from origami_nlp.numerics import INPUT_TOL, cross
from origami_nlp.pattern.cells import make_sheet
from origami_nlp.pattern.hinges_stated import law_probes
from origami_nlp.pattern.polygons import Side, side
from origami_nlp.pattern.sheet import Pattern


def with_bending(pattern: Pattern, stiffness: float, diagonal: str = "short") -> Pattern:
    """Return a pattern whose facets with more than three corners bend about diagonals.

    Each such facet is cut into triangles by diagonals, and these are creases with a linear spring that rests flat.  As
    the stiffness grows states tend to those of rigid facets, at a distance of one over it.

    Parameters
    ----------
    pattern
        Of facets that are one convex polygon each.
    stiffness
        Of a diagonal, per length of it [N/rad].
    diagonal
        ``"short"`` or ``"long"``: which one is cut first; of equal ones (squares, rectangles) one that is chosen by the
        lengths, springs and facets around its ends, whatever corners and creases are called.  ``"both"``: four halves,
        which meet in a new corner; as facets do not stretch one of the two lines bends, or the facet is flat, and
        states choose which (facets with more corners are cut by short ones until four are left).

    Returns
    -------
    Pattern
        With the creases of the pattern first, in their order, then the diagonals; `notes` says how many and which.

    Raises
    ------
    SceneError
        If the stiffness is not positive, a facet is of several pieces or not convex, or no facet has four corners.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import with_bending
    >>> soft = with_bending(o.examples.pattern("miura", 2, 2), 0.5)
    >>> soft.facets, soft.creases
    (8, 8)
    """
    k = check_number("stiffness", stiffness, 0.0)
    if diagonal not in ("short", "long", "both"):
        raise SceneError(f"diagonal = {diagonal!r} must be short, long or both")
    if pattern.facets < len(pattern.polygons):
        raise SceneError("facets of several pieces do not bend: draw their inner edges as creases")
    if pattern.orders:
        raise SceneError("facets that bend have no faceOrders: leave these out")
    for number, polygon in enumerate(pattern.polygons, start=1):
        _check_convex(pattern.corners, polygon, number)
    cutting = _Cutting(pattern, diagonal)
    corners, polygons, cuts = list(pattern.corners), list[tuple[int, ...]](), list[Side]()
    for own, left, cut in zip(cutting.pieces, cutting.left, cutting.cuts, strict=True):
        polygons += own
        cuts += cut
        if len(left) < 4:
            polygons.append(tuple(left))
            continue
        middle = len(corners)
        corners.append(_where_diagonals_meet(pattern.corners[left]))
        polygons += [(middle, a, b) for a, b in zip(left, left[1:] + left[:1], strict=True)]
        cuts += [side(a, middle) for a in left]
    if not cuts:
        raise SceneError("no facet has more than three corners: triangles do not bend")
    sides = [(a, b) for a, b in pattern.ends.tolist()]
    least = int(pattern.numbers.max(initial=-1)) + 1

    def of(values: Iterable[Any], new: Any) -> dict[tuple[int, int], Any]:
        each = new if isinstance(new, list) else [new] * len(cuts)
        return dict(zip([*sides, *cuts], [*values, *each], strict=True))

    which = "halves of both diagonals" if diagonal == "both" else f"{diagonal} diagonals"
    told = (
        f"facets bend: {len(cuts)} {which} are creases of {k:g} N/rad per length, which rest flat"
    )
    cell, stops = pattern.cell, pattern.limit_angles.T.tolist()
    made = make_sheet(
        np.array(corners),
        polygons,
        cell and cell.lattice,
        rolled=cell and cell.rolled,
        assignment=of(pattern.assignment, "F"),
        fold_angles=of(pattern.reference.tolist(), 0.0),
        numbers=of(pattern.numbers.tolist(), [*range(least, least + len(cuts))]),
        stiffness=of(
            pattern.stiffness.tolist(),
            [k * float(np.linalg.norm(corners[a] - corners[b])) for a, b in cuts],
        ),
        rest=of(pattern.rest.tolist(), 0.0),
        limits=of(stops, (-math.pi, math.pi)) if pattern.limits else None,
        laws=of(pattern.laws, None) if pattern.laws else None,
        name=pattern.name,
        notes=[*pattern.notes, told],
    )
    return made.with_contact(pattern.contact)


def _where_diagonals_meet(x: np.ndarray) -> np.ndarray:
    """Return the crossing of the diagonals of a quadrilateral, [4, 3]."""
    one, other = x[2] - x[0], x[3] - x[1]
    share = np.linalg.lstsq(np.column_stack([one, -other]), x[1] - x[0], rcond=None)[0]
    out: np.ndarray = x[0] + share[0] * one
    return out


def _check_convex(corners: np.ndarray, polygon: tuple[int, ...], number: int) -> None:
    x = corners[list(polygon)]
    turns = cross(np.roll(x, -1, axis=0) - x, np.roll(x, -2, axis=0) - np.roll(x, -1, axis=0))
    if len(x) > 3 and (turns @ turns[0]).min() < -INPUT_TOL * float(turns[0] @ turns[0]):
        raise SceneError(f"facet {number} is not convex: draw the creases about which it bends")


class _Cutting:
    """Polygons that are cut into triangles, ear by ear at the shortest diagonal, or the longest.

    Of equal diagonals one is chosen by what the sheet looks like from its ends, not by their numbers: by how far all
    corners and creases are, each with a weight of its kind.  Where all look alike, diagonals are images of each other:
    one is cut, and the rest sees it.
    """

    def __init__(self, pattern: Pattern, diagonal: str) -> None:
        self.corners, self.longest = pattern.corners, diagonal == "long"
        self.corners_left = 4 if diagonal == "both" else 3
        self.left = [list(p) for p in pattern.polygons]
        self.pieces: list[list[tuple[int, ...]]] = [[] for _ in self.left]
        self.cuts: list[list[Side]] = [[] for _ in self.left]
        probes = law_probes(pattern.laws, False, 1.0).T
        numbers = [pattern.stiffness, pattern.rest, *pattern.limit_angles, *probes]
        kinds = np.array([_classes(np.asarray(v, float)) for v in numbers]).T.tolist()
        ends = (side(a, b) for a, b in pattern.ends.tolist())
        self.kinds = kinds or [[]]
        self.kind: dict[Side, tuple[int, ...]] = dict(zip(ends, map(tuple, kinds), strict=True))
        while some := [f for f, p in enumerate(self.left) if len(p) > self.corners_left]:
            ties = {f: self._shortest(f) for f in some}
            sure = self._sure(ties)
            if not sure:
                looks = self._looks()
                seen = {
                    f: sorted((sorted(looks[[*self._ends(f, i)]].tolist()), i) for i in ties[f])
                    for f in some
                }
                ties = {f: [i for key, i in seen[f] if key == seen[f][0][0]] for f in some}
                sure = self._sure(ties) or [min(some, key=lambda f: seen[f][0][0])]
            for f in sure:
                self._cut(f, ties[f][0])

    def _sure(self, ties: dict[int, list[int]]) -> list[int]:
        """Return the facets in which one diagonal is left."""
        return [f for f, own in ties.items() if len({self._ends(f, i) for i in own}) == 1]

    def _ends(self, f: int, i: int) -> Side:
        p = self.left[f]
        return side(p[i - 1], p[(i + 1) % len(p)])

    def _shortest(self, f: int) -> list[int]:
        """Return the corners of a facet that its shortest diagonals cut off, or its longest."""
        ends = [self._ends(f, i) for i in range(len(self.left[f]))]
        size = np.array([np.linalg.norm(self.corners[a] - self.corners[b]) for a, b in ends])
        best = size.max() if self.longest else size.min()
        return np.flatnonzero(np.abs(size - best) <= INPUT_TOL * best).tolist()

    def _cut(self, f: int, i: int) -> None:
        p = self.left[f]
        a, b = p[i - 1], p[(i + 1) % len(p)]
        self.cuts[f].append(side(a, b))
        self.kind[side(a, b)] = (-1,)
        self.pieces[f].append((a, p[i], b))
        del p[i]

    def _looks(self) -> np.ndarray:
        """Return a number of each corner, equal where the sheet looks alike from them: a sum over all that is drawn."""
        x, kinds = self.corners, [*self.kind.values()]
        cuts = np.array([[cut == (-1,)] for cut in kinds], float)
        kinds = [k if k != (-1,) else (0,) * len(self.kinds[0]) for k in kinds]
        heavy = np.column_stack([np.ones(len(kinds)), np.array(kinds, float), cuts])
        weights = heavy @ np.sqrt(np.arange(2, 2 + heavy.shape[1]))
        looks, size = np.zeros(len(x)), np.linalg.norm(x - x.mean(axis=0), axis=1).max()
        points = [((v, v), 1.0) for v in range(len(x))]
        for ends, weight in [*zip(self.kind, weights, strict=True), *points]:
            away = (np.linalg.norm(x - x[v], axis=1) for v in ends)
            looks += weight * np.exp(-sum(away) / size)
        return _classes(looks)


def _classes(values: np.ndarray) -> np.ndarray:
    """Return numbers of values in their order, equal for those that rounding alone keeps apart."""
    order = np.argsort(values, kind="stable")
    apart = np.diff(values[order]) > INPUT_TOL * max(float(np.abs(values).max(initial=0.0)), 1.0)
    out = np.zeros(len(values), int)
    out[order] = np.concatenate([[0], np.cumsum(apart)]) if len(values) else []
    return out
