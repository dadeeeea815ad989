"""States closed in closed form: some fold angles are given, the last one, two or three follow.

The folded piece is a product of turns about its creases.  With the creases to be solved left flat, the others carry
their axes to u_1, u_2, ... and the end of the piece to F; closure then asks for turns about these fixed axes:

- no symmetry: Q(u_1, a) Q(u_2, b) Q(u_3, c) = T = F^-1 (three turns; Paden and Kahan's subproblems, see Murray, Li and
  Sastry, A Mathematical Introduction to Robotic Manipulation, section 3.3);
- D1: Q(u_1, a) Q(u_2, b) v = w with v = F e2, w = e2 (two turns);
- D_n, n >= 2: the angle between Q(u, a) F n_k and n_1 is pi - pi/n (one turn);
- C_n, n >= 2: the scalar part of Q(u, a) F Q(e3, 2 pi/n) is cos(pi/n) (one turn).

States that wind w times round the axis have n/w in place of n.

The first three are one spherical triangle, whose corner comes from half its perimeter: unlike cosines, that keeps
closure to rounding where the triangle is flat (a double root) or small (next to flat states).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from origami_nlp.numerics import EPS, OUTSIDE, ROUNDED, quaternion as quat
from origami_nlp.problem.closure import exact_cosine, exact_sine
from origami_nlp.problem.kinematics import from_the_right, products
from origami_nlp.problem.posed import PosedProblem

E2 = np.array([[0.0], [1.0], [0.0]])
Turns = tuple[list[np.ndarray], np.ndarray, np.ndarray]
"""Turns [2, K] each, whether they exist, [2, K] or [K], and whether they are of a family, same shape."""


def within(
    model: PosedProblem, states: np.ndarray, exists: np.ndarray, solve: tuple[int, ...] | np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Leave out completions [K, 2, n] beyond a stop; what misses one by rounding is put at it, where that closes."""
    limits = model.fold_limits
    near = np.zeros(states.shape, dtype=bool)
    solved = np.broadcast_to(solve, (len(states), np.shape(solve)[-1]))
    np.put_along_axis(near, solved[:, None].repeat(states.shape[1], 1), True, axis=2)
    near &= exists[..., None] & (np.abs(limits.room(states)) <= OUTSIDE)
    snapped = np.where(near, limits.hold(states, limits.side(states)), states)
    exact = np.asarray(near.any(axis=2))
    exact[exact] = CreaseChain(model).misses(snapped[exact]) <= ROUNDED
    states = np.where(exact[..., None], snapped, states)
    return states, exists & limits.inside(states, OUTSIDE).all(axis=2)


def close_by(
    piece: CreaseChain, limits: bool, x: np.ndarray, solve: tuple[int, ...] | np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Close states by as many of their fold angles as there are equations.

    Parameters
    ----------
    piece
        Of any group, flat vertex or not.
    limits
        Whether states exist only within +-pi; what misses one by rounding is put at it.
    x
        Fold angles [rad], shape [K, n]; what stands at the entries to be solved does not matter.
    solve
        The m = `equation_count` variables (0-based) to be solved, the same for all states, or shape [K, m].

    Returns
    -------
    states
        Both completions, shape [K, 2, n]; equal where the root is double.
    exists, family
        Of bool, shape [K, 2]: what `states` holds where it does not exist means nothing; of a family of states that
        close, the first of the turns that only their sum matters of, or the one that moves nothing, is 0.

    Notes
    -----
    States close on the lift q = +1.  A crease that closes at +pi may close at -pi as well: one of the two is returned.
    Without fold limits angles are the principal ones, except that without symmetry, where the lift q = +1 asks for it,
    the largest of the three makes a whole turn backward.
    """
    x, m = np.array(x, dtype=float), piece.equation_count
    solve = np.sort(np.broadcast_to(np.asarray(solve, dtype=int), (len(x), m)), axis=1)
    u, end = piece.axes(x, solve)
    # turns about given axes that undo the rest: two sets of them at most
    if m == 3:
        angles, exists, family = _three_turns(u[0], u[1], u[2], _inverse(end), limits)
    elif m == 2:
        angles, exists, family = _two_turns(u[0], u[1], _rotated(end, E2[:, 0]), E2)
    else:
        angles, exists, family = piece.one_turn(u[0], end)
    states = np.repeat(x[:, None, :], 2, axis=1)
    for i in range(m):
        share = piece.share[solve[:, i]]
        states[np.arange(len(x)), :, solve[:, i]] = (angles[i] / share).T
    exists, family = (np.broadcast_to(mask, (2, len(x))).T.copy() for mask in (exists, family))
    if limits:
        solved = np.take_along_axis(states, solve[:, None, :], axis=2)
        exists &= (np.abs(solved) <= math.pi + OUTSIDE).all(axis=2)
        states = at_limits(piece, states, exists, solve)
    return states, exists, family


class CreaseChain:
    """The piece of a model as a product of turns, without CasADi; components first, states last.

    rays: creases of the flat piece [n, 3].  share: turn of each over its fold angle [n].  tail: what follows the last.
    """

    def __init__(self, model: PosedProblem) -> None:
        s, sectors = model.structure, model.parameters.sectors
        self.kind, self.order, self.equation_count = s.kind, s.turn, model.equation_count
        count = len(s.has_crease)
        azimuth = np.concatenate([[0.0], np.cumsum(sectors[: count - 1])])
        rays = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(count)], axis=1)
        share = np.ones(count)
        if s.kind == "D":
            share[[0, -1]] = 0.5  # the mirror halves the fold angle of a crease that lies on it
            if s.flat_piece:
                rays[-1] = exact_cosine(s.turn), exact_sine(s.turn), 0.0
        crease = np.array(s.has_crease)
        self.rays, self.share = rays[crease], share[crease]
        self._right = from_the_right(self.rays)
        whole = math.pi if s.kind == "D" else 2 * math.pi
        gap = 0.0 if s.flat_piece else float(sectors.sum()) - whole / s.turn
        self.tail = (math.cos(gap / 2), 0.0, 0.0, math.sin(gap / 2))
        if s.kind == "C" and s.turn > 1:
            half = math.pi / s.turn
            self.tail = quat.multiply(self.tail, (math.cos(half), 0.0, 0.0, math.sin(half)))
        self.normal = (exact_sine(s.turn), -exact_cosine(s.turn), 0.0)

    def fold(self, turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Carry the creases and the end of the piece by turns [K, n]: axes [n, 3, K], quaternion [4, K]."""
        before = products(self._right, turns.T)
        axes = np.array(quat.rotate([*before[:-1].swapaxes(0, 1)], [*self.rays.T[..., None]]))
        return axes.swapaxes(0, 1), np.array(quat.multiply([*before[-1]], self.tail))

    def axes(self, x: np.ndarray, solve: np.ndarray) -> tuple[list[Any], Any]:
        """Fold with the creases solve [K, m] flat: their axes, m times [3, K], and the end of the piece [4, K]."""
        turns = x * self.share
        np.put_along_axis(turns, solve, 0.0, axis=1)
        axes, end = self.fold(turns)
        rows = np.arange(len(x))
        return [axes[solve[:, i], :, rows].T for i in range(solve.shape[1])], end

    def misses(self, x: np.ndarray) -> np.ndarray:
        """Largest closure residual of fold angles [K, n], [K]; infinite on the lift q = -1."""
        return self.misses_of(self.fold(x * self.share)[1])

    def misses_of(self, q: np.ndarray) -> np.ndarray:
        """Largest closure residual of ends of the piece [4, K], [K]; infinite on the lift q = -1."""
        if self.kind == "C":
            if self.order > 1:
                return np.abs(q[0] - exact_cosine(self.order))
            return np.where(q[0] > 0, np.abs(q[1:]).max(axis=0), math.inf)
        if self.order == 1:
            return np.maximum(np.abs(q[1]), np.abs(q[3]))
        return np.abs(quat.rotate(tuple(q), self.normal)[1] + exact_cosine(self.order))

    def slopes(self, axes: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Derivatives of the one equation of C_n and D_n, n >= 2, by turns about axes [K, n, 3]: [K, n]."""
        if self.kind == "C":
            return -0.5 * np.einsum("kni,ik->kn", axes, end[1:])
        # (axis x h) . e2
        h = _rotated(end, self.normal)
        return axes[:, :, 2] * h[0][:, None] - axes[:, :, 0] * h[2][:, None]

    def fewer_turns(self, x: np.ndarray, solve: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Fold angles [K, k], k < m, that close x if any do, and whether they are of a family, [K]."""
        u, end = self.axes(x, solve)
        turns, family = [], np.zeros(len(x), dtype=bool)
        if len(u) == 2 or (u and self.order == 1 and self.kind == "D"):
            # the first turn takes the last axis, or the mirror's normal, to where it has to be
            v = u[1] if len(u) == 2 else _rotated(end, E2[:, 0])
            w = _rotated(_inverse(end), u[1]) if len(u) == 2 else E2
            a, family = _azimuth(u[0], v, w)
            turns.append(a)
        if u and self.kind == "C":
            # turns that are known are taken off from the left; what remains is the turn about the last axis
            q: Any = tuple(_inverse(end))
            for axis, a in zip(u, turns, strict=False):
                q = quat.multiply(_turn(axis, -a), q)
            turns.append(last_turn(u[-1], q))
        return np.array(turns).reshape(len(u), len(x)).T / self.share[solve], family

    def meetings(self, variable: int) -> tuple[np.ndarray, np.ndarray]:
        """Fold angles of a variable at which its two completions by all others meet, for one degree of freedom.

        Returns the angles within +-pi (twice that where the crease lies on a mirror, or for C_n) [M], and whether
        they only touch there: two curves cross, or an isolated state; else one curve turns back.
        """
        others = np.delete(np.arange(len(self.rays)), variable)
        x = np.zeros((3, len(self.rays)))
        x[:, variable] = np.array([0.0, 2.0, -2.0]) * math.pi / 3 / self.share[variable]
        u, end = self.axes(x, np.tile(others, (3, 1)))
        if self.kind == "C" and self.order > 1:
            # the two roots of `one_turn` are one where its `reach` is |cos(pi/n)|
            values = end[0] ** 2 + quat.dot(u[0], end[1:]) ** 2
            bounds = np.array([exact_cosine(self.order) ** 2])
        else:
            sides = np.cos(self._sides(u, end))
            moving = int(np.ptp(sides, axis=1).argmax())
            values = sides[moving]
            first, second = np.arccos(np.clip(np.delete(sides[:, 0], moving), -1.0, 1.0))
            # the triangle is flat where one side is the sum or the difference of the others: both completions are one
            bounds = np.cos([first + second, first - second])
        # values = mean + size cos(turn - start): one side of a triangle against the angle that faces it
        mean, even, odd = (
            values.mean(),
            (2 * values[0] - values[1] - values[2]) / 3,
            values[1] - values[2],
        )
        size, start = math.hypot(even, odd / math.sqrt(3)), math.atan2(odd / math.sqrt(3), even)
        if size <= 16 * EPS:
            return np.zeros(0), np.zeros(0, dtype=bool)
        cosine = (bounds - mean) / size
        touching = np.abs(np.abs(cosine) - 1) <= 16 * EPS / size
        cosine = np.where(touching, np.sign(cosine), cosine)[np.abs(cosine) <= 1 + 16 * EPS / size]
        touching = touching[np.abs((bounds - mean) / size) <= 1 + 16 * EPS / size]
        angle = start + np.arccos(cosine)[:, None] * np.array([1.0, -1.0])
        angle = _principal(angle) / self.share[variable]
        both = angle.ravel(), np.repeat(touching, 2)
        if self.kind == "C" and self.order > 1:  # a whole turn changes the half angle's sign
            return np.concatenate([both[0], both[0] - np.copysign(2 * math.pi, both[0])]), np.tile(
                both[1], 2
            )
        return both

    def _sides(self, u: list[Any], end: Any) -> np.ndarray:
        """Sides of the triangle behind two completions, [3, K]."""
        if len(u) == 3:
            ends = u[0], _rotated(_inverse(end), u[2]), u[1], u[2]
        elif len(u) == 2:
            ends = u[0], np.broadcast_to(E2, u[0].shape), u[1], _rotated(end, E2[:, 0])
        else:
            v, w = _rotated(end, self.normal), np.broadcast_to(E2, u[0].shape)
            third = np.full(u[0].shape[1], math.pi - math.pi / self.order)
            return np.array([_between(u[0], v), _between(u[0], w), third])
        a, w, b, v = ends
        return np.array([_between(b, v), _between(b, a), _between(a, w)])

    def one_turn(self, u: Any, end: Any) -> Turns:
        """Solve the one equation of C_n and D_n, n >= 2, for the turn about u [3, K]."""
        sides = np.array([[1.0], [-1.0]])
        if self.kind == "D":
            v = _rotated(end, self.normal)
            corner, exists = _corner(
                _between(u, v), _between(u, E2), math.pi - math.pi / self.order
            )
            toward, lost = _azimuth(u, v, E2)
            return [_principal(toward + sides * corner)], exists, lost
        along = quat.dot(u, end[1:])
        # f0 cos(a/2) - (u . f) sin(a/2) = reach cos(a/2 + atan2(u . f, f0)) shall be cos(pi/n); the arc cosine of
        # cos(pi/n) / reach is written as an arc tangent, since reach - |cos(pi/n)| is small next to double roots
        reach, cosine = np.hypot(end[0], along), exact_cosine(self.order)
        spare = _cleared(reach - abs(cosine))
        half = np.arctan2(np.sqrt(np.maximum(spare, 0.0) * (reach + abs(cosine))), cosine)
        lost = reach <= 16 * EPS  # C2 only
        half = np.where(lost, 0.0, sides * half - np.arctan2(along, end[0]))
        return [2 * _principal(half)], spare >= 0, lost


def at_limits(
    piece: CreaseChain, states: np.ndarray, exists: np.ndarray, solve: np.ndarray
) -> np.ndarray:
    """Set solved fold angles that miss +-pi by rounding to it, where closure stays at rounding."""
    solved = np.zeros((len(states), 1, states.shape[2]), dtype=bool)
    np.put_along_axis(solved, solve[:, None, :], True, axis=2)
    near = solved & exists[..., None] & (np.abs(np.abs(states) - math.pi) <= OUTSIDE)
    where = near.any(axis=2)
    snapped = np.where(near, np.copysign(math.pi, states), states)
    where[where] = piece.misses(snapped[where]) <= ROUNDED
    return np.where(where[..., None], snapped, states)


def _three_turns(
    u1: np.ndarray, u2: np.ndarray, u3: np.ndarray, target: np.ndarray, limits: bool
) -> Turns:
    """`close_three` on components [3, K], [4, K]."""
    # the third turn leaves its own axis: the first two take u3 to T u3, and what is then left is a turn about u3
    (a, b), exists, family = _two_turns(u1, u2, u3, _rotated(target, u3))
    c = last_turn(u3, quat.multiply(_turn(u2, -b), quat.multiply(_turn(u1, -a), tuple(target))))
    wrong = np.abs(c) > math.pi + (OUTSIDE if limits else 0.0)
    angles = np.array([a, b, np.where(wrong, c - np.copysign(2 * math.pi, c), c)])
    # the sign is mended by a whole turn of one of them, which within limits leads from +-pi to -+pi only
    largest = np.abs(angles).argmax(axis=0)[None]
    size = np.take_along_axis(angles, largest, axis=0)
    turned = np.where(wrong, size - np.copysign(2 * math.pi, size), size)
    np.put_along_axis(angles, largest, turned, axis=0)
    exists = np.broadcast_to(exists, a.shape)
    if limits:
        exists = exists & (np.abs(angles) <= math.pi + OUTSIDE).all(axis=0)
    return list(angles), exists, family


def _two_turns(u1: Any, u2: Any, v: Any, w: Any) -> Turns:
    """Solve Q(u1, a) Q(u2, b) v = w."""
    # triangle u1, u2, Q(u2, b) v: turns about u1 keep the distance from u1, so the third side is that from u1 to w;
    # the corner at u2 says how far v turns from over u1, and the mirror image of the triangle is the second solution
    corner, exists = _corner(_between(u2, v), _between(u2, u1), _between(u1, w))
    toward, lost = _azimuth(u2, v, u1)
    b = _principal(toward + np.array([[1.0], [-1.0]]) * corner)
    a, lost_too = _azimuth(u1, quat.rotate(_turn(u2, b), v), w)
    return [a, b], exists, lost | lost_too


def last_turn(u: Any, q: Any) -> np.ndarray:
    """Turn about u [3, K] nearest to the rotation q, in [-2 pi, 2 pi]: a whole turn of it changes the sign of q."""
    return 2 * np.arctan2(quat.dot(u, q[1:]), q[0])


# tan^2(A/2) = sin(s - b) sin(s - c) / (sin s sin(s - a)), s half the perimeter of the triangle with sides a, b, c
def _corner(left: Any, right: Any, opposite: Any) -> tuple[np.ndarray, np.ndarray]:
    """Angle of a spherical triangle between two sides, and whether there is such a triangle."""
    half = (left + right + opposite) / 2
    less = [_cleared(half - side) for side in (left, right, opposite)]
    less.append(_cleared(math.pi - half))
    # three triangle inequalities, and a perimeter of 2 pi at most
    exists = np.min(less, axis=0) >= 0
    sines = np.maximum(np.sin(less), 0.0)
    return 2 * np.arctan2(np.sqrt(sines[0] * sines[1]), np.sqrt(sines[2] * sines[3])), exists


def _cleared(value: np.ndarray) -> np.ndarray:
    """What is only rounding of a product of folds is 0: there the two roots are one."""
    return np.where(np.abs(value) <= 16 * EPS, 0.0, value)


def _between(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Angle between unit vectors [3, K], as accurate next to 0 and pi as elsewhere."""
    # tan(angle / 2) = |u - v| / |u + v|; the arc cosine of u . v would lose half of the digits at both ends
    apart, across = u - v, u + v
    return 2 * np.arctan2(np.sqrt((apart**2).sum(axis=0)), np.sqrt((across**2).sum(axis=0)))


def _azimuth(u: Any, v: Any, w: Any) -> tuple[np.ndarray, np.ndarray]:
    """Turn about unit u that takes v to over w, in [-pi, pi]; 0, and True, where one of them is along u."""
    v, w = ([x[k] - along * u[k] for k in range(3)] for x in (v, w) for along in [quat.dot(u, x)])
    angle = np.arctan2(quat.dot(u, quat.cross(v, w)), quat.dot(v, w))
    lost = (
        np.minimum(quat.dot(v, v), quat.dot(w, w)) <= (16 * EPS) ** 2
    )  # rounding of a product of folds
    return np.where(lost, 0.0, angle), lost


def _principal(angle: np.ndarray) -> np.ndarray:
    """Bring angles within +-2 pi to [-pi, pi]."""
    return np.where(np.abs(angle) > math.pi, angle - np.copysign(2 * math.pi, angle), angle)


def _turn(axis: Any, angle: np.ndarray) -> Any:
    return quat.fold(np.cos(angle / 2), np.sin(angle / 2), axis)


def _inverse(q: np.ndarray) -> np.ndarray:
    return np.array([q[0], -q[1], -q[2], -q[3]])


def _rotated(q: np.ndarray, v: Any) -> np.ndarray:
    return np.array(quat.rotate(tuple(q), v))
