"""States that keep a symmetry of the paper: their fold angles are a linear map of fewer variables, phi = sign y[orbit].

A symmetry takes corners to corners, and with them facets, creases and contacts.  On states that keep it a contact and
its images are one inequality: the first of them stands for all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from origami_nlp.numerics import area_vectors
from origami_nlp.pattern import HingeLaw, Pattern
from origami_nlp.pattern_problem.contact_pairs import ContactPair
from origami_nlp.problem import FoldLimits

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
        return np.asarray(self.gather(np.asarray(phi, float)) / self.multiplicity)

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
    def _triangles(self) -> tuple[list[tuple[int, int, int]], np.ndarray]:
        """Of each facet three of its corners, and its normal in the reference state, [F, 3]."""
        p, found = self.pattern, dict[int, tuple[int, int, int]]()
        normal = np.zeros((p.facets, 3))
        for ring, facet in zip(p.polygons, p.facet_of.tolist(), strict=True):
            normal[facet] += area_vectors(p.corners[list(ring)])
            found.setdefault(facet, (ring[0], ring[1], ring[2]))
        return [found[f] for f in range(p.facets)], normal

    def _image(self, touch: ContactPair, by: Image | None) -> ContactPair:
        """Return the image of a contact, written in the one way of those that say the same."""
        x, (triangles, normals) = self.pattern.corners, self._triangles
        sign, (i, j) = touch.sign, touch.facets
        four = list(touch.corners)
        if by is not None:
            sign, i, j = sign * by.turns, int(by.facets[i]), int(by.facets[j])
            four = [c if c < 0 else int(by.corners[c]) for c in four]
        if touch.type == "edge-edge":
            (p, q), (r, s) = sorted(four[:2]), sorted(four[2:])
            # each exchange of two ends turns the common normal
            sign *= (-1.0) ** ((p != four[0]) + (r != four[2]))
            one, other = sorted([(i, p, q), (j, r, s)])
            (i, p, q), (j, r, s) = one, other
            return ContactPair("edge-edge", (i, j), (p, q, r, s), sign)
        a, b, c = x[four[1:]]
        sign *= float(np.sign(np.cross(b - a, c - a) @ normals[i]))
        corners = (four[0], *triangles[i])
        return replace(touch, facets=(i, j), corners=corners, sign=sign, **self._place(touch, by))

    def _place(self, touch: ContactPair, by: Image | None) -> dict[str, tuple[float, ...]]:
        """Return where points on a facet go, of contacts that have some."""
        if touch.type != "face-face":
            return {}
        found = {name: np.array(getattr(touch, name)) for name in ("place", "middle")}
        if by is not None:
            of, x = list(self._triangles[0][touch.facets[1]]), self.pattern.corners
            back = np.linalg.pinv(np.column_stack([x[of[1]] - x[of[0]], x[of[2]] - x[of[0]]]))
            to = x[by.corners[of]]
            for name, point in found.items():
                s, t = back @ (point - x[of[0]])
                found[name] = to[0] + s * (to[1] - to[0]) + t * (to[2] - to[0])
        return {name: tuple(point.tolist()) for name, point in found.items()}

    def images_of(self, touch: ContactPair) -> dict[tuple[object, ...], ContactPair]:
        """Return a contact and its images by what tells them apart, the one that stands for all first."""
        found: dict[tuple[object, ...], ContactPair] = {}
        for by in (None, *self.images):
            image = self._image(touch, by)
            at = np.round(getattr(image, "place", ()), DIGITS) + 0.0
            found.setdefault((image.facets, image.corners, *at.tolist(), image.sign), image)
        return dict(sorted(found.items()))


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
