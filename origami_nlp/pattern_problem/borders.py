"""Facets that meet at borders: of several gaps one at least stays open, whichever.

A side s of one facet that leads away from the plane of another facet meets it in a point.  Beside a state in which
that point is on the border of the facet, the side passes through the facet exactly if its end is on the other side of
the plane (where the point is an end of the side) and the point is inside every border on which it was.  Paper that
does not cross therefore keeps one of these gaps open, for every side and facet that meet:

- that of the end over the facet, if the point is an end of the side,
- that of the side beside the border, for one border, or two where the point is a corner.

Sides that lie in the plane of the facet say nothing here; those that start where they end do.  So sides that lie along
each other are distinguished by the sides that come next, and facets that lie on each other by nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, DEEP, INSIDE, cross
from origami_nlp.pattern_problem.contact_pairs import ContactPair, FoldedGeometry
from origami_nlp.pattern_problem.features import Features, Planes

STEEP = math.sqrt(INSIDE)
"""Slope of a side over the plane of a facet above which it leads away from it."""
Disjunction: TypeAlias = tuple[ContactPair, ...]
"""Gaps of which one at least is not negative where facets do not cross."""


def choices(features: Features, at: FoldedGeometry, reach: float = 0.0) -> list[Disjunction]:
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
    >>> from origami_nlp.pattern_problem import Features, FoldedGeometry, PatternProblem, choices
    >>> problem = PatternProblem(o.examples.pattern("miura", 2, 2))
    >>> choices(Features(problem.crossings), FoldedGeometry(problem.crossings.poses, np.zeros(4)))
    []
    """
    crossings = features.crossings
    planes = features.planes(at)
    pairs = crossings.candidates(planes.x, margin=0.5 * max(DEEP, reach) * crossings.size)
    found: dict[object, Disjunction] = {}
    for choice in _sides_on_faces(features, planes, np.vstack([pairs, pairs[:, ::-1]]), reach):
        if reach or max(abs(t.gap(at)) for t in choice) <= 10 * CLOSURE_TOL * crossings.size:
            found.setdefault(frozenset((t.key, t.sign) for t in choice), choice)
    return list(found.values())


def without_passing(
    features: Features, found: list[Disjunction]
) -> list[tuple[tuple[ContactPair, ...], ...]]:
    """Return choices as options of one or more gaps, joined for two sides of one facet that meet in a corner.

    Where the sides lead to both sides of the plane of another facet, each asks the corner to its own.  Exactly on the
    plane both gaps are closed, but inside the border the facet of the two sides passes through the other one there, in
    the line of both planes.  So the corner is on one side, and the side that leads to the other is beside the border.

    Parameters
    ----------
    features
        Of a pattern.
    found
        Of `choices`.

    Returns
    -------
    list of tuple of tuple of ContactPair
        Choices, each a tuple of options: all gaps of one option at least stay open.
    """
    over = [c[0] if c[0].type == "vertex-face" else None for c in found]
    # corners over one facet: before each the others
    same: dict[object, list[int]] = {}
    out: list[tuple[tuple[ContactPair, ...], ...]] = []
    joined: set[int] = set()
    for k, one in enumerate(over):
        if one is None:
            continue
        before = same.setdefault(one.key, [])
        for m in before:
            other = over[m]
            if other is None or one.sign == other.sign:
                continue
            sides = {*found[k][1].corners[:2], *found[m][1].corners[:2]}
            if len(sides) == 3 and any(ring >= sides for ring in features.rings):
                joined |= {k, m}
                out.append((*((one, t) for t in found[m][1:]), *((other, t) for t in found[k][1:])))
        before.append(k)
    rest = [tuple((t,) for t in c) for k, c in enumerate(found) if k not in joined]
    return rest + out


def _sides_on_faces(
    features: Features, planes: Planes, pairs: np.ndarray, reach: float
) -> Iterator[Disjunction]:
    """Go through sides of the first piece of each pair [K, 2] that meet the borders of the second one."""
    rings, crossings = features.rings_of_pieces, features.crossings
    near, inside = max(DEEP, reach) * crossings.size, max(INSIDE, reach)
    ids, facet = crossings.pieces, crossings.facet
    # sides that come to the plane of the other piece at other places than at a common corner, which stays one
    a, b = pairs.T
    low = np.einsum("kqi,ki->kq", planes.x[a] - planes.x[b][:, :1], planes.normal[b])
    after = rings.after[a]
    high = np.take_along_axis(low, after, axis=1)
    length = np.linalg.norm(planes.side[a], axis=2)
    met = rings.valid[a] & (np.abs(high - low) > STEEP * length)
    met &= (np.minimum(np.abs(low), np.abs(high)) <= near) | (low * high < 0)
    # where along the side its height over the plane is 0
    share = np.clip(-low / np.where(met, high - low, 1.0), 0.0, 1.0)
    room = inside * length
    ends = np.stack([share * length <= room, (1 - share) * length <= room])
    common = (ids[a][:, :, None] == ids[b][:, None]).any(axis=2)
    met &= ~np.where(ends[0], common, ends[1] & np.take_along_axis(common, after, axis=1))
    pair, i = np.nonzero(met)
    a, b, low, high, share = a[pair], b[pair], low[pair, i], high[pair, i], share[pair, i]
    length, (first, last) = length[pair, i], ends[:, pair, i]
    side = planes.side[a, i]
    point = planes.x[a, i] + share[:, None] * side
    # distance of that point inside each border of the other piece, [K, border]
    depth = np.einsum("kpi,kpi->kp", point[:, None] - planes.x[b], planes.inward[b])
    depth = np.where(rings.valid[b], depth, np.inf)
    border = depth <= inside * crossings.size
    # pieces with one common corner are sectors about it: only borders that start there part them
    shared = (ids[a][:, :, None] == ids[b][:, None]) & (
        rings.valid[a][:, :, None] & rings.valid[b][:, None]
    )
    here = shared.any(axis=1)
    starts = here | np.take_along_axis(here, rings.after[b], axis=1)
    border &= starts | (shared.sum(axis=(1, 2)) != 1)[:, None]
    on = (depth.min(axis=1, initial=np.inf) >= -near) & (border & rings.border[b]).any(axis=1)
    # what meets inside has a gap of its own
    on &= border.sum(axis=1) + (first | last) >= 2
    a, b, i, low, high = a[on], b[on], i[on], low[on], high[on]
    first, last, border = first[on], last[on], border[on]
    towards = cross(side[on][:, None], planes.side[b])
    signs = np.sign(np.einsum("kpi,kpi->kp", towards, planes.inward[b])).tolist()
    away = np.sign(np.where(first, high, low)).tolist()
    ends = np.column_stack([ids[a, i], ids[a, rings.after[a, i]]])
    here = np.where(first, ends[:, 0], ends[:, 1]).tolist()
    sides = np.stack([ids[b], np.take_along_axis(ids[b], rings.after[b], axis=1)], axis=2).tolist()
    triangles = rings.triangle[b].tolist()
    facets = np.column_stack([facet[a], facet[b]]).tolist()
    touches = (first | last).tolist()
    for k, ((one, other), (f, g)) in enumerate(zip(ends.tolist(), facets, strict=True)):
        # an end that lies on the plane has a gap over the facet; each border beside it has one of its own
        gaps = []
        if touches[k]:
            corners = (here[k], *triangles[k])
            gaps.append(ContactPair("vertex-face", (g, f), corners, away[k]))
        for j in np.flatnonzero(border[k]).tolist():
            corners = (one, other, *sides[k][j])
            gaps.append(ContactPair("edge-edge", (f, g), corners, signs[k][j]))
        yield tuple(gaps)
