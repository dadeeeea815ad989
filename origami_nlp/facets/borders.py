"""Facets that meet at borders: of several gaps one at least stays open, whichever.

A side s of one facet that leads away from the plane of another facet meets it in a point.  Beside a state in which
that point is on the border of the facet, the side passes through the facet exactly if its end is on the other side of
the plane (where the point is an end of the side) and the point is inside every border on which it was.  Paper that
does not cross therefore keeps one of these gaps open, for every side and facet that meet:

- that of the end over the facet, if the point is an end of the side,
- that of the side beside the border, for one border, or two where the point is a corner.

Sides that lie in the plane of the facet say nothing here; those that start where they end do.  So sides that lie along
each other are told by the sides that come next, and facets that lie on each other by nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from origami_nlp.facets.features import Features
from origami_nlp.facets.touches import Placed, Touch
from origami_nlp.numerics import CLOSES, DEEP, INSIDE, NONZERO, cross

STEEP = math.sqrt(INSIDE)
"""Slope of a side over the plane of a facet above which it leads away from it."""
Choice: TypeAlias = tuple[Touch, ...]
"""Gaps of which one at least is not negative where facets do not cross."""


def choices(features: Features, at: Placed, reach: float = 0.0) -> list[Choice]:
    """Return what keeps facets apart that meet at borders, each once.

    Parameters
    ----------
    features
        Of a pattern.
    at
        A closed state in which no facets cross.
    reach
        Over the sheet's size: how close to each other sides and borders are that do not touch; 0: those that do alone.

    Returns
    -------
    list of tuple of Touch
        Gaps of which one at least stays open beside the state; all of them are closed there where `reach` is 0.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> from origami_nlp.facets import Features, Placed, Sheet, choices
    >>> sheet = Sheet(o.examples.pattern("miura", 2, 2))
    >>> choices(Features(sheet.crossings), Placed(sheet.crossings.poses, np.zeros(4)))
    []
    """
    crossings = features.crossings
    x = crossings.carried(at.turn, at.shift)
    pairs = crossings.candidates(x, margin=0.5 * max(DEEP, reach) * crossings.size)
    found: dict[object, Choice] = {}
    for a, b in (pairs.T, pairs[:, ::-1].T):
        for choice in _sides_on_faces(features, x, a, b, reach):
            if reach or max(abs(t.gap(at)) for t in choice) <= 10 * CLOSES * crossings.size:
                found.setdefault(frozenset((t.key, t.sign) for t in choice), choice)
    return list(found.values())


def _sides_on_faces(
    features: Features, x: np.ndarray, a: np.ndarray, b: np.ndarray, reach: float
) -> Iterator[Choice]:
    """Go through sides of pieces a that meet the borders of pieces b, [K] each; x are corners [P, q, 3]."""
    if not len(a):
        return
    rings, crossings = features.rings_of_pieces, features.crossings
    near, inside = max(DEEP, reach) * crossings.size, max(INSIDE, reach)
    k = np.arange(len(a))[:, None]
    of, on = x[a], x[b]
    next_on = on[k, rings.after[b]]
    normal = cross(on - on[:, :1], next_on - on[:, :1]).sum(axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    inward = cross(normal[:, None], next_on - on)
    inward /= np.maximum(np.linalg.norm(inward, axis=2, keepdims=True), NONZERO)
    after = rings.after[a]
    start, end = of, of[k, after]
    low, high = (np.einsum("kqi,ki->kq", y - on[:, :1], normal) for y in (start, end))
    length = np.linalg.norm(end - start, axis=2)
    steep = rings.valid[a] & (np.abs(high - low) > STEEP * length)
    rise = np.where(steep, high - low, 1.0)
    # where along the side its height over the plane is 0
    share = np.clip(-low / rise, 0.0, 1.0)
    point = start + share[..., None] * (end - start)
    # distance of that point inside each border of the other piece, [K, side, border]
    depth = np.einsum("kqpi,kpi->kqp", point[:, :, None] - on[:, None], inward)
    depth = np.where(rings.valid[b][:, None], depth, np.inf)
    border = depth <= inside * crossings.size
    met = steep & (np.minimum(np.abs(low), np.abs(high)) <= near) | (steep & (low * high < 0))
    met &= (depth.min(axis=2) >= -near) & (border & rings.border[b][:, None]).any(axis=2)
    ids, facet = crossings.pieces, crossings.facet
    for p, i in np.argwhere(met):
        one, other = int(ids[a[p], i]), int(ids[a[p], after[p, i]])
        f, g = int(facet[a[p]]), int(facet[b[p]])
        room = inside * length[p, i]
        sides = [(int(ids[b[p], j]), int(ids[b[p], rings.after[b[p], j]]), j)
                 for j in np.flatnonzero(border[p, i])]  # fmt: skip
        ends = share[p, i] * length[p, i] <= room, (1 - share[p, i]) * length[p, i] <= room
        # the corner of the side that lies on the border, if its end does
        here = one if ends[0] else other if ends[1] else -1
        if here in ids[b[p]] or len(sides) + any(ends) < 2:
            continue  # a common corner stays one; what meets inside has a gap of its own
        # an end that lies on the plane has a gap over the facet; each border beside it has one of its own
        gaps = []
        if any(ends):
            away = high[p, i] if ends[0] else low[p, i]
            corners = (here, *map(int, rings.triangle[b[p]]))
            gaps.append(Touch("vertex-face", (g, f), corners, float(np.sign(away))))  # type: ignore[arg-type]
        for q, r, j in sides:
            way = cross(end[p, i] - start[p, i], next_on[p, j] - on[p, j])
            sign = float(np.sign(way @ inward[p, j]))
            gaps.append(Touch("edge-edge", (f, g), (one, other, q, r), sign))
        yield tuple(gaps)
