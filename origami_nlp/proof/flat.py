"""The flat state: within a radius of it there is no other critical point, and it is no minimum itself.

Here phi = r u, |u|_inf = 1, 0 < r <= r0, one u for creases that are images.  Derivatives in r of order p of q =
prod exp(r u_i b_i / 2) are at most (sum |u_i| / 2)^p, those of the axes c_i = R_{i-1} b_i at most s_i^p, s_i =
sum_{j<i} |u_j|.  Reflection in the sheet sends phi to -phi: q_x, q_y and the z of axes are odd in r, q_z and the x, y
of axes even.  With sum |u_i| <= N
and (b_j x b_i) = (b_j x b_i)_z e_z:

    closure, x and y:  sum_i u_i b_i = 0  +- r^2 N^3 / 24    (q_x / (r / 2); the next order is (r N / 2)^3 / 6)
    closure, z:        Q(u) = sum_{j<i} u_j u_i (b_j x b_i)_z = 0  +- r^2 N^4 / 96    (q_z / (r^2 / 4))
    minors over r:     det [G, c_x, c_y, c_z / r]_S = 0,  G_i = k_i (r u_i - rest_i),
                       (c_x, c_y) = b_i +- r^2 s_i^2 / 2,
                       c_z / r = h_i(u) +- r^2 s_i^3 / 6,  h_i(u) = sum_{j<i} u_j (b_j x b_i)_z.

The variables are u on a face u_i = 1 and r in [-r0, r0], which stands for the faces u_i = -1 too.  If no (u, r)
satisfies all, there is no other critical point within r0.  A determinant with errors E of its entries A is off by at
most per(|A| + E) - per(|A|).

With a symmetry minors are those of the whole vertex all the same.  Where axes span space, multipliers of symmetric
states are those m that the group leaves alone, G_i = m . c_i for all images at once; where not, all minors are 0.

So it is at a state folded flat, of the creases that are free there: b are then their directions in the plane.

The flat state is no minimum if u, v with sum u_i b_i = 0 have Q(u) > 0 > Q(v) and both lower the energy to first order,
sum_i G_i u_i < 0 at r = 0: so does a w between them with Q(w) = 0 and a simple sign change, along which closed states
leave.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.proof.boxes import Boxes, prune
from origami_nlp.proof.pieces import ReducedVertex, piece_of
from origami_nlp.proof.rows import (
    SECTORS,
    TRIGONOMETRIC,
    UNIT,
    Affine,
    joined,
    number,
    variables,
)

RADII = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6)
"""Radii [rad] tried, the largest first; smaller ones cost more boxes outside."""
MOST = 3_000
"""Boxes for a radius; generic scenes take some ten."""
NARROW = 1e-3
"""Boxes of directions narrower than this are left: the radius is too large, or the flat state critical."""
CLEAR = 1e-9
"""Slopes and curvatures of the first order, of unit springs, that are signs for certain: rounding is below 1e-13."""


@dataclass(frozen=True)
class Flat:
    """What the lemma says.

    Attributes
    ----------
    radius
        No critical point but the flat state within it [rad]; 0.0 where that was not shown.
    boxes
        How many it took.
    minimum
        False where the flat state is shown to be no minimum, else None.
    """

    radius: float
    boxes: int
    minimum: bool | None

    @property
    def text(self) -> str:
        """The lemma in words."""
        if not self.radius:
            return "near the flat state: not decided"
        itself = "which is no minimum" if self.minimum is False else "judged by its cone"
        return f"no critical point within {self.radius:g} rad of the flat state, {itself}"


class FlatVertex:
    """A whole vertex at a flat state: the creases that are free, single springs, and which are one variable.

    Parameters
    ----------
    vertex
        Of a flat sheet.
    base, pins
        Variables of a state folded flat, multiples of pi, and which of them are held, [n]; None: the flat state.

    Attributes
    ----------
    b
        Directions of the creases, [N, 2].
    stiffness, rest
        Of creases, from where they are at the state, [N].
    tied
        1 where a crease is of a variable, [N, n].
    closes
        Whether that state closes.
    """

    def __init__(
        self,
        vertex: ReducedVertex,
        base: np.ndarray | None = None,
        pins: np.ndarray | None = None,
    ) -> None:
        piece, of = piece_of(vertex), vertex.variable_of_crease
        base = np.zeros(vertex.size) if base is None else base
        free = np.ones(vertex.size, bool) if pins is None else pins == 0
        sectors = vertex.scene.vertex.sector_angles
        # beyond a crease that is closed the sheet goes back
        way = np.cumprod(np.where(np.abs(base[of]) > 1, -1, 1)) * sectors
        azimuth = np.array([math.fsum(way[:i]) for i in range(len(way))])
        # relations of sectors that hold to what these may be off are taken as exact
        open_ = math.remainder(math.fsum(way), 2 * math.pi)
        self.closes = abs(open_) <= (len(way) + 1) * SECTORS * 4 * UNIT
        self.b = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)[free[of]]
        self.stiffness = piece.stiffness[of][free[of]]
        self.rest = (piece.rest - base)[of][free[of]]
        self.tied = np.eye(vertex.size)[of][free[of]][:, free]
        # of creases on one line: k_a x_a - s k_b x_b, and what that is at the state, None where exactly 0
        self.twins: list[tuple[np.ndarray, float | None]] = []
        springs = np.stack([piece.stiffness, piece.rest, base])
        for t, row in piece.twins_on(np.zeros(vertex.size) if pins is None else pins):
            apart = np.ptp(springs[:, list(t.creases)], axis=1).max()
            same = len(t.creases) == 2 and t.sign > 0 and apart == 0
            self.twins.append((row[free][None], None if same else row @ (base - piece.rest)))


class ClosedDirections:
    """The equations of closed directions u on the faces |u|_inf = 1, at a distance r up to `radius` on either side.

    Variables are u [n] and r / radius in [-1, 1].

    Parameters
    ----------
    vertex
        In its flat state.
    radius
        The largest r [rad].
    """

    def __init__(self, vertex: FlatVertex, radius: float) -> None:
        self.vertex, self.radius, b = vertex, radius, vertex.b
        n, self.size = len(b), vertex.tied.shape[1] + 1
        # azimuths are off by what the sectors before them are; a cosine and a sine
        doubt = (n * SECTORS * 4 + 8) * UNIT + 2 * TRIGONOMETRIC
        cross = b[:, None, 0] * b[None, :, 1] - b[:, None, 1] * b[None, :, 0]
        self.before = np.triu(cross, 1)  # [j, i]: (b_j x b_i)_z, j before i
        fours = np.array(list(itertools.combinations(range(n), 4)), dtype=int).reshape(-1, 4)
        # levers[S, i, j]: of G_i h_j in det [G, c_x, c_y, h]_S
        self.levers = np.zeros((len(fours), n, n))
        for i, j in itertools.permutations(range(4), 2):
            columns = np.zeros((len(fours), 4, 4))
            columns[:, i, 0] = columns[:, j, 3] = 1.0
            columns[:, :, 1:3] = b[fours]
            self.levers[np.arange(len(fours)), fours[:, i], fours[:, j]] = np.linalg.det(columns)
        many = np.arange(n)
        size = np.stack(
            [
                vertex.stiffness * (np.abs(vertex.rest) + radius),
                *np.abs(b.T),
                np.abs(self.before).sum(axis=0),
            ]
        )
        planar = radius**2 * many**2 / 2 + doubt
        error = [0 * planar, planar, planar, radius**2 * many**3 / 6 + 3 * n * doubt]
        with_error = _permanents(size + np.stack(error), fours)
        # |det(A + E) - det A| <= per(|A| + E) - per(|A|): every product of the expansion taken with its absolute value
        off = with_error - _permanents(size, fours) + 16 * (n * n + 64) * UNIT * with_error
        planes, height = (
            radius**2 * n**3 / 24 + n * doubt,
            radius**2 * n**4 / 96 + 3 * n * n * doubt,
        )
        exact = [0.0] * len(vertex.twins)
        self.off = np.array([*exact, planes, planes, height, *off])[:, None]

    def faces(self) -> Boxes:
        """Return the boxes to start from: u_i = 1, the others and r / radius in [-1, 1]."""
        n = self.size - 1
        pins = np.concatenate([np.eye(n, dtype=np.int8), np.zeros((1, n), np.int8)])
        return Boxes(-1.0 + 2.0 * pins, np.ones((n + 1, n)), pins)

    def rows(
        self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray
    ) -> tuple[Affine, np.ndarray]:
        """Enclose all rows over boxes: x, y, z, the minors; all hold everywhere."""
        middle, half = variables(lower, upper)
        every, i = number(middle, 0.0, self.size), np.arange(self.size)
        every.slopes[i, i] = half
        u, r = every[:-1].mapped(self.vertex.tied), every[-1:]
        heights = u.mapped(self.before.T)
        k, rest = self.vertex.stiffness, self.vertex.rest
        torques = (r * u).mapped(np.diag(k * self.radius))
        torques += number(np.repeat((-k * rest)[:, None], middle.shape[1], 1), 0.0, self.size)
        n = len(k)
        a, b = np.repeat(np.arange(n), n), np.tile(np.arange(n), n)
        twins = [every[:-1].mapped(row) for row, _ in self.vertex.twins]
        for k_th, (_, at) in enumerate(self.vertex.twins):
            if at is not None:  # else it is divided by r
                here = number(np.full((1, middle.shape[1]), at), 64 * UNIT, self.size)
                twins[k_th] = (r * twins[k_th]).mapped(np.array([[self.radius]])) + here
        rows = joined(
            [
                *(row.affine() for row in twins),
                u.mapped(self.vertex.b.T).affine(),
                (u * heights).mapped(np.ones((1, n))).affine(),
                (torques[a] * heights[b]).mapped(self.levers.reshape(-1, n * n)).affine(),
            ]
        )
        rows = Affine(rows.centre, rows.slopes, rows.error + self.off)
        return rows, np.ones(rows.centre.shape, dtype=bool)


def _permanents(entries: np.ndarray, fours: np.ndarray) -> np.ndarray:
    """Permanents of the 4 x 4 matrices of columns `fours` [M, 4] of entries [4, n] >= 0."""
    total = np.zeros(len(fours))
    for order in itertools.permutations(range(4)):
        total += np.prod([entries[row, fours[:, order[row]]] for row in range(4)], axis=0)
    return total


def flat_lemma(vertex: FlatVertex, radii: Sequence[float] = RADII, most: int = MOST) -> Flat:
    """Look for the first radius within which the flat state is the only critical point, in so many boxes each."""
    boxes = 0
    for radius in radii if vertex.closes else ():
        cone = ClosedDirections(vertex, radius)
        left = prune(cone, cone.faces(), small=NARROW, most=most)
        boxes += left.boxes
        if not len(left.candidates) and not len(left.open):
            return Flat(radius, boxes, no_minimum(vertex))
    return Flat(0.0, boxes, no_minimum(vertex))


def no_minimum(vertex: FlatVertex) -> bool | None:
    """Return False where closed states leave the flat one downhill, None where that is not shown."""
    b = vertex.b
    slope = -vertex.tied.T @ (vertex.stiffness * vertex.rest)
    cross = np.triu(b[:, None, 0] * b[None, :, 1] - b[:, None, 1] * b[None, :, 0], 1)
    form = vertex.tied.T @ (cross + cross.T) @ vertex.tied
    _, values, turned = np.linalg.svd(b.T @ vertex.tied)
    kernel = turned[int((values > CLEAR).sum()) :]  # [n - 2, n] without symmetry
    _, vectors = np.linalg.eigh(0.5 * kernel @ form @ kernel.T)
    for share in (0.0, 0.1, -0.1, 0.3, -0.3):  # a direction may happen to be level
        # directions with Q > 0 and Q < 0: largest and smallest eigenvalue on the kernel of the planar rows
        up, down = vectors[:, -1] + share * vectors[:, 0], vectors[:, 0] + share * vectors[:, -1]
        steps = [(u @ kernel) * -math.copysign(1.0, u @ kernel @ slope) for u in (up, down)]
        curved = [float(u @ form @ u) / 2 for u in steps]
        if all(float(u @ slope) < -CLEAR for u in steps) and curved[0] > CLEAR > -CLEAR > curved[1]:
            return False
    return None
