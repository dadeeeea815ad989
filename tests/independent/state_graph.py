"""All closed states of a sheet of parallel and zigzag rows (Miura) on a grid, and which of them are next to each other.

Facets are placed by rotations (`rigid`), the Flexible Collision Library says what passes through what, and facets in
one plane are stacked in every order.  Nothing is known of curves but that tangents of half the folds are proportional
round a vertex, which each state shows by closing.
"""

import itertools
import math

import numpy as np
from scipy.optimize import brentq
from shapely.geometry import LineString, Polygon

from tests.independent.rigid import Rigid, _mesh, fcl

SHRUNK = 1e-3
"""Facets are drawn in by this share, so that those that touch do not collide."""
ZERO, TURNED, FREE = range(3)


class StateGraph:
    """States of a pattern, `steps` from flat to folded flat along each row that moves."""

    def __init__(self, pattern, steps):
        self.p, self.n, self.rigid = pattern, steps, Rigid(pattern)
        self.vertices = [self._vertex(v) for v in pattern.vertices]
        joined = {c: {c} for c in range(pattern.creases)}
        for down, left, up, right in self.vertices:
            for a, b in ((down, up), (left, right)):
                both = joined[a] | joined[b]
                for c in both:
                    joined[c] = both
        self.rows = sorted({tuple(sorted(s)) for s in joined.values()})
        self.row = {c: r for r, row in enumerate(self.rows) for c in row}
        self.ratio = [self._ratio(v) for v in range(len(self.vertices))]
        self._paper = {}

    def _vertex(self, v):
        """Creases down, left, up, right: left and right in one line."""
        creases = list(v.creases)
        u = [
            self.p.corners[self.p.ends[c].sum() - v.vertex] - self.p.corners[v.vertex]
            for c in creases
        ]
        u = [x / np.linalg.norm(x) for x in u]
        at = 1 if np.linalg.norm(u[1] + u[3]) < 1e-9 else 0
        creases = creases[at - 1 :] + creases[: at - 1]
        return tuple(creases)

    def _ratio(self, v):
        """Of the tangents of half of left, and of half of down, where right is -left and up is down."""
        down, left, up, right = self.vertices[v]

        def miss(x):
            q = np.eye(2, dtype=complex)
            phi = {down: 1.0, up: 1.0, left: x, right: -x}
            corner = self.p.vertices[v].vertex
            for c in self.p.vertices[v].creases:
                a, b, _ = self.p.corners[self.p.ends[c].sum() - corner] - self.p.corners[corner]
                s = math.sin(phi[c] / 2) / math.hypot(a, b)
                turn = np.array([[0, s * (a - 1j * b)], [s * (a + 1j * b), 0]])
                q = q @ (math.cos(phi[c] / 2) * np.eye(2) - 1j * turn)
            return (q[0, 0].imag, q[0, 1].real, q[0, 1].imag)

        for part in range(3):
            for low, high in ((-3.0, -0.05), (0.05, 3.0)):
                if miss(low)[part] * miss(high)[part] < 0:
                    x = brentq(lambda t, k=part: miss(t)[k], low, high, xtol=1e-15)
                    if np.abs(miss(x)).max() < 1e-12:
                        return math.tan(x / 2) / math.tan(0.5)
        raise AssertionError

    def states(self):
        """Yield products: states by their place on the grid."""
        for modes in itertools.product((True, False), repeat=len(self.vertices)):
            groups = self._groups(modes)
            if groups is None:
                continue
            for kinds in itertools.product(range(3), repeat=len(groups)):
                of = {r: k for g, k in zip(groups, kinds, strict=True) for r in g}
                fits = all(
                    mode or of[self.row[v[0]]] == ZERO or of[self.row[v[1]]] == TURNED
                    for v, mode in zip(self.vertices, modes, strict=True)
                )
                if fits:
                    yield from self._expand(modes, groups, kinds)

    def _groups(self, modes):
        """Rows that move together: of each its ratio to the first, and of each crease its sign along the row."""
        signs = {row[0]: 1 for row in self.rows}
        ratio = {}
        for _ in self.vertices:
            for (down, left, up, right), mode in zip(self.vertices, modes, strict=True):
                for a, b, s in ((down, up, mode), (left, right, not mode)):
                    for x, y in ((a, b), (b, a)):
                        if x in signs:
                            signs.setdefault(y, signs[x] if s else -signs[x])
        groups = []
        for r in range(len(self.rows)):
            if r in ratio:
                continue
            ratio[r] = 1.0
            group = [r]
            for one in group:
                for k, (down, left, _, _) in enumerate(self.vertices):
                    if not modes[k]:
                        continue
                    m = self.ratio[k] * signs[down] * signs[left]
                    for x, y, z in ((down, left, m), (left, down, 1 / m)):
                        if self.row[x] == one and self.row[y] not in ratio:
                            ratio[self.row[y]] = ratio[one] * z
                            group.append(self.row[y])
            groups.append(tuple(group))
        self.signs, self.share = signs, ratio
        return groups

    def _expand(self, modes, groups, kinds):
        signs, share, n = dict(self.signs), dict(self.share), self.n
        ways = []
        for group, kind in zip(groups, kinds, strict=True):
            if kind == ZERO:
                ways.append([(0, (0.0,) * len(group))])
            elif kind == FREE:
                own = []
                for k in (*range(1 - n, 0), *range(1, n)):
                    t = math.tan(0.5 * math.pi * k / n)
                    own.append((k, tuple(2 * math.atan(share[r] * t) for r in group)))
                ways.append(own)
            else:
                own = []
                for sides in itertools.product((-1, 1), repeat=len(group)):
                    ends = {
                        s * (1 if share[r] > 0 else -1) for s, r in zip(sides, group, strict=True)
                    }
                    # other signs than at the ends of the curve: not next to it
                    k = n * ends.pop() if len(ends) == 1 else ("beside it", sides)
                    own.append((k, tuple(s * math.pi for s in sides)))
                ways.append(own)
        for parts in itertools.product(*ways):
            phi = np.zeros(self.p.creases)
            for group, (_, folds) in zip(groups, parts, strict=True):
                for r, x in zip(group, folds, strict=True):
                    for c in self.rows[r]:
                        phi[c] = signs[c] * x
            yield (modes, tuple(k for k, _ in parts)), phi

    def minima(self):
        """Return states of paper on the grid below all that are next to them, [m, n], and how many are paper."""
        places, at = {}, {}
        for place, phi in self.states():
            key = tuple(np.round(phi, 7).tolist())
            if key not in at:
                assert np.abs(self.rigid.open(phi)).max() < 1e-8
                at[key] = phi
            places[place] = key
        energy = {k: 0.5 * float(self.p.stiffness @ (x - self.p.rest) ** 2) for k, x in at.items()}
        lowest = dict.fromkeys(at, True)
        paper = {k: None for k in at}

        def is_paper(key):
            if paper[key] is None:
                paper[key] = self.paper(at[key])
            return paper[key]

        for (modes, ks), key in places.items():
            if not lowest[key]:
                continue
            near = [[k] if isinstance(k, tuple) else [k - 1, k, k + 1] for k in ks]
            for other in itertools.product(*near):
                there = places.get((modes, other))
                if there is None or there == key or energy[there] >= energy[key]:
                    continue
                # rows move at once only where all states between are closed
                if not all(
                    (modes, x) in places for x in itertools.product(*zip(ks, other, strict=True))
                ):
                    continue
                if is_paper(there):
                    lowest[key] = False
                    break
        return np.array([at[k] for k, low in lowest.items() if low and is_paper(k)])

    def paper(self, phi):
        """Return whether facets do not cross, and those in one plane have an order."""
        still = [abs(x) < 1e-9 or abs(abs(x) - math.pi) < 1e-9 for x in phi]
        block = list(range(self.p.facets))
        for c, (a, b) in enumerate(zip(self.p.left, self.p.right, strict=True)):
            if still[c]:
                block = [block[a] if k == block[b] else k for k in block]
        key = tuple(round(x / math.pi) if s else None for x, s in zip(phi, still, strict=True))
        if key not in self._paper:
            self._paper[key] = self._stacks(key, block)
        if not self._paper[key]:
            return False
        inner = []
        for x in self.rigid.polygons(phi):
            middle = x.mean(axis=0)
            inner.append(_mesh(middle + (1 - SHRUNK) * (x - middle)))
        return not any(
            block[f] != block[g]
            and fcl.collide(inner[f], inner[g], fcl.CollisionRequest(), fcl.CollisionResult())
            for f, g in itertools.combinations(range(self.p.facets), 2)
        )

    def _stacks(self, key, block):
        """Return whether some order of the facets of all blocks is one of paper; every one is tried."""
        zero = np.array([0.7 if s is None else s * math.pi for s in key])
        x = self.rigid.polygons(zero)
        plane, up = {}, {}
        for f in range(self.p.facets):
            b = block[f]
            if b not in plane:
                o, e = x[f][0], x[f][1] - x[f][0]
                normal = np.cross(e, x[f][2] - o)
                e, normal = e / np.linalg.norm(e), normal / np.linalg.norm(normal)
                plane[b] = o, np.array([e, np.cross(normal, e), normal])
            o, frame = plane[b]
            flat = (x[f] - o) @ frame.T
            up[f] = 1 if Polygon(flat[:, :2]).exterior.is_ccw else -1
            x[f] = flat[:, :2]
        shape = [Polygon(q).buffer(-1e-4) for q in x]
        over = [
            [block[f] == block[g] and shape[f].intersects(shape[g]) for g in range(len(x))]
            for f in range(len(x))
        ]
        sides = []
        for c, pair in enumerate(zip(self.p.left.tolist(), self.p.right.tolist(), strict=True)):
            for f, g in (pair, pair[::-1]):
                q = x[f][[self.p.polygons[f].index(v) for v in self.p.ends[c]]]
                sides.append((c, f, g, LineString(q), key[c]))
        rules = []
        for _, f, g, line, kind in sides:
            if kind in (1, -1):
                # a valley has the other facet on the side of this one's normal
                rules.append(((f, g), lambda z, f=f, g=g, s=kind: (z[g] - z[f]) * up[f] * s > 0))
            for h in range(len(x)):
                if h in (f, g) or block[h] != block[f] or not shape[h].intersects(line):
                    continue
                if kind is None:
                    return False  # it goes on where a crease leaves its plane
                rules.append(
                    ((f, g, h), lambda z, f=f, g=g, h=h: (z[f] - z[h]) * (z[g] - z[h]) > 0)
                )
        for (_, f, g, one, k), (_, h, j, two, m) in itertools.combinations(sides, 2):
            if len({f, g, h, j}) < 4 or block[f] != block[h] or not over[f][h]:
                continue
            if one.buffer(1e-6).intersection(two).length < 1e-3:
                continue
            # both facets are on one side of the line
            if k in (1, -1) and m in (1, -1):
                rules.append(
                    (
                        (f, g, h, j),
                        lambda z, f=f, g=g, h=h, j=j: (
                            sum(min(z[f], z[g]) < y < max(z[f], z[g]) for y in (z[h], z[j])) != 1
                        ),
                    )
                )
            elif k in (1, -1):
                rules.append(
                    ((f, g, h), lambda z, f=f, g=g, h=h: (z[f] - z[h]) * (z[g] - z[h]) > 0)
                )
            elif m in (1, -1):
                rules.append(
                    ((f, h, j), lambda z, f=f, h=h, j=j: (z[h] - z[f]) * (z[j] - z[f]) > 0)
                )
            elif block[g] == block[j] and over[g][j]:
                rules.append(
                    (
                        (f, g, h, j),
                        lambda z, f=f, g=g, h=h, j=j: (
                            (z[h] - z[f]) * up[f] * (z[j] - z[g]) * up[g] > 0
                        ),
                    )
                )
        due = [[] for _ in x]
        for facets, rule in rules:
            due[max(facets)].append(rule)

        def insert(f, stacks):
            """Put facet f into the stack of its block at every place."""
            if f == len(x):
                return True
            stack = stacks.get(block[f], ())
            for k in range(len(stack) + 1):
                more = stacks | {block[f]: (*stack[:k], f, *stack[k:])}
                z = {h: i for one in more.values() for i, h in enumerate(one)}
                if all(rule(z) for rule in due[f]) and insert(f + 1, more):
                    return True
            return False

        return insert(0, {})
