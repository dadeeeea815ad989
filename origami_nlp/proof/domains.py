"""A folded piece of a vertex as vectors that move with the folds: closure, gaps and their slopes, over boxes.

Every ray and the last mirror of a piece is a vector carried by the folds before it: a fold by theta_l turns the vectors
after crease l about the axis c_l, d v / d theta_l = c_l x v.  Closure and gaps are products of such vectors, so that
their derivatives are sums of products too.  Ray 1 stays at e1, a mirror through it stays the e1-e3 plane; a crease on
a mirror turns by half of its fold angle, x = theta / share with share 1/2, which is 1 for all others.

Stationary.  With U = sum K_l (x_l - rest_l)^2 / 2 a state that is critical among those with closure f = 0 and gaps
g = 0 has K_l (x_l - rest_l) / share_l = m . df/dtheta_l + nu . dg/dtheta_l at every free crease.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.problem import Model
from origami_nlp.proof.affine import TRIGONOMETRIC, UNIT, Affine, Turn, constant, dot, mixed, turned
from origami_nlp.proof.angles import Angles
from origami_nlp.proof.chains import SECTORS, taken
from origami_nlp.proof.law_torques import torques_of

AXES = np.eye(3)


@dataclass(frozen=True)
class TargetTolerance:
    """A vector over K boxes that turns with the folds before number `reach`.

    Attributes
    ----------
    vector
        Shape [3, K].
    reach
        How many variables move it.
    """

    vector: Affine
    reach: int


@dataclass(frozen=True)
class Product:
    """A product of moving vectors less a number: u . v, or u . (v x w).

    Attributes
    ----------
    factors
        Two or three.
    less
        What is taken off; known to `TRIGONOMETRIC`.
    """

    factors: tuple[TargetTolerance, ...]
    less: float = 0.0

    def value(self) -> Affine:
        """Enclose it, [K]."""
        out = times([f.vector for f in self.factors])
        if not self.less:
            return out
        return Affine(out.centre - self.less, out.slopes, out.error + 4 * TRIGONOMETRIC)

    def slope(self, rays: Sequence[TargetTolerance], i: int) -> Affine | None:
        """Enclose its derivative by theta_i, [K]; None where it is zero."""
        vectors = [f.vector for f in self.factors]
        # product rule: d v / d theta_i = c_i x v for the factors that crease i carries
        parts = [
            times([*vectors[:s], cross(rays[i].vector, v), *vectors[s + 1 :]])
            for s, v in enumerate(vectors)
            if i < self.factors[s].reach
        ]
        if not parts or len(parts) == len(vectors):  # turned as a whole it stays
            return None
        return _sum(parts)


@dataclass(frozen=True)
class FoldedDomain:
    """A piece folded over K boxes.

    Attributes
    ----------
    rays
        In order.
    closure
        Zero where it closes: three products without symmetry, two for D_1, one for D_n.
    lift
        Positive where it closes as a sheet of paper (up to the sign of q).
    start, end
        Inward normals of the two mirrors (D_n).
    """

    rays: tuple[TargetTolerance, ...]
    closure: tuple[Product, ...]
    lift: tuple[Product, ...]
    start: TargetTolerance
    end: TargetTolerance

    def meet(self, a: int, b: int) -> Product:
        """Rays a, b of the plane of the first mirror on each other: the sine of the angle between them."""
        return Product((self.start, self.rays[a], self.rays[b]))

    def on_facet(self, k: int, j: int) -> Product:
        """Ray k in the plane of the facet from ray j to the next, over the sine of its sector: not divided."""
        n = len(self.rays)
        return Product((self.rays[j], self.rays[(j + 1) % n], self.rays[k]))

    def behind(self, r: int, side: int) -> Product:
        """Ray r before a mirror, the first (side 0) or the last."""
        return Product((self.rays[r], (self.start, self.end)[side]))


class FundamentalDomain:
    """The modelled piece of a vertex of a flat sheet, without symmetry or with D_n.

    Parameters
    ----------
    model
        Of the scene.

    Attributes
    ----------
    share
        Turn of the variable's fold over its fold angle, [n]: 1/2 for creases on mirrors.
    stiffness
        K_l / share_l over the largest of them, [n].
    laws
        Of hinges that are no linear springs, times the same; or None.
    """

    def __init__(self, model: Model) -> None:
        s = model.structure
        self.kind, self.order = s.kind, s.order
        self.has_crease = s.has_crease
        self.size = model.size
        self.equations = model.equation_count
        p = model.parameters
        self.sectors = np.asarray(p.sectors, dtype=float)
        self.rest = np.asarray(p.rest, dtype=float)
        count = len(s.has_crease)
        self.crease = [sum(s.has_crease[:r]) for r in range(count)]
        share = [
            0.5 if s.kind == "D" and r in (0, count - 1) else 1.0
            for r in range(count)
            if s.has_crease[r]
        ]
        self.share = np.array(share)
        stiffness = np.asarray(p.stiffness) / self.share
        self.stiffness = stiffness / stiffness.max()
        self.laws = torques_of(model, model.multiplicity / self.share, stiffness.max())
        self.doubt = SECTORS * 4 * UNIT + 2 * TRIGONOMETRIC

    @property
    def springs(self) -> np.ndarray:
        """Stiffness, and rest angles, [2, n, 1]."""
        return np.stack([self.stiffness, self.rest])[:, :, None]

    def fold(self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray) -> FoldedDomain:
        """Fold over boxes lower, upper [n, K] [rad]; where pins [n, K] is not 0 the angle is pins pi exactly."""
        return self.folded(Angles.over(lower, upper, pins))

    def folded(self, angles: Angles) -> FoldedDomain:
        """Fold by angles over boxes."""
        n, boxes = angles.middle.shape
        kinds = [angles.whole if self.share[v] == 1.0 else angles.halves for v in range(n)]
        turns = [taken(kind, v) for v, kind in enumerate(kinds)]
        frame = [constant(e, 0.0, 0, boxes) for e in AXES]
        e1, e2, e3 = (TargetTolerance(constant(e, 0.0, n, boxes), 0) for e in AXES)
        rays, used, count = [], 0, len(self.has_crease)
        for r in range(count):
            rays.append(TargetTolerance(frame[0].on(n), used))
            if self.has_crease[r]:
                frame = folded_frame(frame, turns[used])
                used += 1
            if self.kind == "C" or r < count - 1:
                frame = next_frame(frame, self.sectors[r], self.doubt)
        along, across = (TargetTolerance(v.on(n), n) for v in frame[:2])
        if self.kind == "C":
            # F e1 has no part along e2 and e3, F e2 none along e3: F is 1 or a half turn, which `lift` distinguishes
            zero = Product((e2, along)), Product((e3, along)), Product((e3, across))
            return FoldedDomain(
                tuple(rays), zero, (Product((e1, along)), Product((e2, across))), e2, e2
            )
        end = TargetTolerance(-across.vector, n)
        if self.order == 1:
            both = Product((e1, end)), Product((e3, end))
            return FoldedDomain(tuple(rays), both, (Product((e2, end)),), e2, end)
        # n_1 . H n_k = -cos(pi / n)
        level = {2: 0.0, 3: -0.5}.get(self.order, -math.cos(math.pi / self.order))
        return FoldedDomain(tuple(rays), (Product((e2, end), level),), (), e2, end)

    def torques(self, angles: Angles) -> Affine:
        """Enclose stiffness_l (x_l - rest_l), or what laws are in its place, [n, K]."""
        middle, half = angles.middle, angles.half
        n, boxes = middle.shape
        k, rest = self.springs
        slopes = np.zeros((n, n, boxes))
        if angles.torque is not None:
            slopes[np.arange(n), np.arange(n)] = angles.torque[1]
            return Affine(angles.torque[0], slopes, angles.torque[2])
        slopes[np.arange(n), np.arange(n)] = k * half
        centre = k * (middle - rest)
        error = 16 * UNIT * k * (np.abs(middle) + np.abs(rest) + half)
        return Affine(centre, slopes, error)


def cross(x: Affine, y: Affine) -> Affine:
    """Multiply vectors [3, K]."""
    for v in (x, y):
        v.magnitude()  # of all entries at once
    return x[[1, 2, 0],] * y[[2, 0, 1],] - x[[2, 0, 1],] * y[[1, 2, 0],]


def times(vectors: Sequence[Affine]) -> Affine:
    """Multiply two vectors [3, K], or three: u . (v x w)."""
    u, v = vectors[0], vectors[1] if len(vectors) == 2 else cross(vectors[1], vectors[2])
    return dot(u, v)


def _sum(parts: Sequence[Affine]) -> Affine:
    out = parts[0]
    for p in parts[1:]:
        out = out + p
    return out


def folded_frame(frame: Sequence[Affine], by: Turn) -> list[Affine]:
    """Turn a frame, along a ray, across it and up, about the ray by a new variable."""
    x, y, z = frame
    ay, az = mixed(y, by.cosine, z, by.sine), mixed(z, by.cosine, y, -by.sine)
    return [x.on(x.variables + 1), turned(ay, az, by), turned(az, -ay, by)]


def next_frame(frame: Sequence[Affine], sector: float, doubt: float) -> list[Affine]:
    """Turn a frame in its facet to the next ray, a sector [rad] on that is known to within `doubt`."""
    x, y, z = frame
    c, s = (np.full(x.centre.shape[-1], v) for v in (math.cos(sector), math.sin(sector)))
    return [mixed(x, c, y, s, doubt), mixed(y, c, x, -s, doubt), z]
