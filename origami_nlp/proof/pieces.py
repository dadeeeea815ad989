"""What vanishes at every local minimum of a vertex, over boxes of the fold angles of its piece: closure, minors, twins.

Torques are those of single creases, G_i = k_i (phi_i - rest_i); c_i are the axes.  On the free creases
of a stratum a minimum is critical in the sense of Fritz John: [G | slopes of closure] has no more than as many
independent columns as closure has equations, so that every minor with one column more vanishes.

No symmetry, and periods of C_n that close by themselves.  The product of folds and sectors is -A B = -1 (a sheet of
paper winds once), so A - 1 / B = 0; multiplied by B as it is at the middle of a box, A and 1 / B are unit quaternions
turned by half of the folds each, about axes as the facet before crease 1 has them.  Rank 3: det [G_S | C_S] = 0 for
every four free creases S, an alternating sum of G_i times triple products of axes, which depend on the folds along two
of the three arcs between them: the two with fewest creases.

C_n.  The period T has T^n = -1, its scalar is cos(w pi / n) where states wind w times.  One equation: G_a t_b = G_b
t_a, t_i the derivatives of the scalar.

D_1.  Both mirrors are one plane, their normals n_1 and N are equal; seen from the middle ray each depends on half of
the folds.  Two of the entries are of first order, the one along n_1 is of second and tells N from -n_1.  Slopes of
closure are a rotation of n_1 x c_i, in the mirror's plane: rank 2, G_i (n_1, c_j, c_k) + cyclic = 0 for three free
creases, the same with N.

D_n.  n_1 . N = -cos(w pi / n), with slopes t_i = (n_1, c_i, N): G_a t_b = G_b t_a.

A crease on a mirror counts half in the energy of a piece, and turns it half: G_i stands beside c_i all the same.

Touches.  A gap is a triple product, and so are its slopes: ray k off facet j is (c_j, c_{j+1}, c_k), with slopes (z_j,
c_i, c_k), z_j the facet's normal.  Closed gaps are further equations and further columns: minors are expanded along
them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from origami_nlp.numerics import quaternion
from origami_nlp.proof.reduced import CollinearPair, ReducedVertex, collinear_creases, twins_asked
from origami_nlp.proof.rows import (
    CREASE,
    SECTORS,
    SLIGHTLY,
    UNIT,
    Affine,
    Chain,
    Folded,
    Quadratic,
    Triples,
    cross,
    joined_rows,
    number,
    pairs,
    times_vector,
    variables,
)


class Piece:
    """The piece of a vertex whose fold angles are the variables.

    Parameters
    ----------
    vertex
        Of a flat sheet.

    Attributes
    ----------
    pivots
        How many rows of closure are independent to first order where it is regular.
    by_vectors
        Whether closure is of vectors that rotate, not of quaternions.
    near_flat
        Whether closure is known the better the nearer the flat state.
    subsets
        Variables of each minor, [M, rank + 1].
    """

    chain: Chain
    pivots: int
    by_vectors = False
    near_flat = False

    def __init__(self, vertex: ReducedVertex, rank: int) -> None:
        p, scene = vertex.problem.parameters, vertex.scene
        self.size, self.limits = vertex.size, vertex.problem.fold_limits
        stiffness = p.stiffness / vertex.problem.multiplicity
        self.sectors = np.asarray(vertex.sectors, float)
        # a load on a crease is a spring that rests elsewhere
        self.rest = np.asarray(p.rest + p.load / p.stiffness, float)
        self.stiffness = stiffness / stiffness.max()
        self.subsets = np.array(
            list(itertools.combinations(range(self.size), rank + 1)), dtype=int
        ).reshape(-1, rank + 1)
        self.twins: tuple[CollinearPair, ...] = collinear_creases(
            scene.vertex.sector_angles, vertex.variable_of_crease.tolist(), SECTORS * 4 * UNIT
        )

    def twins_on(self, pins: np.ndarray) -> Iterator[tuple[CollinearPair, np.ndarray]]:
        """Go through the creases on one line on a stratum [n], with slopes of what must vanish, [n]."""
        flat = self.limits.folded_flat(pins)
        for t in itertools.compress(
            self.twins, twins_asked(self.twins, pins[:, None], flat[:, None])
        ):
            row, one = np.zeros(self.size), [*t.creases]
            row[one] = (1.0, -t.sign)[: len(one)] * self.stiffness[one]
            yield t, row

    def closure(self, folded: Folded) -> Quadratic:
        """Enclose closure."""
        raise NotImplementedError

    def equations(self, folded: Folded) -> Quadratic:
        """Enclose as many rows of closure as are independent (`system` says why a zero of them closes)."""
        return self.closure(folded)

    def closes(self, folded: Folded) -> np.ndarray:
        """Return whether a zero of the equations at the middle of boxes closes, [K]."""
        return np.ones(folded.near.shape, dtype=bool)

    def minors(self, folded: Folded, torques: Quadratic) -> Quadratic:
        """Enclose the minors of `subsets`."""
        raise NotImplementedError

    def torques(self, middle: np.ndarray, half: np.ndarray) -> Quadratic:
        """Enclose the torques of single creases over boxes [n, K], over the largest stiffness."""
        k, i = self.stiffness[:, None], np.arange(self.size)
        out = number(k * (middle - self.rest[:, None]), 0.0, self.size)
        out.slopes[i, i] = k * half
        out.rest[:] = 16 * UNIT * (out.magnitude() + 8 * k)
        return out

    def rows(
        self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray
    ) -> tuple[Affine, np.ndarray]:
        """Enclose closure, minors and twins over boxes, and say which of them hold on the box's stratum, [R, K].

        Parameters
        ----------
        lower, upper
            Shape [n, K] [rad].
        pins
            -1, 0 or +1, shape [n, K].
        """
        middle, half = variables(lower, upper)
        folded, torques = self.chain.fold(middle, half), self.torques(middle, half)
        rows = [self.closure(folded), self.minors(folded, torques)]
        for t in self.twins:  # G_a = s G_b, or G_a = 0
            one, *other = (torques[[v]] for v in t.creases)
            rows.append(sum((g.times(-t.sign) for g in other), one))
        asked = [
            np.ones(rows[0].value.shape, dtype=bool),
            (pins == 0)[self.subsets].all(axis=1),
            twins_asked(self.twins, pins, self.limits.folded_flat(pins.T).T),
        ]
        return joined_rows([r.affine() for r in rows]), np.concatenate(asked)


class VertexPiece(Piece):
    """A vertex without symmetry, or a period of C_n that closes by itself."""

    pivots = 3

    def __init__(self, vertex: ReducedVertex) -> None:
        super().__init__(vertex, 3)
        n = self.size
        steps = [p % n for p in range(2 * n - 1)]
        self.chain = Chain(steps, [1.0] * len(steps), self.sectors[steps].tolist(), n, n)
        self.half = (n + 1) // 2
        self.whole = 2 * math.pi / vertex.scene.group.order
        self.near_flat = self.whole == 2 * math.pi
        triples = list(itertools.combinations(range(n), 3))
        self.triples = Triples(self.chain, [self._along(t) for t in triples])
        place = {t: i for i, t in enumerate(triples)}
        self.without = np.array(
            [[place[(*s[:a], *s[a + 1 :])] for a in range(4)] for s in self.subsets.tolist()],
            dtype=int,
        ).reshape(-1, 4)

    def _along(self, creases: tuple[int, int, int]) -> tuple[int, int, int]:
        """Rays of three creases on the arc round the longest of the three gaps, by number of creases."""
        i, j, k = creases
        n = self.size
        ways = [(i, j, k), (j, k, i + n), (k, i + n, j + n)]
        return min(ways, key=lambda w: w[2] - w[0])

    def equations(self, folded: Folded) -> Quadratic:
        """Enclose the vector part of closure."""
        return self.closure(folded)[1:]

    def closes(self, folded: Folded) -> np.ndarray:
        """Return whether the product of folds and sectors is -1 where its vector part vanishes, [K]."""
        return self.loop(folded)[0] > 0

    def loop(self, folded: Folded) -> np.ndarray:
        """Return -A B at the middle of boxes, [4, K]."""
        if self.near_flat:
            return folded.loop
        turn = about_normal(self.whole + 2 * math.pi)
        return np.stack(quaternion.multiply(tuple(folded.loop), turn))

    def closure(self, folded: Folded) -> Quadratic:
        """Enclose A B_0 - B_0 / B, four rows."""
        n, h, e = self.size, self.half, self.chain.steps
        x = folded.vectors
        end = np.stack([x[:, n], cross(x[:, e + n - 1], x[:, n]), x[:, e + n - 1]])
        back = list(range(n - 1, h - 1, -1))
        axes = np.einsum("abk,bck->ack", end, x[:, back])
        one = np.zeros_like(folded.loop)
        one[0] = 1.0
        loop, near = self.loop(folded), np.full(folded.loop.shape, self.chain.loop_rounding)
        if self.near_flat:
            near[1:] *= folded.near
        left = self.chain.turned(loop, x[:, :h], range(h), folded.radii[:h], near)
        return left + self.chain.turned(-one, axes, back, -folded.radii[back], 0 * near)

    def minors(self, folded: Folded, torques: Quadratic) -> Quadratic:
        """Enclose det [G_S | C_S]."""
        return expansion(torques, self.triples.at(folded), self.subsets, self.without)


class Period(Piece):
    """A period of C_n that does not close by itself."""

    pivots = 1

    def __init__(self, vertex: ReducedVertex) -> None:
        super().__init__(vertex, 1)
        n = self.size
        self.chain = Chain(range(n), [1.0] * n, self.sectors.tolist(), n, n)
        order = vertex.scene.group.order
        self.level, self.whole = (
            math.cos(vertex.winding * math.pi / order),
            2 * math.pi / order,
        )

    def closure(self, folded: Folded) -> Quadratic:
        """Enclose the scalar less what it is."""
        n = self.size
        q, near = self.loop(folded), np.full((4, 1), self.chain.loop_rounding)
        row = self.chain.turned(q, folded.vectors[:, :n], range(n), folded.radii, near)[:1]
        return row + number(0 * row.value - self.level, 4 * UNIT, n)

    def minors(self, folded: Folded, torques: Quadratic) -> Quadratic:
        """Enclose G_a t_b - G_b t_a."""
        return expansion(torques, self.slopes(folded), self.subsets, self.subsets[:, ::-1])

    def loop(self, folded: Folded) -> np.ndarray:
        """Return the product of folds and sectors at the middle of boxes, [4, K]."""
        return np.stack(quaternion.multiply(tuple(folded.loop), about_normal(self.whole)))

    def slopes(self, folded: Folded) -> Quadratic:
        """Enclose twice the derivatives of the scalar by each fold."""
        n, q, r = self.size, self.loop(folded), folded.radii
        axes = folded.vectors[:, :n]
        one = times_vector(axes, q[:, None])  # c_k q
        two = 0.5 * times_vector(axes[:, :, None], one[:, None])  # c_j c_k q / 2
        three = -0.5 * np.einsum("aik,ajlk->ijlk", axes, two[1:])
        i, j, k = np.sort(np.indices((n, n, n)), axis=0)
        a, b = np.sort(np.indices((n, n)), axis=0)
        first, second, _ = pairs(n)
        share = np.where(first == second, 0.5, 1.0)[:, None]
        s = r.sum(axis=0)
        rest = s**3 / 48 * SLIGHTLY + self.chain.rounding * (1 + s + s * s)
        return Quadratic(
            one[0],
            two[0][a, b] * r,
            three[i, j, k][:, first, second] * (share * r[first] * r[second]),
            np.repeat(rest[None], n, axis=0),
        )


class Wedge(Piece):
    """The wedge of D_n between two mirrors; D_1, too, is where states wind n times.

    Attributes
    ----------
    rays
        Ray of each variable.
    """

    by_vectors = True

    def __init__(self, vertex: ReducedVertex) -> None:
        self.order = vertex.turn
        super().__init__(vertex, 2 if self.order == 1 else 1)
        has = vertex.has_crease
        self.rays = [r for r, crease in enumerate(has) if crease]
        e, n = len(has), self.size
        variable = [self.rays.index(r) if crease else -1 for r, crease in enumerate(has)]
        weight = [0.5 if r in (0, e - 1) else 1.0 for r in range(e)]
        self.chain = c = Chain(variable, weight, [*self.sectors, 0.0], e, n)
        self.pivots = 2 if self.order == 1 else 1
        if self.order == 1:
            self.pairs = list(itertools.combinations(range(n), 2))
            wanted = [
                (c.first, self.rays[i], self.rays[j])
                if j <= n - 1 - i  # fewer creases before j than after i
                else (self.rays[i], self.rays[j], c.last)
                for i, j in self.pairs
            ]
        else:
            self.level = math.cos(math.pi / self.order)
            wanted = [(c.first, r, c.last) for r in self.rays]
            self.product = Triples(c, [(c.up, 0, c.last)])
        self.triples = Triples(c, wanted)

    def closure(self, folded: Folded) -> Quadratic:
        """Enclose n_1 - N as the middle ray sees it, or n_1 . N + cos(w pi / n)."""
        if self.order > 1:
            row = self.product.at(folded)
            return row + number(0 * row.value + self.level, 4 * UNIT, self.size)
        return apart(self.normals_apart(folded))

    def equations(self, folded: Folded) -> Quadratic:
        """Enclose the two rows of first order, or the one."""
        return self.closure(folded) if self.order > 1 else self.normals_apart(folded)[1:]

    def closes(self, folded: Folded) -> np.ndarray:
        """Return whether N is n_1, and not -n_1, for D_1, [K]."""
        x, c = folded.vectors, self.chain
        away = (x[:, c.first] * x[:, c.last]).sum(axis=0) < 0
        return ~away if self.order == 1 else np.ones_like(away)

    def normals_apart(self, folded: Folded) -> Quadratic:
        """Enclose n_1 - N as the middle ray sees it, in the frame of the first mirror at the middle: y, x, z."""
        c, x, r = self.chain, folded.vectors, folded.radii
        half = len(self.rays) // 2
        back, on = self.rays[:half][::-1], self.rays[half:]
        known = CREASE * (2 * c.steps + 1)
        first = c.turned(x[:, c.first], x[:, back], back, -r[back], 0.0)
        last = c.turned(x[:, c.last], x[:, on], on, r[on], known)
        return (first + last.times(-1.0))[[1, 0, 2]]

    def minors(self, folded: Folded, torques: Quadratic) -> Quadratic:
        """Enclose G_i (n_1, c_j, c_k) + cyclic, or G_a t_b - G_b t_a."""
        t = self.triples.at(folded)
        if self.order > 1:
            return expansion(torques, t, self.subsets, self.subsets[:, ::-1])
        place = {pair: i for i, pair in enumerate(self.pairs)}
        of = [[place[j, k], place[i, k], place[i, j]] for i, j, k in self.subsets.tolist()]
        return expansion(torques, t, self.subsets, np.array(of, dtype=int).reshape(-1, 3))


def apart(rows: Quadratic) -> Quadratic:
    """Turn the last two rows so that their slopes are at right angles: the weak one does not drown in the other."""
    a, b = rows.slopes[-2:]
    angle = 0.5 * np.arctan2(2 * (a * b).sum(axis=0), (a * a - b * b).sum(axis=0))
    c, s = np.cos(angle), np.sin(angle)
    out = [v.copy() for v in rows.parts]
    for v in out[:3]:
        v[-2], v[-1] = c * v[-2] + s * v[-1], c * v[-1] - s * v[-2]
    size = 4 * UNIT * rows.magnitude()[-2:].sum(axis=0)
    first, second = rows.rest[-2:]
    out[3][-2] = np.abs(c) * first + np.abs(s) * second + size
    out[3][-1] = np.abs(s) * first + np.abs(c) * second + size
    return Quadratic(*out)


def about_normal(angle: float) -> tuple[float, float, float, float]:
    """Return the turn about e3 by an angle [rad] as a quaternion."""
    return math.cos(0.5 * angle), 0.0, 0.0, math.sin(0.5 * angle)


def expansion(column: Quadratic, rows: Quadratic, which: np.ndarray, of: np.ndarray) -> Quadratic:
    """Return the sums over a of (-1)^a column[which_a] rows[of_a], which and of [M, A]: M determinants.

    Row i of the column is linear in variable i alone.
    """
    at, pair = np.arange(len(which)), pairs(column.slopes.shape[1])[2]
    size, every = column.magnitude(), rows.magnitude()
    out = number(np.zeros((len(which), column.value.shape[1])), 0.0, len(pair))
    for a, (i, t) in enumerate(zip(which.T, of.T, strict=True)):
        g, r = ((-1.0) ** a * v for v in (column.value[i], column.slopes[i, i]))
        out.value[:] += g * rows.value[t]
        out.slopes[:] += g[:, None] * rows.slopes[t]
        out.slopes[at, i] += r * rows.value[t]
        out.bends[:] += g[:, None] * rows.bends[t]
        # xi_i times the slopes of the row: each pair (i, j) once
        out.bends[at[:, None], pair[i]] += r[:, None] * rows.slopes[t]
        out.rest[:] += size[i] * rows.rest[t] + np.abs(r) * np.abs(rows.bends[t]).sum(axis=1)
        out.rest[:] += (column.rest[i] + 32 * UNIT * size[i]) * every[t]
    return out


@lru_cache(maxsize=8)
def piece_of(vertex: ReducedVertex) -> Piece:
    """Return the piece of a vertex whose rows are searched.

    Parameters
    ----------
    vertex
        Of a flat sheet.
    """
    group = vertex.scene.group
    if group.kind == "D":
        return Wedge(vertex)
    return VertexPiece(vertex) if vertex.turn == 1 else Period(vertex)
