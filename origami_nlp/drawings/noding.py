"""Lines made edges that meet in vertices: ends joined, lines split where others end on them or cross, each once.

Letters are carried: where lines lie on each other the border wins, then cuts, then folds, then what is unassigned or
flat; a mountain on a valley is a fault, and both stay.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.errors import DrawingError
from origami_nlp.numerics import groups

RANKS = {"B": 0, "C": 1, "M": 2, "V": 2, "U": 3, "F": 4}
"""Which letter stays where two lie on each other: the lowest; M and V contradict each other."""
GRAIN = 0.25
"""Of the tolerance: side of squares whose points are one, so that many points in a place are few pairs."""
MOST_MEETINGS, A_TIME = 4_000_000, 1000
"""Ends on lines and crossings of a drawing, and shapes that are looked at together."""
Edge = tuple[int, int, int, frozenset[int]]
"""Both vertices, the line whose letter and fold angle it has, and the lines that lie on it."""
ROUNDS = 30
"""Of joining and splitting; drawings take two to four."""


@dataclass(frozen=True, eq=False)
class Noded:
    """A drawing as edges between vertices.

    Attributes
    ----------
    points
        [V, 2]; each one that the drawing states, or a crossing.
    edges
        Vertices, the smaller first, [E, 2]; where mountain lies on valley, both.
    letters
        One an edge.
    angles
        Fold angles [deg], [E].
    moved
        How far an end is from the vertex that it was joined to, at most.
    clashes
        Edges (positions) that are drawn as mountain and as valley, or with two fold angles.
    repairs
        How many of what were mended.
    """

    points: np.ndarray
    edges: np.ndarray
    letters: tuple[str, ...]
    angles: np.ndarray
    moved: float
    clashes: tuple[int, ...]
    repairs: dict[str, int]


def node(ends: np.ndarray, letters: Sequence[str], angles: np.ndarray, tolerance: float) -> Noded:
    """Make edges and vertices of lines.

    Parameters
    ----------
    ends
        [n, 2, 2].
    letters
        One a line.
    angles
        Fold angles [deg], [n]; NaN where not given.
    tolerance
        Distance within which points are one, and lie on lines.

    Returns
    -------
    Noded
        In the order of the lines.

    Raises
    ------
    DrawingError
        If lines go on splitting each other.

    Examples
    --------
    >>> import numpy as np
    >>> cross = np.array([[[0, 0], [2, 2]], [[0, 2], [2, 0.0]]])
    >>> made = node(cross, "MV", np.full(2, np.nan), 1e-6)
    >>> made.points[-1].tolist(), made.edges.tolist(), made.letters
    ([1.0, 1.0], [[0, 4], [1, 4], [2, 4], [3, 4]], ('M', 'M', 'V', 'V'))
    """
    given = ends.reshape(-1, 2)
    points, at = _join(given, len(given), tolerance)
    off, drawn, split, crossed = points[at] - given, len(points), 0, 0
    # pieces of lines: both vertices and the line, [P, 3]
    pieces = np.column_stack([at.reshape(-1, 2), np.arange(len(ends))])
    kinds = np.unique(list(letters), return_inverse=True)[1].ravel(), np.nan_to_num(angles, nan=1e3)
    whole = _with_length(pieces)
    pieces = _once(whole, *(kind[whole[:, 2]] for kind in kinds))
    twice = len(whole) - len(pieces)
    for _ in range(ROUNDS):
        pieces, cuts = _split_at_points(points, pieces, tolerance)
        split += cuts
        pieces = _once(pieces, pieces[:, 2])
        more, pieces = _split_at_crossings(points, pieces)
        if not len(more):
            break
        crossed += len(more)
        points, at = _join(np.concatenate([points, more]), drawn, tolerance)
        pieces = _with_length(np.column_stack([at[pieces[:, :2]], pieces[:, 2]]))
    else:
        raise DrawingError("the drawing: its lines split each other on and on: --tolerance, larger")
    on: dict[tuple[int, int], list[int]] = {}
    for a, b, k in np.column_stack([np.sort(pieces[:, :2], axis=1), pieces[:, 2]]).tolist():
        on.setdefault((a, b), []).append(k)
    said = [(letter, str(angle)) for letter, angle in zip(letters, angles, strict=True)]
    kept = _straightened(_merged(on, said), said)
    used, edges = np.unique(np.array([(a, b) for a, b, *_ in kept], int), return_inverse=True)
    lines = [k for _, _, k, _ in kept]
    repairs = {
        "ends joined": int((np.abs(off).max(axis=1) > 0).sum()),
        "lines split where others end on them": split,
        "crossings made vertices": crossed,
        "lines drawn again": twice + sum(len(several) - 1 for several in on.values()),
        "lines shorter than the tolerance left out": len(ends) - len(whole),
    }
    moved = float(np.linalg.norm(off, axis=1).max(initial=0.0))
    names = tuple(letters[k] for k in lines)
    told = names, angles[lines].astype(float), moved, tuple(sorted(_doubled(kept))), repairs
    return Noded(points[used], edges.reshape(-1, 2), *told)


def _join(points: np.ndarray, drawn: int, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Join points within the tolerance; one stays of each group: of those drawn (the first) the nearest to its middle.

    Returns the points that stay, and which one each point became.
    """
    group = groups(len(points), _near(points, tolerance))
    many = np.bincount(group)
    mean = np.stack([np.bincount(group, weights=x) for x in points.T], axis=1) / many[:, None]
    off = np.linalg.norm(points - mean[group], axis=1)
    order = np.lexsort((off, np.arange(len(points)) >= drawn, group))
    first = order[np.concatenate([[True], np.diff(group[order]) > 0])]
    return points[first], group


def _near(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Return pairs of points by which all hang together that are as near, [P, 2]: not all pairs, of many in a place."""
    from scipy.spatial import cKDTree

    places = np.floor(points / (GRAIN * tolerance))
    _, first, of = np.unique(places, axis=0, return_index=True, return_inverse=True)
    near = cKDTree(points[first]).query_pairs(tolerance, output_type="ndarray")
    alike = np.column_stack([np.arange(len(points)), first[of.ravel()]])
    return np.concatenate([alike, first[near]])


def _with_length(pieces: np.ndarray) -> np.ndarray:
    return pieces[pieces[:, 0] != pieces[:, 1]]


def _once(pieces: np.ndarray, *kinds: np.ndarray) -> np.ndarray:
    """Return the pieces, in order, without those that have the ends and kinds of one before."""
    key = np.column_stack([np.sort(pieces[:, :2], axis=1), *kinds])
    kept: np.ndarray = pieces[np.sort(np.unique(key, axis=0, return_index=True)[1])]
    return kept


def _pairs(tree: Any, shapes: np.ndarray, **how: Any) -> np.ndarray:
    """Return which shapes meet which of a tree, [2, P]; many at a time, so that too many are refused in time."""
    found, total = [np.zeros((2, 0), int)], 0
    for begin in range(0, len(shapes), A_TIME):
        found.append(tree.query(shapes[begin : begin + A_TIME], **how) + np.array([[begin], [0]]))
        total += found[-1].shape[1]
        if total > MOST_MEETINGS:
            raise DrawingError(f"the drawing: its lines meet more than {MOST_MEETINGS:,} times")
    return np.concatenate(found, axis=1)


def _split_at_points(
    points: np.ndarray, pieces: np.ndarray, tolerance: float
) -> tuple[np.ndarray, int]:
    """Split pieces where a point lies on them; how many were."""
    from shapely import STRtree, linestrings, points as as_points

    used, ends = np.unique(pieces[:, :2]), points[pieces[:, :2]]
    tree = STRtree(linestrings(ends))
    which, piece = _pairs(tree, as_points(points[used]), predicate="dwithin", distance=tolerance)
    vertex, (a, b) = used[which], ends[piece].swapaxes(0, 1)
    along = ((points[vertex] - a) * (b - a)).sum(axis=1) / ((b - a) ** 2).sum(axis=1)
    inside = (vertex[:, None] != pieces[piece, :2]).all(axis=1) & (along > 0) & (along < 1)
    piece, vertex, along = piece[inside], vertex[inside], along[inside]
    return _cut(pieces, piece, vertex, along), len(np.unique(piece))


def _cut(
    pieces: np.ndarray, piece: np.ndarray, vertex: np.ndarray, along: np.ndarray
) -> np.ndarray:
    """Split pieces at vertices, which lie on them in the order of `along`."""
    every = np.arange(len(pieces))
    owner = np.concatenate([every, piece, every])
    where = np.concatenate([np.full(len(pieces), -1.0), along, np.full(len(pieces), 2.0)])
    chain = np.concatenate([pieces[:, 0], vertex, pieces[:, 1]])
    order = np.lexsort((where, owner))
    owner, chain = owner[order], chain[order]
    cut = np.column_stack([chain[:-1], chain[1:], pieces[owner[:-1], 2]])
    kept: np.ndarray = cut[owner[:-1] == owner[1:]]
    return kept


def _split_at_crossings(points: np.ndarray, pieces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points at which pieces cross, numbered on from those there are, and the pieces split there."""
    import shapely

    ends = pieces[:, :2]
    shapes = shapely.linestrings(points[ends])
    one, other = _pairs(shapely.STRtree(shapes), shapes, predicate="intersects")
    apart = (one < other) & (ends[one][:, :, None] != ends[other][:, None, :]).all(axis=(1, 2))
    one, other = one[apart], other[apart]
    meet = shapely.intersection(shapes[one], shapes[other])
    sure = shapely.get_type_id(meet) == 0
    both, met = np.concatenate([one[sure], other[sure]]), np.tile(meet[sure], 2)
    new = shapely.get_coordinates(meet[sure])
    along = shapely.line_locate_point(shapes[both], met, normalized=True)
    return new, _cut(pieces, both, len(points) + np.tile(np.arange(len(new)), 2), along)


def _merged(on: dict[tuple[int, int], list[int]], said: Sequence[tuple[str, str]]) -> list[Edge]:
    """Merge the lines on each edge: what the first rank among them says of it."""
    kept: list[Edge] = []
    for (a, b), several in on.items():
        top = min(RANKS[said[k][0]] for k in several)
        first = {said[k]: k for k in reversed(several) if RANKS[said[k][0]] == top}
        each = sorted(first.values(), key=several.index)
        stated = {letter for letter, angle in first if angle != "nan"}
        if top == RANKS["M"]:
            each = [k for k in each if said[k][1] != "nan" or said[k][0] not in stated]
        else:
            each = each[:1]
        kept += [(a, b, k, frozenset(several)) for k in each]
    return kept


def _doubled(kept: list[Edge]) -> set[int]:
    """Return the edges that are there in several ways."""
    many = Counter(edge[:2] for edge in kept)
    return {i for i, edge in enumerate(kept) if many[edge[:2]] > 1}


def _straightened(kept: list[Edge], said: Sequence[tuple[str, str]]) -> list[Edge]:
    """Join edges at points where nothing but one line goes on: its split was that of a line on it."""
    fixed, at = _doubled(kept), dict[int, list[int]]()
    for e, (a, b, *_) in enumerate(kept):
        at.setdefault(a, []).append(e)
        at.setdefault(b, []).append(e)
    joined = []
    for both in at.values():
        if len(both) == 2 and not fixed & {*both}:
            (*_, k, lines), (*_, m, others) = (kept[e] for e in both)
            joined += [both] if said[k] == said[m] and lines & others else []
    chains: dict[int, list[int]] = {}
    for e, chain in enumerate(groups(len(kept), np.array(joined, int).reshape(-1, 2)).tolist()):
        chains.setdefault(chain, []).append(e)
    out: list[Any] = []
    for edges in chains.values():
        met = Counter(v for e in edges for v in kept[e][:2])
        ends = sorted(v for v, many in met.items() if many == 1)
        whole = len(edges) > 1 and len(ends) == 2
        out += [(*ends, *kept[edges[0]][2:])] if whole else [kept[e] for e in edges]
    return out
