"""A triangulation of all closed symmetric states whose edges follow every contact curve exactly.

Base points of the half-chain (`half_chain`) are triangulated, cut where the two leaves meet, doubled, and cut along
every wall; new vertices lie on the walls to rounding, and where walls meet on both.  Nothing is dropped here but base
points without a state: which triangles are admissible is decided later.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from origami_nlp.chart.half_chain import CURVED, CUT, HEIGHT, OTHER, SEAM, STRAIGHT, HalfChain
from origami_nlp.errors import OrigamiError
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import EPS, NONZERO, OUTSIDE, ROUNDED, bracketed_roots

ON = 1000 * ROUNDED
"""Walls whose value at a vertex is smaller are taken to pass through it: values are good to about `ROUNDED`."""
ON_SEAM = ROUNDED
"""The same for the seam, which is seen through a square root."""
LONGEST, SHORTENINGS = 16.0, 6
"""Edges longer than LONGEST / size [rad, largest fold angle] are divided, this often: next to the seam states change
with the square root of the base point."""
DIFFERENCE = 1e-6
"""Step of central differences of a wall [rad]."""
LOOKS = 2
"""How often edges that a wall crosses twice are looked for."""
SAMPLES = tuple(np.linspace(0.0, 1.0, 10)[1:-1].tolist())


class MeshError(OrigamiError):
    """The mesh is too coarse for this scene."""


@dataclass(frozen=True, repr=False)
class DoubleCover(ShortRepr):
    """A triangulated surface of closed states, of so many `rings`.

    base [V, 2], leaf [V] (0 on the seam): coordinates of the vertices on the chain.
    on [V]: bit mask of the walls (and the seam) that pass through a vertex.
    triangles [F, 3].  values [V, 3]: `Points.walls`, exactly 0 where `on` says so.  wedge [V, k]: fold angles.
    """

    chain: HalfChain
    rings: int
    base: np.ndarray
    leaf: np.ndarray
    on: np.ndarray
    triangles: np.ndarray
    values: np.ndarray
    wedge: np.ndarray


class Surface(NamedTuple):
    """A surface that is being cut: base [V, 2], on [V], leaf [V] and triangles [F, 3] as in `DoubleCover`."""

    base: np.ndarray
    on: np.ndarray
    leaf: np.ndarray
    triangles: np.ndarray

    def edges(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the ends of all edges, their leaf, and what passes through both ends, [E] each."""
        a, b = edges_of(self.triangles)[0].T
        leaf = np.where(self.leaf[a] != 0, self.leaf[a], self.leaf[b])
        return a, b, leaf, self.on[a] & self.on[b]

    def divided(
        self, which: np.ndarray, base: np.ndarray, on: np.ndarray, leaf: np.ndarray
    ) -> Surface:
        """Give edges with the numbers `which` (of `edges_of`) a vertex each."""
        edges, of_triangle = edges_of(self.triangles)
        middle = np.full(len(edges), -1)
        middle[which] = len(self.base) + np.arange(len(which))
        return Surface(
            np.vstack([self.base, base]),
            np.concatenate([self.on, on]),
            np.concatenate([self.leaf, leaf]),
            divide(self.triangles, middle[of_triangle]),
        )


def mesh_cover(chain: HalfChain, size: int) -> DoubleCover:
    """Triangulate the closed states of `chain`; `size` rings around the flat state, 4 `size` directions."""
    base, triangles = polar_mesh(chain.reach, size)
    on = ((np.abs(base) == chain.reach) << np.arange(2)).sum(axis=1)
    surface = Surface(base, on, np.zeros(len(base), dtype=np.int64), triangles)
    for bit in (HEIGHT, SEAM):
        surface = _split(chain, surface, bit)
    surface = _double(chain, surface)
    for bit in (CUT, OTHER):
        surface = _split(chain, surface, bit)
    for _ in range(SHORTENINGS):
        surface = _shorten(chain, surface, LONGEST / size)
    used, triangles = np.unique(surface.triangles, return_inverse=True)
    base, on, leaf = (v[used] for v in surface[:3])
    values = chain.points(base, leaf).walls
    on = on | ((np.abs(values) <= ON) << np.array(CURVED)).sum(axis=1)
    for column, bit in enumerate(CURVED):
        values[has(on, bit), column] = 0.0
    wedge = exact_states(chain, base, leaf, on)
    return DoubleCover(chain, size, base, leaf, on, triangles.reshape(-1, 3), values, wedge)


def exact_states(
    chain: HalfChain, base: np.ndarray, leaf: np.ndarray, on: np.ndarray
) -> np.ndarray:
    """Return the states of base points on walls, [V, k], with the fold angles that walls fix exactly there."""
    wedge = chain.points(base, leaf).wedge
    flat = has(on, HEIGHT)  # the last fold angle is +-pi there, from the side the state is on
    wedge[flat, -1] = np.copysign(math.pi, wedge[flat, -1])
    return wedge


def pulled(chain: HalfChain, base: np.ndarray, leaf: np.ndarray, on: np.ndarray) -> np.ndarray:
    """Move base points between two vertices onto the curved walls that pass through both, `on` [V].

    By Newton steps along the gradient of one wall after the other.
    """
    base = np.array(base)
    for bit in (*CURVED, SEAM):
        here = np.flatnonzero(has(on, bit))
        if not len(here):
            continue
        for _ in range(6):
            x, side = base[here], leaf[here]
            off = chain.value(bit, x, side)
            if np.abs(off).max() <= EPS:
                break
            steps = DIFFERENCE * np.eye(2)
            rises = [chain.value(bit, x + h, side) - chain.value(bit, x - h, side) for h in steps]
            slope = np.stack(rises, axis=1) / (2 * DIFFERENCE)
            way = (off / np.maximum((slope**2).sum(axis=1), OUTSIDE))[:, None] * slope
            length = np.maximum(np.linalg.norm(way, axis=1, keepdims=True), NONZERO)
            base[here] = x - way * np.minimum(1.0, 0.1 / length)
    return base


def polar_mesh(reach: tuple[float, float], size: int) -> tuple[np.ndarray, np.ndarray]:
    """Rings around the origin of a rectangle: vertices [V, 2], triangles [F, 3].

    All directions leave the origin, so that the two cones that meet there are seen however thin they are.  Each side of
    the border has vertices at its middle and quarters: there the height y over the last mirror is extreme along
    the border (for degree 6 y is -+sin a_2 sin phi_2 and sin(a_1 - a_2) cos phi_1/2), and walls can touch it.
    """
    t = np.linspace(-1.0, 1.0, max(8, 4 * round(size / 4)) + 1)[:-1]
    one = np.ones_like(t)
    sides = ((t, -one), (one, t), (-t, one), (-one, -t))
    outer = np.concatenate([np.stack(v, axis=1) for v in sides]) * reach
    base = ((np.arange(1, size + 1) / size)[:, None, None] * outer).reshape(-1, 2)
    base[-len(outer) :] = outer
    ring = 1 + np.arange(len(base)).reshape(size, -1)
    after = np.roll(ring, -1, axis=1)
    corners = (
        (0 * ring[0], ring[0], after[0]),
        (ring[:-1], ring[1:], after[1:]),
        (ring[:-1], after[1:], after[:-1]),
    )
    triangles = np.vstack([np.stack(c, axis=-1).reshape(-1, 3) for c in corners])
    return np.vstack([[0.0, 0.0], base]), triangles


def has(on: np.ndarray, bit: int) -> np.ndarray:
    """Return which vertices lie on a wall or the seam."""
    return (on >> bit) & 1 == 1


def several(on: np.ndarray) -> np.ndarray:
    """Return which vertices lie on two walls or more (the seam of the leaves does not count)."""
    walls = on & ~(1 << SEAM)
    # more than one bit is set
    return np.asarray((walls & (walls - 1)) != 0)


def _split(chain: HalfChain, surface: Surface, bit: int) -> Surface:
    """Cut every triangle along a wall or the seam."""
    wrapped = bit != SEAM and chain.wrapped[bit - HEIGHT]
    period = math.pi if wrapped else math.inf
    for _ in range(LOOKS):
        surface = _refine(chain, surface, bit, period)
    return _cut(chain, surface, bit, period)


def _cut(chain: HalfChain, surface: Surface, bit: int, period: float) -> Surface:
    """Give every edge whose ends are on different sides a vertex on the wall."""
    value = chain.value(bit, surface.base, surface.leaf)
    zero = np.abs(value) <= (ON_SEAM if bit == SEAM else ON)
    surface = surface._replace(on=surface.on | np.where(zero, 1 << bit, 0))
    value = np.where(zero, 0.0, value)
    a, b, leaf, common = surface.edges()
    # a wrapped angle that jumps from near pi to near -pi does not pass 0
    cut = np.flatnonzero((value[a] * value[b] < 0) & (np.abs(value[a]) + np.abs(value[b]) < period))
    a, b, leaf, common = (v[cut] for v in (a, b, leaf, common))
    start, way = surface.base[a], surface.base[b] - surface.base[a]

    def at(t: np.ndarray) -> np.ndarray:
        # edges that follow curved walls stay on them
        return pulled(chain, start + t[:, None] * way, leaf, common)

    zeros, ones = np.zeros(len(cut)), np.ones(len(cut))
    place = at(bracketed_roots(lambda t: chain.value(bit, at(t), leaf), zeros, ones))
    return surface.divided(cut, place, common | (1 << bit), 0 * leaf if bit == SEAM else leaf)


def _refine(chain: HalfChain, surface: Surface, bit: int, period: float) -> Surface:
    """Give edges that a wall crosses twice, as far as a few samples show, a vertex in between."""
    base = surface.base
    a, b, leaf, common = surface.edges()
    value = chain.value(bit, base, surface.leaf)
    # the larger end decides the side
    end = np.where(np.abs(value[a]) >= np.abs(value[b]), value[a], value[b])
    look = np.flatnonzero((value[a] * value[b] > -(ON**2)) & (np.abs(end) > ON))
    a, b, leaf, common, end = (v[look] for v in (a, b, leaf, common, np.sign(end)))
    worst, where = np.zeros(len(look)), np.full(len(look), 0.5)
    for t in SAMPLES:
        beyond = -end * chain.value(bit, base[a] + t * (base[b] - base[a]), leaf)
        beyond = np.where(np.abs(beyond) < period / 4, beyond, -math.inf)
        where, worst = np.where(beyond > worst, t, where), np.maximum(worst, beyond)
    twice = np.flatnonzero(worst > 10 * ON)
    if not len(twice):
        return surface
    place = base[a] + where[:, None] * (base[b] - base[a])
    return surface.divided(look[twice], place[twice], common[twice] & STRAIGHT, leaf[twice])


def edges_of(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges [E, 2] (smaller vertex first) and, for each triangle, its three: (0, 1), (1, 2), (2, 0)."""
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=-1)
    edges, inverse = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    return edges, inverse.reshape(-1, 3)


def beside(triangles: np.ndarray) -> np.ndarray:
    """Return the pairs of triangles that share an edge, [P, 2]."""
    names = edges_of(triangles)[1].ravel()
    order = names.argsort(kind="stable")
    pair = np.flatnonzero(np.diff(names[order]) == 0)
    return np.stack([order[pair] // 3, order[pair + 1] // 3], axis=1)


def divide(triangles: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Divide triangles at new vertices on their edges ([F, 3], -1 where an edge is whole), one after the other."""
    while (cut := (middle >= 0).any(axis=1)).any():
        # the first that is divided goes from corner 0 to corner 1
        turn = ((middle >= 0).argmax(axis=1)[:, None] + np.arange(3)) % 3
        triangles, middle = (np.take_along_axis(v, turn, axis=1) for v in (triangles, middle))
        (u, v, w), (at, two, three) = triangles[cut].T, middle[cut].T
        whole = np.full(len(u), -1)
        halves = [np.stack([u, at, w], axis=1), np.stack([at, v, w], axis=1)]
        left = [np.stack([whole, whole, three], axis=1), np.stack([whole, two, whole], axis=1)]
        triangles = np.vstack([triangles[~cut], *halves])
        middle = np.vstack([middle[~cut], *left])
    return triangles


def _double(chain: HalfChain, surface: Surface) -> Surface:
    """Two copies of the triangles where states are, joined along the seam."""
    base, on, _, triangles = surface
    seam, count = has(on, SEAM), len(base)
    corners = np.where(seam, 0.0, chain.fold_margin(base))[triangles]
    triangles = triangles[(corners >= 0).all(axis=1) & (corners > 0).any(axis=1)]
    other = np.where(seam, 0, count) + np.arange(count)
    leaf = np.concatenate([np.where(seam, 0, 1), np.full(count, -1)])
    if seam[triangles].all(axis=1).any():
        # its two copies would be one triangle, and the surface no surface there
        raise MeshError("a triangle lies between seams: use a larger size")
    triangles = np.vstack([triangles, other[triangles]])
    if np.bincount(edges_of(triangles)[1].ravel()).max() > 2:
        raise MeshError("two seams are closer than the mesh: use a larger size")
    return Surface(np.vstack([base, base]), np.concatenate([on, on]), leaf, triangles)


def _shorten(chain: HalfChain, surface: Surface, longest: float) -> Surface:
    """Divide edges between states that are far apart; nearer to the seam, where one end is on it."""
    base, on = surface.base, surface.on
    wedge = chain.points(base, surface.leaf).wedge
    a, b, leaf, common = surface.edges()
    apart = np.abs(wedge[a] - wedge[b])
    apart[:, -2] = np.minimum(apart[:, -2], 2 * math.pi - apart[:, -2])
    # edges that follow curved walls would have to be pulled back onto them: those stay
    long = np.flatnonzero((apart.max(axis=1) > longest) & (common & ~STRAIGHT == 0))
    a, b = a[long], b[long]
    # next to the seam states go as the square root of the base point: a quarter of the way is half of it
    t = 0.5 + 0.25 * (has(on[b], SEAM).astype(int) - has(on[a], SEAM))[:, None]
    return surface.divided(long, (1 - t) * base[a] + t * base[b], common[long], leaf[long])
