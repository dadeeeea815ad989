"""Topology of the closed, admissible states by the Kuhn triangulation of the box of fold angles.

The box [-pi, pi]^d of a piece's fold angles (d = 3 for a quarter vertex, 4 for half of one) is cut into cubes and
each cube into d! simplices.  On a simplex the closure equations (m = d - 2 of them) are replaced by their linear
interpolation, whose zero set is a point in m-faces, a segment in (m+1)-faces, a polygon in d-simplices: a
triangulated-by-cells surface without any chart, branch or wall.  Each polygon is kept or not by one state in it,
retracted to exact closure and asked for embedding.  Around the flat state, where two cones meet, a ball is left out.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tests.independent.search_manifold import Piece


@dataclass(frozen=True)
class Surface:
    """Pieces of surface that hang together over segments: polygons and Euler characteristic of each.

    Segments and points count where all polygons around them are kept (the open surface, whose Euler characteristic
    with compact support is the ordinary one).
    """

    polygons: tuple[int, ...]
    euler: tuple[int, ...]


def chains(d: int, length: int) -> list[tuple[int, ...]]:
    """Increasing chains of `length` nonempty subsets of d axes, as bit masks: the faces of the Kuhn triangulation."""
    masks = range(1, 2**d)
    found = [(m,) for m in masks]
    for _ in range(length - 1):
        found = [(*c, m) for c in found for m in masks if m != c[-1] and m & c[-1] == c[-1]]
    return found


def kuhn_surface(piece: Piece, size: int, ball: float) -> Surface:
    """Cut the box into size^d cubes; leave out polygons within `ball` of the flat state (largest fold angle)."""
    d, m = piece.size, piece.size - 2
    rng = np.random.default_rng(
        0
    )  # uneven steps: no vertex, edge or diagonal on a state with special angles
    axes = [np.linspace(-math.pi, math.pi, size + 1) for _ in range(d)]
    for axis in axes:
        axis[1:-1] += rng.uniform(-0.2, 0.2, size - 1) * 2 * math.pi / size
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, d)
    value = piece.closure(grid)[0]
    stride = np.array([(size + 1) ** (d - 1 - k) for k in range(d)])
    step = [sum(stride[k] for k in range(d) if mask >> k & 1) for mask in range(2**d)]
    place = np.stack(np.meshgrid(*[np.arange(size + 1)] * d, indexing="ij"), axis=-1).reshape(-1, d)

    def bases(chain: tuple[int, ...]) -> np.ndarray:
        """Vertices from which a face of this kind stays in the box."""
        room = [size - (chain[-1] >> k & 1) for k in range(d)]
        return np.flatnonzero((place <= room).all(axis=1))

    points: dict[
        tuple[int, ...], np.ndarray
    ] = {}  # by kind of m-face: its zero at each base, or nan
    for chain in chains(d, m):
        base = bases(chain)
        corner = value[[base, *(base + step[s] for s in chain)]]  # [m + 1, B, m]
        edge = (corner[1:] - corner[0]).transpose(1, 2, 0)
        with np.errstate(all="ignore"):
            if m == 1:
                weight = -corner[0] / edge[:, :, 0]
            else:
                det = edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]
                u, v = corner[0].T
                weight = np.stack(
                    [
                        (-u * edge[:, 1, 1] + v * edge[:, 0, 1]) / det,
                        (-v * edge[:, 0, 0] + u * edge[:, 1, 0]) / det,
                    ],
                    axis=1,
                )
            inside = (weight > 0).all(axis=1) & (weight.sum(axis=1) < 1)
        hit = base[inside]
        zero = grid[hit]
        for k, s in enumerate(chain):
            zero = zero + weight[inside, k, None] * (grid[hit + step[s]] - grid[hit])
        table = np.full((len(grid), d), np.nan)
        table[hit] = zero
        points[chain] = table
    return _count(piece, d, m, step, bases, points, ball)


def _count(piece, d, m, step, bases, points, ball) -> Surface:
    found = {chain: np.isfinite(table[:, 0]) for chain, table in points.items()}
    # polygons: d-simplices that one of their m-faces makes nonempty, with the mean of these points
    kinds, at, middle = [], [], []
    for number, chain in enumerate(chains(d, d)):
        base = bases(chain)
        total, count = np.zeros((len(base), d)), np.zeros(len(base))
        for kind, shift in _faces(chain, m, step):
            hit = found[kind][base + shift]
            count += hit
            total[hit] += points[kind][base[hit] + shift]
        some = count > 0
        kinds.append(np.full(some.sum(), number))
        at.append(base[some])
        middle.append(total[some] / count[some, None])
    kind, base, state = np.concatenate(kinds), np.concatenate(at), np.concatenate(middle)
    exact, residual = piece.retract(state)
    inside = np.clip(exact, -math.pi + 1e-9, math.pi - 1e-9)  # the box is the fold limits
    keep = (residual < 1e-10) & (np.abs(state).max(axis=1) > ball)
    near = np.abs(exact - inside).max(axis=1) < 0.2
    keep &= near
    moved, residual = piece.retract(inside[keep], steps=2)
    moved = np.clip(moved, -math.pi, math.pi)
    good = piece.admissible(np.where(np.abs(exact[keep]) > math.pi, moved, exact[keep]))
    keep[keep] = good
    simplices = chains(d, d)
    segments = _cells(kind, base, simplices, m + 1, step, found, m)
    corners = _cells(kind, base, simplices, m, step, found, m)
    inner = _kept_all_round(segments, keep, 2)
    pairs = segments[np.isin(segments[:, 1], inner)]
    pairs = pairs[pairs[:, 1].argsort(kind="stable")]
    one, two = pairs[0::2, 0], pairs[1::2, 0]
    n = len(kind)
    graph = coo_array((np.ones(len(one)), (one, two)), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    faces = np.bincount(label[keep], minlength=n)
    edges = np.bincount(label[one], minlength=n)
    points_inner = _kept_all_round(corners, keep, 1)
    # points on the border of the box have segments with one polygon only
    open_polygons = np.unique(segments[~np.isin(segments[:, 1], inner)][:, 0])
    beside = np.unique(corners[np.isin(corners[:, 0], open_polygons)][:, 1])
    suspects = points_inner[np.isin(points_inner, beside)]
    points_inner = np.setdiff1d(points_inner, suspects[_on_border(suspects, d, m, points)])
    first = np.unique(corners[:, 1], return_index=True)
    owner = corners[first[1][np.isin(first[0], points_inner)], 0]
    vertices = np.bincount(label[owner], minlength=n)
    order = [k for k in np.argsort(-faces) if faces[k]]
    return Surface(
        tuple(int(faces[k]) for k in order),
        tuple(int(faces[k] - edges[k] + vertices[k]) for k in order),
    )


def _faces(chain: tuple[int, ...], k: int, step: list[int]):
    """k-faces of a d-simplex as (kind, shift of the base)."""
    corners = (0, *chain)
    for chosen in itertools.combinations(corners, k + 1):
        yield tuple(c ^ chosen[0] for c in chosen[1:]), step[chosen[0]]


def _cells(kind, base, simplices, k, step, found, m) -> np.ndarray:
    """Rows (polygon, number of k-face that the zero set meets), for all polygons."""
    names = {chain: i for i, chain in enumerate(chains(len(simplices[0]), k))}
    rows = []
    for number, chain in enumerate(simplices):
        mine = np.flatnonzero(kind == number)
        for face, shift in _faces(chain, k, step):
            meets = np.zeros(len(mine), dtype=bool)
            for lower, more in _faces(face, m, step):
                meets |= found[lower][base[mine] + shift + more]
            who = mine[meets]
            rows.append(np.stack([who, (base[who] + shift) * len(names) + names[face]], axis=1))
    return np.concatenate(rows)


def _on_border(names: np.ndarray, d: int, m: int, points: dict) -> np.ndarray:
    """Return which points lie on the border of the box."""
    kinds = chains(d, m)
    where = [points[kinds[name % len(kinds)]][name // len(kinds)] for name in names]
    return np.abs(np.array(where).reshape(-1, d)).max(axis=1, initial=0.0) >= math.pi - 1e-12


def _kept_all_round(cells: np.ndarray, keep: np.ndarray, least: int) -> np.ndarray:
    """Faces around which all polygons are kept, and that have at least `least` of them."""
    name, where, count = np.unique(cells[:, 1], return_inverse=True, return_counts=True)
    lost = np.bincount(where, ~keep[cells[:, 0]]) > 0
    return name[~lost & (count >= least)]
