"""Closed forms of a long chain for many states at once: every derivative is a product of deformed creases.

With q the product of all folds and c_i the deformed creases (the axis about which crease i turns what follows it),

    dq/dphi_i = 1/2 c_i q,      d2q/dphi_i dphi_j = 1/4 c_i c_j q    (i <= j, quaternion products),

so that closure, vec q = 0, has first and second derivatives without another fold.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import cross, quaternion as quat
from origami_nlp.problem.posed import PosedProblem

FEW, LONG = 32, 24
"""Up to so many states of a chain of more rays than this are folded by products of neighbours: fewer calls."""


@dataclass(frozen=True, eq=False)
class FoldedChain:
    """K folded vertices.

    Attributes
    ----------
    axes
        Deformed creases, shape [K, n, 3].
    end
        Quaternion of the product of all folds, shape [K, 4].
    """

    axes: np.ndarray
    end: np.ndarray


class Kinematics:
    """Closure of a vertex without symmetry, and its derivatives, at states [K, n].

    Parameters
    ----------
    model
        The posed scene: its sector angles are read.

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp.pattern import Scene, Vertex
    >>> from origami_nlp.problem import Kinematics, Model
    >>> model = Model(Scene(Vertex.from_degrees((70, 80, 120, 90)), (1,) * 4, (0,) * 4, "none", "fold-limits"))
    >>> at = Kinematics(model).fold(np.zeros((1, 4)))
    >>> Kinematics(model).closure(at)[0].shape
    (1, 3)
    """

    def __init__(self, model: PosedProblem) -> None:
        sectors = np.array(model.parameters.sectors)
        azimuth = np.concatenate([[0.0], np.cumsum(sectors)[:-1]])
        self._flat = np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=1)
        self._flat[0] = (1.0, 0.0, 0.0)
        self._right = from_the_right(self._flat)
        # a cone closes with the turn by which it falls short of flat paper
        excess = 0.0 if model.structure.flat_piece else float(sectors.sum()) - 2 * math.pi
        self._onward = (math.cos(excess / 2), 0.0, 0.0, math.sin(excess / 2))

    def fold(self, x: np.ndarray) -> FoldedChain:
        """Fold states x [K, n] [rad]."""
        together = len(x) <= FEW and len(self._flat) > LONG
        before = _in_levels(self._flat, x.T) if together else products(self._right, x.T)
        end = np.array(quat.multiply([*before[-1]], [*self._onward]))
        axes = np.empty((3, len(self._flat), len(x)))
        turn_in_plane(before[:-1], self._flat, axes)
        return FoldedChain(np.ascontiguousarray(axes.T), end.T)

    def closure(self, at: FoldedChain) -> tuple[np.ndarray, np.ndarray]:
        """Return the equations [K, 3] and their Jacobian [K, 3, n]."""
        # vec of c_i q / 2, c_i as a quaternion without scalar part
        scalar, vector = at.end[:, None, :1], at.end[:, None, 1:]
        slope = 0.5 * (scalar * at.axes + cross(at.axes, vector))
        return at.end[:, 1:], slope.transpose(0, 2, 1)

    def closure_hessian(self, at: FoldedChain, weights: np.ndarray) -> np.ndarray:
        """Return the Hessian of weights . equations, weights [K, 3], shape [K, n, n]."""
        c, (scalar, vector) = at.axes, (at.end[:, :1], at.end[:, 1:])
        # weights . vec(p q) = a p_0 + b . vec p, c_i c_j = (-c_i . c_j, c_i x c_j), (c_i x c_j) . b = c_j . (b x c_i)
        a = (weights * vector).sum(axis=1)[:, None, None]
        b = (scalar * weights + cross(vector, weights))[:, None]
        return _symmetric(0.25 * (cross(b, c) - a * c) @ c.transpose(0, 2, 1))


def from_the_right(axes: np.ndarray) -> np.ndarray:
    """Return q -> q b for unit axes b = (x, y, 0), shape [R, 3], as matrices [R, 4, 4]."""
    out = np.zeros((len(axes), 4, 4))
    for matrix, (bx, by, _) in zip(out, axes, strict=True):
        matrix[:] = [[0, -bx, -by, 0], [bx, 0, 0, -by], [by, 0, 0, bx], [0, by, -bx, 0]]
    return out


def products(right: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Multiply turns [R, K] [rad] about axes (`from_the_right`): the product before each, and of all, [R + 1, 4, K]."""
    cosine, sine = np.cos(0.5 * turns), np.sin(0.5 * turns)
    before = np.empty((len(right) + 1, 4, turns.shape[1]))
    before[0] = np.array(quat.IDENTITY, dtype=float)[:, None]
    for r, b in enumerate(right):
        before[r + 1] = cosine[r] * before[r] + sine[r] * (b @ before[r])
    return before


def _in_levels(flat: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Return the same by products of 1, 2, 4, ... neighbours (Hillis and Steele, Comm. ACM 29, 1986)."""
    before = np.zeros((4, len(flat) + 1, turns.shape[1]))
    before[0, 0], before[0, 1:] = 1.0, np.cos(0.5 * turns)
    before[1:3, 1:] = flat[:, :2].T[..., None] * np.sin(0.5 * turns)
    step = 1
    while step < before.shape[1]:
        before[:, step:] = quat.multiply([*before[:, :-step]], [*before[:, step:]])
        step *= 2
    return before.swapaxes(0, 1)


def turn_in_plane(q: np.ndarray, flat: np.ndarray, out: np.ndarray) -> None:
    """Write vectors (x, y, 0), [R, 3], turned by quaternions q [R, 4, K], into out [3, R, K]."""
    w, a, b, c = q.swapaxes(0, 1)
    x, y = flat[:, 0, None], flat[:, 1, None]
    # twice the cross product, as `quaternion.rotate`
    tx, ty, tz = (-2 * y) * c, (2 * x) * c, (2 * y) * a - (2 * x) * b
    out[0] = x + w * tx + b * tz - c * ty
    out[1] = y + w * ty + c * tx - a * tz
    out[2] = w * tz + a * ty - b * tx


def _symmetric(h: np.ndarray) -> np.ndarray:
    """Return the symmetric matrices with the upper triangles of h [K, n, n]."""
    n = h.shape[-1]
    return np.asarray(
        h * np.triu(np.ones((n, n))) + (h * np.triu(np.ones((n, n)), 1)).swapaxes(1, 2)
    )
