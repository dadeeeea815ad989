"""All critical points of a vertex within fold limits as zeros of a map of one vector: the constant internal moment.

Where U = 1/2 sum k_i (phi_i - phi0_i)^2 - load . phi is stationary among closed states with some creases at +-pi, each
free crease balances k_i (phi_i - phi0_i) - load_i = m . c_i with one vector m: d(vec q)/dphi_i = c_i / 2 where q = 1,
so m is half of the multipliers of vec q.  The deformed crease c_i depends on the folds before it only, and

    phi_i = clip(phi0_i + (load_i + m . c_i) / k_i, fold limits)

is a recursion.  It also gives the sign that a fold limit needs: there the springs want to go on.  So m gives all
folds, one after the other, and these how far the vertex misses closing: three numbers, whatever N is, whose zeros are
the stationary states of all strata.  The chain is folded from both ends of the fixed facet and shot at its middle:
errors of m grow over half of the creases only.

With c_i moved by the turns before it, d(m . c_i) = (c_i + Theta_i' (c_i x m)) . dm, where Theta_i = sum over j < i of
c_j (dphi_j/dm)' is the turn of what follows.  A free crease adds to Theta, a fully folded one does not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import NONZERO
from origami_nlp.pattern_problem import CanonicalLabelling, PatternProblem


@dataclass(frozen=True, eq=False)
class MomentChain:
    """The chain of K moments.

    Attributes
    ----------
    x
        Fold angles, shape [K, n] [rad].
    miss
        By which turn the two half chains miss each other in the middle, as a rotation vector in space, of length 0 to
        2 pi (the turn of -1, which is no sheet of paper); shape [K, 3] [rad].
    slope
        Newton's matrix of `miss`: the step dm with slope dm = -miss closes to first order; shape [K, 3, 3]; None where
        it was not asked for.
    growth
        Largest entry of the turns Theta of either half chain [rad per unit of moment]: what rounding of m becomes;
        shape [K]; None without `slope`.
    """

    x: np.ndarray
    miss: np.ndarray
    slope: np.ndarray | None
    growth: np.ndarray | None


class MomentMap:
    """Fold angles and closure of a vertex without symmetry from its moment vector, for many moments at once.

    Moments are over the problem's scale, in the frame of the facet between the last crease and the first: e1 along
    crease 1, e3 the normal of the sheet that counter-clockwise numbering sees.

    Parameters
    ----------
    problem
        Of one vertex without symmetry; contacts other than fold limits are not seen.
    labels
        They say which crease is the first, which way round the others follow, and the side that folds are seen from;
        None: crease 1, counter-clockwise.

    Attributes
    ----------
    order, sign
        Variables in the order of the chain, [n], and the sign of their fold angles there.

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp import Scene, Vertex
    >>> import origami_nlp as o
    >>> from origami_nlp.search.moment_map import MomentMap
    >>> scene = Scene(Vertex(("pi/3",) * 6), (1,) * 6, (0,) * 6, "none", "fold-limits")
    >>> shot = MomentMap(o.pose(scene)).shoot(np.zeros((1, 3)))
    >>> shot.x.tolist(), bool((abs(shot.miss) < 1e-14).all())
    ([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]], True)
    """

    def __init__(self, problem: PatternProblem, labels: CanonicalLabelling | None = None) -> None:
        p, n = problem.parameters, problem.size
        (loop,) = problem.pattern.vertices
        around = np.array(loop.creases)
        self.sign = 1.0 if labels is None else labels.sign
        rank = np.arange(n) if labels is None else labels.rank
        first = int(rank[around].argmin())
        turn = np.roll(np.arange(n), -first)
        if labels is not None and rank[around[turn[1]]] > rank[around[turn[-1]]]:
            turn = np.roll(turn[::-1], 1)
        self.order = around[turn]
        rays = (np.array(loop.signs)[:, None] * problem.pattern.directions[around])[turn]
        after = np.roll(rays, -1, axis=0)
        sectors = np.arctan2(
            np.linalg.norm(np.cross(rays, after), axis=1), (rays * after).sum(axis=1)
        )
        reach = np.array([problem.fold_limits.low, problem.fold_limits.high])[:, self.order]
        reach = reach if self.sign > 0 else -reach[::-1]
        low, high = reach if problem.has_limits else np.copysign(math.inf, reach)
        stiffness = p.stiffness[self.order]
        rest = self.sign * (p.rest[self.order] + p.load[self.order] / stiffness)
        half = (n + 1) // 2
        self.size, self._left = n, np.arange(half)
        self._right = np.arange(n - 1, half - 1, -1)
        # both halves side by side, [half, 2, 1]; where N is odd the right one ends with a crease that does not fold
        self._rest = self._halves(rest)
        self._soft = self._halves(1 / stiffness)
        self._low, self._high = self._halves(low), self._halves(high)
        after, before = sectors[self._left], sectors[self._right - 1]
        before = np.append(before[:-1], np.zeros(half - len(before) + 1))
        turns = np.stack([after, -before], axis=1)[..., None] / 2
        self._cosine, self._sine = np.cos(turns), np.sin(turns)
        # the fixed facet N lies between both ends: the left half starts at crease 1, the right one at crease N
        last = math.pi - sectors[-1] / 2  # a whole turn less the last sector: on the lift q = +1
        self._start = np.array([[1, 0, 0, 0], [math.cos(last), 0, 0, math.sin(last)]]).T[..., None]

    def _halves(self, values: np.ndarray) -> np.ndarray:
        right = values[self._right]
        right = np.append(right, np.zeros(len(self._left) - len(right)))
        return np.stack([values[self._left], right], axis=1)[..., None]

    @property
    def smallest(self) -> float:
        """Length of a moment that turns all free creases together by one radian, over the problem's scale."""
        return 1 / float(self._soft.sum())

    @property
    def largest(self) -> float:
        """Length of a moment that shuts any crease that it does not miss by more than a right angle of 90 degrees."""
        wound = max(math.pi, float(np.abs(self._rest).max()))
        return (math.pi + wound) / float(self._soft[self._soft > 0].min())

    def shoot(self, m: np.ndarray, *, slope: bool = True) -> MomentChain:
        """Fold the creases that moments lead to, from both sides, and compare in the middle.

        Parameters
        ----------
        m
            Moments over the problem's scale, shape [K, 3].
        slope
            Whether derivatives are wanted.

        Returns
        -------
        MomentChain
            Fold angles, what is missed, and Newton's matrix.
        """
        q, theta, x = self._fold(np.ascontiguousarray(m.T), slope)
        (w, w2), (a, b) = q[0], q[1:].swapaxes(0, 1)
        # right conj(left), the turn that is missed
        scalar = w2 * w + (a * b).sum(axis=0)
        # scalar and vector of (w2, b) (w, -a): 0 and +-1 where both halves meet
        vector = w * b - w2 * a + _cross(a, b)
        sine = np.sqrt((vector * vector).sum(axis=0))
        angle = 2 * np.arctan2(sine, scalar)
        # rotation vector: axis times angle; angle / sin(angle / 2) tends to 2 where nothing is missed
        miss = vector * np.where(sine > 0, angle / np.maximum(sine, NONZERO), 2.0)
        # q = -1 has no axis: a whole turn about any of them
        miss[0] = np.where((sine == 0) & (scalar < 0), angle, miss[0])
        if theta is None:
            return MomentChain(x, miss.T, None, None)
        left, right = theta[:, :, 0], theta[:, :, 1]
        # turns of the left half seen behind the miss: R v = v + 2 s (u x v) + 2 u x (u x v) for the quaternion (s, u)
        twice = 2 * _cross(vector[:, None], left)
        carried = left + scalar * twice + _cross(vector[:, None], twice)
        growth = np.abs(theta).max(axis=(0, 1, 2))
        return MomentChain(x, miss.T, (right - carried).transpose(2, 0, 1), growth)

    def _fold(self, m: np.ndarray, slope: bool) -> tuple[np.ndarray, np.ndarray | None, np.ndarray]:
        """Fold both halves: ends [4, 2, K], turns by moments [3, 3, 2, K], fold angles [K, n]."""
        count = m.shape[1]
        m = m[:, None]
        x = np.zeros((2 * len(self._left), count))
        theta = np.zeros((3, 3, 2, count)) if slope else None
        q = np.broadcast_to(self._start, (4, 2, count))
        of_each = zip(self._rest, self._soft, self._low, self._high, strict=True)
        for i, (rest, soft, low, high) in enumerate(of_each):
            w, a, b, c = q
            # deformed crease R(q) e1: the frame moves along, so that each crease is its first axis
            crease = np.stack(
                [w * w + a * a - b * b - c * c, 2 * (a * b + w * c), 2 * (a * c - w * b)]
            )
            free = rest + soft * (crease * m).sum(axis=0)
            phi = np.clip(free, low, high)
            if theta is not None:
                # dphi/dm = (c + Theta' (c x m)) / k of a free crease; 0 where a fold limit is active
                give = np.where(phi == free, soft, 0.0)
                by_m = give * (crease + (theta * _cross(crease, m)[:, None]).sum(axis=0))
                by_m[:, 1] *= -1  # the right half is folded backwards
                theta += crease[:, None] * by_m
            x[[i, -1 - i]] = phi
            phi[1] *= -1
            q = _about_e3(_about_e1(q, phi / 2), self._cosine[i], self._sine[i])
        if 2 * len(self._left) > self.size:
            x = np.delete(x, len(self._left), axis=0)
        return q, theta, x.T


def _cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return u x v of vectors [3, ...]."""
    return np.stack(
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    )


def _about_e1(q: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Return q (cos, sin, 0, 0)."""
    cosine, sine = np.cos(half), np.sin(half)
    w, x, y, z = q
    return np.stack(
        [cosine * w - sine * x, cosine * x + sine * w, cosine * y + sine * z, cosine * z - sine * y]
    )


def _about_e3(q: np.ndarray, cosine: np.ndarray, sine: np.ndarray) -> np.ndarray:
    """Return q (cos, 0, 0, sin)."""
    w, x, y, z = q
    return np.stack(
        [cosine * w - sine * z, cosine * x + sine * y, cosine * y - sine * x, cosine * z + sine * w]
    )
