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

Creases that lie on one line all along a stratum, and what a minimum then needs.

Where all creases between two free ones, a and b, are closed (+-pi), their facets lie in one plane, and crease b is at
the angle of the alternating sum of the sectors between from crease a.  If that is a multiple of pi, c_a = s c_b
throughout, s = +-1: closure loses rank there, and all minors may vanish on a whole curve.  But d phi_a = -s d phi_b
keeps closure, so a minimum needs G_a = s G_b.

With a symmetry the images of that motion are motions too: arcs without another crease of a or b inside are disjoint,
or lie on one line, so that all of them go on at once, and the symmetric sum says G_a = s G_b of the variables.  Where a
and b are one variable it is no motion for s = 1, and says G_a = 0 for s = -1 (a crease across a mirror).

Relations of sectors that hold to within what sectors may be off (`rows.SECTORS`) are taken as exact.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from origami_nlp.numerics import quaternion
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.proof.rows import (
    CREASE,
    SECTORS,
    UNIT,
    Affine,
    Chain,
    Folded,
    Quadratic,
    Triples,
    cross,
    joined,
    number,
    pairs,
    variables,
)


class ReducedVertex:
    """A vertex in the variables that its symmetry leaves, as boxes see it.

    The piece of C_n is a period, that of D_n a wedge between two mirrors, both on it.

    Parameters
    ----------
    scene
        Of one winding; 1 where it says none.
    problem
        The same, posed; None: as stated.

    Attributes
    ----------
    kind, order
        Of the group, C or D and n.
    has_crease
        Of each ray of the piece.
    sectors
        After each ray of a period, between the rays of a wedge [rad].
    variable_of_crease
        Of the whole vertex, [N].
    turn
        How many pieces make one turn round the axis: closed states of a piece depend on no more of the group.
    """

    def __init__(self, scene: Scene, problem: PatternProblem | None = None) -> None:
        group, self.scene = scene.group, scene
        self.problem = pose(scene) if problem is None else problem
        self.winding, self.kind, self.order = scene.winding or 1, group.kind, group.order
        self.turn = Fraction(self.order, self.winding)
        self.has_crease = tuple(ray.crease is not None for ray in group.rays)
        sectors = [ray.sector for ray in group.rays]
        self.sectors = np.array(sectors[:-1] if group.kind == "D" else sectors)
        places = [r for r, has in enumerate(self.has_crease) if has]
        self.variable_of_crease = np.array([places.index(r) for r in group.orbit])

    @property
    def size(self) -> int:
        """Number of variables."""
        return self.problem.size

    @property
    def dof(self) -> int:
        """Degrees of freedom at a regular state."""
        once = 3 if self.kind == "C" else 2
        return self.size - (once if self.turn == 1 else 1)


@dataclass(frozen=True)
class CollinearPair:
    """Creases on one line while others are closed.

    Attributes
    ----------
    creases
        Variables: two, or one that lies across a mirror.
    sign
        s with G_a = s G_b.
    closed
        Variables between, which are to be closed.
    """

    creases: tuple[int, ...]
    sign: int
    closed: tuple[int, ...]


def collinear_creases(vertex: ReducedVertex) -> Iterator[CollinearPair]:
    """Go through the pairs of a vertex for each set of closed creases between that fits."""
    sectors, variable = vertex.scene.vertex.sector_angles, vertex.variable_of_crease.tolist()
    n = len(sectors)
    for a, count in itertools.product(range(n), range(1, n)):
        # each closed crease folds the walk back: sectors count forth and back in turn
        total = math.fsum((-1.0) ** i * sectors[(a + i) % n] for i in range(count))
        multiple = round(total / math.pi)
        sign = 1 - 2 * (multiple % 2)
        ends = {variable[a], variable[(a + count) % n]}
        closed = {variable[(a + i) % n] for i in range(1, count)}
        fits = abs(total - multiple * math.pi) <= (count + 1) * SECTORS * 4 * UNIT
        if fits and not ends & closed and (len(ends) == 2 or sign < 0):
            yield CollinearPair(tuple(sorted(ends)), sign, tuple(sorted(closed)))


class Piece:
    """The piece of a vertex whose fold angles are the variables.

    Parameters
    ----------
    vertex
        Of a flat sheet.
    rank
        How many columns of slopes of closure are independent where it is regular.

    Attributes
    ----------
    chain
        Its rays in the order in which folds carry them.
    rank
        Of closure, and how many of its rows are equations.
    by_vectors
        Whether closure is of vectors that rotate, not of quaternions.
    near_flat
        Whether closure is known the better the nearer the flat state.
    sets, subsets
        Variables of each determinant of slopes [T, rank], and of each minor, [M, rank + 1].
    """

    chain: Chain
    by_vectors = False
    near_flat = False

    def __init__(self, vertex: ReducedVertex, rank: int) -> None:
        p = vertex.problem.parameters
        self.size, self.limits, self.rank = vertex.size, vertex.problem.fold_limits, rank
        stiffness = p.stiffness / vertex.problem.multiplicity
        self.sectors = np.asarray(vertex.sectors, float)
        # a load on a crease is a spring that rests elsewhere
        self.rest = np.asarray(p.rest + p.load / p.stiffness, float)
        self.stiffness = stiffness / stiffness.max()
        self.twins = tuple(dict.fromkeys(collinear_creases(vertex)))
        self.sets, subsets = (
            list(itertools.combinations(range(self.size), rank + more)) for more in (0, 1)
        )
        place = {s: i for i, s in enumerate(self.sets)}
        without = [[place[s[:a] + s[a + 1 :]] for a in range(rank + 1)] for s in subsets]
        self.subsets, self.without = (
            np.array(s, dtype=int).reshape(-1, rank + 1) for s in (subsets, without)
        )

    def twins_asked(self, pins: np.ndarray) -> np.ndarray:
        """Return on which strata [n, K] creases lie on one line, [T, K]."""
        flat = self.limits.folded_flat(pins.T).T != 0
        asked = [
            (pins[[*t.creases]] == 0).all(axis=0) & flat[[*t.closed]].all(axis=0)
            for t in self.twins
        ]
        return np.array(asked, dtype=bool).reshape(len(self.twins), pins.shape[1])

    def twins_on(self, pins: np.ndarray) -> Iterator[tuple[CollinearPair, np.ndarray]]:
        """Go through the creases on one line on a stratum [n], with slopes of what must vanish, [n]."""
        for t in itertools.compress(self.twins, self.twins_asked(pins[:, None])):
            row, one = np.zeros(self.size), [*t.creases]
            row[one] = (1.0, -t.sign)[: len(one)] * self.stiffness[one]
            yield t, row

    def closure(self, folded: Folded) -> Quadratic:
        """Enclose closure."""
        raise NotImplementedError

    def slopes(self, folded: Folded) -> Quadratic:
        """Enclose determinants of slopes of closure, of `sets`, but for a common factor."""
        raise NotImplementedError

    def equations(self, folded: Folded) -> Quadratic:
        """Enclose as many rows of closure as are independent (`roots` says why a zero of them closes)."""
        return self.closure(folded)

    def closes(self, folded: Folded) -> np.ndarray:
        """Return whether a zero of the equations at the middle of boxes closes, [K]."""
        return np.ones(folded.near.shape, dtype=bool)

    def minors(self, folded: Folded, torques: Quadratic) -> Quadratic:
        """Enclose the minors [G | slopes of closure] of `subsets`, expanded along G.

        Row i of the torques is linear in variable i alone.
        """
        rows, which = self.slopes(folded), self.subsets
        at, pair = np.arange(len(which)), pairs(self.size)[2]
        size, every = torques.magnitude(), rows.magnitude()
        out = number(np.zeros((len(which), torques.value.shape[1])), 0.0, self.size)
        for a, (i, t) in enumerate(zip(which.T, self.without.T, strict=True)):
            g, r = ((-1.0) ** a * v for v in (torques.value[i], torques.slopes[i, i]))
            out.value[:] += g * rows.value[t]
            out.slopes[:] += g[:, None] * rows.slopes[t]
            out.slopes[at, i] += r * rows.value[t]
            out.bends[:] += g[:, None] * rows.bends[t]
            # xi_i times the slopes of the row: each pair (i, j) once
            out.bends[at[:, None], pair[i]] += r[:, None] * rows.slopes[t]
            out.rest[:] += size[i] * rows.rest[t] + np.abs(r) * np.abs(rows.bends[t]).sum(axis=1)
            out.rest[:] += (torques.rest[i] + 32 * UNIT * size[i]) * every[t]
        return out

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
            self.twins_asked(pins),
        ]
        return joined([r.affine() for r in rows]), np.concatenate(asked)


class VertexPiece(Piece):
    """A vertex without symmetry, or a period of C_n that closes by itself."""

    def __init__(self, vertex: ReducedVertex) -> None:
        super().__init__(vertex, 3)
        n = self.size
        steps = [p % n for p in range(2 * n - 1)]
        self.chain = Chain(steps, [1.0] * len(steps), self.sectors[steps].tolist(), n, n)
        self.half = (n + 1) // 2
        self.whole = 2 * math.pi / vertex.scene.group.order
        self.near_flat = self.whole == 2 * math.pi
        # three creases on the arc round the longest of the three gaps, by number of creases
        ways = ([(i, j, k), (j, k, i + n), (k, i + n, j + n)] for i, j, k in self.sets)
        self.triples = Triples(self.chain, [min(w, key=lambda t: t[2] - t[0]) for w in ways])

    def slopes(self, folded: Folded) -> Quadratic:
        """Enclose triple products of axes."""
        return self.triples.at(folded)

    def equations(self, folded: Folded) -> Quadratic:
        """Enclose the vector part of closure."""
        return self.closure(folded)[1:]

    def closes(self, folded: Folded) -> np.ndarray:
        """Return whether the product of folds and sectors is -1 where its vector part vanishes, [K]."""
        return self.loop(folded)[0] > 0

    def loop(self, folded: Folded) -> np.ndarray:
        """Return -A B at the middle of boxes, [4, K]."""
        return folded.loop if self.near_flat else turned_by(folded, self.whole + 2 * math.pi)

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


class Period(Piece):
    """A period of C_n that does not close by itself."""

    def __init__(self, vertex: ReducedVertex) -> None:
        super().__init__(vertex, 1)
        n, order = self.size, vertex.scene.group.order
        self.chain = Chain(range(n), [1.0] * n, self.sectors.tolist(), n, n)
        self.level, self.whole = math.cos(vertex.winding * math.pi / order), 2 * math.pi / order

    def loop(self, folded: Folded) -> Quadratic:
        """Enclose the product of folds and sectors."""
        n, q = self.size, turned_by(folded, self.whole)
        near = np.full((4, 1), self.chain.loop_rounding)
        return self.chain.turned(q, folded.vectors[:, :n], range(n), folded.radii, near)

    def closure(self, folded: Folded) -> Quadratic:
        """Enclose the scalar less what it is."""
        row = self.loop(folded)[:1]
        return row + number(0 * row.value - self.level, 4 * UNIT, self.size)

    def slopes(self, folded: Folded) -> Quadratic:
        """Enclose c . vec T of each fold, minus twice the derivatives of the scalar."""
        n, x, r = self.size, folded.vectors, folded.radii
        known = CREASE * (2 * n + 1)
        q = self.loop(folded)[1:]
        axes = (self.chain.turned(x[:, k], x[:, :k], range(k), r[:k], known) for k in range(n))
        return joined([(q * axis).mapped(np.ones((1, 3))) for axis in axes])


class Wedge(Piece):
    """The wedge of D_n between two mirrors.

    Attributes
    ----------
    rays
        Ray of each variable.
    """

    by_vectors = True

    def __init__(self, vertex: ReducedVertex, rank: int = 1) -> None:
        super().__init__(vertex, rank)
        has = vertex.has_crease
        self.rays = [r for r, crease in enumerate(has) if crease]
        e = len(has)
        variable = [self.rays.index(r) if crease else -1 for r, crease in enumerate(has)]
        weight = [0.5 if r in (0, e - 1) else 1.0 for r in range(e)]
        self.chain = c = Chain(variable, weight, [*self.sectors, 0.0], e, self.size)
        self.level = math.cos(math.pi / vertex.turn)
        self.product = Triples(c, [(c.up, 0, c.last)])
        self.triples = Triples(c, self.wanted())

    def wanted(self) -> list[tuple[int, int, int]]:
        """Return the vectors of the triple products of `slopes`."""
        return [(self.chain.first, r, self.chain.last) for r in self.rays]

    def slopes(self, folded: Folded) -> Quadratic:
        """Enclose triple products of mirrors and axes."""
        return self.triples.at(folded)

    def closure(self, folded: Folded) -> Quadratic:
        """Enclose n_1 . N + cos(w pi / n)."""
        row = self.product.at(folded)
        return row + number(0 * row.value + self.level, 4 * UNIT, self.size)


class OneMirror(Wedge):
    """The wedge of D_1, or of D_n where states wind n times: both mirrors are one plane."""

    def __init__(self, vertex: ReducedVertex) -> None:
        super().__init__(vertex, 2)

    def wanted(self) -> list[tuple[int, int, int]]:
        """Return n_1 with two axes, or these with N, whichever has fewer creases between."""
        c, rays, n = self.chain, self.rays, self.size
        return [
            (c.first, rays[i], rays[j]) if j <= n - 1 - i else (rays[i], rays[j], c.last)
            for i, j in self.sets
        ]

    def closure(self, folded: Folded) -> Quadratic:
        """Enclose n_1 - N as the middle ray sees it."""
        return apart(self.normals_apart(folded))

    def equations(self, folded: Folded) -> Quadratic:
        """Enclose the two rows of first order."""
        return self.normals_apart(folded)[1:]

    def closes(self, folded: Folded) -> np.ndarray:
        """Return whether N is n_1, and not -n_1, [K]."""
        x, c = folded.vectors, self.chain
        return np.asarray((x[:, c.first] * x[:, c.last]).sum(axis=0) >= 0)

    def normals_apart(self, folded: Folded) -> Quadratic:
        """Enclose n_1 - N as the middle ray sees it, in the frame of the first mirror at the middle: y, x, z."""
        c, x, r = self.chain, folded.vectors, folded.radii
        half = len(self.rays) // 2
        back, on = self.rays[:half][::-1], self.rays[half:]
        known = CREASE * (2 * c.steps + 1)
        first = c.turned(x[:, c.first], x[:, back], back, -r[back], 0.0)
        last = c.turned(x[:, c.last], x[:, on], on, r[on], known)
        return (first + last.times(-1.0))[[1, 0, 2]]


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


def turned_by(folded: Folded, angle: float) -> np.ndarray:
    """Return the product of folds, and the turn about e3 by an angle [rad], as quaternions [4, K]."""
    turn = math.cos(0.5 * angle), 0.0, 0.0, math.sin(0.5 * angle)
    return np.stack(quaternion.multiply(tuple(folded.loop), turn))


@lru_cache(maxsize=8)
def piece_of(vertex: ReducedVertex) -> Piece:
    """Return the piece of a vertex whose rows are searched.

    Parameters
    ----------
    vertex
        Of a flat sheet.
    """
    once = vertex.turn == 1
    if vertex.kind == "D":
        return OneMirror(vertex) if once else Wedge(vertex)
    return VertexPiece(vertex) if once else Period(vertex)
