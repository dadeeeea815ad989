"""Topology of a complex of triangles, edges and vertices: components, holes, links, handles.  No geometry here."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from origami_nlp.chart.mesh import beside, edges_of
from origami_nlp.display import shown
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import groups


@dataclass(frozen=True, repr=False)
class Component(ShortRepr):
    """One connected component of a complex.

    Attributes
    ----------
    vertices
        Their numbers.
    dimension
        Of its largest cell.
    euler_characteristic
        V - E + F.
    holes
        First Betti number.
    closed_surfaces
        Second Betti number (modulo 2).
    """

    vertices: np.ndarray = field(metadata={"plain": False})
    dimension: int = field(metadata=shown("dimension"))
    euler_characteristic: int = field(metadata=shown("Euler characteristic"))
    holes: int = field(metadata=shown("holes"))
    closed_surfaces: int = field(metadata=shown("closed surfaces"))


@dataclass(frozen=True)
class Spot:
    """A vertex whose link is disconnected: a pinch point, or where a handle begins.

    vertex: its number.  dimensions: of the branches that meet, one for each piece of the link, largest first.
    """

    vertex: int
    dimensions: tuple[int, ...]


def parts(count: int, triangles: np.ndarray, extra: np.ndarray) -> list[Component]:
    """Components of the complex, largest first; `extra` [E, 2] are edges that border no triangle."""
    edges = np.vstack([edges_of(triangles)[0], extra])
    of = groups(count, edges)
    number = int(of.max()) + 1 if count else 0
    v = np.bincount(of, minlength=number)
    e = np.bincount(of[edges[:, 0]], minlength=number)
    f = np.bincount(of[triangles[:, 0]], minlength=number) if len(triangles) else 0 * v
    closed = _closed_surfaces(triangles, of, number)
    found = []
    for k in range(number):
        euler = int(v[k] - e[k] + f[k])
        dimension = 2 if f[k] else (1 if e[k] else 0)
        # b_0 - b_1 + b_2 = chi with b_0 = 1
        holes = 1 + int(closed[k]) - euler
        own = np.flatnonzero(of == k)
        found.append(Component(own, dimension, euler, holes, int(closed[k])))
    return sorted(found, key=lambda part: (-part.dimension, -len(part.vertices)))


def _closed_surfaces(triangles: np.ndarray, of: np.ndarray, number: int) -> np.ndarray:
    """Second Betti number of each component: pieces of surface (joined over edges) without a border edge.

    Exact where no edge borders more than two triangles, which is checked.
    """
    count = np.zeros(number, dtype=int)
    if not len(triangles):
        return count
    edges, of_triangle = edges_of(triangles)
    uses = np.bincount(of_triangle.ravel(), minlength=len(edges))
    assert uses.max() <= 2, "an edge borders three triangles"
    # modulo 2: a piece without a border edge is a cycle of triangles
    face = surface_pieces(triangles)
    open_piece = np.zeros(face.max() + 1, dtype=bool)
    open_piece[face[(uses[of_triangle] == 1).any(axis=1)]] = True
    for piece in np.flatnonzero(~open_piece):
        count[of[triangles[np.flatnonzero(face == piece)[0], 0]]] += 1
    return count


def surface_pieces(triangles: np.ndarray) -> np.ndarray:
    """Number the pieces of surface that hang together over edges, for each triangle [F]."""
    return groups(len(triangles), beside(triangles))


def spots(count: int, triangles: np.ndarray, extra: np.ndarray) -> list[Spot]:
    """Vertices with a disconnected link, except the inner points of handles."""
    # corners of triangles around each vertex: two corners belong together when they share an edge at the vertex
    f = len(triangles)
    corner_vertex = triangles.ravel()
    after, before = np.roll(triangles, -1, axis=1).ravel(), np.roll(triangles, 1, axis=1).ravel()
    who = np.arange(3 * f)
    # two corners at one vertex share an edge there exactly if they share its other end
    key = np.concatenate(
        [corner_vertex * (count + 1) + after, corner_vertex * (count + 1) + before]
    )
    corner = np.concatenate([who, who])
    order = key.argsort(kind="stable")
    pair = np.flatnonzero(key[order][1:] == key[order][:-1])
    fan = groups(3 * f, np.stack([corner[order[pair]], corner[order[pair + 1]]], axis=1))
    first = np.unique(fan, return_index=True)[1]
    fans = np.bincount(corner_vertex[first], minlength=count)
    ends = np.bincount(extra.ravel(), minlength=count)
    where = np.flatnonzero((fans + ends > 1) & ~((fans == 0) & (ends == 2)))
    return [Spot(int(v), (2,) * int(fans[v]) + (1,) * int(ends[v])) for v in where]


def borders(triangles: np.ndarray, extra: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges of one triangle and those of none, [B, 2], and which are the latter, [B]."""
    edges, of_triangle = edges_of(triangles)
    edges = edges[np.bincount(of_triangle.ravel(), minlength=len(edges)) == 1]
    alone = np.repeat([False, True], [len(edges), len(extra)])
    return np.vstack([edges, extra.reshape(-1, 2)]), alone


def handles(count: int, triangles: np.ndarray, extra: np.ndarray) -> list[np.ndarray]:
    """Maximal arcs of edges that border no triangle, each as its vertices in order (a loop repeats the first)."""
    # vertices of two such edges and of no triangle: an arc goes on through them
    inner = np.bincount(extra.ravel(), minlength=count) == 2
    inner[np.unique(triangles)] = False
    return arcs(extra, inner)


def arcs(edges: np.ndarray, inner: np.ndarray) -> list[np.ndarray]:
    """Maximal arcs of edges [E, 2] that go on through vertices `inner` [V], each as its vertices in order."""
    around: dict[int, list[int]] = {}
    for k, (a, b) in enumerate(edges.tolist()):
        around.setdefault(a, []).append(k)
        around.setdefault(b, []).append(k)
    left = set(range(len(edges)))
    found = []

    def walk(v: int, k: int) -> np.ndarray:
        path = [v]
        while True:
            left.discard(k)
            a, b = edges[k].tolist()
            v = b if v == a else a
            path.append(v)
            onward = [m for m in around[v] if m in left] if inner[v] else []
            if not onward:
                return np.array(path)
            k = onward[0]

    for v in sorted(v for v in around if not inner[v]):
        found += [walk(v, k) for k in around[v] if k in left]
    while left:  # loops without an end
        k = min(left)
        found.append(walk(int(edges[k, 0]), k))
    return found
