"""Closure, minors and rows of collinear creases near a singular state x*, as forms in the direction and the distance.

*Closure.*  Write x = x* + r u, |u|_inf = 1, g(x) for the closure rows (entries of a unit quaternion, or of a unit
vector that it carries), all axes seen at x*.  As q(x) conj q(x*) = prod exp(r u_i c_i / 2), the k-th derivative of g
along u is at most s^k, s = sum_i l |u_i| <= l n with l = 1/2 (quaternions) or 1 (vectors); with d/dx_i in it, l
s^(k-1). Rows are turned so that J = dg/dx* is zero in the last ones ("normal") and of full rank in the others
("planar").  With H the Hessian of a row at x*:

    planar   g / r         = J u               +- r s^2 / 2
    normal   g / (r^2 / 2) = u' H u            +- r s^3 / 3

*Parity.*  If every fold angle of x* is 0 or +-pi, the reflection in the plane of all axes sends exp(r u c / 2) to
exp(-r u c / 2): planar rows are odd in r, normal ones even, and the errors become

    planar   r^2 s^3 / 6,    normal   r^2 s^4 / 12.

*Minors.*  The column of the normal row is divided by r.  The entries of crease i are

    G_i = G*_i + r k_i u_i,    J_i +- r l s  (even: r^2 l s^2 / 2),    (H u)_i +- r l s^2 / 2  (even: r^2 l s^3 / 6).

The leading determinant is linear in u, and r times its next term is det [K u | J | H u]; the rest is bounded by columns
(Hadamard): |det(A + E) - det A| <= prod (|A_c| + |E_c|) - prod |A_c|.  Where G* is zero on S, the column of G is
divided by r too.  Without a normal row the determinant starts with det [G* | J]; where that is zero, it is divided by
r, and, in norms of columns,

    |det(A + r B + r^2 D) - det A - r (linear part)| <= prod (A + r B + r^2 D) - prod A - r sum_c B_c prod_(d != c) A_d.

*Collinear creases* a, b of a stratum, with closed creases alone between them, have J_a = t J_b on the whole stratum,
and at a critical point G_a = t G_b, that is G*_a - t G*_b + r (k_a u_a - t k_b u_b) = 0.  *Turned* ones have no parity:
facets lie in one plane until a line turns the sheet; free axes in one of these planes have a normal row, else there is
none.

No common zero on |u|_inf = 1 for 0 < r <= r0 means no other critical point within r0 of x*, on a stratum and its
limits.  A crease that is closed at x* and free on the stratum can only open: its u_i has one sign.

*Hinge laws.*  G_i = G*_i + r k_i u_i +- r^2 w_i, k_i the slope of the torque at x*, w_i by how it changes within r0
(`LawTorques.linear_about`): of order r^2 in the column of G, of order r where that is divided by r.

*Rounding.*  Coefficients are computed in doubles, to `CLOSURE_TOL`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, EPS, RANK, cross
from origami_nlp.problem import Kinematics, Model
from origami_nlp.proof.forms import Forms
from origami_nlp.proof.law_torques import torques_of

SLACK = 64 * EPS
"""Torques over the stiffness [rad] that differ by less are meant to be equal: rounding of pi and of rest angles."""

Stratum = tuple[int, ...]


class NotShown(Exception):
    """Why nothing is shown."""


@lru_cache(maxsize=4)
def kinematics_of(model: Model) -> Kinematics:
    """Return the closed forms of a model, made once for all its singular states."""
    return Kinematics(model)


def shares(model: Model) -> np.ndarray:
    """Share of each variable that its crease turns the piece by: a half on a mirror, [n]."""
    has = model.structure.has_crease
    rays = np.flatnonzero(has)
    return np.where(np.isin(rays, (0, len(has) - 1)) & (model.structure.kind == "D"), 0.5, 1.0)


class Site:
    """Closure and torques at a singular state, and the rows that follow from them.

    Parameters
    ----------
    model
        A posed scene.
    point
        x*, shape [n] [rad].
    lines
        Turned creases, line by line; none at a flat folding.
    stratum
        With turned twins, the stratum that is looked at; else all may be.

    Raises
    ------
    NotShown
        If axes nearly lie in one plane, or do for no reason that is known.
    """

    def __init__(
        self, model: Model, point: np.ndarray, lines: list[list[int]], stratum: Stratum
    ) -> None:
        kinematics, n, m = kinematics_of(model), model.size, model.equation_count
        self.model, self.lines, self.point = model, lines, point
        self.turned = [i for line in lines for i in line]
        at = kinematics.fold(np.repeat(point[None], m, axis=0))
        self.axes, self.shares = at.axes[0, :n], shares(model)
        jacobian = kinematics.closure(at)[1][0]
        hessian = kinematics.closure_hessian(at, np.eye(m))
        seen = [i for i, s in enumerate(stratum) if not s] if lines else list(range(n))
        left, size, _ = np.linalg.svd(jacobian[:, seen])
        size = np.append(size, np.zeros(m))[:m]
        # rows of left' J beyond the rank are zero: the normal ones
        self.rank = int((size > RANK).sum())
        if (size[self.rank :] > CLOSURE_TOL).any():
            raise NotShown("its axes nearly lie in one plane")
        if lines and self.rank < m and not self._in_one_plane(seen):
            raise NotShown("its axes seem to lie in one plane, for no reason that is looked for")
        self.turn, self.jacobian = left.T, left.T @ jacobian
        self.hessian = np.einsum("ab,aij->bij", left, hessian)
        self.order = 1 if lines else 2
        self.lever = 1.0 if model.structure.kind == "D" and model.structure.turn > 1 else 0.5
        stiffness = model.parameters.stiffness
        self.laws = torques_of(model, model.multiplicity, 1.0)
        if self.laws is None:
            torque, slope = model.parameters.torque(point), stiffness
        else:
            torque, slope, _, known = self.laws.linear_about(point, 0.0)
            stiffness = np.maximum(stiffness, known / SLACK)
        largest = float(np.abs(torque).max())
        self.scale = largest if largest > SLACK * stiffness.max() else float(stiffness.max())
        self.torque, self.stiffness = torque / self.scale, stiffness / self.scale
        self.slope = slope / self.scale
        self.minors = list(self._minors(seen))

    def bow(self, radius: float) -> np.ndarray:
        """By how much torques miss being linear within a radius, over its square, [n]; 0 of linear springs."""
        if self.laws is None:
            return np.zeros(len(self.point))
        _, _, miss, known = self.laws.linear_about(self.point, radius)
        return (miss - known) / radius**2 / self.scale

    def _in_one_plane(self, seen: list[int]) -> bool:
        """Return whether the axes of the free creases lie in one plane, or on one line, by what the state is.

        Facets that closed or flat creases part lie in one plane; a line of twins leaves its plane at the first of them,
        and is back in it after the last.  In a wedge the components along the mirror count: the plane must be that of
        the first facet, or one that a right angle parts from it, which is then at right angles to the mirror.
        """
        axes = self.axes[seen]
        if np.linalg.norm(cross(axes, axes[0]), axis=1).max() <= CLOSURE_TOL:
            return True
        planes = self._planes()
        shared = set.intersection(*(planes[i] for i in seen)) if planes else set()
        s = self.model.structure
        quarters = self.point[self.turned] / (0.5 * math.pi)
        if (s.kind, s.turn) == ("C", 1) or (s.turn == 1 and (quarters == np.rint(quarters)).all()):
            return bool(shared)
        return 0 in shared

    def _planes(self) -> list[set[int]]:
        """Planes that each axis lies in, by number, 0 that of the first facet; none where lines cross."""
        # walk round the vertex with a stack: a line of twins opens a plane at its first crease and closes it at its
        # last
        plane, last, planes = 0, 0, [{0} for _ in self.point]
        back: list[tuple[list[int], int]] = []
        for i in range(len(self.point)):
            planes[i] = {plane}
            for line in (line for line in self.lines if i in line):
                if i == line[0]:
                    back.append((line, plane))
                if back[-1][0] is not line:
                    return []
                last += 1
                plane = back.pop()[1] if i == line[-1] and len(line) > 1 else last
                planes[i].add(plane)
        for line in self.lines:
            every = set.union(*(planes[i] for i in line))
            beside = np.linalg.norm(cross(self.axes, self.axes[line[0]]), axis=1) <= CLOSURE_TOL
            for k, other in enumerate(planes):
                other |= every if beside[k] else set()
        return planes

    def _minors(self, seen: list[int]) -> Iterator[_Minor]:
        """Each minor of creases that may be free, with at most one normal row."""
        m, rank = len(self.jacobian), self.rank
        if m - rank > 1:
            return
        for s in itertools.combinations(seen, m + 1):
            rows = list(s)
            yield _Minor(
                rows,
                self.torque[rows],
                self.slope[rows],
                self.stiffness[rows],
                self.jacobian[:rank, rows].T,
                self.hessian[:, rows],
                rank < m,
            )

    def forms(self, strata: list[Stratum], radius: float) -> tuple[Forms, np.ndarray]:
        """Return the rows on strata, for r <= radius, and whether they hold from `DUPLICATE_TOL` on only, bool [S]."""
        free = np.array(strata) == 0
        rows = [(row, np.ones(len(strata), dtype=bool)) for row in self._closure()]
        made = zip(rows_of(self.minors, self, radius), self.minors, strict=True)
        rows += [(row, free[:, minor.creases].all(axis=1)) for row, minor in made]
        rows += list(self._twins(free, radius))
        holds = np.array([which for _, which in rows]).T
        loose = np.asarray(holds[:, [row.loose for row, _ in rows]].any(axis=1))
        turns = np.where(
            np.isin(np.arange(len(self.point)), self.turned), 0, np.rint(self.point / math.pi)
        )
        columns = zip(*((*row.forms, row.base, row.error) for row, _ in rows), strict=True)
        c, a, q, t, tq, b, e = (np.array(column, dtype=float) for column in columns)
        lower, upper = (
            np.where(free & (turns >= 0), -1.0, 0.0),
            np.where(free & (turns <= 0), 1.0, 0.0),
        )
        return Forms(c, a, q, t, tq, b, e, self.order, holds, lower, upper), loose

    @property
    def size(self) -> float:
        """Bound s of a derivative along u."""
        return self.lever * len(self.point)

    def _closure(self) -> Iterator[_Row]:
        n, s, even = len(self.point), self.size, self.order == 2
        for a, (j, h) in enumerate(zip(self.jacobian, self.hessian, strict=True)):
            if a < self.rank:
                yield _Row(n, linear=j, base=CLOSURE_TOL * n, error=s**3 / 6 if even else s**2 / 2)
            else:
                # rest of order 3 (4 by parity) over r^2 / 2
                error = s**4 / 12 if even else s**3 / 3
                yield _Row(n, quadratic=h, base=CLOSURE_TOL * n * n, error=error)

    def _balance(self, i: int, t: float, k: int, radius: float) -> _Row:
        """G_i - t G_k = 0 for all states of a stratum."""
        n, ki, kk = len(self.point), self.stiffness[i], t * self.stiffness[k]
        slope = np.zeros(n)
        slope[k], slope[i] = -t * self.slope[k], self.slope[i]
        bow = self.bow(radius)
        off = float(bow[i] + abs(t) * bow[k])  # times r^2
        # 0 at x* but for rounding: then the row holds divided by r, and for r >= DUPLICATE_TOL only
        miss = self.torque[i] - t * self.torque[k]
        rounding = SLACK * (ki + abs(kk))
        if abs(miss) <= rounding:
            base = 2 * rounding / DUPLICATE_TOL + off * radius
            return _Row(n, linear=slope, base=base, loose=True)
        error = off * radius ** (2 - self.order)
        return _Row(n, constant=miss, tilt_linear=slope, base=rounding, error=error)

    def _twins(self, free: np.ndarray, radius: float) -> Iterator[tuple[_Row, np.ndarray]]:
        """Rows of creases on one line that only closed ones part, and where they hold."""
        s = self.model.structure
        apart = np.linalg.norm(cross(self.axes[:, None], self.axes), axis=2)
        for a, b in np.argwhere(np.triu(apart <= CLOSURE_TOL, 1)).tolist():
            t = float(np.sign(self.axes[a] @ self.axes[b]) * self.shares[a] / self.shares[b])
            at_limit = ~free[:, a + 1 : b].any(axis=1)
            if s.kind == "C" and s.turn == 1:
                at_limit |= ~(free[:, :a].any(axis=1) | free[:, b + 1 :].any(axis=1))
            yield self._balance(a, t, b, radius), at_limit & free[:, a] & free[:, b]


class _Row:
    """c + a . u + u' M u + r (t . u + u' T u) = +-(base + error r^p); `loose`: for r >= DUPLICATE_TOL only."""

    def __init__(
        self,
        n: int,
        constant: float = 0.0,
        linear: np.ndarray | None = None,
        quadratic: np.ndarray | None = None,
        tilt_linear: np.ndarray | None = None,
        tilt_quadratic: np.ndarray | None = None,
        base: float = 0.0,
        error: float = 0.0,
        loose: bool = False,
    ) -> None:
        row, square = np.zeros(n), np.zeros((n, n))
        self.forms = (
            constant,
            row if linear is None else linear,
            square if quadratic is None else 0.5 * (quadratic + quadratic.T),
            row if tilt_linear is None else tilt_linear,
            square if tilt_quadratic is None else 0.5 * (tilt_quadratic + tilt_quadratic.T),
        )
        self.base, self.error, self.loose = base, error, loose


@dataclass(frozen=True, eq=False)
class _Minor:
    """det [G | J | (normal row)] of m + 1 creases.

    Attributes
    ----------
    creases
        The set S.
    torque, slope, stiffness
        G*, k, and what rounding of G* is a share of, shape [m + 1].
    planar
        J, shape [m + 1, rank].
    bends
        H of each closure row, shape [m, m + 1, n].
    normal
        Whether the last closure row is normal.
    """

    creases: list[int]
    torque: np.ndarray
    slope: np.ndarray
    stiffness: np.ndarray
    planar: np.ndarray
    bends: np.ndarray
    normal: bool

    def with_normal(self, site: Site, radius: float) -> _Row:
        """Return the row that the minor makes, one of its rows normal."""
        n, s, even = len(site.point), site.size, site.order == 2
        count, rank = self.planar.shape
        h = self.bends[-1]
        linear, quadratic = np.zeros(n), np.zeros((n, n))
        for a, b in itertools.permutations(range(count), 2):
            # expansion along the first column, G, and the last, the normal row
            sign = (-1.0) ** (a + b + (b > a) + rank)
            d = sign * float(np.linalg.det(np.delete(self.planar, (a, b), axis=0)) if rank else 1.0)
            # det [G | J | H u] with G = G* + r K u: G* makes the part linear in u, K u the next one
            linear += d * self.torque[a] * h[b]
            quadratic[self.creases[a]] += d * self.slope[a] * h[b]
        root, stiff = math.sqrt(count), float(np.linalg.norm(self.stiffness))
        slope = float(np.linalg.norm(self.slope))
        bow = float(np.linalg.norm(site.bow(radius)[self.creases]))
        planar = np.linalg.norm(self.planar, axis=0)
        bend = float(np.linalg.norm(np.abs(h).sum(axis=1)))
        lever = site.lever * root
        # what each column may be off, so that the determinant is (Hadamard) by prod (|A_c| + |E_c|) - prod |A_c| at
        # most
        more_planar = lever * (s * s * radius**2 / 2 if even else s * radius)
        more_bend = lever * (s**3 * radius**2 / 6 if even else s * s * radius / 2)
        rests = np.abs(self.torque).max() <= SLACK * self.stiffness.max()
        g = slope if rests else float(np.linalg.norm(self.torque)) + slope * radius
        sizes = np.array([g, *planar, bend])
        # where torques rest at x* their column is divided by r: what laws add to it is of order r only, and goes to
        # the base
        more = np.array([0.0 if rests else bow * radius**2, *([more_planar] * rank), more_bend])
        wrong = np.array([SLACK * stiff, *([CLOSURE_TOL * root] * rank), CLOSURE_TOL * root * n])
        if rests:
            wrong[0] = 2 * SLACK * stiff / DUPLICATE_TOL + bow * radius
        error = float(np.prod(sizes + more) - np.prod(sizes)) / radius**site.order
        base = float(np.prod(sizes + more + wrong) - np.prod(sizes + more))
        base += 128 * EPS * float(np.prod(sizes + more))
        if rests:
            return _Row(n, quadratic=quadratic, base=base, error=error, loose=True)
        return _Row(n, linear=linear, tilt_quadratic=quadratic, base=base, error=error)


def rows_of(minors: Sequence[_Minor], site: Site, radius: float) -> list[_Row]:
    """Return the rows that the minors of a site make: without a normal row all at once."""
    if not minors or minors[0].normal:
        return [minor.with_normal(site, radius) for minor in minors]
    n, s = len(site.point), site.size
    creases = np.array([minor.creases for minor in minors])
    torque, stiffness, steep, bends = (
        np.array([getattr(minor, name) for minor in minors])
        for name in ("torque", "stiffness", "slope", "bends")
    )
    whole = np.array([np.column_stack([minor.torque, minor.planar]) for minor in minors])
    many, count = creases.shape
    others, sign = _others(count)
    cofactors = sign * np.linalg.det(whole[:, others[:, None, :, None], others[:, None]])
    # det [G* | J], and its change along u by cofactors (Jacobi): sum_ic cof_ic dA_ic
    constant = (cofactors[:, :, 0] * torque).sum(axis=1)
    slope = np.einsum("kic,kcij->kj", cofactors[:, :, 1:], bends)
    slope[np.arange(many)[:, None], creases] += cofactors[:, :, 0] * steep
    root, stiff = math.sqrt(count), np.linalg.norm(stiffness, axis=1)[:, None]
    bow = np.linalg.norm(site.bow(radius)[creases], axis=1)[:, None]
    first = np.linalg.norm(np.abs(bends).sum(axis=3), axis=2)
    first = np.hstack([np.linalg.norm(steep, axis=1)[:, None], first])
    ones = np.ones((many, count - 1))
    second = np.hstack([bow, site.lever * s * s / 2 * root * ones])
    sizes = np.linalg.norm(whole, axis=1)
    wrong = CLOSURE_TOL * root * np.hstack([stiff, ones])
    grown = sizes + radius * first + radius**2 * second
    most = (grown + wrong).prod(axis=1)
    linear = (first * sizes[:, others].prod(axis=2)).sum(axis=1)
    rest = grown.prod(axis=1) - sizes.prod(axis=1) + 128 * EPS * most - radius * linear
    base = most - grown.prod(axis=1) + 128 * EPS * most
    doubt = CLOSURE_TOL * n * count**2 * (sizes + first + 1).prod(axis=1)  # of the slope
    loose = np.abs(constant) <= base
    divided = (np.abs(constant) + base) / DUPLICATE_TOL + rest / radius + doubt
    error = rest / radius**site.order
    return [
        _Row(n, linear=slope[k], base=float(divided[k]), loose=True)
        if loose[k]
        else _Row(
            n, float(constant[k]), tilt_linear=slope[k], base=float(base[k]), error=float(error[k])
        )
        for k in range(many)
    ]


@lru_cache
def _others(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return all numbers but each, [count, count - 1], and the signs of cofactors, [count, count]."""
    each = np.arange(count)
    rest = np.array([np.delete(each, i) for i in each])
    return rest, (-1.0) ** (each[:, None] + each)
