"""The reduced compatibility conditions, solved from scratch.

Every reduced condition of a symmetric vertex is one (or two) equations A cos t + B sin t = C in
half a fold angle; `TrigEquation` holds one and knows its solutions.  Three families:

`reflection_form`
    D_1, any even degree N: creases b_1 = e1 .. b_k = -e1 of half the vertex, k = N/2 + 1.
`dihedral_form`, `dihedral_fold_form`, `dihedral_inner_form`
    D_n, n >= 2: creases b_1 = e1 .. b_k of the wedge between neighbouring mirrors, the last at
    azimuth pi/n.  Solved for phi_1 from (elevation, inner folds), or for any one fold angle from
    the others.  A mirror that runs through a facet is a mirror crease that never folds.
`cyclic_form`
    C_n: the creases b_1 .. b_m of one period 2 pi/n, solved for any one of them.

Conventions: creases counter-clockwise in the e1-e2 plane and
H = Q(b_1, phi_1/2) Q(b_2, phi_2) .. Q(b_k, phi_k/2).  Inner creases are given as azimuths (SymPy
angles) or as ready (cos, sin) pairs of the azimuth; folds as fold angles or as ready pairs
(cos phi/2, sin phi/2).  A ready pair lets a proof use free symbols with c^2 + s^2 = 1.
The paper's families: degree 6 = `reflection_form` with 2 inner creases, degree 8 =
`dihedral_form(2, ..)` with one inner crease, cone of degree N = `dihedral_form(N/2, ..)` with none
(claims ``derive.*`` prove it).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from .rotations import (
    E1,
    E2,
    E3,
    Pair,
    Quaternion,
    about,
    cross,
    dot,
    half_pair,
    planar,
    product,
    scale,
)


def as_direction(azimuth: Any) -> Pair:
    """(cos, sin) of an azimuth; a ready pair is passed through."""
    return azimuth if isinstance(azimuth, tuple) else (sp.cos(azimuth), sp.sin(azimuth))


def as_fold(angle: Any) -> Pair:
    """(cos phi/2, sin phi/2) of a fold angle; a ready pair is passed through."""
    return angle if isinstance(angle, tuple) else half_pair(angle)


def inner_product(azimuths: Sequence[Any], folds: Sequence[Any]) -> Quaternion:
    """M = Q(b_2, phi_2) .. Q(b_{k-1}, phi_{k-1}): the creases strictly inside the wedge."""
    if len(azimuths) != len(folds):
        raise ValueError(f"{len(azimuths)} inner creases but {len(folds)} fold angles")
    return product(
        about(planar(as_direction(a)), as_fold(f)) for a, f in zip(azimuths, folds, strict=True)
    )


@dataclass(frozen=True)
class TrigEquation:
    """A cos t + B sin t = C; t is HALF the unknown fold angle unless a function says otherwise.

    Solvable in real t exactly when A^2 + B^2 >= C^2 and not A = B = 0 != C.  With D = sqrt(A^2 +
    B^2 - C^2) the two solutions, branch = +1 and -1, are t = atan2(B, A) + branch atan2(D, C);
    they meet where D = 0. Where A = B = C = 0 every t solves it: the chart ends there (a whole
    family of states over one point).
    """

    A: Any
    B: Any
    C: Any

    @property
    def discriminant(self) -> Any:
        """A^2 + B^2 - C^2: the existence condition is discriminant >= 0."""
        return self.A**2 + self.B**2 - self.C**2

    def residual(self, cos_t: Any, sin_t: Any) -> Any:
        """A cos t + B sin t - C."""
        return self.A * cos_t + self.B * sin_t - self.C

    def solution(self, branch: int, root: Any = None) -> Any:
        """T on one branch; `root` overrides D by a factored square root of the discriminant."""
        d = sp.sqrt(self.discriminant) if root is None else root
        return sp.atan2(self.B, self.A) + branch * sp.atan2(d, self.C)

    def cos_sin(self, branch: int, root: Any = None) -> Pair:
        """(cos t, sin t) on one branch without inverse functions (needs A^2 + B^2 > 0)."""
        d = sp.sqrt(self.discriminant) if root is None else root
        r2 = self.A**2 + self.B**2
        return (
            (self.A * self.C - branch * self.B * d) / r2,
            (self.B * self.C + branch * self.A * d) / r2,
        )

    def half_tangent(self, branch: int, root: Any = None) -> Pair:
        """(numerator, denominator) of tan(t/2) = (B + branch D)/(A + C): t = 2 atan2(num, den)."""
        d = sp.sqrt(self.discriminant) if root is None else root
        return (self.B + branch * d, self.A + self.C)


@dataclass(frozen=True)
class ReflectionForm:
    """D_1 solved for both mirror creases: phi_1 = -2 arg(u v), phi_k = 2 arg(u conj v).

    With e1 as the imaginary unit the inner product is M = u + v j, u = m_w + i m_x and
    v = m_y + i m_z, so H = u e^{i(phi_1-phi_k)/4} + v e^{i(phi_1+phi_k)/4} j.  H e2 = e2 means
    h_x = h_z = 0, that is Im(u e^{i(phi_1-phi_k)/4}) = 0 = Im(v e^{i(phi_1+phi_k)/4}): two
    `TrigEquation`s with C = 0, always solvable.  Both fold angles come modulo 2 pi, with a common
    parity (`paper`).  u = 0 frees phi_1 - phi_k, v = 0 frees phi_1 + phi_k: the chart ends there.
    The book fold at phi_2 = .. = phi_{k-1} = 0 is v = 0; u = 0 lays crease k on crease 1.
    """

    u: Pair
    v: Pair

    @property
    def first(self) -> Pair:
        """(y, x) with phi_1/2 = atan2(y, x) modulo pi: y = -Im(u v), x = Re(u v)."""
        (a, b), (c, d) = self.u, self.v
        return (-(a * d + b * c), a * c - b * d)

    @property
    def last(self) -> Pair:
        """(y, x) with phi_k/2 = atan2(y, x) modulo pi: y = Im(u conj v), x = Re(u conj v)."""
        (a, b), (c, d) = self.u, self.v
        return (b * c - a * d, a * c + b * d)

    @property
    def phi_first(self) -> Any:
        """phi_1 (bring it into [-pi, pi] by adding 2 pi z)."""
        return 2 * sp.atan2(*self.first)

    @property
    def phi_last(self) -> Any:
        """phi_k (bring it into [-pi, pi] by adding 2 pi z)."""
        return 2 * sp.atan2(*self.last)

    @property
    def paper(self) -> Any:
        """Re(u v) Re(u conj v): positive where (phi_1, phi_k) in [-pi, pi]^2 lies on q = +1.

        Where it is negative the two wrapped angles close F = I on q = -1 only: no sheet of paper
        does that.  Proof: e^{i phi_1/2} = s_1 conj(u v)/|u v|, e^{i phi_k/2} = s_k u conj(v)/|u v|
        with s = sign of the real parts, so (u e^{i(phi_1-phi_k)/4})^2 = s_1 s_k |u|^2, and q = +1
        is the case of a real u e^{i(phi_1-phi_k)/4}.
        """
        return self.first[1] * self.last[1]


def reflection_form(azimuths: Sequence[Any], folds: Sequence[Any]) -> ReflectionForm:
    """Solve D_1 for the mirror creases.

    azimuths, folds: the inner creases 2 .. k-1 of the half between b_1 = e1 and b_k = -e1 (k - 2
    each); the vertex has degree N = 2 (k - 1).  Any number of inner creases, flat-foldable or
    not.
    """
    m = inner_product(azimuths, folds)
    return ReflectionForm((m.w, m.x), (m.y, m.z))


@dataclass(frozen=True)
class DihedralForm:
    """D_n in the chart (elevation, inner folds): `equation` gives t = phi_1/2, then phi_k."""

    equation: TrigEquation
    inner: Quaternion
    elevation: Pair
    mirror: Pair

    def last(self, cos_t: Any, sin_t: Any) -> Pair:
        """(sin, cos) of phi_k/2, once cos and sin of t = phi_1/2 are known: phi_k = 2 atan2(sin,
        cos).

        Q(b_k, phi_k/2) n_k = H'^T n_k with H' = Q(e2, v) Q(b_1, t) M.
        """
        cv, sv = self.elevation
        n = last_normal(self.mirror)
        back = (n[0] * cv - n[2] * sv, n[1], n[0] * sv + n[2] * cv)
        back = (back[0], back[1] * cos_t + back[2] * sin_t, -back[1] * sin_t + back[2] * cos_t)
        back = self.inner.inverse.rotate(back)
        return (-dot(E3, back), dot(n, back))


def last_normal(mirror: Pair) -> tuple[Any, Any, Any]:
    """Inward flat normal n_k = (sin pi/n, -cos pi/n, 0) of the wedge's second mirror."""
    return (mirror[1], -mirror[0], sp.Integer(0))


def as_mirror(n: Any) -> Pair:
    """(cos pi/n, sin pi/n) for an integer n; a ready pair is passed through."""
    if isinstance(n, tuple):
        return n
    return (sp.cos(sp.pi / n), sp.sin(sp.pi / n))


def dihedral_form(
    n: Any, azimuths: Sequence[Any], folds: Sequence[Any], elevation: Any
) -> DihedralForm:
    """Solve D_n (n >= 2) for phi_1 and phi_k from the elevation v of crease 1 and the inner
    folds.

    n: the integer, or the pair (cos pi/n, sin pi/n).  elevation: v, or the pair (cos v, sin v);
    positive v LOWERS the mirror creases, c_1 = Q(e2, v) e1 = (cos v, 0, -sin v), so that the
    vertex pops up (paper's sign). The condition is c_k . n_k = 0 (the paper's
    eq:rotation-reflection-condition cleared of its denominators).
    """
    mirror = as_mirror(n)
    elev = elevation if isinstance(elevation, tuple) else (sp.cos(elevation), sp.sin(elevation))
    m = inner_product(azimuths, folds)
    w = m.rotate(planar(mirror))
    n1, n2, _ = last_normal(mirror)
    m1, m2, m3 = elev[0] * n1, n2, elev[1] * n1
    equation = TrigEquation(m2 * w[1] + m3 * w[2], m3 * w[1] - m2 * w[2], -m1 * w[0])
    return DihedralForm(equation, m, elev, mirror)


def dihedral_fold_form(
    n: Any, azimuths: Sequence[Any], folds: Sequence[Any], other: Any, unknown: str = "first"
) -> TrigEquation:
    """D_n with fold angles only: n_1 . H n_k = n_1 . n_k solved for one mirror crease.

    unknown "first": t = phi_1/2 from the inner folds and other = phi_k; "last": t = phi_k/2 from
    other = phi_1. other: the fold angle, or the pair (cos phi/2, sin phi/2).
    """
    mirror = as_mirror(n)
    c, s = as_fold(other)
    m = inner_product(azimuths, folds)
    nk = last_normal(mirror)
    right = m.rotate(nk), m.rotate(scale(-1, E3))
    mat = [[dot(E2, r) for r in right], [dot(scale(-1, E3), r) for r in right]]
    goal = dot(E2, nk)
    if unknown == "first":
        return TrigEquation(mat[0][0] * c + mat[0][1] * s, mat[1][0] * c + mat[1][1] * s, goal)
    if unknown == "last":
        return TrigEquation(mat[0][0] * c + mat[1][0] * s, mat[0][1] * c + mat[1][1] * s, goal)
    raise ValueError(f"unknown must be 'first' or 'last', not {unknown!r}")


def dihedral_inner_form(
    n: Any,
    azimuths: Sequence[Any],
    folds: Sequence[Any],
    first: Any,
    last: Any,
    unknown: int,
) -> TrigEquation:
    """D_n with fold angles only, solved for the inner crease number `unknown` (0 is crease 2).

    Here t is the WHOLE fold angle phi of that crease.  first, last: phi_1 and phi_k, or pairs
    (cos phi/2, sin phi/2); 0 for a mirror that runs through a facet.  With a = P^-1 n_1 and
    w = S n_k, the wedge being P Q(b, phi) S, the condition a . Q(b, phi) w = n_1 . n_k reads
    (a.w - (a.b)(w.b)) cos phi + a.(b x w) sin phi = n_1.n_k - (a.b)(w.b).
    """
    mirror = as_mirror(n)
    nk = last_normal(mirror)
    b = planar(as_direction(azimuths[unknown]))
    before = inner_product(azimuths[:unknown], folds[:unknown])
    after = inner_product(azimuths[unknown + 1 :], folds[unknown + 1 :])
    (c1, s1), (ck, sk) = as_fold(first), as_fold(last)
    a = before.inverse.rotate((sp.Integer(0), c1, -s1))
    w = after.rotate((ck * nk[0], ck * nk[1], -sk))
    along = dot(a, b) * dot(w, b)
    return TrigEquation(dot(a, w) - along, dot(a, cross(b, w)), dot(E2, nk) - along)


def cyclic_form(
    n: Any, azimuths: Sequence[Any], folds: Sequence[Any], unknown: int = 0
) -> TrigEquation:
    """C_n: T = Q(b_1, phi_1) .. Q(b_m, phi_m) Q(e3, 2 pi/n) has quaternion scalar part cos(pi/n).

    azimuths: all m creases of one period; folds: their fold angles, the entry `unknown` is
    ignored and solved for, t = phi_unknown/2.
    """
    mirror = as_mirror(n)
    crease = planar(as_direction(azimuths[unknown]))
    after = inner_product(azimuths[unknown + 1 :], folds[unknown + 1 :])
    before = inner_product(azimuths[:unknown], folds[:unknown])
    w = after * about(E3, mirror) * before  # the scalar part of a product is cyclic
    return TrigEquation(w.w, -dot(crease, w.vector), mirror[0])


__all__ = [
    "E1",
    "DihedralForm",
    "ReflectionForm",
    "TrigEquation",
    "cyclic_form",
    "dihedral_fold_form",
    "dihedral_form",
    "dihedral_inner_form",
    "inner_product",
    "reflection_form",
]
