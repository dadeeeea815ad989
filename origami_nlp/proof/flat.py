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

The flat state is no minimum if u, v with sum u_i b_i = 0 have Q(u) > 0 > Q(v) and both lower the energy to first order,
sum_i G_i u_i < 0 at r = 0: so does a w between them with Q(w) = 0 and a simple sign change, along which closed states
leave.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.proof.boxes import Boxes, prune
from origami_nlp.proof.pieces import piece_of
from origami_nlp.proof.reduced import ReducedVertex
from origami_nlp.proof.rows import SECTORS, TRIGONOMETRIC, UNIT, Affine, padded, variables

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
    """A whole vertex in its flat state: creases, single springs, and which are one variable.

    Attributes
    ----------
    b
        Directions of the creases on the sheet, [N, 2].
    stiffness, rest
        Of creases, [N].
    tied
        1 where a crease is of a variable, [N, n].
    """

    def __init__(self, vertex: ReducedVertex) -> None:
        piece, of = piece_of(vertex), vertex.variable_of_crease
        self.stiffness, self.rest = piece.stiffness[of], piece.rest[of]
        self.tied = np.eye(vertex.size)[of]
        sectors = vertex.scene.vertex.sector_angles
        azimuth = np.array([math.fsum(sectors[:i]) for i in range(len(sectors))])
        self.b = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)


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
        self.radius, self.tied, b = radius, vertex.tied, vertex.b
        self.b, n, self.size = b, len(b), vertex.tied.shape[1] + 1
        # azimuths are off by what the sectors before them are; a cosine and a sine
        doubt = self.doubt = (n * SECTORS * 4 + 8) * UNIT + 2 * TRIGONOMETRIC
        cross = b[:, None, 0] * b[None, :, 1] - b[:, None, 1] * b[None, :, 0]
        self.before = np.triu(cross, 1)  # [j, i]: (b_j x b_i)_z, j before i
        self.square = self.tied.T @ (self.before + self.before.T) @ self.tied
        self.misses = np.array([radius**2 * n**3 / 24] * 2) + n * doubt
        self.miss = radius**2 * n**4 / 96 + n * n * 3 * doubt
        self._pose_minors(vertex)

    def _pose_minors(self, vertex: FlatVertex) -> None:
        """Minors as coefficients of u [M, n] and of r u_i u_j [M, n, n], and how far they are off [M]."""
        n, radius = len(self.b), self.radius
        k = vertex.stiffness
        fours = np.array(list(itertools.combinations(range(n), 4)))
        # levers[S, i, j]: of G_i h_j in the determinant, the minor of x and y of the other two rows
        levers = np.zeros((len(fours), n, n))
        rows = np.arange(len(fours))
        for i, j in itertools.permutations(range(4), 2):
            p, q = (v for v in range(4) if v not in (i, j))
            # rows i, p, q, j in the columns G, x, y, z: Laplace expansion along G and z
            sign = _sign((i, p, q, j))
            lever = self.before[fours[:, p], fours[:, q]]
            levers[rows, fours[:, i], fours[:, j]] = sign * lever
        g = k * (np.abs(vertex.rest) + radius)
        first = np.einsum("sij,i,aj->sa", levers, -k * vertex.rest, self.before)
        self.matrix = np.concatenate([self.b.T, first]) @ self.tied
        second = np.einsum("sij,i,aj->sia", levers, k, self.before) * radius
        self.second = self.tied.T @ (0.5 * (second + second.transpose(0, 2, 1))) @ self.tied
        many = np.arange(n)
        size = np.stack([g, *np.abs(self.b.T), np.abs(self.before).sum(axis=0)])  # [4, n]
        planar = radius**2 * many**2 / 2 + self.doubt
        error = np.stack([0 * k, planar, planar, radius**2 * many**3 / 6 + 3 * n * self.doubt])
        with_error = _permanents(size + error, fours)
        # a coefficient is a sum of at most n^2 products of these entries
        # |det(A + E) - det A| <= per(|A| + E) - per(|A|): every product of the expansion taken with its absolute value
        self.off = with_error - _permanents(size, fours) + 16 * (n * n + 64) * UNIT * with_error

    def faces(self) -> Boxes:
        """Return the boxes to start from: u_i = 1, the others and r / radius in [-1, 1]."""
        n = self.size - 1
        pins = np.concatenate([np.eye(n, dtype=np.int8), np.zeros((1, n), np.int8)])
        return Boxes(-1.0 + 2.0 * pins, np.ones((n + 1, n)), pins)

    def rows(
        self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray
    ) -> tuple[Affine, np.ndarray]:
        """Enclose all rows over boxes: x, y, the minors, z; all hold everywhere."""
        middle, half = variables(lower, upper)
        u, r, du, dr = middle[:-1], middle[-1], half[:-1], half[-1]
        centre, slopes = self.matrix @ u, self.matrix[:, :, None] * du
        size = np.abs(self.matrix).sum(axis=1)[:, None]
        # r u' W u, to first order in u and r
        value, lever, curved = _form(self.second, u, du)
        bound = np.abs(self.second).sum(axis=(1, 2))[:, None]
        # r u' W u about the middle: r value + dr value xi_r + 2 r (W u) . du xi_u, the rest goes to the error
        centre[2:] += r * value
        slopes[2:] += 2.0 * r * lever * du
        spread = 2.0 * np.abs(lever * du).sum(axis=1) + curved
        error = np.concatenate([0 * centre[:2], np.abs(r) * curved + dr * spread])
        error += np.concatenate([self.misses, self.off])[:, None]
        along = np.concatenate([0 * centre[:2], dr * value])
        size = np.concatenate([size[:2], size[2:] + 4 * bound]) + 0 * centre
        height, tilt, bent = _form(0.5 * self.square[None], u, du)
        rows = padded(
            np.concatenate([centre, height]),
            np.concatenate(
                [
                    np.concatenate([slopes, along[:, None]], axis=1),
                    np.concatenate([2.0 * tilt * du, 0 * height[:, None]], axis=1),
                ]
            ),
            np.concatenate([error, self.miss + bent]),
            np.concatenate([size, 4 * np.abs(self.square).sum() + 0 * height]),
            4 * (len(self.b) + 1) ** 2 + 8,
        )
        return rows, np.ones(rows.centre.shape, dtype=bool)


def _form(
    w: np.ndarray, u: np.ndarray, du: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """u' W u of symmetric matrices W [M, n, n]: its value [M, K], W u [M, n, K], and du' |W| du [M, K]."""
    lever = w @ u
    return (lever * u).sum(axis=1), lever, ((np.abs(w) @ du) * du).sum(axis=1)


def _sign(order: tuple[int, ...]) -> float:
    """Sign of a permutation."""
    swaps = sum(a > b for a, b in itertools.combinations(order, 2))
    return -1.0 if swaps % 2 else 1.0


def _permanents(entries: np.ndarray, fours: np.ndarray) -> np.ndarray:
    """Permanents of the 4 x 4 matrices of columns `fours` [M, 4] of entries [4, n] >= 0."""
    total = np.zeros(len(fours))
    for order in itertools.permutations(range(4)):
        total += np.prod([entries[row, fours[:, order[row]]] for row in range(4)], axis=0)
    return total


def flat_lemma(vertex: FlatVertex) -> Flat:
    """Look for the largest radius within which the flat state is the only critical point."""
    boxes = 0
    for radius in RADII:
        cone = ClosedDirections(vertex, radius)
        left = prune(cone, cone.faces(), small=NARROW, most=MOST)
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
