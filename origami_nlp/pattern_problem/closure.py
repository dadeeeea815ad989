"""Loop closure of a pattern in closed form, with first and second derivatives, sparse.

Facets move rigidly from their reference state.  A walk crosses crease i with direction b_i through the point p_i,
turning by delta_i = phi_i less the reference angle; round a loop these turns must cancel: the product of the
quaternions (cos delta_i/2, sin delta_i/2 b_i) has no vector part, and round a hole the product of the motions has no
translation either: once round a tube that by which the reference state, laid out, is off, and a turn of 360 degrees.
With c_i the axis where the turns before it have brought it, and o_i a point on it,

    dq/dphi_i = 1/2 c_i q,                      d2q/dphi_i dphi_j = 1/4 c_i c_j q           (i <= j in the walk),
    dt/dphi_i = c_i x (t - o_i),                d2t/dphi_i dphi_j = c_i x (c_j x (t - o_j)).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy as sp

from origami_nlp.numerics import CLOSURE_TOL, Matrix, cross
from origami_nlp.pattern import Loop, Pattern
from origami_nlp.pattern_problem.compiled_closure import CompiledClosure
from origami_nlp.pattern_problem.orbits import Orbits
from origami_nlp.problem import LoopClosure

MOST_DENSE_ROWS = 150
"""Creases up to which matrices are dense arrays: sparse ones cost more to set up than they save."""


UNITS = np.array(
    [
        [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1], [0, 0, -1, 0]],
        [[0, 0, -1, 0], [0, 0, 0, -1], [1, 0, 0, 0], [0, 1, 0, 0]],
        [[0, 0, 0, -1], [0, 0, 1, 0], [0, -1, 0, 0], [1, 0, 0, 0]],
    ],
    float,
)
"""Matrices of q -> q i, q -> q j, q -> q k on quaternions, the real part first."""


@dataclass(frozen=True, eq=False)
class _Group:
    """Loops of the same length d: creases [K, d], axes and points of the reference state [K, d, 3], first rows [K].

    `products` are the matrices q -> q (0, axis), [K, d, 4, 4]; q begins with `start` [K], -1 round a tube, where
    `moved` [K, 3] is added to the translation.  Creases are those variables that fold them; signs and `reference`
    angles [K, d] are of the variables.
    """

    creases: np.ndarray
    signs: np.ndarray
    axes: np.ndarray
    products: np.ndarray
    points: np.ndarray | None
    rows: np.ndarray
    start: np.ndarray
    moved: np.ndarray
    reference: np.ndarray


@dataclass(frozen=True, eq=False)
class _Turned:
    """A group at a state: products q [K, 4]; for holes translation t [K, 3], points o [K, d, 3].

    `before` are products up to each crease, `turned` those times its axis, [K, d, 4].
    """

    q: np.ndarray
    before: np.ndarray
    turned: np.ndarray
    t: np.ndarray | None = None
    o: np.ndarray | None = None

    @cached_property
    def c(self) -> np.ndarray:
        """Axes where the turns before them have brought them, vec(q axis q*), [K, d, 3]; values do not need them."""
        before, turned = self.before, self.turned
        v = turned[..., 1:]
        return before[..., :1] * v - turned[..., :1] * before[..., 1:] - cross(v, before[..., 1:])


@dataclass(frozen=True, eq=False)
class _Form:
    """Where entries of a matrix of so many rows go: the place of each among those stored.

    Dense matrices store all; sparse ones, row by row, `columns` [K], those of each row from `first` on [rows + 1].
    """

    rows: int
    slots: np.ndarray
    columns: np.ndarray
    first: np.ndarray


def _form(rows: list[np.ndarray], columns: list[np.ndarray], m: int, n: int) -> _Form:
    """Lay out a matrix [m, n] for entries at these places; those at one place are added up."""
    # row * n + column: sorted codes are the entries of a compressed row matrix, in order
    codes = np.concatenate(rows) * n + np.concatenate(columns)
    if n <= MOST_DENSE_ROWS:
        return _Form(m, codes, np.zeros(0, int), np.zeros(0, int))
    stored, slots = np.unique(codes, return_inverse=True)
    first = np.searchsorted(stored, np.arange(m + 1) * n)
    return _Form(m, slots, (stored % n).astype(np.int32), first.astype(np.int32))


class Closure:
    """The closure equations of a pattern.

    Parameters
    ----------
    pattern
        The pattern.
    orbits
        Of states that keep a symmetry: what is a fold angle here is then a variable.

    Attributes
    ----------
    variables
        Number of variables n.
    count
        Number of equations m: three for each interior vertex and each lattice vector of a cell, six for each hole.
    size
        Largest coordinate from the middle, over which translations are.
    lifted
        The state that was last projected, as bytes, and whether loops lift to one there.
    """

    def __init__(self, pattern: Pattern, orbits: Orbits | None = None) -> None:
        self.pattern, self.orbits = pattern, orbits
        self.variables = pattern.creases if orbits is None else orbits.variables
        turning = (*pattern.vertices, *pattern.generators)
        self.count = 3 * len(turning) + 6 * len(pattern.holes)
        self._groups = []
        row = 0
        for loops, rows in ((turning, 3), (pattern.holes, 6)):
            by_length: dict[int, list[tuple[int, Loop]]] = {}
            for loop in loops:
                by_length.setdefault(len(loop.creases), []).append((row, loop))
                row += rows
            for members in by_length.values():
                self._groups.append(self._group(members, rows == 6))
        self._last: tuple[bytes, list[_Turned]] | None = None
        self.lifted: tuple[bytes, bool] | None = None
        away = pattern.corners - pattern.corners.mean(axis=0)
        self.size = float(np.abs(away).max(initial=0.0)) or 1.0

    def _group(self, members: list[tuple[int, Loop]], hole: bool) -> _Group:
        p = self.pattern
        creases = np.array([loop.creases for _, loop in members], int)
        signs = np.array([loop.signs for _, loop in members], float)
        points = p.corners[p.ends[creases, 0]] if hole else None
        directions, reference = p.directions[creases], p.reference[creases]
        if self.orbits is not None:
            # the turn s y - r about d is the turn y - s r about s d
            s = self.orbits.sign[creases]
            signs, reference, creases = signs * s, reference * s, self.orbits.orbit[creases]
        # a turn from left to right about d is one from right to left about -d: the sign goes into the axis
        axes = signs[..., None] * directions
        if points is not None and p.cell:
            points = points + np.array([loop.shifts for _, loop in members]) @ p.cell.lattice
        moved = np.array([loop.moved or (0.0, 0.0, 0.0) for _, loop in members])
        return _Group(
            creases,
            signs,
            axes,
            np.einsum("kdi,iab->kdab", axes, UNITS),
            points,
            np.array([row for row, _ in members], int),
            np.array([-1.0 if loop.moved else 1.0 for _, loop in members]),
            moved,
            reference,
        )

    @cached_property
    def compiled(self) -> CompiledClosure:
        """Steps onto it in C."""
        return CompiledClosure(self.tables(), self.size, self.variables)

    def tables(self) -> dict[str, np.ndarray]:
        """Return the loops, one after the other, as arrays.

        Of each turn, [E]: `crease`, the loop that it is `of`, signed `axis` and `point` [E, 3], `reference` angle; of
        each loop, [L]: the `first` turn, the end of all in addition, the first `row`, how many `rows`, `start` and
        `moved` [L, 3].
        """
        every = [(g, k) for g in self._groups for k in range(len(g.creases))]
        long = np.array([g.creases.shape[1] for g, _ in every], int)
        points = (np.zeros_like(g.axes) if g.points is None else g.points for g in self._groups)
        return {
            "crease": np.concatenate(
                [g.creases.ravel() for g in self._groups] or [np.zeros(0, int)]
            ),
            "of": np.repeat(np.arange(len(every)), long),
            "axis": np.concatenate(
                [*(g.axes.reshape(-1, 3) for g in self._groups), np.zeros((0, 3))]
            ),
            "point": np.concatenate([*(x.reshape(-1, 3) for x in points), np.zeros((0, 3))]),
            "first": np.cumsum([0, *long]),
            "row": np.array([g.rows[k] for g, k in every], int),
            "rows": np.array([3 if g.points is None else 6 for g, _ in every], int),
            "reference": np.concatenate(
                [*(g.reference.ravel() for g in self._groups), np.zeros(0)]
            ),
            "start": np.concatenate([*(g.start for g in self._groups), np.zeros(0)]),
            "moved": np.concatenate([*(g.moved for g in self._groups), np.zeros((0, 3))]),
        }

    def _turn(self, g: _Group, phi: np.ndarray) -> _Turned:
        half = 0.5 * (phi[g.creases] - g.reference)
        cos, sin = np.cos(half)[..., None], np.sin(half)[..., None]
        count, d = g.creases.shape
        q, turned = np.empty((count, d + 1, 4)), np.empty((count, d, 4))  # q_i and q_i (0, axis)
        q[:, 0, 0], q[:, 0, 1:] = g.start, 0.0
        for i in range(d):
            # q (cos + sin b) = cos q + sin (q b)
            turned[:, i] = np.einsum("kab,kb->ka", g.products[:, i], q[:, i])
            q[:, i + 1] = cos[:, i] * q[:, i] + sin[:, i] * turned[:, i]
        before = q[:, :-1]
        if g.points is None:
            return _Turned(q[:, -1], before, turned)
        # a turn r about an axis through p is x -> p + r (x - p); carried by Q it adds Q p - Q r p to the translation
        near, far = _rotate(before, g.points), _rotate(q[:, 1:], g.points)
        t = np.zeros((count, d + 1, 3))
        np.cumsum(near - far, axis=1, out=t[:, 1:])
        return _Turned(q[:, -1], before, turned, t[:, -1], t[:, :-1] + near)

    def turned(self, phi: np.ndarray) -> list[_Turned]:
        """Turn along every loop at a state [n]; what values and derivatives are made of."""
        key = phi.tobytes()
        if self._last is None or self._last[0] != key:
            # values, derivatives and tests of one state ask for it in turn
            self._last = key, [self._turn(g, phi) for g in self._groups]
        return self._last[1]

    def values(self, phi: np.ndarray, at: list[_Turned] | None = None) -> np.ndarray:
        """Evaluate closure at a state [n], shape [m]: vec q of each loop, and t over the size of the sheet."""
        out = np.zeros(self.count)
        for g, s in zip(self._groups, at or self.turned(phi), strict=True):
            out[g.rows[:, None] + np.arange(3)] = s.q[:, 1:]
            if s.t is not None:
                # over the sheet's size, so that rows of translation are angles like those of rotation
                out[g.rows[:, None] + np.arange(3, 6)] = (s.t + g.moved) / self.size
        return out

    def closes(self, phi: np.ndarray) -> bool:
        """Return whether every loop closes with q = +1."""
        return bool(np.abs(self.values(phi)).max(initial=0.0) <= CLOSURE_TOL) and self.lifts_to_one(
            phi
        )

    def lifts_to_one(self, phi: np.ndarray) -> bool:
        """Return whether every loop closes with q = +1, as the reference state does (q = -1 is no sheet of paper)."""
        if self.lifted is not None and self.lifted[0] == phi.tobytes():
            return self.lifted[1]
        return all((s.q[:, 0] > 0).all() for s in self.turned(phi))

    def __call__(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate the equations [m] and their Jacobian [m, n] at a state; dense."""
        if self.compiled.usable:
            values, jacobian, lifts = self.compiled.equations(phi)
            self.lifted = phi.tobytes(), lifts
            return values, jacobian
        at = self.turned(phi)
        j = self.jacobian(phi, at)
        return self.values(phi, at), j if isinstance(j, np.ndarray) else j.toarray()

    def loops(self, phi: np.ndarray) -> list[LoopClosure]:
        """Return closure to second order at a closed state [n], of each loop; of each hole to first order."""
        found: dict[int, LoopClosure] = {}
        for g, s in zip(self._groups, self.turned(phi), strict=True):
            slopes = self._derivatives(s).swapaxes(1, 2)
            bent = np.zeros((*slopes.shape, slopes.shape[2]))
            if g.points is None:  # with q = 1: vec(c_i c_j) / 4 for i before j
                bent = 0.25 * np.moveaxis(cross(s.c[:, :, None], s.c[:, None]), 3, 1)
                bent = np.triu(bent, 1)
                bent = bent + bent.swapaxes(2, 3)
            for k, row in enumerate(g.rows.tolist()):
                found[row] = _once(LoopClosure(g.creases[k], slopes[k], bent[k]))
        return [found[row] for row in sorted(found)]

    def axes(self, phi: np.ndarray) -> list[np.ndarray]:
        """Return the axes of the creases round each interior vertex where a state [n] has brought them, [d, 3] each.

        In the frame of the facet at which the loop begins, with the signs of the loop.
        """
        found: dict[int, np.ndarray] = {}
        for g, s in zip(self._groups, self.turned(phi), strict=True):
            if g.points is None:
                found.update(zip(g.rows.tolist(), s.c, strict=True))
        return [found[row] for row in sorted(found)]

    def _derivatives(self, s: _Turned) -> np.ndarray:
        """Derivative of a group's equations by each of its turns, [K, d, 3 or 6]."""
        # vec(c q) = q0 c + c x qv, also off closure, where q is not 1
        q0, qv = s.q[:, 0], s.q[:, None, 1:]
        out = 0.5 * (q0[:, None, None] * s.c + cross(s.c, qv))
        if s.t is None or s.o is None:
            return out
        return np.concatenate([out, cross(s.c, s.t[:, None] - s.o) / self.size], axis=2)

    def jacobian(self, phi: np.ndarray, at: list[_Turned] | None = None) -> Matrix:
        """Evaluate the Jacobian at a state [n], [m, n]; sparse beyond `MOST_DENSE_ROWS` creases."""
        data = [self._derivatives(s).ravel() for s in (at or self.turned(phi))]
        return self._matrix(data, self._places)

    def _matrix(self, data: list[np.ndarray], form: _Form) -> Matrix:
        """Add up entries at their places in a matrix."""
        n = self.variables
        values = np.concatenate([*data, np.zeros(0)])
        if n > MOST_DENSE_ROWS:
            filled = np.bincount(form.slots, values, len(form.columns))
            return sp.sparse.csr_array((filled, form.columns, form.first), shape=(form.rows, n))
        return np.bincount(form.slots, values, form.rows * n).reshape(form.rows, n)

    @cached_property
    def _places(self) -> _Form:
        """Places of the entries of the Jacobian."""
        rows, columns = [np.zeros(0, int)], [np.zeros(0, int)]
        for g in self._groups:
            r = 6 if g.points is not None else 3
            count, d = g.creases.shape
            shape = count, d, r
            rows.append(np.broadcast_to((g.rows[:, None] + np.arange(r))[:, None], shape).ravel())
            columns.append(np.broadcast_to(g.creases[:, :, None], shape).ravel())
        return _form(rows, columns, self.count, self.variables)

    @cached_property
    def _pairs(self) -> _Form:
        """Places of the entries of the Hessian."""
        rows, columns = [np.zeros(0, int)], [np.zeros(0, int)]
        for g in self._groups:
            count, d = g.creases.shape
            # creases that two loops share give entries at one place: they are added
            rows.append(np.broadcast_to(g.creases[:, :, None], (count, d, d)).ravel())
            columns.append(np.broadcast_to(g.creases[:, None, :], (count, d, d)).ravel())
        return _form(rows, columns, self.variables, self.variables)

    def hessian(
        self, phi: np.ndarray, multipliers: np.ndarray, at: list[_Turned] | None = None
    ) -> Matrix:
        """Evaluate the Hessian of multipliers . closure at a state [n], [n, n]; multipliers [m]."""
        if at is None and self.variables <= MOST_DENSE_ROWS and self.compiled.usable:
            return self.compiled.hessian(phi, multipliers)
        data = []
        for g, s in zip(self._groups, at or self.turned(phi), strict=True):
            rows = 3 if s.t is None or s.o is None else 6
            lam = multipliers[g.rows[:, None] + np.arange(rows)]
            data.append(self._bent_by(s, lam).ravel())
        return self._matrix(data, self._pairs)

    def second(self, phi: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Evaluate the second derivatives of the equations along directions z [n, t] at a state [n], [m, t, t]."""
        out = np.zeros((self.count, z.shape[1], z.shape[1]))
        for g, s in zip(self._groups, self.turned(phi), strict=True):
            bent, here = self._bent(s), z[g.creases]
            forms = np.einsum("kijr,kit,kju->krtu", bent, here, here, optimize=True)
            out[g.rows[:, None] + np.arange(bent.shape[3])] = forms
        return out

    def _bent_by(self, s: _Turned, lam: np.ndarray) -> np.ndarray:
        """Second derivatives of lam [K, 3 or 6] . a group's equations by its turns, [K, d, d]: `_bent` @ lam."""
        force, qv, c = lam[:, :3], s.q[:, 1:], s.c
        # lam . vec(c_i c_j q) = c_i . (c_j x u) - (c_i . c_j) (lam . vec q), u = q_0 lam + vec q x lam
        u = s.q[:, :1] * force + cross(qv, force)
        right = cross(c, u[:, None]) - np.einsum("ka,ka->k", qv, force)[:, None, None] * c
        h = 0.25 * (c @ right.transpose(0, 2, 1))
        if s.t is not None and s.o is not None:
            arm = cross(c, s.t[:, None] - s.o) / self.size
            h += c @ cross(arm, lam[:, None, 3:]).transpose(0, 2, 1)
        i, j = np.tril_indices(h.shape[1], -1)
        h[:, i, j] = h[:, j, i]
        return h

    def _bent(self, s: _Turned) -> np.ndarray:
        """Second derivatives of a group's equations by its turns, [K, d, d, 3 or 6]."""
        q0, qv = s.q[:, 0, None, None, None], s.q[:, None, None, 1:]
        # vec(c_i c_j q), c_i c_j = (-c_i . c_j, c_i x c_j)
        dots = np.einsum("kia,kja->kij", s.c, s.c)[..., None]
        crosses = cross(s.c[:, :, None], s.c[:, None])
        h = 0.25 * (q0 * crosses + cross(crosses, qv) - dots * qv)
        if s.t is not None and s.o is not None:
            arm = cross(s.c, s.t[:, None] - s.o) / self.size
            h = np.concatenate([h, cross(s.c[:, :, None], arm[:, None])], axis=3)
        # formulas hold for i before j in the walk: the upper triangle, mirrored
        d = h.shape[1]
        i, j = np.tril_indices(d, -1)
        h[:, i, j] = h[:, j, i]
        return h


def _once(loop: LoopClosure) -> LoopClosure:
    """Return closure of a loop by its variables, each once where it folds several creases."""
    variables, place = np.unique(loop.variables, return_inverse=True)
    if len(variables) == len(place):
        return loop
    e = np.eye(len(variables))[place]
    return LoopClosure(variables, loop.jacobian @ e, e.T @ loop.hessians @ e)


def _rotate(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Rotate vectors [..., 3] by unit quaternions [..., 4]."""
    t = 2 * cross(q[..., 1:], v)
    return v + q[..., :1] * t + cross(q[..., 1:], t)
