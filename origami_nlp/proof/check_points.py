"""Critical points of a proof, examined in ball arithmetic of 128 bits: each is there, alone, and of its kind.

On the stratum of a pin pattern s the unknowns are the free angles x and the moment m, the equations

    k_i (x_i - rest_i) - m . c_i(x) = 0  for each free crease i,     vec q(x) = 0,

(a hinge law has its torque for k_i (x_i - rest_i) and its slopes, over a box, for k_i) with
q = prod (cos x_i/2, b_i sin x_i/2), c_i = b_i turned by q_1 .. q_(i-1).  Derivatives: d c_i/d x_j = c_j x c_i
for j < i and 0 otherwise; d q/d x_j = (0, c_j) q / 2.

Existence: Krawczyk's operator z0 - Y F(z0) + (1 - Y J(Z)) (Z - z0) maps a box Z into its interior, with q_0 > 0.
Uniqueness: in a box of angles every critical point in the sense of Fritz John, rank [G | C] <= 3, has its m in an
interval vector M: with a matrix P for which |1 - P C| < 1 over the box, m = m0 + (P C)^-1 P (G - C m0).  So it
is a zero of F in the box times M, and there is one at most where a weighted norm of 1 - Y J is below 1 over all of it
(then Y J, and every mean value of J, is regular).

Index: negative directions of the Hessian H_ij = k_i (i = j), - m . (c_i x c_j) / 2 (i < j) on the angles that keep
closure, sum c_i dx_i = 0: three creases whose axes span space follow the others, and LDL^T counts signs.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat

from origami_nlp.proof.check_domains import BallChain
from origami_nlp.proof.check_forms import AROUND

Balls = list[Any]
NEWTON, GROWTHS = 30, 8
"""Newton steps at most, and how often the box tried for existence is made four times as large."""
ROUGHLY = 2.0**-30
"""Of the largest energy of a hinge law: how well the least one is looked for."""
TINY = 2.0**-100
"""Least size of a box, and of a Newton step that matters."""


class Refused(Exception):
    """A claim that was not confirmed; its text says which."""


@dataclass(frozen=True)
class Located:
    """What is certain of a critical point: balls that hold it, and its kind.

    Attributes
    ----------
    x, moment
        Balls that hold the true fold angles (the limit where pinned), shape [N], and the true moment, shape [3].
    index
        Negative directions of the Hessian on the stratum; None where unclear.
    signs
        Of s_i (G_i - m . c_i) at pinned creases: -1, +1, 0 where unclear; 0 at free creases.
    is_minimum
        True: index 0 and every pinned crease pushes; False: certainly not; None: unclear.
    energy
        Ball that holds U.
    """

    x: Balls
    moment: Balls
    index: int | None
    signs: tuple[int, ...]
    is_minimum: bool | None
    energy: Any


class CheckedStratum:
    """Critical points with given creases pinned.

    Parameters
    ----------
    piece
        The sheet, or piece of it, made at the precision wanted.
    pins
        Sign of each pinned crease, 0: free.
    """

    def __init__(self, piece: BallChain, pins: Sequence[int]) -> None:
        self.piece, self.pins, self.rank = piece, tuple(pins), piece.rank
        self.free = [i for i, s in enumerate(pins) if not s]

    def angles(self, free: Balls) -> Balls:
        """All fold angles, of the free ones."""
        given = iter(free)
        return [self.piece.limit(i, s) if s else next(given) for i, s in enumerate(self.pins)]

    def torque(self, i: int, x: Balls, moment: Balls, columns: list[Balls]) -> Any:
        """K_i (x_i - rest_i) - m . C_i, or with the torque of a law."""
        return self.piece.weights[i] * self.piece.pull(i, x[i]) - _dot(moment, columns[i])

    def stiff(self, i: int, x: Balls) -> Any:
        """K_i, or the slope of a law."""
        return self.piece.weights[i] * self.piece.stiff(i, x[i])

    def residual(self, z: Balls) -> Any:
        """F at (x_free, m), as a column."""
        x, m = self.angles(z[: -self.rank]), z[-self.rank :]
        closure, _, columns, _, _ = self.piece.at(x)
        return _column([self.torque(i, x, m, columns) for i in self.free] + closure)

    def jacobian(self, z: Balls) -> Any:
        """Derivatives of F over a box of (x_free, m)."""
        moment, x = z[-self.rank :], self.angles(z[: -self.rank])
        _, slopes, columns, bends, _ = self.piece.at(x)
        rows = []
        for i in self.free:
            row = [
                (self.stiff(i, x) if i == j else arb(0)) - _dot(moment, bends[i][j])
                for j in self.free
            ]
            rows.append(row + [-c for c in columns[i]])
        for r in range(self.rank):
            rows.append([slopes[j][r] for j in self.free] + [arb(0)] * self.rank)
        return arb_mat(rows)

    def locate(self, x: Sequence[float], moment: Sequence[float]) -> Located:
        """Prove that a critical point lies near the given angles and moment, and find its kind.

        Raises
        ------
        Refused
            If no box around it is mapped into itself, or the point is beyond the limits.
        """
        z = [arb(x[i]) for i in self.free] + [arb(m) for m in moment]
        for _ in range(NEWTON):
            step = _inverse(self.jacobian(z)) * self.residual(z)
            # Newton on midpoints: a suggestion, the box around it is what is shown
            z = [(a - b).mid() for a, b in zip(z, step.entries(), strict=True)]
            if all(b.contains(0) or abs(b) < TINY for b in step.entries()):
                break
        else:
            raise Refused(f"Newton's method does not converge in {NEWTON} steps")
        held = self._held(z)
        angles, m = self.angles(held[: -self.rank]), held[-self.rank :]
        _, slopes, columns, bends, lift = self.piece.at(angles)
        if not lift > 0:
            raise Refused("closes with q = -1")
        ends = self.piece.limit
        if not all(ends(i, -1) < angles[i] < ends(i, 1) for i in self.free):
            raise Refused("a free crease is at its limit, or beyond it")
        signs = tuple(
            _sign(s * self.torque(i, angles, m, columns)) if s else 0
            for i, s in enumerate(self.pins)
        )
        index = self._index(angles, m, slopes, bends)
        unclear = index is None or any(s and not t for s, t in zip(self.pins, signs, strict=True))
        no = bool(index) or 1 in signs
        of = enumerate(zip(self.piece.weights, angles, strict=True))
        energy = sum((w * self.piece.stored(i, a) for i, (w, a) in of), arb(0))
        return Located(angles, m, index, signs, False if no else None if unclear else True, energy)

    def reach(self, point: Located, radius: float) -> Any:
        """Bound the change of energy within `radius` of a point."""
        total = arb(0)
        for i, (w, x) in enumerate(zip(self.piece.weights, point.x, strict=True)):
            total += w * self.piece.pull(i, x + AROUND * arb(radius)).abs_upper() * radius
            if (law := self.piece.laws[i]) is not None:
                total += w * ROUGHLY * law.size
        return total.upper()

    def _held(self, z: Balls) -> Balls:
        """Krawczyk's operator around z: balls that hold a zero of F."""
        near = _inverse(self.jacobian(z))
        start = (near * self.residual(z)).entries()

        def image(box: Balls) -> Balls:
            left = _identity(len(z)) - near * self.jacobian(box)
            off = _column([b - a for a, b in zip(z, box, strict=True)])
            moved = (left * off).entries()
            return [a - b + c for a, b, c in zip(z, start, moved, strict=True)]

        sizes = [2 * s.abs_upper() + TINY for s in start]
        for _ in range(GROWTHS):
            box = [a + AROUND * s for a, s in zip(z, sizes, strict=True)]
            # Krawczyk's operator on the box; inside the box, it holds a zero of F
            found = image(box)
            if all(a.contains_interior(b) for a, b in zip(box, found, strict=True)):
                # zeros stay in the image of every box that holds them and z
                return image([b.union(a) for a, b in zip(z, found, strict=True)])
            sizes = [4 * s for s in sizes]
        raise Refused("no box around it is mapped into itself: nothing shows that it exists")

    def moments(self, x: Sequence[float], radius: float, moment: Balls) -> Balls:
        """Balls that hold m of every critical point within `radius` of x.

        Raises
        ------
        Refused
            If the axes of the free creases may be dependent there.
        """
        middle = [arb(x[i]) for i in self.free]
        box = [a + AROUND * arb(radius) for a in middle]
        of_all = self.piece.at(self.angles(box))[2]
        columns = arb_mat([of_all[i] for i in self.free])
        c = columns.mid()
        pseudo = (_inverse(c.transpose() * c) * c.transpose()).mid()
        rank = range(self.rank)
        off = _identity(self.rank) - pseudo * columns
        sums = [sum((off[r, k].abs_upper() for k in rank), arb(0)) for r in rank]
        norm = max(sums, key=lambda v: float(v.upper()))
        # |1 - P C| < 1 over the box: P C is regular, closure independent
        if not norm < 1:
            raise Refused(f"closure may be dependent within {radius:.3g} rad")
        size = len(self.free)
        slopes = self.jacobian(box + moment)
        at = self.residual(middle + moment)
        spread = [AROUND * arb(radius)] * size
        rows = [
            at[r, 0] + sum((slopes[r, k] * spread[k] for k in range(size)), arb(0))
            for r in range(size)
        ]
        right = (pseudo * _column(rows)).entries()
        largest = max((v.abs_upper() for v in right), key=float)
        return [
            m + v + AROUND * (s * largest / (1 - norm))
            for m, v, s in zip(moment, right, sums, strict=True)
        ]

    def alone(self, x: Sequence[float], radius: float, moment: Balls) -> bool:
        """Return whether at most one critical point of the stratum lies within `radius` of x.

        Raises
        ------
        Refused
            As for `moments`.
        """
        exact = [m.mid() for m in moment]
        box = [arb(x[i]) + AROUND * arb(radius) for i in self.free]
        box += self.moments(x, radius, exact)
        near = _inverse(self.jacobian([a.mid() for a in box]))
        left = _identity(len(box)) - near * self.jacobian(box)
        size = len(box)
        sizes = arb_mat([[left[r, k].abs_upper() for k in range(size)] for r in range(size)])
        try:
            # weights v with |1 - Y J| v < v (Perron): the weighted norm below 1 that makes Y J regular
            weights = (_identity(size) - sizes).solve(_column([arb(1)] * size)).mid()
        except ZeroDivisionError:
            return False
        image = (sizes * weights).entries()
        pairs = list(zip(weights.entries(), image, strict=True))
        return all(a > 0 and b < a for a, b in pairs)

    def _index(
        self, x: Balls, moment: Balls, slopes: list[Balls], bends: list[list[Balls]]
    ) -> int | None:
        """Negative eigenvalues of the Hessian on the tangent space of closure."""
        free, rank = self.free, range(self.rank)
        if len(free) == self.rank:
            return 0
        led = max(
            itertools.combinations(free, self.rank),
            key=lambda some: float(abs(arb_mat([slopes[t] for t in some]).det()).mid()),
        )
        # dx_led = -base^-1 (rest) dx_rest: a basis of the kernel of closure in balls
        base = arb_mat([[slopes[t][r] for t in led] for r in rank])
        if not abs(base.det()) > 0:
            return None
        rest = [i for i in free if i not in led]
        follow = -(base.inv() * arb_mat([[slopes[i][r] for i in rest] for r in rank]))
        place = {t: r for r, t in enumerate(led)}
        tangent = arb_mat(
            [
                [follow[place[i], k] if i in place else int(i == j) for k, j in enumerate(rest)]
                for i in free
            ]
        )
        hessian = [[arb(0)] * len(free) for _ in free]
        for a, i in enumerate(free):
            for b, j in enumerate(free[: a + 1]):
                bent = -_dot(moment, self.piece.curvature(i, j, bends))
                hessian[a][b] = hessian[b][a] = bent + (self.stiff(i, x) if i == j else 0)
        return negative(tangent.transpose() * arb_mat(hessian) * tangent)


def negative(matrix: Any) -> int | None:
    """Count negative eigenvalues of a symmetric matrix of balls by LDL^T; None where a pivot has no sign.

    Where all pivots on the diagonal are unclear, rows and columns are added to each other: a congruence.
    """
    for change in _congruences(matrix.nrows()):
        found = _count(change.transpose() * matrix * change)
        if found is not None:
            return found
    return None


def _congruences(size: int) -> Iterator[Any]:
    yield _identity(size)
    for i, j in itertools.permutations(range(size), 2):
        yield arb_mat([[int(r == c or (r, c) == (i, j)) for c in range(size)] for r in range(size)])


def _count(matrix: Any) -> int | None:
    rows, count = matrix.tolist(), 0
    while rows:
        p = max(range(len(rows)), key=lambda i: float(abs(rows[i][i].mid())))
        sign = _sign(rows[p][p])
        if not sign:
            return None
        count += sign < 0
        kept = [i for i in range(len(rows)) if i != p]
        # Schur complement; by Sylvester's law signs of pivots are those of eigenvalues
        rows = [[rows[i][j] - rows[i][p] * rows[p][j] / rows[p][p] for j in kept] for i in kept]
    return count


def _sign(value: Any) -> int:
    return 1 if value > 0 else -1 if value < 0 else 0


def _identity(size: int) -> Any:
    return arb_mat(size, size, [int(i % (size + 1) == 0) for i in range(size * size)])


def _inverse(matrix: Any) -> Any:
    """Return about the inverse of the middle of a matrix, without radius: a suggestion."""
    try:
        return matrix.mid().inv().mid()
    except ZeroDivisionError:
        raise Refused("singular to 128 bits") from None


def _column(values: Sequence[Any]) -> Any:
    return arb_mat([[v] for v in values])


def _dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return sum((x * y for x, y in zip(a, b, strict=True)), arb(0))
