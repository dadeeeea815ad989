"""Pieces of symmetric vertices, over boxes of fold angles: a wedge between two mirrors, and a period of turns.

D_n: H = Q(b_1, x_1) .. Q(b_k, x_k), half as much at creases on the mirrors, carries the last mirror, of flat normal n_k
= (sin pi/n, -cos pi/n, 0), to one at an angle from the first, of normal n_1 = e2, with which the vertex closes: -n_1 .
H n_k = c, c one of the roots of `check_whole`. c = -1: H n_k = n_1, stated as h_x = h_z = 0 once H is followed by the
turn by pi/n - pi that takes n_1 to n_k; on closed states the slopes of these by all angles are those of the x and z of
the axes, turned, so that the minors may be had from (n_1, c_j, c_k), or (c_j, c_k, H n_k). c > -1: n_1 . H n_k + c = 0,
of slopes (n_1, c_i, H n_k). C_n: T = H Q(e3, 2 pi/n) has the scalar c > -1; its slope by x_i is that of T with b_i put
in before Q(b_i, x_i), halved. c = -1: T = -1, minors as without symmetry, of triple products of the axes of one period.
A crease on a mirror stands for half as many creases and moves half: rows of minors are as without symmetry, with the
torque of one crease.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

from flint import arb, arb_mat, fmpq

from origami_nlp.pattern import Scene
from origami_nlp.proof.check_domains import BallChain, Balls, VertexChain, cross, near
from origami_nlp.proof.check_forms import Box, Form, Terms, carry, linear
from origami_nlp.proof.check_laws import laws_of
from origami_nlp.proof.check_whole import closing_numbers, whole_vertex


def piece_of(scene: Scene) -> BallChain:
    """Return what a scene's proof is about: the sheet, or the piece that its symmetry leaves.

    Parameters
    ----------
    scene
        With flat sheet.

    Returns
    -------
    BallChain
        In balls of the precision that is set.
    """
    if scene.group.is_trivial:
        chain = VertexChain(scene.vertex.sector_angles, scene.stiffness, scene.wound_angles)
        low, high = scene.limit_angles.tolist()
        chain.limits = list(zip(low, high, strict=True))
        chain.laws = laws_of(scene, range(scene.degree))
        return chain
    if scene.group.kind == "D":
        return WedgeChain(scene)
    return (
        ClosedPeriodChain(scene)
        if closing_numbers(scene.group.order)[_root(scene)] == -1
        else PeriodChain(scene)
    )


def _root(scene: Scene) -> int:
    """Which root of `closing_numbers` the states of a scene have: they wind round the axis 1, 3, 5, .. times."""
    return ((scene.winding or 1) - 1) // 2


class SymmetricPiece(BallChain):
    """What both kinds share: variables in the order of the creases on the rays."""

    def __init__(self, scene: Scene) -> None:
        rays, orbit = scene.group.rays, scene.group.orbit
        mirrors = (0, len(rays) - 1) if scene.group.kind == "D" else ()
        self.order, self.scene = scene.group.order, scene
        self.level = closing_numbers(self.order)[_root(scene)]
        self.sectors = [near(a) for a in scene.vertex.sector_angles]
        self.gaps = [near(ray.sector) for ray in rays]
        whole = arb.pi() / self.order
        places = [r for r, ray in enumerate(rays) if ray.crease is not None]
        azimuths = [sum(self.gaps[:r], arb(0)) for r in places]
        if mirrors and rays[-1].crease is not None:
            # exactly pi/n, whatever the sectors' last bits say
            azimuths[-1] = whole
        creases = [rays[r].crease for r in places]
        super().__init__(
            azimuths,
            [scene.stiffness[c] for c in creases if c is not None],
            [scene.wound_angles[c] for c in creases if c is not None],
            [2 if r in mirrors else 1 for r in places],
            [orbit.count(r) for r in places],
        )
        self.places = places
        low, high = scene.limit_angles.tolist()
        self.limits = [(low[c], high[c]) for c in creases if c is not None]
        self.laws = laws_of(scene, [c for c in creases if c is not None])
        share = fmpq(1, self.order)
        self.cosine, self.sine = arb.cos_pi_fmpq(share), arb.sin_pi_fmpq(share)

    def vertex(self, angles: Sequence[Any]) -> Balls:
        """Product of all folds of the whole vertex, [w, x, y, z]: 1 where it closes."""
        return whole_vertex(self.scene, self.sectors, angles)

    @abstractmethod
    def number(self, angles: Sequence[Any]) -> Any:
        """Return the number c of the piece, which decides whether the whole vertex closes."""

    def whole(self, box: Box, pins: Sequence[int], before: int | None = None) -> Terms:
        """H over a box, as a column [w, x, y, z]; with b_i put in before Q(b_i, x_i)."""
        maps: list[tuple[int, Any, Any]] = []
        for i in range(self.count):
            if i == before:
                maps.append((i, self._spins[i], None))
            maps.append((i, *self.half_turn(i, box, pins, 1)))
        return carry(arb_mat([[1], [0], [0], [0]]), maps)

    def plate(self, run: Sequence[int], pins: Sequence[int], first: int) -> Any | None:
        """Angle between two rays, those between closed: sectors add with a sign that turns at every crease; or None."""
        total, sign = arb(0), 1
        for r, gap in enumerate(run):
            if r:
                ray = (first + r) % len(self.gaps)
                if ray in self.places:
                    place = self.places.index(ray)
                    if not self.closed(place, pins[place]):
                        return None
                    sign = -sign
            total += sign * self.gaps[gap]
        return total / arb.pi()

    def curvature(self, i: int, j: int, bends: list[list[Balls]]) -> Balls:
        """Second derivatives of closure."""
        return bends[i][j]


class WedgeChain(SymmetricPiece):
    """A wedge of D_n."""

    spare = 0

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self.rank = 2 if self.level == -1 else 1
        # followed by the last mirror's turn to where that of n = 1 is
        s, c = ((arb.pi() / self.order - arb.pi()) / 2).sin_cos()
        self.onward = arb_mat([[c, 0, 0, -s], [0, c, s, 0], [0, -s, c, 0], [s, 0, 0, c]])
        self.first = arb_mat([[0], [1], [0]])
        self.last = arb_mat([[self.sine], [-self.cosine], [0]])

    def closure(self, box: Box, pins: Sequence[int]) -> tuple[Terms, list[list[float]]]:
        """As of `BallChain`: h_x and h_z, or n_1 . H n_k + c."""
        if self.rank == 2:
            pick = arb_mat([[0, 1, 0, 0], [0, 0, 0, 1]]) * self.onward
            terms = {mask: pick * v for mask, v in self.whole(box, pins).items()}
            return terms, [[1.0, 0.0], [0.0, 1.0]]
        terms = {mask: v.transpose() * self.first for mask, v in self._onward(0, box, pins).items()}
        terms[0] = terms[0] + arb_mat([[self.level]])
        return terms, [[1.0]]

    def _onward(self, i: int, box: Box, pins: Sequence[int], to: int | None = None) -> Terms:
        """Axis `to`, or the last mirror's normal, seen from before the fold of crease i."""
        end = self.count if to is None else to
        start = self.last if to is None else self._axes[to]
        return carry(start, [(c, *self.turn(c, box, pins, 1)) for c in reversed(range(i, end))])

    def _back(self, i: int, box: Box, pins: Sequence[int], to: int | None = None) -> Terms:
        """Axis `to`, or the first mirror's normal, seen from before the fold of crease i."""
        begin = 0 if to is None else to + 1
        start = self.first if to is None else self._axes[to]
        return carry(start, [(c, *self.turn(c, box, pins, -1)) for c in range(begin, i)])

    def slopes(self, some: Sequence[int], box: Box, pins: Sequence[int]) -> Form:
        """(n_1, c_j, c_k), from either mirror, or (n_1, c_i, H n_k)."""
        j, k = some[0], some[-1]
        if self.rank == 1:
            return self.mixed(self._back(j, box, pins), j, self._onward(j, box, pins))
        # the product with fewer free angles has the smaller balls
        if sum(not s for s in pins[:k]) <= sum(not s for s in pins[j + 1 :]):
            return self.mixed(self._back(j, box, pins), j, self._onward(j, box, pins, k))
        return self.mixed(self._back(k, box, pins, j), k, self._onward(k, box, pins))

    def twin(self, a: int, b: int, pins: Sequence[int]) -> int | None:
        """As of `BallChain`; across a mirror where the plate to it, mirrored itself, is a quarter turn, or three."""
        r, s = sorted((self.places[a], self.places[b]))
        if a != b:
            angle = self.plate(range(r, s), pins, r)
            whole = None if angle is None else angle.unique_fmpz()
            return None if whole is None else -1 if int(whole) % 2 else 1
        last = len(self.gaps) - 1
        for mirror, first, end in ((0, 0, r), (last, r, last)):
            # a facet that a mirror runs through stands across it; a crease there, fully folded, lays its facets into it
            if mirror not in self.places and first < end:
                angle = self.plate(range(first, end), pins, first)
                if angle is not None and (angle - arb(0.5)).unique_fmpz() is not None:
                    return 1
        return None

    def at(
        self, angles: Sequence[Any]
    ) -> tuple[Balls, list[Balls], list[Balls], list[list[Balls]], Any]:
        """As of `BallChain`."""
        h, turn, axes = self.chain(angles)
        n, lift = range(self.count), self.vertex(angles)[0]
        if self.rank == 2:
            h = (self.onward * arb_mat([[v] for v in h])).entries()
            by = [arb(1) / (2 * o) for o in self.over]
            bends = _products(h, axes, by, (1, 3))
            slopes = [[b * v for v in _times(c, h)[1::2]] for b, c in zip(by, axes, strict=True)]
            return h[1::2], slopes, slopes, bends, lift
        v = (turn * self.last).entries()
        by = [arb(1) / o for o in self.over]
        # d(n_1 . v)/dx_i = n_1 . (c_i x v) / over, n_1 = e2
        slopes = [[b * cross(c, v)[1]] for b, c in zip(by, axes, strict=True)]
        # c_i x (c_j x v), the earlier crease outside
        turned = [
            [[by[i] * by[j] * cross(axes[min(i, j)], cross(axes[max(i, j)], v))[1]] for j in n]
            for i in n
        ]
        return [v[1] + self.level], slopes, slopes, turned, lift

    def number(self, angles: Sequence[Any]) -> Any:
        """-n_1 . H n_k."""
        return -(self.chain(angles)[1] * self.last).entries()[1]


class PeriodChain(SymmetricPiece):
    """A period of C_n, n > 1."""

    rank, spare = 1, 0

    def _scalar(self, terms: Terms) -> Terms:
        """The scalar of H Q(e3, 2 pi/n)."""
        row = arb_mat([[self.cosine, 0, 0, -self.sine]])
        return {mask: row * v for mask, v in terms.items()}

    def closure(self, box: Box, pins: Sequence[int]) -> tuple[Terms, list[list[float]]]:
        """As of `BallChain`: the scalar less c."""
        terms = self._scalar(self.whole(box, pins))
        terms[0] = terms[0] - arb_mat([[self.level]])
        return terms, [[1.0]]

    def slopes(self, some: Sequence[int], box: Box, pins: Sequence[int]) -> Form:
        """Twice the slope by x_i."""
        return linear(self._scalar(self.whole(box, pins, before=some[0])))[0]

    def twin(self, a: int, b: int, pins: Sequence[int]) -> int | None:
        """As of `BallChain`, between creases of one period, or of it and the next."""
        if a == b:
            return None
        n = self.count
        for first, last in ((a, b), (b, a)):
            run = [(first + i) % n for i in range((last - first) % n)]
            angle = self.plate(run, pins, first)
            whole = None if angle is None else angle.unique_fmpz()
            if whole is not None:
                return -1 if int(whole) % 2 else 1
        return None

    def at(
        self, angles: Sequence[Any]
    ) -> tuple[Balls, list[Balls], list[Balls], list[list[Balls]], Any]:
        """As of `BallChain`."""
        t, axes = self.turned(angles)
        by = [arb(0.5)] * self.count
        slopes = [[b * _times(a, t)[0]] for b, a in zip(by, axes, strict=True)]
        lift = self.vertex(angles)[0]
        return [t[0] - self.level], slopes, slopes, _products(t, axes, by, (0,)), lift

    def turned(self, angles: Sequence[Any]) -> tuple[Balls, list[Balls]]:
        """T at balls of fold angles, [w, x, y, z], and all axes [n][3]."""
        (w, x, y, z), _, axes = self.chain(angles)
        c, s = self.cosine, self.sine
        return [w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s], axes  # q (c + s k)

    def number(self, angles: Sequence[Any]) -> Any:
        """The scalar of T."""
        return self.turned(angles)[0][0]


class ClosedPeriodChain(PeriodChain):
    """A period of C_n, n odd, that closes by itself: T = -1."""

    rank, spare = 3, 1

    def closure(self, box: Box, pins: Sequence[int]) -> tuple[Terms, list[list[float]]]:
        """As of `BallChain`: T + 1, its scalar of second order."""
        c, s = self.cosine, self.sine
        onward = arb_mat([[c, 0, 0, -s], [0, c, s, 0], [0, -s, c, 0], [s, 0, 0, c]])
        terms = {mask: onward * v for mask, v in self.whole(box, pins).items()}
        terms[0] = terms[0] + arb_mat([[1], [0], [0], [0]])
        return terms, [[float(r == k) for k in range(4)] for r in range(4)]

    def slopes(self, some: Sequence[int], box: Box, pins: Sequence[int]) -> Form:
        """Triple product of the axes of three creases, in order."""
        i, j, k = some
        back = [(c, *self.turn(c, box, pins, -1)) for c in range(i + 1, j)]
        forth = [(c, *self.turn(c, box, pins, 1)) for c in reversed(range(j, k))]
        return self.mixed(carry(self._axes[i], back), j, carry(self._axes[k], forth))

    def at(
        self, angles: Sequence[Any]
    ) -> tuple[Balls, list[Balls], list[Balls], list[list[Balls]], Any]:
        """As of `BallChain`, of -T as `VertexChain` has it of q."""
        t, axes = self.turned(angles)
        w, *v = [-value for value in t]
        slopes = [[(w * a + b) / 2 for a, b in zip(c, cross(c, v), strict=True)] for c in axes]
        none, n = [arb(0)] * 3, range(self.count)
        bends = [[cross(axes[j], axes[i]) if j < i else none for j in n] for i in n]
        # T = 1 has no vector either
        lift = w.min(self.vertex(angles)[0])
        return v, slopes, axes, bends, lift

    def curvature(self, i: int, j: int, bends: list[list[Balls]]) -> Balls:
        """As of `VertexChain`."""
        return [b / 2 for b in bends[i][j]]


def _times(v: Sequence[Any], q: Sequence[Any]) -> Balls:
    """Product of the quaternions (0, v) and q."""
    w, *u = q
    dot = sum((a * b for a, b in zip(v, u, strict=True)), arb(0))
    return [-dot, *(w * a + b for a, b in zip(v, cross(v, u), strict=True))]


def _products(
    q: Sequence[Any], axes: list[Balls], by: Sequence[Any], rows: Sequence[int]
) -> list[list[Balls]]:
    """Second derivatives c_i c_j q by_i by_j, i before j, of some entries of a product of folds."""
    n = range(len(axes))
    inner = [_times(axes[j], q) for j in n]
    found: list[list[Balls]] = [[[] for _ in n] for _ in n]
    for i in n:
        for j in range(i, len(axes)):
            whole = _times(axes[i], inner[j])
            found[i][j] = found[j][i] = [by[i] * by[j] * whole[r] for r in rows]
    return found
