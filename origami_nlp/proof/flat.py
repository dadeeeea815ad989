"""The flat state: within a radius of it there is no other critical point, and it is no minimum itself.

Without symmetry, phi = r u, |u|_inf = 1, 0 < r <= r0.  A fold about b_i by r u_i is exp(r u_i b_i / 2), so derivatives of
q = prod exp(r u_i b_i / 2) in r of order p are at most (sum |u_i| / 2)^p, those of the axes c_i = R_{i-1} b_i at most
s_i^p, s_i = sum_{j<i} |u_j|.  Reflected in the sheet, phi becomes -phi: q_x, q_y and the z of axes are odd in r, q_z and the
x, y of axes are even.  Hence, with n = sum |u_i| at most N, b x b = (b x b)_z e_z:

    closure, x and y:  sum_i u_i b_i          = 0  +- r^2 n^3 / 24     (q_x / (r / 2); next order r^3 (n/2)^3 / 6)
    closure, z:        Q(u) = sum_{j<i} u_j u_i (b_j x b_i)_z = 0  +- r^2 n^4 / 96   (q_z / (r^2 / 4); r^4 (n/2)^4 / 24)
    minors over r:     det [G, c_x, c_y, c_z / r]_S = 0,  G_i = -k_i rest_i +- k_i r,  (c_x, c_y) = b_i +- r^2 s_i^2 / 2,
                       c_z / r = h_i(u) +- r^2 s_i^3 / 6,  h_i(u) = sum_{j<i} u_j (b_j x b_i)_z.

To lowest order all but Q is linear in u.  If no u on a face u_i = 1 satisfies these (u and -u give the same: errors are
symmetric), there is no critical point but the flat state within r0.  The determinant with errors E of its entries A is
off by at most per(|A| + E) - per(|A|).

The flat state is no minimum if p, m with sum u_i b_i = 0 have Q(p) > 0 > Q(m) and both lower the energy to first order,
sum_i -k_i rest_i u_i < 0: so does a u between them, where Q(u) = 0 with a simple sign change; there the equations over r,
continued to r = 0, are regular, so closed states leave the flat one along u.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.proof.affine import UNIT, Affine, padded, variables
from origami_nlp.proof.boxes import Boxes, prune
from origami_nlp.proof.chains import Rows, Vertex

RADII = (1e-3, 1e-4, 1e-5, 1e-6)
"""Radii [rad] tried, the largest first; smaller ones cost more boxes outside."""
MOST = 3_000
"""Boxes for a radius; generic scenes take some ten."""
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


class Cone:
    """The equations of lowest order on the faces |u|_inf = 1, with remainders for 0 < r <= radius."""

    linear = slice(0, 2)
    pivots = 2

    def __init__(self, vertex: Vertex, radius: float) -> None:
        n = self.size = vertex.size
        self.minor_count = 0
        b = vertex.creases  # [n, 2]
        self.doubt = vertex.doubt_crease
        cross = b[:, None, 0] * b[None, :, 1] - b[:, None, 1] * b[None, :, 0]
        self.before = np.triu(cross, 1)  # [j, i]: (b_j x b_i)_z, j before i
        self.b = b
        self.misses = np.array([radius**2 * n**3 / 24] * 2) + n * self.doubt
        self.miss = radius**2 * n**4 / 96 + n * n * 3 * self.doubt
        self._pose_minors(vertex, radius)

    def _pose_minors(self, vertex: Vertex, radius: float) -> None:
        """Coefficients [M, n] of the minors in u, and how far these are off, [M]."""
        n, b = self.size, self.b
        k = vertex.stiffness / vertex.stiffness.max()
        g = -k * vertex.rest
        many = np.arange(n)
        size = np.abs(np.stack([g, b[:, 0], b[:, 1], np.abs(self.before).sum(axis=0)]))  # [4, n]
        error = np.stack(
            [
                k * radius,
                radius**2 * many**2 / 2 + self.doubt,
                radius**2 * many**2 / 2 + self.doubt,
                radius**2 * many**3 / 6 + 3 * n * self.doubt,
            ]
        )
        fours = vertex.fours
        pairs = np.stack([np.ones(n), b[:, 0], b[:, 1]])
        three = np.stack([g, pairs[1], pairs[2]])  # rows g, x, y
        coefficients = np.zeros((len(fours), n))
        for a in range(4):
            rest = np.delete(fours, a, axis=1)
            minor = np.linalg.det(three[:, rest].transpose(1, 2, 0)) if len(fours) else np.zeros(0)
            coefficients += (-1.0) ** (a + 3) * minor[:, None] * self.before[:, fours[:, a]].T
        self.coefficients = coefficients
        with_error = _permanents(size + error, fours)
        self.off = with_error - _permanents(size, fours) + 2_000 * UNIT * with_error

    def faces(self) -> Boxes:
        """Return the boxes to start from: u_i = 1, the others in [-1, 1]."""
        n = self.size
        pins = np.eye(n, dtype=np.int8)
        return Boxes(-1.0 + 2.0 * pins, np.ones((n, n)), pins, np.arange(n))

    def rows(self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray) -> Rows:
        """Enclose all rows over boxes of u, as rows of closure: two, the minors, Q."""
        middle, half = variables(lower, upper)
        matrix = np.concatenate([self.b.T, self.coefficients])
        off = np.concatenate([self.misses, self.off])
        centre = matrix @ middle
        slopes = matrix[:, :, None] * half[None]
        # Q(u) = u' T u with T[j, i] for j < i
        square = self.before + self.before.T
        lever = square @ middle
        q = 0.5 * (middle * lever).sum(axis=0)
        second = 0.5 * np.einsum("jk,ji,ik->k", half, np.abs(square), half)
        total = np.abs(matrix).sum(axis=1)[:, None] + 0 * centre
        size = np.full((1, middle.shape[1]), np.abs(square).sum())
        return Rows(
            padded(
                np.concatenate([centre, q[None]]),
                np.concatenate([slopes, (lever * half)[None]]),
                np.concatenate([off[:, None] + 0 * centre, self.miss + second[None]]),
                np.concatenate([total, size]),
                2 * self.size**2 + 8,
            ),
            Affine(np.zeros((0, len(q))), np.zeros((0, self.size, len(q))), np.zeros((0, len(q)))),
            np.zeros((0, len(q)), dtype=bool),
        )


def _permanents(entries: np.ndarray, fours: np.ndarray) -> np.ndarray:
    """Permanents of the 4 x 4 matrices of columns `fours` [M, 4] of entries [4, n] >= 0."""
    total = np.zeros(len(fours))
    for order in itertools.permutations(range(4)):
        total += np.prod([entries[row, fours[:, order[row]]] for row in range(4)], axis=0)
    return total


def flat_lemma(vertex: Vertex) -> Flat:
    """Look for the largest radius within which the flat state is the only critical point.

    Parameters
    ----------
    vertex
        Without symmetry.

    Returns
    -------
    Flat
    """
    boxes = 0
    for radius in RADII:
        cone = Cone(vertex, radius)
        left = prune(cone, cone.faces(), small=0.01, most=MOST)
        boxes += left.boxes
        if not len(left.candidates) and not len(left.open):
            return Flat(radius, boxes, no_minimum(vertex))
    return Flat(0.0, boxes, no_minimum(vertex))


def no_minimum(vertex: Vertex) -> bool | None:
    """Return False where closed states leave the flat one downhill, None where that is not shown."""
    b, n = vertex.creases, vertex.size
    k = vertex.stiffness / vertex.stiffness.max()
    slope = -k * vertex.rest
    cross = np.triu(b[:, None, 0] * b[None, :, 1] - b[:, None, 1] * b[None, :, 0], 1)
    kernel = np.linalg.svd(b.T)[2][2:]  # [n - 2, n]
    values, vectors = np.linalg.eigh(0.5 * kernel @ (cross + cross.T) @ kernel.T)
    for share in (0.0, 0.1, -0.1, 0.3, -0.3):  # a direction may happen to be level
        up, down = vectors[:, -1] + share * vectors[:, 0], vectors[:, 0] + share * vectors[:, -1]
        steps = [(u @ kernel) * -math.copysign(1.0, u @ kernel @ slope) for u in (up, down)]
        curved = [float(u @ cross @ u) for u in steps]
        if all(float(u @ slope) < -CLEAR for u in steps) and curved[0] > CLEAR > -CLEAR > curved[1]:
            return False
    return None
