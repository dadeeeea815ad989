"""Facets that bend: diagonals as creases with a stiffness per length."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import scipy as sp

from origami_nlp.arguments import check_number
from origami_nlp.errors import SceneError
from origami_nlp.numerics import INPUT_TOL, cross
from origami_nlp.pattern.hinges_stated import law_probes
from origami_nlp.pattern.polygons import Side, side
from origami_nlp.pattern.sheet import Pattern
from origami_nlp.pattern.sheet_data import pattern_from_dict, pattern_to_dict


def with_bending(pattern: Pattern, stiffness: float) -> Pattern:
    """Return a pattern whose facets with more than three corners bend about diagonals.

    Each such facet is cut into triangles by diagonals, and these are creases with a linear spring that rests flat.  As
    the stiffness grows states tend to those of rigid facets, at a distance of one over it.  The shortest is cut
    first; of equal ones (squares, rectangles) one that is chosen by all that is drawn, whatever corners and creases are
    called.

    Parameters
    ----------
    pattern
        Of facets that are one convex polygon each.
    stiffness
        Of a diagonal, per length of it [N/rad].

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
    if pattern.facets < len(pattern.polygons):
        raise SceneError("facets of several pieces do not bend: draw their inner edges as creases")
    if pattern.orders:
        raise SceneError("facets that bend have no faceOrders: leave these out")
    for number, polygon in enumerate(pattern.polygons, start=1):
        _check_convex(pattern.corners, polygon, number)
    cutting = _Cutting(pattern)
    corners, cuts = pattern.corners, [cut for own in cutting.cuts for cut in own]
    if not cuts:
        raise SceneError("no facet has more than three corners: triangles do not bend")
    each = zip(cutting.pieces, cutting.left, strict=True)
    least, many = int(pattern.numbers.max(initial=-1)) + 1, len(cuts)
    told = f"facets bend: {many} short diagonals are creases of {k:g} N/rad per length, which rest flat"
    lengths = np.linalg.norm(np.subtract(*corners[np.array(cuts).T]), axis=1)
    of_cuts: dict[str, Any] = {
        "creases": [[*cut] for cut in cuts],
        "assignment": "F" * many,
        "numbers": [*range(least, least + many)],
        "reference": [0.0] * many,
        "stiffness": (k * lengths).tolist(),
        "rest_angles": [0.0] * many,
        "limits": [[-math.pi, math.pi]] * many,
        "law": [None] * many,
        "notes": [told],
    }
    data = pattern_to_dict(pattern)
    data |= {key: data[key] + more for key, more in of_cuts.items() if key in data}
    # the state that a file states is one of facets that do not bend
    data |= {"source": "", "file_angles": [None] * len(data["creases"])}
    data["polygons"] = [[*p] for own, left in each for p in (*own, left)]
    return pattern_from_dict(data)


def _check_convex(corners: np.ndarray, polygon: tuple[int, ...], number: int) -> None:
    x = corners[list(polygon)]
    turns = cross(np.roll(x, -1, axis=0) - x, np.roll(x, -2, axis=0) - np.roll(x, -1, axis=0))
    if len(x) > 3 and (turns @ turns[0]).min() < -INPUT_TOL * float(turns[0] @ turns[0]):
        raise SceneError(f"facet {number} is not convex: draw the creases about which it bends")


class _Cutting:
    """Polygons that are cut into triangles, ear by ear at the shortest diagonal.

    Of equal diagonals one is chosen by what the sheet looks like from its ends, not by their numbers: by how far all
    corners and creases are, each with a weight of its kind.  Where all look alike, diagonals are images of each other:
    one is cut, and the rest sees it.
    """

    def __init__(self, pattern: Pattern) -> None:
        self.corners = pattern.corners
        self.left = [list(p) for p in pattern.polygons]
        self.pieces: list[list[tuple[int, ...]]] = [[] for _ in self.left]
        self.cuts: list[list[Side]] = [[] for _ in self.left]
        probes = law_probes(pattern.laws, False, 1.0).T
        numbers = [pattern.stiffness, pattern.rest, *pattern.limit_angles, *probes]
        kinds = np.array([_classes(np.asarray(v, float)) for v in numbers])
        # powers of e are linearly independent over the whole numbers: no two kinds have one weight
        weights = 1.0 + np.exp(np.linspace(0.0, 1.0, len(kinds))) @ kinds
        ends = (side(a, b) for a, b in pattern.ends.tolist())
        self.weight: dict[Side, float] = dict(zip(ends, weights.tolist(), strict=True))
        while some := [f for f, p in enumerate(self.left) if len(p) > 3]:
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
        """Return the corners of a facet that its shortest diagonals cut off."""
        ends = [self._ends(f, i) for i in range(len(self.left[f]))]
        size = np.array([np.linalg.norm(self.corners[a] - self.corners[b]) for a, b in ends])
        return np.flatnonzero(size - size.min() <= INPUT_TOL * size.min()).tolist()

    def _cut(self, f: int, i: int) -> None:
        p = self.left[f]
        a, b = p[i - 1], p[(i + 1) % len(p)]
        self.cuts[f].append(side(a, b))
        self.weight[side(a, b)] = math.pi
        self.pieces[f].append((a, p[i], b))
        del p[i]

    def _looks(self) -> np.ndarray:
        """Return a number of each corner, equal where the sheet looks alike from them: a sum over all that is drawn."""
        x, weights = self.corners, np.array([*self.weight.values()])
        a, b = np.array([*self.weight], int).reshape(-1, 2).T
        looks, size = np.zeros(len(x)), np.linalg.norm(x - x.mean(axis=0), axis=1).max()
        for own in np.array_split(np.arange(len(x)), len(x) // 100 + 1):
            near = np.exp(-sp.spatial.distance.cdist(x[own], x) / size)
            looks[own] = (near[:, a] * near[:, b]) @ weights + (near**2).sum(axis=1)
        return _classes(looks)


def _classes(values: np.ndarray) -> np.ndarray:
    """Return numbers of values in their order, equal for those that rounding alone keeps apart."""
    order = np.argsort(values, kind="stable")
    apart = np.diff(values[order]) > INPUT_TOL * max(float(np.abs(values).max(initial=0.0)), 1.0)
    out = np.zeros(len(values), int)
    out[order] = np.concatenate([[0], np.cumsum(apart)]) if len(values) else []
    return out
