"""A triangulation of all closed symmetric states whose edges follow every contact curve exactly.

Base points of the half-chain (`chain`) are triangulated, cut where the two leaves meet, doubled, and cut along
every wall; new vertices lie on the walls to rounding, and where walls meet on both.  Nothing is dropped here but base
points without a state: which triangles are admissible is decided later.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from origami_nlp.chart.half_chain import HalfChain
from origami_nlp.errors import OrigamiError
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import EPS, NONZERO, OUTSIDE, ROUNDED, bracketed_roots

ON = 1000 * ROUNDED
"""Walls whose value at a vertex is smaller are taken to pass through it: values are good to about `ROUNDED`."""
ON_SEAM = ROUNDED
"""The same for the seam, which is seen through a square root."""
BORDER_P, BORDER_Q, HEIGHT, CUT, OTHER = range(5)
"""Bits of `DoubleCover.on`: the walls in the order of `HalfChain.walls`, after these five the stops."""
SEAM = 60
"""The bit of the seam, where the two leaves meet: behind all walls."""


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
    triangles [F, 3].  values [V, 3 + stops]: `Points.walls`, exactly 0 where `on` says so.  wedge [V, k]: fold angles.
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

    def between(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Leaf of the edges between vertices a and b, [E]."""
        return np.where(self.leaf[a] != 0, self.leaf[a], self.leaf[b])

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
    on = np.zeros(len(base), dtype=np.int64)
    for k in (0, 1):
        on |= np.where(np.abs(base[:, k]) == chain.reach[k], 1 << k, 0)
    surface = Surface(base, on, np.zeros(len(base), dtype=np.int64), triangles)
    straight = [bit for bit in curved_walls(chain) if straight_walls(chain) >> bit & 1]
    for bit in (*straight, HEIGHT, SEAM):
        surface = _split(chain, surface, bit)
    margin = chain.fold_margin(surface.base)
    margin[has(surface.on, SEAM)] = 0.0
    corners = margin[surface.triangles]
    surface = _double(surface, (corners >= 0).all(axis=1) & (corners > 0).any(axis=1))
    for bit in (CUT, *(b for b in curved_walls(chain)[3:] if b not in straight), OTHER):
        surface = _split(chain, surface, bit)
    for _ in range(SHORTENINGS):
        surface = _shorten(chain, surface, LONGEST / size)
    base, on, leaf, triangles = _compact(surface)
    values = chain.points(base, leaf).walls
    for column, bit in enumerate(curved_walls(chain)):
        on |= np.where(np.abs(values[:, column]) <= ON, 1 << bit, 0)
        values[has(on, bit), column] = 0.0
    wedge = exact_states(chain, base, leaf, on)
    return DoubleCover(chain, size, base, leaf, on, triangles, values, wedge)


def exact_states(
    chain: HalfChain, base: np.ndarray, leaf: np.ndarray, on: np.ndarray
) -> np.ndarray:
    """Return the states of base points on walls, [V, k], with the fold angles that walls fix exactly there."""
    wedge = chain.points(base, leaf).wedge
    flat = has(on, HEIGHT)  # the last fold angle is +-pi there, from the side the state is on
    wedge[flat, -1] = np.copysign(math.pi, wedge[flat, -1])
    for bit, (v, at) in enumerate(chain.stops, start=OTHER + 1):
        wedge[has(on, bit), v] = at
    return wedge


def pulled(chain: HalfChain, base: np.ndarray, leaf: np.ndarray, on: np.ndarray) -> np.ndarray:
    """Move base points between two vertices onto the curved walls that pass through both, `on` [V]."""
    straight = straight_walls(chain)
    base = np.array(base)
    for bit in (*curved_walls(chain), SEAM):
        here = has(on, bit)
        if not straight >> bit & 1 and here.any():
            base[here] = pull(chain, base[here], leaf[here], bit)
    return base


def curved_walls(chain: HalfChain) -> range:
    """Bits of the walls that are found by their values, in the order of `Points.walls`."""
    return range(HEIGHT, OTHER + 1 + len(chain.stops))


def straight_walls(chain: HalfChain) -> int:
    """Bit mask of the walls that are straight in the base: its borders, and stops of its fold angles."""
    stops = (
        1 << bit for bit, (v, _) in enumerate(chain.stops, start=OTHER + 1) if v < chain.size - 2
    )
    return sum(stops, 1 << BORDER_P | 1 << BORDER_Q)


def polar_mesh(reach: tuple[float, float], size: int) -> tuple[np.ndarray, np.ndarray]:
    """Rings around the origin of a rectangle: vertices [V, 2], triangles [F, 3].

    All directions leave the origin, so that the two cones that meet there are seen however thin they are.  Each side of
    the border has vertices at its middle and quarters: there the height y over the last mirror is extreme along
    the border (for degree 6 y is -+sin a_2 sin phi_2 and sin(a_1 - a_2) cos phi_1/2), and walls can touch it.
    """
    per_side = max(8, 4 * round(size / 4))
    t = np.linspace(-1.0, 1.0, per_side + 1)[:-1]
    one = np.ones_like(t)
    square = np.concatenate(
        [np.stack(v, axis=1) for v in ((t, -one), (one, t), (-t, one), (-one, -t))]
    )
    rings = np.arange(1, size + 1) / size
    outer = square * reach
    base = (rings[:, None, None] * outer).reshape(-1, 2)
    base[-len(square) :] = outer
    base = np.vstack([[0.0, 0.0], base])
    k = len(square)
    i = np.arange(k)
    j = (i + 1) % k
    triangles = [np.stack([np.zeros(k, dtype=int), 1 + i, 1 + j], axis=1)]
    for r in range(size - 1):
        a, b, c, d = 1 + r * k + i, 1 + r * k + j, 1 + (r + 1) * k + i, 1 + (r + 1) * k + j
        triangles += [np.stack([a, c, d], axis=1), np.stack([a, d, b], axis=1)]
    return base, np.vstack(triangles)


def has(on: np.ndarray, bit: int) -> np.ndarray:
    """Return which vertices lie on a wall or the seam."""
    return (on >> bit) & 1 == 1


def several(on: np.ndarray) -> np.ndarray:
    """Return which vertices lie on two walls or more (the seam of the leaves does not count)."""
    walls = on & ~(1 << SEAM)
    # more than one bit is set
    return np.asarray((walls & (walls - 1)) != 0)


Evaluate = Callable[[np.ndarray, np.ndarray], np.ndarray]


def wall_function(chain: HalfChain, bit: int) -> Evaluate:
    """Return the function (base, leaf) -> value of a curved wall or of the seam."""
    if bit == SEAM:
        return lambda base, leaf: chain.fold_margin(base)
    column = bit - HEIGHT
    return lambda base, leaf: chain.points(base, leaf).walls[:, column]


def _split(chain: HalfChain, surface: Surface, bit: int) -> Surface:
    """Cut every triangle along a wall or the seam."""
    function = wall_function(chain, bit)
    wrapped = bit in curved_walls(chain) and chain.wrapped[bit - HEIGHT]
    period = math.pi if wrapped else math.inf
    for _ in range(LOOKS):
        surface = _refine(chain, surface, function, period)
    surface = _cut(chain, surface, bit, function, period)
    return _nearby(chain, surface, *chain.stops[bit - OTHER - 1]) if OTHER < bit < SEAM else surface


def _nearby(chain: HalfChain, surface: Surface, variable: int, at: float) -> Surface:
    """Drop the triangles of whose corners none is on this side of a stop, in a fold angle that is not +-pi."""
    phi = chain.points(surface.base, surface.leaf).wedge[:, variable]
    limits = chain.limits
    beyond = phi > at + ON if at == limits.high[variable] else phi < at - ON
    if variable == chain.size - 2:
        beyond &= ~has(surface.on, CUT)
    return surface._replace(triangles=surface.triangles[~beyond[surface.triangles].all(axis=1)])


def _cut(
    chain: HalfChain, surface: Surface, bit: int, function: Evaluate, period: float
) -> Surface:
    """Give every edge whose ends are on different sides a vertex on the wall."""
    value = function(surface.base, surface.leaf)
    zero = np.abs(value) <= (ON_SEAM if bit == SEAM else ON)
    surface = surface._replace(on=surface.on | np.where(zero, 1 << bit, 0))
    value = np.where(zero, 0.0, value)
    a, b = edges_of(surface.triangles)[0].T
    # a wrapped angle that jumps from near pi to near -pi does not pass 0
    cut = np.flatnonzero((value[a] * value[b] < 0) & (np.abs(value[a]) + np.abs(value[b]) < period))
    a, b = a[cut], b[cut]
    leaf = surface.between(a, b)
    common = surface.on[a] & surface.on[b]
    start, way = surface.base[a], surface.base[b] - surface.base[a]

    def at(t: np.ndarray) -> np.ndarray:
        # edges that follow curved walls stay on them
        return pulled(chain, start + t[:, None] * way, leaf, common)

    share = bracketed_roots(lambda t: function(at(t), leaf), 0.0 * value[a], 0.0 * value[a] + 1.0)
    place = at(share)
    return surface.divided(
        cut, place, common | (1 << bit), np.zeros_like(leaf) if bit == SEAM else leaf
    )


def _refine(chain: HalfChain, surface: Surface, function: Evaluate, period: float) -> Surface:
    """Give edges that a wall crosses twice, as far as a few samples show, a vertex in between."""
    base, on = surface.base, surface.on
    a, b = edges_of(surface.triangles)[0].T
    value = function(base, surface.leaf)
    size = np.abs(value)
    end = np.where(size[a] >= size[b], value[a], value[b])  # the larger end decides the side
    look = np.flatnonzero((value[a] * value[b] > -(ON**2)) & (np.abs(end) > ON))
    a, b, end = a[look], b[look], np.sign(end[look])
    leaf = surface.between(a, b)
    worst, where = np.zeros(len(look)), np.full(len(look), 0.5)
    for t in SAMPLES:
        beyond = -end * function(base[a] + t * (base[b] - base[a]), leaf)
        beyond = np.where(np.abs(beyond) < period / 4, beyond, -math.inf)
        where, worst = np.where(beyond > worst, t, where), np.maximum(worst, beyond)
    twice = np.flatnonzero(worst > 10 * ON)
    if not len(twice):
        return surface
    a, b, t = a[twice], b[twice], where[twice, None]
    place = base[a] + t * (base[b] - base[a])
    return surface.divided(look[twice], place, on[a] & on[b] & straight_walls(chain), leaf[twice])


def edges_of(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges [E, 2] (smaller vertex first) and, for each triangle, its three: (0, 1), (1, 2), (2, 0)."""
    t = triangles
    pairs = np.sort(np.stack([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]], axis=1), axis=-1)
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


def pull(chain: HalfChain, base: np.ndarray, leaf: np.ndarray, bit: int) -> np.ndarray:
    """Move base points [V, 2] onto a curved wall by Newton steps along its gradient."""
    function = wall_function(chain, bit)
    h = DIFFERENCE
    for _ in range(6):
        value = function(base, leaf)
        if np.abs(value).max(initial=0.0) <= EPS:
            break
        gradient = np.stack(
            [
                (function(base + step, leaf) - function(base - step, leaf)) / (2 * h)
                for step in ([h, 0.0], [0.0, h])
            ],
            axis=1,
        )
        size = np.maximum((gradient**2).sum(axis=1), OUTSIDE)
        step = (value / size)[:, None] * gradient
        step *= np.minimum(1.0, 0.1 / np.maximum(np.linalg.norm(step, axis=1), NONZERO))[:, None]
        base = base - step
    return base


def _double(surface: Surface, kept: np.ndarray) -> Surface:
    """Two copies of the triangles `kept`, joined along the seam."""
    base, on, _, triangles = surface
    triangles = triangles[kept]
    seam = has(on, SEAM)
    count = len(base)
    other = np.where(seam, np.arange(count), count + np.arange(count))
    leaf = np.where(seam, 0, 1)
    leaf = np.concatenate([leaf, -np.ones(count, dtype=leaf.dtype)])
    triangles = np.vstack([triangles, other[triangles]])
    if seam[triangles % count].all(axis=1).any():
        # its two copies would be one triangle, and the surface no surface there
        raise MeshError("a triangle lies between seams: use a larger size")
    _, of_triangle = edges_of(triangles)
    if np.bincount(of_triangle.ravel()).max() > 2:
        raise MeshError("two seams are closer than the mesh: use a larger size")
    return Surface(np.vstack([base, base]), np.concatenate([on, on]), leaf, triangles)


def _shorten(chain: HalfChain, surface: Surface, longest: float) -> Surface:
    """Divide edges between states that are far apart; nearer to the seam, where one end is on it."""
    base, on = surface.base, surface.on
    wedge = chain.points(base, surface.leaf).wedge
    a, b = edges_of(surface.triangles)[0].T
    apart = np.abs(wedge[a] - wedge[b])
    apart[:, -2] = np.minimum(apart[:, -2], 2 * math.pi - apart[:, -2])
    common = on[a] & on[b]
    # edges that follow curved walls would have to be pulled back onto them: those stay
    long = np.flatnonzero((apart.max(axis=1) > longest) & (common & ~straight_walls(chain) == 0))
    a, b = a[long], b[long]
    seam_a, seam_b = has(on[a], SEAM), has(on[b], SEAM)
    # next to the seam states go as the square root of the base point: a quarter of the way is half of it
    t = np.where(seam_a & ~seam_b, 0.25, np.where(seam_b & ~seam_a, 0.75, 0.5))[:, None]
    place = (1 - t) * base[a] + t * base[b]
    return surface.divided(long, place, common[long], surface.between(a, b))


def _compact(surface: Surface) -> Surface:
    """Drop unused vertices."""
    base, on, leaf, triangles = surface
    used = np.unique(triangles)
    number = np.full(len(base), -1)
    number[used] = np.arange(len(used))
    return Surface(base[used], on[used], leaf[used], number[triangles])
