"""Loop closure of the modelled piece, and where its rays go, as CasADi expressions.

Half-angle sines and cosines only.  Ray 1 stays at e1; a mirror through ray 1 stays the e1-e3 plane.

- D_n wedge: H = Q(b_1, phi_1/2) Q(b_2, phi_2) ... Q(b_k, phi_k/2).  The mirror at the last ray makes the angle pi/n
  with the first one (paper, eq. 2.5, reflection-condition, for n = 1, and eq. 2.8, rotation-reflection-condition).
  With inward flat normals n_1 = e2 and n_k = (sin pi/n, -cos pi/n, 0): n = 1 asks H e2 = e2, that is h_x = h_z = 0 (two
  equations); n >= 2 asks n_1 . H n_k = -cos(pi/n) (one equation).
- C_n period, n >= 2: T = q Q(e3, 2 pi/n) is a rotation by 2 pi/n: its scalar part is cos(pi/n) (one equation).
- States that wind w times round the axis, w odd: T turns by w 2 pi/n, as T^n = -1 asks, and mirrors make the angle
  w pi/n: the conditions above with n/w in place of n (w = n: those of n = 1), for an unrolled piece.
- No symmetry: the vector part of q vanishes (three equations).  q = -1 also solves them: unit quaternions cover
  rotations twice, the sheet of paper is the lift q = +1, and `FoldedExpressions.lift` says which it is.

A vertex that is not flat is unrolled: the last ray of its piece lies at the sum s of the sectors, with n_k = (sin s,
-cos s, 0), T = q Q(e3, s), and q Q(e3, s - 2 pi) = +1 without symmetry.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import casadi as ca

from origami_nlp.numerics import quaternion as quat


@dataclass(frozen=True)
class FoldedExpressions:
    """The folded piece in symbols.

    rays: deformed unit rays c_r of the piece; for C_n also their images, the whole vertex in order.
    end: quaternion of the whole piece (H, T or q).
    end_normal: inward normal of the last mirror after folding (D_n only).
    equations: loop closure, each zero when the piece closes.
    lift: positive on the lift q = +1, negative on q = -1.
    """

    rays: tuple[tuple[Any, Any, Any], ...]
    end: tuple[Any, Any, Any, Any]
    end_normal: tuple[Any, Any, Any] | None
    equations: ca.SX
    lift: Any


def fold_piece(
    kind: str,
    order: int | Fraction,
    has_crease: tuple[bool, ...],
    fold_angles: ca.SX,
    sectors: ca.SX,
    flat_sheet: bool = True,
) -> FoldedExpressions:
    """Fold the piece of a vertex with group `kind`_`order`.

    Parameters
    ----------
    order
        How many pieces make one turn round the axis: n, or n/w where states wind w times.
    has_crease
        For each ray, whether it is a crease (False: a mirror through a facet).
    fold_angles
        Fold angles of the creases of the piece, in order, shape [n].
    sectors
        Angles between successive rays; the last ray of a wedge of a flat sheet lies at pi/order exactly.
    flat_sheet
        Whether `order` pieces make a flat sheet: their sector angles sum to 2 pi.
    """
    count = len(has_crease)
    azimuth: Any = ca.SX(0)
    q: tuple[Any, Any, Any, Any] = tuple(ca.SX(v) for v in quat.IDENTITY)  # type: ignore[assignment]
    rays = []
    used = 0
    for r in range(count):
        if r == 0:
            flat: tuple[Any, Any, Any] = (ca.SX(1), ca.SX(0), ca.SX(0))
        elif kind == "D" and r == count - 1 and flat_sheet:
            flat = (ca.SX(exact_cosine(order)), ca.SX(exact_sine(order)), ca.SX(0))
        else:
            azimuth = azimuth + sectors[r - 1]
            flat = (ca.cos(azimuth), ca.sin(azimuth), ca.SX(0))
        # deformed crease c_r = F_{r-1} b_r (paper, section 2): turned by the folds before it, not by its own
        rays.append(quat.rotate(q, flat))
        if has_crease[r]:
            half = fold_angles[used] / 2
            if kind == "D" and r in (0, count - 1):
                half = half / 2  # the mirror halves the fold angle of a crease that lies on it
            q = quat.multiply(q, quat.fold(ca.cos(half), ca.sin(half), flat))
            used += 1
    if kind == "D":
        if (
            not flat_sheet
        ):  # turn the unrolled wedge so that its last mirror is where a flat one has it
            gap = ca.sum1(sectors) - math.pi / order
            q = quat.multiply(q, (ca.cos(gap / 2), 0, 0, ca.sin(gap / 2)))
        # H n_k: the last fold angle, which eq. 2.5 and 2.8 leave out, is a variable here and turns this mirror
        normal = quat.rotate(q, (ca.SX(exact_sine(order)), ca.SX(-exact_cosine(order)), ca.SX(0)))
        if order == 1:
            # H e2 = e2: H turns about e2, so that its axis has no part along e1 and e3
            equations = ca.vertcat(q[1], q[3])
        else:
            equations = normal[1] + exact_cosine(order)
        return FoldedExpressions(tuple(rays), q, normal, equations, ca.SX(1))
    if not flat_sheet:
        gap = ca.sum1(sectors) - 2 * math.pi / order
        q = quat.multiply(q, (ca.cos(gap / 2), 0, 0, ca.sin(gap / 2)))
    if order == 1:
        # paper, eq. 2.3, F_N = I: q = +-1, a rotation by 0 or by 2 pi, which `lift` distinguishes
        return FoldedExpressions(tuple(rays), q, None, ca.vertcat(q[1], q[2], q[3]), q[0])
    half_turn = math.pi / order
    turn = quat.multiply(q, (math.cos(half_turn), 0, 0, math.sin(half_turn)))
    images = list(rays)
    for _ in range(int(order) - 1 if order == int(order) else 0):
        images += [quat.rotate(turn, c) for c in images[-count:]]
    # T^n = -1 for every solution of T_w = cos(w pi/n), w odd, so the n-fold product is on the lift q = +1
    return FoldedExpressions(tuple(images), turn, None, turn[0] - exact_cosine(order), ca.SX(1))


def exact_cosine(order: int | Fraction) -> float:
    """cos(pi/order), exact where it is rational."""
    return {1: -1.0, 2: 0.0, 3: 0.5}.get(order, math.cos(math.pi / order))  # type: ignore[arg-type]


def exact_sine(order: int | Fraction) -> float:
    """sin(pi/order), exact where it is rational."""
    return {1: 0.0, 2: 1.0, 6: 0.5}.get(order, math.sin(math.pi / order))  # type: ignore[arg-type]
