"""States that keep a symmetry of the paper: their fold angles are a linear map of fewer variables, phi = sign y[orbit].

A symmetry takes corners to corners, and with them facets, creases and contacts.  On states that keep it a contact and
its images are one inequality: the first of them stands for all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import itemgetter
from typing import Any

import numpy as np

from origami_nlp.numerics import area_vectors
from origami_nlp.pattern import HingeLaw, Pattern
from origami_nlp.pattern_problem.contact_pairs import ContactPair
from origami_nlp.problem import FoldLimits

KEY = itemgetter(0)
DIGITS = 9
"""Of places on facets, by which images of a contact are told apart."""


@dataclass(frozen=True, eq=False)
class Image:
    """What a symmetry takes corners, facets and polygons to.

    Attributes
    ----------
    corners, facets, polygons
        Numbers of their images, [V], [F] and [P].
    sign
        -1 where it turns the paper over: fold angles of a state change sign, and what was on the front of a facet is on
        the back of its image.
    turns
        -1 where it is a reflection in space: so do volumes.
    """

    corners: np.ndarray
    facets: np.ndarray
    polygons: np.ndarray
    sign: int
    turns: int

    def facets_of(self, i: int, j: int) -> tuple[int, int]:
        """Return the images of two facets."""
        return self._facets[i], self._facets[j]

    def corners_of(self, four: tuple[int, ...]) -> tuple[int, ...]:
        """Return the images of corners; -1 stands for none."""
        return tuple(c if c < 0 else self._corners[c] for c in four)

    @cached_property
    def _facets(self) -> list[int]:
        facets: list[int] = self.facets.tolist()
        return facets

    @cached_property
    def _corners(self) -> list[int]:
        corners: list[int] = self.corners.tolist()
        return corners

    @classmethod
    def of(cls, pattern: Pattern, corners: Sequence[int], sign: int) -> Image:
        """Follow facets and polygons of a pattern where corners go."""
        to = np.asarray(corners)
        number = {frozenset(ring): k for k, ring in enumerate(pattern.polygons)}
        polygons = np.array([number[frozenset(to[list(r)].tolist())] for r in pattern.polygons])
        facets = np.empty(pattern.facets, int)
        facets[pattern.facet_of] = pattern.facet_of[polygons]
        ring = pattern.polygons[polygons[0]]
        first, second = to[list(pattern.polygons[0][:2])].tolist()
        same = ring[(ring.index(first) + 1) % len(ring)] == second
        return cls(to, facets, polygons, sign, sign if same else -sign)


@dataclass(frozen=True, eq=False)
class Orbits:
    """The map of variables to fold angles, and the symmetries that it keeps.

    Attributes
    ----------
    pattern
        The paper.
    orbit
        Variable that each crease follows, [N].
    sign
        +1, or -1 where it follows the opposite, [N].
    images
        The symmetries but the identity.
    """

    pattern: Pattern
    orbit: np.ndarray
    sign: np.ndarray
    images: tuple[Image, ...]

    @property
    def variables(self) -> int:
        """Number of variables n."""
        return int(self.orbit.max(initial=-1)) + 1

    @cached_property
    def multiplicity(self) -> np.ndarray:
        """How many creases follow each variable, [n]."""
        return np.bincount(self.orbit, minlength=self.variables)

    @cached_property
    def _first(self) -> np.ndarray:
        """The first crease that follows each variable, [n]."""
        return np.asarray(np.unique(self.orbit, return_index=True)[1])

    def expand(self, y: np.ndarray) -> np.ndarray:
        """Return the fold angles [..., N] of variables [..., n]."""
        return np.asarray(self.sign * y[..., self.orbit])

    def gather(self, rows: np.ndarray) -> np.ndarray:
        """Return derivatives by variables [..., n] of those by fold angles [..., N]."""
        out = np.zeros((self.variables, *rows.shape[:-1]))
        np.add.at(out, self.orbit, np.moveaxis(self.sign * rows, -1, 0))
        return np.moveaxis(out, 0, -1)

    def reduce(self, phi: np.ndarray) -> np.ndarray:
        """Return the variables [..., n] of fold angles [..., N]: means over orbits."""
        # what the mean adds is 0 where all agree, to the last bit
        y = (self.sign * phi)[..., self._first]
        return np.asarray(y + self.gather(phi - self.expand(y)) / self.multiplicity)

    def limits(self, limits: FoldLimits) -> FoldLimits:
        """Return between which angles variables are, [n], where all that follow them are within theirs [N]."""
        low, high = np.full(self.variables, -np.inf), np.full(self.variables, np.inf)
        turned = self.sign < 0
        np.maximum.at(low, self.orbit, np.where(turned, -limits.high, limits.low))
        np.minimum.at(high, self.orbit, np.where(turned, -limits.low, limits.high))
        return FoldLimits(low, high)

    def laws(self, laws: Sequence[HingeLaw | None]) -> tuple[HingeLaw | None, ...]:
        """Return the law of each variable, of those of all creases: that of the first crease that follows it."""
        return tuple(laws[c] for c in np.unique(self.orbit, return_index=True)[1].tolist())

    @cached_property
    def _triangles(self) -> list[tuple[int, int, int]]:
        """Of each facet three of its corners, which stand for its plane."""
        p, found = self.pattern, dict[int, tuple[int, int, int]]()
        for ring, facet in zip(p.polygons, p.facet_of.tolist(), strict=True):
            found.setdefault(facet, (ring[0], ring[1], ring[2]))
        return [found[f] for f in range(p.facets)]

    @cached_property
    def _signs(self) -> dict[tuple[int, ...], float]:
        """Of triangles of corners whether they run as that of their facet; filled in as they are asked for."""
        return {}

    def _sign(self, facet: int, corners: tuple[int, ...]) -> float:
        known = self._signs.get((facet, *corners))
        if known is None:
            x = self.pattern.corners
            one, other = area_vectors(x[[list(corners), list(self._triangles[facet])]])
            known = self._signs[facet, *corners] = float(np.sign(one @ other))
        return known

    @cached_property
    def _moves(self) -> dict[tuple[int, int], tuple[np.ndarray, np.ndarray]]:
        """Of images, by their place in `images`, and facets: the map of points of the facet to those of its image."""
        found, x = {}, self.pattern.corners
        for k, by in enumerate(self.images):
            for facet, corners in enumerate(self._triangles):
                (a, u, v), (b, p, q) = (
                    (y[0], *(y[1:] - y[0]))
                    for y in (x[list(corners)], x[by.corners[list(corners)]])
                )
                turn = np.stack([p, q], axis=1) @ np.linalg.pinv(np.stack([u, v], axis=1))
                found[k, facet] = turn, b - turn @ a
        return found

    def _image(self, touch: ContactPair, k: int) -> tuple[tuple[Any, ...], ContactPair]:
        """Return the image k of a contact, -1 for itself, in the one way of those that say the same, and its key."""
        sign, (i, j) = touch.sign, touch.facets
        four: Any = touch.corners
        if k >= 0:
            by = self.images[k]
            sign, (i, j) = sign * by.turns, by.facets_of(i, j)
            four = by.corners_of(four)
        if touch.type == "edge-edge":
            p, q, r, s = four
            # each exchange of two ends turns the common normal
            if p > q:
                p, q, sign = q, p, -sign
            if r > s:
                r, s, sign = s, r, -sign
            if (j, r, s) < (i, p, q):
                i, p, q, j, r, s = j, r, s, i, p, q
            made = ContactPair("edge-edge", (i, j), (p, q, r, s), sign)
            return (made.facets, made.corners, sign), made
        sign *= self._sign(i, four[1:])
        corners: Any = (four[0], *self._triangles[i])
        if touch.type == "vertex-face":
            made = ContactPair("vertex-face", (i, j), corners, sign)
            return (made.facets, made.corners, sign), made
        points = {name: np.array(getattr(touch, name)) for name in ("place", "middle")}
        if k >= 0:
            turn, shift = self._moves[k, touch.facets[1]]
            points = {name: turn @ point + shift for name, point in points.items()}
        places: dict[str, Any] = {name: tuple(point.tolist()) for name, point in points.items()}
        made = replace(touch, facets=(i, j), corners=corners, sign=sign, **places)
        at = (points["place"].round(DIGITS) + 0.0).tolist()
        return (made.facets, made.corners, *at, sign), made

    def images_of(self, touch: ContactPair) -> dict[tuple[object, ...], ContactPair]:
        """Return a contact and its images by what tells them apart, the one that stands for all first."""
        return dict(sorted((self._image(touch, k) for k in range(-1, len(self.images))), key=KEY))


def orbits_of(pattern: Pattern, symmetries: Sequence[tuple[Sequence[int], int]]) -> Orbits:
    """Return the orbits of creases under symmetries of a pattern.

    Parameters
    ----------
    pattern
        The paper.
    symmetries
        A group, each as the images of all corners [V], and -1 where it turns the paper over, else 1.

    Returns
    -------
    Orbits
        Variables in the order of the first crease that follows each.

    Raises
    ------
    KeyError
        If corners of a polygon, or of a crease, go to none.
    """
    number = {frozenset(pair): c for c, pair in enumerate(pattern.ends.tolist())}
    orbit, sign = np.full(pattern.creases, -1), np.ones(pattern.creases)
    maps = [(np.asarray(to), s) for to, s in symmetries]
    for c, ends in enumerate(pattern.ends):
        if orbit[c] < 0:
            v = int(orbit.max(initial=-1)) + 1
            for to, s in maps:
                image = number[frozenset(to[ends].tolist())]
                orbit[image], sign[image] = v, s
            orbit[c], sign[c] = v, 1.0
    identity = np.arange(len(pattern.corners))
    images = tuple(
        Image.of(pattern, to.tolist(), s) for to, s in maps if s < 0 or (to != identity).any()
    )
    return Orbits(pattern, orbit, sign, images)
