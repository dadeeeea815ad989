"""States closed in closed form: some fold angles are given, the last one, two or three follow.

The folded piece is a product of turns about its creases.  With the creases to be solved left flat, the others carry
their axes to u_1, u_2, ... and the end of the piece to F; closure then asks for turns about these fixed axes:

- no symmetry: Q(u_1, a) Q(u_2, b) Q(u_3, c) = T = F^-1 (three turns; Paden and Kahan's subproblems, see Murray, Li and
  Sastry, A Mathematical Introduction to Robotic Manipulation, section 3.3);
- D1: Q(u_1, a) Q(u_2, b) v = w with v = F e2, w = e2 (two turns);
- D_n, n >= 2: the angle between Q(u, a) F n_k and n_1 is pi - pi/n (one turn);
- C_n, n >= 2: the scalar part of Q(u, a) F Q(e3, 2 pi/n) is cos(pi/n) (one turn).

The first three are one spherical triangle, whose corner comes from half its perimeter: unlike cosines, that keeps
closure to rounding where the triangle is flat (a double root) or small (next to flat states).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from origami_nlp.numerics import EPS, OUTSIDE, ROUNDED, quaternion as quat
from origami_nlp.programme.closure import exact_cosine, exact_sine
from origami_nlp.programme.posed import Posed


def complete(
    model: Posed, x: np.ndarray, solve: tuple[int, ...] | np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Close states by as many of their fold angles as there are equations.

    Parameters
    ----------
    model
        Any group, flat vertex or not.
    x
        Fold angles [rad], shape [K, n]; what stands at the entries to be solved does not matter.
    solve
        The m = `equation_count` variables (0-based) to be solved, the same for all states, or shape [K, m].

    Returns
    -------
    states
        Both completions, shape [K, 2, n]; equal where the root is double.
    exists
        Of bool, shape [K, 2]; what `states` holds elsewhere means nothing.

    Notes
    -----
    States close on the sheet q = +1.  With fold limits they exist only within |phi| <= pi; what misses +-pi by rounding
    is +-pi.  A crease that closes at +pi may close at -pi as well: one of the two is returned.
    Without fold limits angles are the principal ones, except that without symmetry, where the sheet asks for it, the
    largest of the three makes a whole turn backward.
    Where a family of states closes (axes that lie on each other), one or two members are returned: a turn that does
    nothing is 0, up to rounding of the axes.
    x -> -x gives the negatives, in the other order.
    """
    x = np.array(x, dtype=float)
    piece, m = Piece(model), model.equation_count
    solve = np.sort(np.broadcast_to(np.asarray(solve, dtype=int), (len(x), m)), axis=1)
    rows = np.arange(len(x))
    turns = x * piece.share
    np.put_along_axis(turns, solve, 0.0, axis=1)
    axes, end = piece.fold(turns)
    u = [axes[solve[:, i], :, rows].T for i in range(m)]
    limits = model.has_limits
    if m == 3:
        angles, exists = _three_turns(u[0], u[1], u[2], _inverse(end), limits)
    elif m == 2:
        v, w = _rotated(end, (0.0, 1.0, 0.0)), np.array([[0.0], [1.0], [0.0]])
        *angles, exists = _two_turns(u[0], u[1], v, w)
    else:
        one, exists = piece.one_turn(u[0], end)
        angles = [one]
    states = np.repeat(x[:, None, :], 2, axis=1)
    for i in range(m):
        share = piece.share[solve[:, i]]
        states[rows, :, solve[:, i]] = (angles[i] / share).T
    exists = np.broadcast_to(exists, (2, len(x))).T
    if not limits:
        return states, exists.copy()
    solved = np.take_along_axis(states, solve[:, None, :], axis=2)
    exists = exists & (np.abs(solved) <= math.pi + OUTSIDE).all(axis=2)
    return _at_limits(piece, states, exists, solve), exists


def close_three(
    u1: np.ndarray, u2: np.ndarray, u3: np.ndarray, target: np.ndarray, limits: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Solve Q(u1, a) Q(u2, b) Q(u3, c) = target, with its sign, for the turns a, b, c.

    Parameters
    ----------
    u1, u2, u3
        Unit axes, shape [K, 3]; parallel ones are allowed.
    target
        Unit quaternions (w, x, y, z), shape [K, 4].
    limits
        Whether turns must lie within +-pi (up to `OUTSIDE` beyond, not rounded to it); else the largest of the three
        makes a whole turn backward where the sign of the target asks for it.

    Returns
    -------
    angles
        Both solutions [rad], shape [K, 2, 3].
    exists
        Of bool, shape [K, 2].
    """
    angles, exists = _three_turns(u1.T, u2.T, u3.T, target.T, limits)
    return np.stack(angles, axis=-1).transpose(1, 0, 2), np.ascontiguousarray(exists.T)


class Piece:
    """The piece of a model as a product of turns, without CasADi; components first, states last.

    rays: creases of the flat piece [n, 3].  share: turn of each over its fold angle [n].  tail: what follows the last.
    """

    def __init__(self, model: Posed) -> None:
        s, sectors = model.structure, model.parameters.sectors
        self.kind, self.order = s.kind, s.order
        count = len(s.has_crease)
        azimuth = np.concatenate([[0.0], np.cumsum(sectors[: count - 1])])
        rays = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(count)], axis=1)
        share = np.ones(count)
        if s.kind == "D":
            share[[0, -1]] = 0.5  # the mirror halves the fold angle of a crease that lies on it
            if s.flat_sheet:
                rays[-1] = exact_cosine(s.order), exact_sine(s.order), 0.0
        crease = np.array(s.has_crease)
        self.rays, self.share = rays[crease], share[crease]
        whole = math.pi if s.kind == "D" else 2 * math.pi
        gap = 0.0 if s.flat_sheet else float(sectors.sum()) - whole / s.order
        self.tail = (math.cos(gap / 2), 0.0, 0.0, math.sin(gap / 2))
        if s.kind == "C" and s.order > 1:
            half = math.pi / s.order
            self.tail = quat.multiply(self.tail, (math.cos(half), 0.0, 0.0, math.sin(half)))
        self.normal = (exact_sine(s.order), -exact_cosine(s.order), 0.0)

    def fold(self, turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Carry the creases and the end of the piece by turns [K, n]: axes [n, 3, K], quaternion [4, K]."""
        cos, sin = np.cos(turns / 2).T, np.sin(turns / 2).T
        q: Any = (np.ones(len(turns)), *np.zeros((3, len(turns))))
        axes = []
        for c, s, ray in zip(cos, sin, self.rays, strict=True):
            axes.append(quat.rotate(q, ray))
            q = quat.multiply(q, quat.fold(c, s, ray))
        return np.array(axes), np.array(quat.multiply(q, self.tail))

    def misses(self, x: np.ndarray) -> np.ndarray:
        """Largest closure residual of fold angles [K, n], [K]; infinite on the sheet q = -1."""
        _, q = self.fold(x * self.share)
        if self.kind == "C":
            if self.order > 1:
                return np.abs(q[0] - exact_cosine(self.order))
            return np.where(q[0] > 0, np.abs(q[1:]).max(axis=0), math.inf)
        if self.order == 1:
            return np.maximum(np.abs(q[1]), np.abs(q[3]))
        return np.abs(quat.rotate(tuple(q), self.normal)[1] + exact_cosine(self.order))

    def one_turn(self, u: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solve the one equation of C_n and D_n, n >= 2, for the turn about u [3, K]: angles [2, K], exists [K]."""
        sides = np.array([[1.0], [-1.0]])
        if self.kind == "D":
            v, w = _rotated(end, self.normal), np.array([[0.0], [1.0], [0.0]])
            opposite = math.pi - math.pi / self.order
            corner, exists = _corner(_between(u, v), _between(u, w), opposite)
            return _principal(_azimuth(u, v, w) + sides * corner), exists
        along = quat.dot(u, end[1:])
        reach, cosine = np.hypot(end[0], along), exact_cosine(self.order)
        spare = _cleared(reach - cosine)
        half = np.arctan2(np.sqrt(np.maximum(spare, 0.0) * (reach + cosine)), cosine)
        return 2 * _principal(sides * half - np.arctan2(along, end[0])), spare >= 0


def _at_limits(
    piece: Piece, states: np.ndarray, exists: np.ndarray, solve: np.ndarray
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
) -> tuple[list[np.ndarray], np.ndarray]:
    """`close_three` on components [3, K], [4, K]: angles [2, K] each, exists [2, K]."""
    a, b, exists = _two_turns(u1, u2, u3, _rotated(target, u3))
    rest = quat.multiply(_turn(u2, -b), quat.multiply(_turn(u1, -a), tuple(target)))
    c = 2 * np.arctan2(quat.dot(u3, rest[1:]), rest[0])  # a whole turn of it changes the sign
    wrong = np.abs(c) > math.pi + (OUTSIDE if limits else 0.0)
    angles = np.array([a, b, np.where(wrong, c - np.copysign(2 * math.pi, c), c)])
    # the sign is mended by a whole turn of one of them, which within limits leads from +-pi to -+pi only
    largest = np.abs(angles).argmax(axis=0)[None]
    size = np.take_along_axis(angles, largest, axis=0)
    turned = np.where(wrong, size - np.copysign(2 * math.pi, size), size)
    np.put_along_axis(angles, largest, turned, axis=0)
    both = np.broadcast_to(exists, a.shape)
    return list(angles), both & (np.abs(angles) <= math.pi + OUTSIDE).all(
        axis=0
    ) if limits else both


def _two_turns(
    u1: np.ndarray, u2: np.ndarray, v: np.ndarray, w: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Solve Q(u1, a) Q(u2, b) v = w: a, b [2, K], exists [K]."""
    corner, exists = _corner(_between(u2, v), _between(u2, u1), _between(u1, w))
    b = _principal(_azimuth(u2, v, u1) + np.array([[1.0], [-1.0]]) * corner)
    return _azimuth(u1, quat.rotate(_turn(u2, b), v), w), b, exists


def _corner(left: Any, right: Any, opposite: Any) -> tuple[np.ndarray, np.ndarray]:
    """Angle of a spherical triangle between two sides, and whether there is such a triangle."""
    half = (left + right + opposite) / 2
    less = [_cleared(half - side) for side in (left, right, opposite)]
    less.append(_cleared(math.pi - half))
    exists = np.min(less, axis=0) >= 0
    sines = np.maximum(np.sin(less), 0.0)
    return 2 * np.arctan2(np.sqrt(sines[0] * sines[1]), np.sqrt(sines[2] * sines[3])), exists


def _cleared(value: np.ndarray) -> np.ndarray:
    """What is only rounding of a product of folds is 0: there the two roots are one."""
    return np.where(np.abs(value) <= 16 * EPS, 0.0, value)


def _between(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Angle between unit vectors [3, K], as accurate next to 0 and pi as elsewhere."""
    apart, across = u - v, u + v
    return 2 * np.arctan2(np.sqrt((apart**2).sum(axis=0)), np.sqrt((across**2).sum(axis=0)))


def _azimuth(u: np.ndarray, v: Any, w: Any) -> np.ndarray:
    """Turn about unit u that takes v to over w, in [-pi, pi]; 0 where one of them is along u, up to rounding."""
    v, w = ([x[k] - along * u[k] for k in range(3)] for x in (v, w) for along in [quat.dot(u, x)])
    angle = np.arctan2(quat.dot(u, quat.cross(v, w)), quat.dot(v, w))
    return np.where(np.minimum(quat.dot(v, v), quat.dot(w, w)) <= (64 * EPS) ** 2, 0.0, angle)


def _principal(angle: np.ndarray) -> np.ndarray:
    """Bring angles within +-2 pi to [-pi, pi]."""
    return np.where(np.abs(angle) > math.pi, angle - np.copysign(2 * math.pi, angle), angle)


def _turn(axis: np.ndarray, angle: np.ndarray) -> Any:
    return quat.fold(np.cos(angle / 2), np.sin(angle / 2), axis)


def _inverse(q: np.ndarray) -> np.ndarray:
    return np.array([q[0], -q[1], -q[2], -q[3]])


def _rotated(q: np.ndarray, v: Any) -> np.ndarray:
    return np.array(quat.rotate(tuple(q), v))
