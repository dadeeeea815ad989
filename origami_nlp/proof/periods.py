"""What every local minimum satisfies where turns are imposed, over boxes of the fold angles of a period of C_n.

The scalar of T = prod Q(e1, phi_i) Q(e3, a_i) is cos(w pi / n), w the winding; its slopes are, but for a factor, the x
of T read from crease i on, t_i: G_a t_b = G_b t_a for every two free creases, G the torques of single creases.  Each is
a product of two half chains.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.proof.affine import (
    TRIGONOMETRIC,
    UNIT,
    Affine,
    Turn,
    constant,
    dot,
    mixed,
    padded,
    turned,
)
from origami_nlp.proof.angles import Angles
from origami_nlp.proof.chains import (
    SECTORS,
    Enclosed,
    springs_of,
    taken,
    with_twins,
    with_twins_asked,
)
from origami_nlp.proof.collinear_creases import CollinearPair, collinear_creases_of_loop
from origami_nlp.proof.law_torques import LawTorques
from origami_nlp.proof.mirror_domains import all_free, sums_of_torques


class PeriodForms(Enclosed):
    """The forms of a period of C_n.

    Parameters
    ----------
    order
        n of C_n.
    sectors
        Of the period, shape [n] [rad].
    stiffness, rest
        Of each crease of the period, [n].
    winding
        How often states wind round the axis, less than n: the scalar is cos(winding pi / n).
    laws
        Of hinges that are no linear springs, over the largest stiffness.
    """

    pivots = 1
    linear = slice(0, 1)

    def __init__(
        self,
        order: int,
        sectors: np.ndarray,
        stiffness: np.ndarray,
        rest: np.ndarray,
        winding: int = 1,
        laws: LawTorques | None = None,
    ) -> None:
        n = self.size = len(sectors)
        self.laws = laws
        self.order, self.level = order, math.cos(winding * math.pi / order)
        self.sectors = np.asarray(sectors, float)
        self.stiffness, self.rest = np.asarray(stiffness, float), np.asarray(rest, float)
        self.minor_creases = tuple(itertools.combinations(range(n), 2))
        doubt = SECTORS * 4 * UNIT
        self.doubt = n * (doubt + 2 * TRIGONOMETRIC)
        found = {}
        for twin in collinear_creases_of_loop(np.tile(self.sectors, order), doubt):
            a, b = (c % n for c in twin.creases)
            if a != b:
                closed = tuple(sorted({c % n for c in twin.closed}))
                if not {a, b} & set(closed):
                    found[min(a, b), max(a, b), closed] = twin.sign
        self.twin_rule = tuple(CollinearPair((a, b), sign, c) for (a, b, c), sign in found.items())

    @property
    def springs(self) -> np.ndarray:
        """Stiffness over the largest, and rest angles, [2, n, 1]."""
        return springs_of(self.stiffness, self.rest)

    def enclosed(self, angles: Angles) -> tuple[Affine, Affine]:
        """Enclose closure, and minors and twins, over boxes."""
        scalar, slopes = self._products(angles.halves)
        first = scalar[:1]
        closure = padded(
            first.centre - self.level, first.slopes, first.error, 2.0 + 0 * first.centre, 4
        )
        # one equation: rank [G | t] <= 1, its minors are G_a t_b - G_b t_a
        terms = [[(a, slopes[b], 1.0), (b, slopes[a], -1.0)] for a, b in self.minor_creases]
        return closure, with_twins(self, sums_of_torques(self, terms, angles), angles)

    def asked(self, pins: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Return which minors and twins hold on the strata of boxes, [R, K]."""
        return with_twins_asked(self, all_free(self.minor_creases, pins), pins, flat)

    def _products(self, turn: Turn) -> tuple[Affine, Affine]:
        """Enclose scalar and x of the product read from every crease on, [n, K]."""
        n, boxes = turn.cosine.shape
        h = (n + 1) // 2
        start = np.arange(n)
        left = self._chain(turn, [(start + i) % n for i in range(h)], boxes)
        right = self._chain(turn, [(start + i) % n for i in range(h, n)], boxes)
        signs = np.array([1.0, -1.0, -1.0, -1.0])[:, None, None]
        # scalar of p q = p_0 q_0 - p_1 q_1 - p_2 q_2 - p_3 q_3: both halves as a dot product
        other = Affine(signs * right.centre, signs[..., None] * right.slopes, right.error)
        scalar = _dotted(left, other)
        order, signs = [1, 0, 3, 2], np.array([1.0, 1.0, 1.0, -1.0])[:, None, None]
        other = Affine(
            signs * right.centre[order], signs[..., None] * right.slopes[order], right.error[order]
        )
        x = _dotted(left, other)
        return (Affine(v.centre, v.slopes, v.error + 4 * self.doubt) for v in (scalar, x))  # type: ignore[return-value]

    def _chain(self, turn: Turn, creases: list[np.ndarray], boxes: int) -> Affine:
        """Enclose products of Q(e1, phi) Q(e3, a) over successive creases, from n starts: [4, n, K] in n variables."""
        n = self.size
        q = constant(np.eye(4)[:, [0] * n], 0.0, n, boxes)
        start = np.arange(n)
        for crease in creases:
            by = taken(turn, crease)
            a, b = q, _times_x(q)
            x = mixed(a, by.cosine, b, by.sine)
            new = turned(x, _times_x(x), by)
            slopes = new.slopes[..., :-1, :].copy()
            # start i reads the period from crease i on: the new variable is another crease for each start
            slopes[:, start, crease] += new.slopes[:, start, -1]
            q = Affine(new.centre, slopes, new.error)
            # half angles, as quaternions take them
            sector = 0.5 * self.sectors[crease][:, None]
            q = mixed(q, np.cos(sector), _times_z(q), np.sin(sector))
        return q


def _times_x(q: Affine) -> Affine:
    """Multiply quaternions [4, ...] by e1 from the right."""
    return _permuted(q, [1, 0, 3, 2], [-1.0, 1.0, 1.0, -1.0])


def _times_z(q: Affine) -> Affine:
    """Multiply quaternions [4, ...] by e3 from the right."""
    return _permuted(q, [3, 2, 1, 0], [-1.0, 1.0, -1.0, 1.0])


def _permuted(q: Affine, order: list[int], signs: list[float]) -> Affine:
    s = np.array(signs).reshape(4, *[1] * (q.centre.ndim - 1))
    return Affine(s * q.centre[order], s[..., None] * q.slopes[order], q.error[order])


def _dotted(x: Affine, y: Affine) -> Affine:
    """Dot along the first axis, [4, n, K] to [n, K]."""
    moved = (
        Affine(v.centre.swapaxes(0, 1), v.slopes.swapaxes(0, 1), v.error.swapaxes(0, 1))
        for v in (x, y)
    )
    return dot(*moved)
