"""Topology of a complex of triangles, edges and vertices: components, holes, links, handles.  No geometry here."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from origami_nlp.chart.mesh import beside, edges_of
from origami_nlp.display import shown
from origami_nlp.numerics import groups


@dataclass(frozen=True)
class Component:
    """One connected component of a complex.

    Attributes
    ----------
    size
        Number of its vertices.
    dimension
        Of its largest cell.
    euler_characteristic
        V - E + F.
    holes
        First Betti number.
    closed_surfaces
        Second Betti number (modulo 2).
    """

    size: int = field(metadata=shown("vertices"))
    dimension: int = field(metadata=shown("dimension"))
    euler_characteristic: int = field(metadata=shown("Euler characteristic"))
    holes: int = field(metadata=shown("holes"))
    closed_surfaces: int = field(metadata=shown("closed surfaces"))


class Spot(NamedTuple):
    """A vertex whose link is disconnected: a pinch point, or where a handle begins.

    vertex: its number.  dimensions: of the branches that meet, one for each piece of the link, largest first.
    """

    vertex: int
    dimensions: tuple[int, ...]


def parts(count: int, triangles: np.ndarray, extra: np.ndarray) -> list[Component]:
    """Components of the complex, largest first; `extra` [E, 2] are edges that border no triangle."""
    edges, of_triangle = edges_of(triangles)
    uses = np.bincount(of_triangle.ravel(), minlength=len(edges))
    assert uses.max(initial=0) <= 2, "an edge borders three triangles"
    edges = np.vstack([edges, extra])
    of = groups(count, edges)
    # modulo 2: a piece of surface (joined over edges) without a border edge is a cycle of triangles
    face = surface_pieces(triangles)
    bordered = np.unique(face[(uses[of_triangle] == 1).any(axis=1)])
    pieces, first = np.unique(face, return_index=True)
    whole = triangles[first[~np.isin(pieces, bordered)], 0]
    cells = (np.arange(count), edges[:, 0], triangles[:, 0], whole)
    many = (np.bincount(of[c], minlength=of.max(initial=-1) + 1).tolist() for c in cells)
    found = []
    for v, e, f, closed in zip(*many, strict=True):
        euler = v - e + f
        # b_0 - b_1 + b_2 = chi with b_0 = 1
        dimension = 2 if f else int(e > 0)
        found.append(Component(v, dimension, euler, 1 + closed - euler, closed))
    return sorted(found, key=lambda part: (-part.dimension, -part.size))


def surface_pieces(triangles: np.ndarray) -> np.ndarray:
    """Number the pieces of surface that hang together over edges, for each triangle [F]."""
    return groups(len(triangles), beside(triangles))


def spots(count: int, triangles: np.ndarray, extra: np.ndarray) -> list[Spot]:
    """Vertices with a disconnected link, except the inner points of handles."""
    # corners of triangles around each vertex: two corners at one vertex share an edge there exactly if they share its
    # other end
    corners = triangles.ravel()
    ends = np.concatenate([np.roll(triangles, k, axis=1).ravel() for k in (1, -1)])
    key = np.tile(corners, 2) * (count + 1) + ends
    order = key.argsort(kind="stable")
    pair = np.flatnonzero(np.diff(key[order]) == 0)
    which = order % max(len(corners), 1)
    fan = groups(len(corners), np.stack([which[pair], which[pair + 1]], axis=1))
    first = np.unique(fan, return_index=True)[1]
    fans = np.bincount(corners[first], minlength=count)
    ends = np.bincount(extra.ravel(), minlength=count)
    where = np.flatnonzero((fans + ends > 1) & ~((fans == 0) & (ends == 2)))
    return [Spot(int(v), (2,) * int(fans[v]) + (1,) * int(ends[v])) for v in where]


def borders(triangles: np.ndarray, extra: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges of one triangle and those of none, [B, 2], and which are the latter, [B]."""
    edges, of_triangle = edges_of(triangles)
    edges = edges[np.bincount(of_triangle.ravel(), minlength=len(edges)) == 1]
    return np.vstack([edges, extra]), np.arange(len(edges) + len(extra)) >= len(edges)


def handles(count: int, triangles: np.ndarray, extra: np.ndarray) -> list[np.ndarray]:
    """Maximal arcs of edges that border no triangle, each as its vertices in order (a loop repeats the first)."""
    # vertices of two such edges and of no triangle: an arc goes on through them
    inner = np.bincount(extra.ravel(), minlength=count) == 2
    inner[np.unique(triangles)] = False
    return arcs(extra, inner)


def arcs(edges: np.ndarray, inner: np.ndarray) -> list[np.ndarray]:
    """Maximal arcs of edges [E, 2] that go on through vertices `inner` [V], each as its vertices in order."""
    around: dict[int, dict[int, int]] = {}
    for k, (a, b) in enumerate(edges.tolist()):
        around.setdefault(a, {})[k] = b
        around.setdefault(b, {})[k] = a
    found, walked = [], set[int]()
    # ends first, then loops without an end
    for v in sorted(around, key=lambda v: (bool(inner[v]), v)):
        for k in around[v]:
            path, at = [v], k
            while at not in walked:
                walked.add(at)
                path.append(around[path[-1]][at])
                onward = around[path[-1]] if inner[path[-1]] else {}
                at = next((m for m in onward if m not in walked), at)
            if len(path) > 1:
                found.append(np.array(path))
    return found
