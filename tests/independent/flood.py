"""Barriers by brute force: a min-max flood fill of the paper's chart, from closed forms alone.

Every grid point of the chart (both branches) is a cell; water rises from one minimum until it reaches the other.  Two
neighbours are joined only where the straight way between them in the chart is continuous in the fold angles, which
cuts it where one passes +-pi, and admissible.  The way found is replayed at points between the cells,
so that its height is that of an explicit path: a barrier from above, exact as the grid becomes fine.

What the chart leaves out is added: the flat state and the family of states that share the chart's origin (cells on
either side of it are joined), and thin sets, as given chains of states.

No graph, Newton or loop-closure code of `barriers` is used here.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.chart import Chart, admissible, chart_of, crease_number
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Scene

ROWS = 32
"""Grid rows that are evaluated together."""
STEEP = 8.0
"""A fold angle that changes by more than this many grid steps between neighbours is looked at closely."""
FINEST = 14
"""An edge is halved this often before a change that stays counts as a jump."""
SMOOTH = 0.1
"""Fold angles change continuously where they change by less [rad] between halvings."""
REPLAY = 8
"""Points at which each edge of the way found is looked at again."""
MOST_REPLAYS = 400
BRIDGES = (0.5, 0.35, 0.25, 0.15, 0.1, 0.05)
"""Distances from the chart's origin [rad] at which its two sides are joined through the book fold."""
REACH = 3.5
"""Cells around the end of a thin set are joined to it within this many grid steps: walls of slope 2 meet there, and the
cell a knight's move away (2 steps in one coordinate) must not be lost to rounding."""
DIRECTIONS = ((0, 1), (1, 0), (1, 1), (1, -1))


@dataclass(frozen=True)
class Flood:
    """A min-max way between two states on the grid.

    level: largest energy of its cells.  height: largest energy along the way itself, sampled between the
    cells: an upper bound of the barrier.  states: wedge fold angles [M, k] of the cells.  size: of the grid.
    spacing: of the first coordinate [rad].
    """

    level: float
    height: float
    states: np.ndarray = field(repr=False)
    size: int
    spacing: float


class ChartGrid:
    """The admissible cells of a scene's chart and the ways between neighbours.

    Energies are not part of it: scenes that differ in springs only can share one (`flood`).
    """

    def __init__(
        self,
        scene: Scene,
        size: int,
        chains: Sequence[np.ndarray] = (),
    ) -> None:
        """Evaluate a size x size grid; `chains` are polylines [m, N] of fold angles on thin sets.

        Raises
        ------
        OptionError
            If the scene has no two-dimensional chart, or `size` is even or out of range (an odd
            grid has the flat state as a cell).
        """
        chart = chart_of(scene)
        if chart is None or scene.contact == "none":
            raise OptionError("a flood fill needs a scene with a two-dimensional chart and contact")
        if not 17 <= size <= 8193 or size % 2 == 0:
            raise OptionError(f"size = {size} must be odd and lie between 17 and 8193")
        self.scene, self.chart, self.size = scene, chart, size
        self.wedge = [crease_number(scene, r) - 1 for r in range(len(scene.group.rays))]
        self.x = np.linspace(-math.pi, math.pi, size)
        reach = math.pi if chart.kind == "degree6" else math.pi / 2
        self.y = np.linspace(-reach, reach, size)
        self.spacing = float(self.x[1] - self.x[0])
        k = len(self.wedge)
        shape = (len(chart.signs), size, size)
        self.states = np.full((*shape, k), np.nan)
        self.good = np.zeros(shape, dtype=bool)
        for b in range(shape[0]):
            for i in range(0, size, ROWS):
                phi = chart.fold_angles(b, self.x[i : i + ROWS, None], self.y[None, :])
                flat = phi.reshape(-1, phi.shape[-1])
                self.good[b, i : i + ROWS] = admissible(scene, flat).reshape(phi.shape[:2])
                self.states[b, i : i + ROWS] = phi[..., self.wedge]
        centre = size // 2
        for b in range(shape[0]):  # one cell for the flat state
            self.states[b, centre, centre] = 0.0
            self.good[b, centre, centre] = b == 0
        self.open = [self._ways(chart, b) for b in range(shape[0])]
        self._add_links(chains)

    def _ways(self, chart: Chart, b: int) -> list[np.ndarray]:
        """Tell for each direction which cells are joined to their neighbour there, [4][size, size]."""
        n, good, states = self.size, self.good[b], self.states[b]
        out = []
        rim = good & ~_all_neighbours(good)
        for di, dj in DIRECTIONS:
            lo, hi = max(0, -dj), n - max(0, dj)
            one = (slice(0, n - di), slice(lo, hi))
            two = (slice(di, n), slice(lo + dj, hi + dj))
            both = good[one] & good[two]
            jump = np.zeros(both.shape)
            for c in range(states.shape[-1]):
                with np.errstate(invalid="ignore"):
                    np.maximum(jump, np.abs(states[(*two, c)] - states[(*one, c)]), out=jump)
            look = both & ((jump > STEEP * self.spacing) | rim[one] | rim[two])
            i, j = np.nonzero(look)
            j = j + lo
            both[look] = self._continuous(chart, b, i, j, i + di, j + dj)
            full = np.zeros((n, n), dtype=bool)
            full[one] = both
            out.append(full)
        return out

    def _at(
        self, chart: Chart, b: int, x: np.ndarray, y: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return wedge fold angles [K, k] of chart points and which are admissible."""
        phi = chart.fold_angles(b, x, y)
        return phi[:, self.wedge], admissible(self.scene, phi)

    def _continuous(
        self, chart: Chart, b: int, i: np.ndarray, j: np.ndarray, i2: np.ndarray, j2: np.ndarray
    ) -> np.ndarray:
        """Tell along which edges the fold angles change continuously and stay admissible, by halving."""
        result = np.ones(len(i), dtype=bool)
        left, right = self.states[b, i, j], self.states[b, i2, j2]
        xa, ya, xb, yb = self.x[i], self.y[j], self.x[i2], self.y[j2]
        edge = np.arange(len(i))
        for depth in range(FINEST):
            if not len(edge):
                return result
            xm, ym = 0.5 * (xa + xb), 0.5 * (ya + yb)
            middle, good = self._at(chart, b, xm, ym)
            result[edge[~good]] = False
            parts = []
            for u, v, pa, pb in (
                (left, middle, (xa, ya), (xm, ym)),
                (middle, right, (xm, ym), (xb, yb)),
            ):
                with np.errstate(invalid="ignore"):
                    jump = np.abs(v - u).max(axis=1)
                more = good & result[edge] & ((jump > SMOOTH) | (depth < 1))
                parts.append([a[more] for a in (u, v, *pa, *pb, edge)])
            left, right, xa, ya, xb, yb, edge = (
                np.concatenate([p, q]) for p, q in zip(*parts, strict=True)
            )
        result[edge] = False  # still steep: a jump
        return result

    def _add_links(self, chains: Sequence[np.ndarray]) -> None:
        """Join cells across the chart's origin, and chains to each other and to the cells at their ends."""
        self.extra = np.empty((0, len(self.wedge)))
        self.links: dict[int, list[int]] = {}
        self.bridges: dict[tuple[int, int], np.ndarray] = {}
        centre, n = self.size // 2, self.size
        near = 3.0 * math.sqrt(self.spacing)
        if self.chart.kind == "degree6":
            self._bridge_book_fold()
            pairs = []
        else:
            i, k = np.meshgrid(np.arange(-4, 5), np.arange(1, 5), indexing="ij")
            pairs = [(b, i, k, 1 - b, -i, -k) for b in (0, 1)]
        for b1, p, q, b2, r, s in pairs:
            inside = (np.abs(q) <= centre) & (np.abs(s) <= centre) & (np.abs(p) <= centre)
            p, q, r, s = (v[inside] + centre for v in (p, q, r, s))
            u, v = self.states[b1, p, q], self.states[b2, r, s]
            with np.errstate(invalid="ignore"):
                same = np.abs(u - v).max(axis=1) <= near
            same &= self.good[b1, p, q] & self.good[b2, r, s]
            for a, c in zip(
                ((b1 * n + p) * n + q)[same].tolist(),
                ((b2 * n + r) * n + s)[same].tolist(),
                strict=True,
            ):
                self._link(a, c)
        for b in range(1, self.good.shape[0]):
            # the flat state is a cell of the first branch: join the others' cells around it
            for di, dj in ((0, 1), (1, 0), (1, 1), (1, -1), (0, -1), (-1, 0), (-1, -1), (-1, 1)):
                if self.good[b, centre + di, centre + dj]:
                    self._link(centre * n + centre, ((b * n) + centre + di) * n + centre + dj)
        for chain in chains:
            start = self.good.size + len(self.extra)
            states = np.asarray(chain)[:, self.wedge]
            self.extra = np.vstack([self.extra, states])
            for a in range(start, start + len(states) - 1):
                self._link(a, a + 1)
            for at in (0, len(states) - 1):
                self._link_to_cells(start + at, states[at])

    def _bridge_book_fold(self) -> None:
        """Join cells (r, -r + c r^2) to (-r, r + c r^2): as r falls to 0 both go to the book fold that belongs to c.

        Each way is kept as closed-form states on the two parabolas, for the replay.
        """
        h, n, centre = self.spacing, self.size, self.size // 2
        t = np.concatenate([np.linspace(1, 0.05, 20), -np.linspace(0.05, 1, 20)])
        for i in sorted({max(1, round(r / h)) for r in BRIDGES}):
            most = min(centre - i, 4 + math.ceil(6 * (i * h) ** 2 / h))
            for k in range(-most, most + 1):
                if not (abs(k - i) <= centre and abs(k + i) <= centre):
                    continue
                x, y = i * h * t, -i * h * t + k * h * t * t
                states, good = self._at(self.chart, 0, x, y)
                if not good.all() or np.abs(np.diff(states, axis=0)).max() > 2 * SMOOTH:
                    continue
                a = (centre + i) * n + centre + k - i
                c = (centre - i) * n + centre + k + i
                self._link(a, c)
                self.bridges[a, c], self.bridges[c, a] = states, states[::-1]

    def _link(self, a: int, b: int) -> None:
        self.links.setdefault(a, []).append(b)
        self.links.setdefault(b, []).append(a)

    def _link_to_cells(self, node: int, state: np.ndarray) -> None:
        """Join a state to the admissible cells around it."""
        with np.errstate(invalid="ignore"):
            gap = np.abs(self.states - state).max(axis=-1)
        gap[~self.good] = np.inf
        for cell in np.flatnonzero(gap.ravel() <= REACH * self.spacing).tolist():
            self._link(node, cell)

    def nearest(self, fold_angles: np.ndarray) -> int:
        """Return the cell (or chain state) nearest to a state [N]."""
        state = np.asarray(fold_angles)[self.wedge]
        gap = np.full(self.good.shape, np.inf)
        gap[self.good] = np.abs(self.states[self.good] - state).max(axis=-1)
        best = int(gap.argmin())
        if len(self.extra):
            extra = np.abs(self.extra - state).max(axis=1)
            if extra.min() <= gap.min():
                return self.good.size + int(extra.argmin())
        return best

    def flood(
        self,
        scene: Scene,
        start: np.ndarray,
        end: np.ndarray,
        more: Callable[[np.ndarray], np.ndarray] | None = None,
    ) -> Flood | None:
        """Find the min-max way between two states [N] with the springs of `scene`; None if there is none.

        more: energy of wedge fold angles [..., k] beside that of the springs.
        """
        k = np.bincount(scene.group.orbit, scene.stiffness)
        rest = np.array(scene.rest_angles)[self.wedge]

        def of(x: np.ndarray) -> np.ndarray:
            springs = 0.5 * (k * (x - rest) ** 2).sum(axis=-1)
            return np.asarray(springs if more is None else springs + more(x))

        energy = np.full(self.good.shape, np.inf)
        energy[self.good] = of(self.states[self.good])
        extra = of(self.extra)
        levels = np.concatenate([energy.ravel(), extra])
        a, b = self.nearest(start), self.nearest(end)
        for _ in range(MOST_REPLAYS):
            way = self._way(levels, a, b)
            if way is None:
                return None
            height, broken = self._replay(way, of)
            if not broken:
                states = np.array([self._state(v) for v in way])
                return Flood(float(levels[way].max()), height, states, self.size, self.spacing)
            for u, v in broken:
                self._close(u, v)
        return None

    def _state(self, v: int) -> np.ndarray:
        cells = self.good.size
        k = len(self.wedge)
        return self.extra[v - cells] if v >= cells else self.states.reshape(-1, k)[v]

    def _bits(self) -> np.ndarray:
        """One byte a cell: which of its eight neighbours it is joined to."""
        bits = np.zeros(self.good.shape, dtype=np.uint8)
        n = self.size
        for b, ways in enumerate(self.open):
            for d, (di, dj) in enumerate(DIRECTIONS):
                i, j = np.nonzero(ways[d])
                bits[b, i, j] |= np.uint8(1 << d)
                bits[b, (i + di) % n, (j + dj) % n] |= np.uint8(1 << (d + 4))
        return bits

    def _way(self, levels: np.ndarray, start: int, end: int) -> list[int] | None:
        """Flood from `start`, lowest cells first, until `end` is wet; return the cells on the way."""
        n = self.size
        bits = memoryview(self._bits().ravel())  # type: ignore[arg-type]
        level = memoryview(np.ascontiguousarray(levels))  # type: ignore[arg-type]
        steps = [di * n + dj for di, dj in DIRECTIONS]
        offsets = [*steps, *(-s for s in steps)]
        fan = [[offsets[d] for d in range(8) if m >> d & 1] for m in range(256)]
        came = np.full(len(levels), -1, dtype=np.int64)
        from_ = memoryview(came)  # type: ignore[arg-type]
        from_[start] = start
        cells = self.good.size
        heap = [(level[start], start)]
        push, pop, links = heapq.heappush, heapq.heappop, self.links
        while heap:
            u, v = pop(heap)
            if v == end:
                break
            near = [v + s for s in fan[bits[v]]] if v < cells else []
            if v in links:
                near += links[v]
            for w in near:
                if from_[w] < 0:
                    from_[w] = v
                    push(heap, (level[w] if level[w] > u else u, w))
        if came[end] < 0:
            return None
        way = [end]
        while way[-1] != start:
            way.append(int(came[way[-1]]))
        return way[::-1]

    def _replay(
        self, way: list[int], of: Callable[[np.ndarray], np.ndarray]
    ) -> tuple[float, list[tuple[int, int]]]:
        """Sample the way between its cells; return its height and the edges that do not hold."""
        n, cells = self.size, self.good.size
        height, broken = -math.inf, []
        t = np.linspace(0, 1, REPLAY + 1)[:, None]
        tops = [self._state(v) for v in way]
        height = float(of(np.array(tops)).max())
        by_branch: dict[int, list[int]] = {}
        flat = self.size // 2 * (n + 1)
        for m, (u, v) in enumerate(itertools.pairwise(way)):
            linked = u >= cells or v >= cells or v in self.links.get(u, ())
            if (u, v) in self.bridges:
                over = self.bridges[u, v]
                height = max(height, float(of(over).max()))
            elif linked or flat in (u, v):  # straight in the fold angles
                chord = tops[m] + t * (tops[m + 1] - tops[m])
                height = max(height, float(of(chord).max()))
            else:
                by_branch.setdefault(u // (n * n), []).append(m)
        for b, edges in by_branch.items():
            at = np.array(way)
            i, j = np.divmod(at % (n * n), n)
            e = np.array(edges)
            x = self.x[i[e]] + t[1:-1] * (self.x[i[e + 1]] - self.x[i[e]])
            y = self.y[j[e]] + t[1:-1] * (self.y[j[e + 1]] - self.y[j[e]])
            states, fine = self._at(self.chart, b, x.ravel(), y.ravel())
            holds = np.asarray(fine.reshape(x.shape).all(axis=0))
            broken += [(way[v], way[v + 1]) for v in e[~holds].tolist()]
            energy = of(states).reshape(x.shape)
            if holds.any():
                height = max(height, float(energy[:, holds].max()))
        return height, broken

    def _close(self, u: int, v: int) -> None:
        """Take an edge between two cells away."""
        n = self.size
        for a, c in ((u, v), (v, u)):
            b, rest = divmod(a, n * n)
            i, j = divmod(rest, n)
            i2, j2 = divmod(c % (n * n), n)
            if (i2 - i, j2 - j) in DIRECTIONS:
                self.open[b][DIRECTIONS.index((i2 - i, j2 - j))][i, j] = False


def _all_neighbours(good: np.ndarray) -> np.ndarray:
    """Return which cells have eight admissible neighbours."""
    out = good.copy()
    for axis in (0, 1):
        for shift in (1, -1):
            moved = np.roll(out, shift, axis)
            edge = [slice(None)] * 2
            edge[axis] = slice(0, 1) if shift == 1 else slice(-1, None)
            moved[tuple(edge)] = False
            out = out & moved
    return out
