"""Samples of a model brought onto closure and the contacts that they hold, by Gauss-Newton."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from origami_nlp.numerics import EPS, OUTSIDE, RANK, ROUNDED
from origami_nlp.problem import OPEN, FoldedRays, HingeLaws, Kinematics, Model
from origami_nlp.starts.batch_states import Samples

CLOSED = 0.1 * OUTSIDE
"""Closure and held gaps when they are brought closer: what is held must not look crossed."""
QUADRATIC, SETTLING = 1e-7, 0.1
"""A step of Gauss-Newton this short [rad] is the last one; after one this short what is beyond a fold limit is held."""
STEPS = 5
"""Steps of Gauss-Newton."""
UNEQUAL = 1e3
"""Ratio of stiffnesses above which states are closed in the metric of the springs."""
POOR = 1e10
"""Condition of rows rows' above which its eigenvalues are looked at one by one."""


class Closing:
    """Closure and held contacts of a model, at many samples.

    Parameters
    ----------
    model
        The posed scene.
    """

    def __init__(self, model: Model) -> None:
        self.model, self.kinematics = model, Kinematics(model)
        self._root = np.sqrt(model.parameters.stiffness)
        # where stiffnesses are very unequal; ones elsewhere
        unequal = self._root.max() > math.sqrt(UNEQUAL) * self._root.min()
        self._unequal = self._root if unequal else np.ones(model.size)

    def tables(self) -> dict[str, np.ndarray]:
        """Return what compiled descents read of the springs, [n] each."""
        p = self.model.parameters
        return {
            "stiffness": p.linear,
            "rest": p.rest,
            "load": p.load,
            "root": self._root,
            "metric": self._unequal,
            **(p.laws or HingeLaws((), np.zeros(0), np.zeros(0))).tables(),
        }

    def rows(self, s: Samples) -> tuple[FoldedRays, np.ndarray, np.ndarray]:
        """Fold samples; return the folded states, closure and held gaps [K, r], and their Jacobian [K, r, n].

        Slots behind the last one that any sample uses have no rows.
        """
        at = self.kinematics.fold(s.x)
        value, jacobian = self.kinematics.closure(at)
        used = np.flatnonzero((s.slots != OPEN).any(axis=0))
        if not len(used):
            return at, value, jacobian
        slots, sides = s.slots[:, : used[-1] + 1], s.sides[:, : used[-1] + 1]
        g, dg = self.kinematics.gaps(at, slots)
        value = np.concatenate([value, sides * g], axis=1)
        return at, value, np.concatenate([jacobian, sides[..., None] * dg], axis=1)

    def close(self, s: Samples, steps: int = STEPS, to: float = CLOSED) -> Samples:
        """Close samples on their strata to a residual; those that leave the fold limits on the way are held there."""
        x, at_limit, todo = s.x.copy(), s.at_limit.copy(), np.arange(len(s))
        for _ in range(steps):
            part = replace(s[todo], x=x[todo], at_limit=at_limit[todo])
            _, value, rows = self.rows(part)
            far = np.abs(value).max(axis=1) > to
            todo, value = todo[far], value[far]
            if not len(todo):
                break
            rows = rows[far] * (at_limit[todo] == 0)[:, None]
            # shortest Gauss-Newton step on the free creases: rows' (rows rows')^-1 value
            move = (rows.transpose(0, 2, 1) @ (gram_inverse(rows) @ value[..., None]))[..., 0]
            length = np.abs(move).max(axis=1)
            x[todo] -= move / np.maximum(1.0, length)[:, None]
            left = length > QUADRATIC  # the next residual is the square of this
            if self.model.has_limits:
                limits = self.model.fold_limits
                over = ~limits.inside(x[todo], ROUNDED) & (at_limit[todo] == 0)
                # far from closure a step may leave the limits and come back
                over &= (length <= SETTLING)[:, None]
                k, v = todo[over.any(axis=1)], over.any(axis=1)
                side = limits.side(x[k])
                x[k] = np.where(over[v], limits.hold(x[k], side), x[k])
                at_limit[k] = np.where(over[v], side, at_limit[k])
                left |= v
            todo = todo[left]
            if not len(todo):
                break
        return replace(s, x=x, at_limit=at_limit)


def gram_inverse(rows: np.ndarray) -> np.ndarray:
    """Return the (pseudo-)inverse [K, r, r] of rows rows', rows [K, r, n]; empty rows are those of the identity.

    Where rows depend on each other (on a handle, or where a crease lies on another) what they do not
    resolve is left out: singular values below `RANK`.
    """
    a = rows @ rows.transpose(0, 2, 1)
    d = np.arange(a.shape[1])
    diagonal = a[:, d, d]
    trace = diagonal.sum(axis=1)
    a[:, d, d] += np.where(diagonal == 0, 1.0, ROUNDED**2 * trace[:, None])
    # shifted in rounding only, so that singular matrices do not raise; those are replaced below
    inverse = _inverted(a + EPS * trace[:, None, None] * np.eye(len(d)))
    largest = np.abs(inverse[:, d, d]).max(axis=1, initial=0.0)
    # not (<=), so that infinite and undefined inverses count as poor
    poor = np.flatnonzero(~(largest * np.maximum(trace, 1.0) <= POOR))
    if len(poor):
        value, vector = np.linalg.eigh(a[poor])
        # eigenvalues of rows rows' are squares of singular values
        keep = value > RANK**2 * value[:, -1:]
        over = np.where(keep, 1 / np.where(keep, value, 1.0), 0.0)
        inverse[poor] = (vector * over[:, None]) @ vector.transpose(0, 2, 1)
    return inverse


def _inverted(a: np.ndarray) -> np.ndarray:
    """Return inverses of positive definite matrices [K, r, r]; those of three rows by their cofactors."""
    if a.shape[1] != 3:
        return np.linalg.inv(a)
    (p, q, r), (_, s, t), (_, _, u) = a.transpose(1, 2, 0)
    pp, pq, pr = s * u - t * t, r * t - q * u, q * t - r * s
    qq, qr, rr = p * u - r * r, q * r - p * t, p * s - q * q
    with np.errstate(divide="ignore", invalid="ignore"):
        over = 1 / (p * pp + q * pq + r * pr)
        inverse = np.array([[pp, pq, pr], [pq, qq, qr], [pr, qr, rr]]) * over
    return np.where(np.isfinite(inverse), inverse, math.inf).transpose(2, 0, 1)
