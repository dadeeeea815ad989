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

RANKS = ("B", "C", "MV", "U", "F")
"""Which letter stays where two lie on each other: the first; M and V contradict each other."""
MOST_MEETINGS, A_TIME = 4_000_000, 1000
"""Ends on lines and crossings of a drawing, and shapes that are looked at together."""
Edge = tuple[int, int, str, float, frozenset[int]]
"""Both vertices, the letter, the fold angle, and the lines that lie on it."""
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
    points = ends.reshape(-1, 2)
    points, at = _join(points, len(points), tolerance)
    moved = float(np.linalg.norm(points[at] - ends.reshape(-1, 2), axis=1).max(initial=0.0))
    joined = int((np.abs(points[at] - ends.reshape(-1, 2)).max(axis=1) > 0).sum())
    pieces, line, vanished = _remap(at, np.arange(len(at)).reshape(-1, 2), np.arange(len(ends)))
    pieces, line = _twice_at_most(pieces, line, letters, angles)
    drawn, split, crossed = len(points), 0, 0
    for _ in range(ROUNDS):
        pieces, line, cuts = _split_at_points(points, pieces, line, tolerance)
        split += cuts
        pieces, line = _once_a_line(pieces, line)
        more, pieces, line = _split_at_crossings(points, pieces, line)
        if not len(more):
            break
        crossed += len(more)
        points, at = _join(np.concatenate([points, more]), drawn, tolerance)
        pieces, line, _ = _remap(at, pieces, line)
    else:
        raise DrawingError(
            "the drawing: its lines go on splitting each other: take a larger tolerance"
        )
    on: dict[tuple[int, int], list[int]] = {}
    for (a, b), k in zip(np.sort(pieces, axis=1).tolist(), line.tolist(), strict=True):
        on.setdefault((a, b), []).append(k)
    kept = _straightened(_merged(on, letters, angles))
    used, edges = np.unique(np.array([(a, b) for a, b, *_ in kept], int), return_inverse=True)
    _, _, names, phi, _ = zip(*kept, strict=True) if kept else ((),) * 5
    repairs = {
        "ends joined": joined,
        "lines split where others end on them": split,
        "crossings made vertices": crossed,
        "edges drawn more than once": sum(len(several) > 1 for several in on.values()),
        "lines shorter than the tolerance left out": vanished,
    }
    edges, clashes = edges.reshape(-1, 2), tuple(_doubled(kept))
    return Noded(points[used], edges, names, np.array(phi, float), moved, clashes, repairs)


def _join(points: np.ndarray, drawn: int, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Return one point for each group within the tolerance, and which each belongs to; drawn: the first ones are."""
    group = groups(len(points), _near(points, tolerance))
    count = int(group.max()) + 1
    many = np.bincount(group, minlength=count)
    mean = (
        np.stack([np.bincount(group, weights=points[:, k]) for k in (0, 1)], axis=1) / many[:, None]
    )
    # the member next to the mean stands for all: its coordinates are the file's, those of a drawn one if there is one
    off = np.linalg.norm(points - mean[group], axis=1)
    order = np.lexsort((off, np.arange(len(points)) >= drawn, group))
    first = order[np.concatenate([[True], np.diff(group[order]) > 0])]
    return points[first], group


def _near(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Return pairs of points by which all hang together that are as near, [P, 2]: not all pairs, of many in a place.

    Points in one square of half the tolerance are one, and of two such squares the nearest points count.
    """
    from scipy.spatial import cKDTree

    places = np.floor(points / (0.5 * tolerance))
    squares, first, of = np.unique(places, axis=0, return_index=True, return_inverse=True)
    of = of.ravel()
    order, many = np.argsort(of, kind="stable"), np.bincount(of)
    members = np.split(order, np.cumsum(many)[:-1])
    # of squares at most two apart in x and in y points may be near
    a, b = cKDTree(squares).query_pairs(2.0, p=np.inf, output_type="ndarray").T
    alone = (many[a] == 1) & (many[b] == 1)
    near = np.linalg.norm(points[first[a]] - points[first[b]], axis=1) <= tolerance
    pairs = [np.column_stack([np.arange(len(points)), first[of]])]
    pairs.append(np.column_stack([first[a], first[b]])[alone & near])
    for k in np.flatnonzero(~alone).tolist():
        one, other = members[a[k]], members[b[k]]
        least = cKDTree(points[one]).query(points[other])[0].min()
        pairs.append(np.array([[one[0], other[0]]] if least <= tolerance else []).reshape(-1, 2))
    return np.concatenate(pairs).astype(int)


def _remap(
    at: np.ndarray, pieces: np.ndarray, line: np.ndarray
) -> tuple[np.ndarray, np.ndarray, int]:
    pieces = at[pieces]
    keep = pieces[:, 0] != pieces[:, 1]
    return pieces[keep], line[keep], int((~keep).sum())


def _once_a_line(pieces: np.ndarray, line: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the pieces of each line once, in order."""
    key = np.column_stack([line, np.sort(pieces, axis=1)])
    first = np.sort(np.unique(key, axis=0, return_index=True)[1])
    return pieces[first], line[first]


def _twice_at_most(
    pieces: np.ndarray, line: np.ndarray, letters: Sequence[str], angles: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return two of the pieces, in order, that are drawn alike with the same ends."""
    known = np.unique(np.array(list(letters)), return_inverse=True)[1].ravel()[line]
    key = np.column_stack([np.sort(pieces, axis=1), known, np.nan_to_num(angles[line], nan=1e3)])
    alike = np.unique(key, axis=0, return_inverse=True)[1].ravel()
    order = np.argsort(alike, kind="stable")
    begin = np.searchsorted(alike[order], alike[order])
    kept = np.sort(order[np.arange(len(order)) - begin < 2])
    return pieces[kept], line[kept]


def _pairs(tree: Any, shapes: np.ndarray, **how: Any) -> np.ndarray:
    """Return which shapes meet which of a tree, [2, P]; many at a time, so that too many are refused in time."""
    found, total = [np.zeros((2, 0), int)], 0
    for begin in range(0, len(shapes), A_TIME):
        found.append(tree.query(shapes[begin : begin + A_TIME], **how) + np.array([[begin], [0]]))
        total += found[-1].shape[1]
        if total > MOST_MEETINGS:
            raise DrawingError(
                f"the drawing: its lines meet more than {MOST_MEETINGS:,} times: no crease pattern"
            )
    return np.concatenate(found, axis=1)


def _split_at_points(
    points: np.ndarray, pieces: np.ndarray, line: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray, int]:
    """Split pieces where a point lies on them."""
    from shapely import STRtree, linestrings, points as as_points

    if not len(pieces):
        return pieces, line, 0
    used = np.unique(pieces)
    tree = STRtree(linestrings(points[pieces]))
    which, piece = _pairs(tree, as_points(points[used]), predicate="dwithin", distance=tolerance)
    vertex = used[which]
    a, b = points[pieces[piece, 0]], points[pieces[piece, 1]]
    along = ((points[vertex] - a) * (b - a)).sum(axis=1) / ((b - a) ** 2).sum(axis=1)
    inside = (vertex != pieces[piece, 0]) & (vertex != pieces[piece, 1]) & (along > 0) & (along < 1)
    return _cut(pieces, line, piece[inside], vertex[inside], along[inside])


def _cut(
    pieces: np.ndarray, line: np.ndarray, piece: np.ndarray, vertex: np.ndarray, along: np.ndarray
) -> tuple[np.ndarray, np.ndarray, int]:
    """Split pieces at vertices, which lie on them in the order of `along`."""
    every = np.arange(len(pieces))
    owner = np.concatenate([every, piece, every])
    where = np.concatenate([np.full(len(pieces), -1.0), along, np.full(len(pieces), 2.0)])
    chain = np.concatenate([pieces[:, 0], vertex, pieces[:, 1]])
    order = np.lexsort((where, owner))
    owner, chain = owner[order], chain[order]
    next_ = owner[:-1] == owner[1:]
    return (
        np.column_stack([chain[:-1], chain[1:]])[next_],
        line[owner[:-1][next_]],
        len(np.unique(piece)),
    )


def _split_at_crossings(
    points: np.ndarray, pieces: np.ndarray, line: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the points at which pieces cross, numbered on from those there are, and the pieces split there."""
    import shapely

    shapes = shapely.linestrings(points[pieces])
    one, other = _pairs(shapely.STRtree(shapes), shapes, predicate="intersects")
    # those that share an end meet nowhere else: where one lies on the other, points on lines have split it
    apart = (one < other) & (pieces[one][:, :, None] != pieces[other][:, None, :]).all(axis=(1, 2))
    one, other = one[apart], other[apart]
    meet = shapely.intersection(shapes[one], shapes[other])
    # no points: lines along each other, whose ends lie on them
    sure = shapely.get_type_id(meet) == 0
    one, other, meet = one[sure], other[sure], meet[sure]
    new = shapely.get_coordinates(meet)
    number = len(points) + np.arange(len(new))
    both, met = np.concatenate([one, other]), np.concatenate([meet, meet])
    along = shapely.line_locate_point(shapes[both], met, normalized=True)
    pieces, line, _ = _cut(pieces, line, both, np.concatenate([number, number]), along)
    return new, pieces, line


def _merged(
    on: dict[tuple[int, int], list[int]], letters: Sequence[str], angles: np.ndarray
) -> list[Edge]:
    """Merge the lines on each edge: what the first rank among them says of it."""
    kept: list[Edge] = []
    for (a, b), several in on.items():
        first = next(rank for rank in RANKS if any(letters[k] in rank for k in several))
        said: dict[tuple[str, float | None], int] = {}
        for k in (k for k in several if letters[k] in first):
            if first == "MV" or not said:
                angle = None if np.isnan(angles[k]) else float(angles[k])
                said.setdefault((letters[k], angle), k)
        # one that states no angle agrees with any that is drawn so
        stated = {letter for letter, angle in said if angle is not None}
        each = [
            k for (letter, angle), k in said.items() if angle is not None or letter not in stated
        ]
        kept += [(a, b, letters[k], float(angles[k]), frozenset(several)) for k in each]
    return kept


def _doubled(kept: list[Edge]) -> list[int]:
    """Return the edges that are there in several ways."""
    many = Counter((a, b) for a, b, *_ in kept)
    return [i for i, (a, b, *_) in enumerate(kept) if many[a, b] > 1]


def _straightened(kept: list[Edge]) -> list[Edge]:
    """Join the two edges at a point where nothing but one line goes on: its split was that of a line on it."""
    fixed = set(_doubled(kept))
    at: dict[int, list[int]] = {}
    for e, (a, b, *_) in enumerate(kept):
        at.setdefault(a, []).append(e)
        at.setdefault(b, []).append(e)
    gone: set[int] = set()
    for v, both in at.items():
        both = [e for e in both if e not in gone]
        if len(both) != 2 or fixed & set(both):
            continue
        (a, b, letter, angle, lines), (c, d, letter2, angle2, lines2) = (kept[e] for e in both)
        alike = letter == letter2 and (angle == angle2 or (np.isnan(angle) and np.isnan(angle2)))
        if not alike or not lines & lines2:
            continue
        ends = sorted((a + b - v, c + d - v))
        if ends[0] == ends[1]:
            continue
        e, f = both
        kept[e] = (ends[0], ends[1], letter, angle, lines & lines2)
        gone.add(f)
        far = ends[0] if kept[f][0] + kept[f][1] - v == ends[0] else ends[1]
        at[far] = [e if g == f else g for g in at[far]]
        at[v] = []
    return [one for e, one in enumerate(kept) if e not in gone]
