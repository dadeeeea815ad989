"""D_1: the two mirror creases of a reflection-symmetric vertex from the fold angles between them.

Paper: eq:reflection-condition, solved for degree 6 in eq:phi1-6-fold (which gives phi_1 only, for
one family of sector angles, and not its sheet).  Here phi_1 = -2 arg(u v), phi_k = 2 arg(u conj v)
with u = m_w + i m_x, v = m_y + i m_z and M the quaternion of the creases strictly between the
mirror creases; see `symbolic.generate_forms`.

Accuracy of values: 1e-14 (|phi| + sum |d phi/d x| |x|) everywhere, so 1e-12 relative next to the
book fold.  The relative error alone cannot stay small where phi_1 itself passes through zero, nor where
creases 1 and 4 coincide (u = 0: rounding turns arg u by eps/|u|).  `degree6` uses extended
precision where |u| or |v| < 0.03, so its error there is 1e-18/|u| with a 64-bit mantissa: 1e-12 down
to |u| = 1e-6, 1e-10 at 1e-8.  `reflection` works in doubles throughout.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from origami_nlp.closed_forms import _degree6_numpy, _mirror_numpy
from origami_nlp.closed_forms._chart import (
    ROUNDOFF,
    ChartPoint,
    Reason,
    finish,
    not_finite,
    refine,
    stack_jets,
)
from origami_nlp.errors import AngleError

NEAR_SINGULAR = 1e-3  # |u|^2 or |v|^2 below which cancellation costs more than a digit and a half


def _reflection_reason(flat: dict[str, Any], bad: np.ndarray) -> np.ndarray:
    """Reason codes from |u|^2, |v|^2 and the sheet margin."""
    shape = np.broadcast_shapes(np.shape(flat["margin"]), np.shape(bad))
    reason = np.zeros(shape, dtype=np.int8)
    reason[np.broadcast_to(flat["margin"] < -ROUNDOFF, shape)] = Reason.NOT_ON_SHEET
    singular = np.minimum(flat["u_squared"], flat["v_squared"]) < ROUNDOFF**2
    reason[np.broadcast_to(singular, shape)] = Reason.SINGULAR
    reason[np.broadcast_to(bad, shape)] = Reason.NOT_FINITE
    return reason


def _evaluate6(arguments: Sequence[np.ndarray]) -> dict[str, Any]:
    """Flat outputs of the generated degree-6 function, in the precision of the arguments."""
    alpha1, alpha2, phi2, phi3 = arguments
    outputs = _degree6_numpy.degree6(alpha1, alpha2, phi2, phi3)
    return dict(zip(_degree6_numpy.OUTPUTS, outputs, strict=True))


def degree6(alpha1: Any, alpha2: Any, phi2: Any, phi3: Any) -> ChartPoint:
    """(phi_1, phi_4) of a D_1-symmetric degree-6 vertex from (phi_2, phi_3), vectorised.

    alpha1, alpha2: sector angles in radians, alpha_1, alpha_2, pi - alpha_1 - alpha_2 > 0; no
        other restriction (the paper has alpha_2 = pi - 2 alpha_1).
    phi2, phi3: fold angles in radians (phi_6 = phi_2, phi_5 = phi_3); any real number, though
        fold angles of paper are in [-pi, pi].
    existence: |m_w m_y| - |m_x m_z|; the completion with |phi_1|, |phi_4| <= pi is on the sheet
        q = +1 exactly where it is >= 0.  It is unique, except that +pi and -pi are the same shape
        on the boundary: there the sign is the one of the limit from inside when that exists.
    reason: SINGULAR at (0, 0), where crease 4 is opposite to crease 1 and phi_1 = phi_4 is free
        (book fold), and where creases 1 and 4 coincide (phi_1 = -phi_4 + const is free), which
        happens for alpha_1, alpha_2, alpha_3 <= pi/2; NOT_ON_SHEET where no state exists.

    Raises AngleError for sector angles that are not positive or leave no third one.
    """
    if np.any(np.asarray(alpha1) <= 0) or np.any(np.asarray(alpha2) <= 0):
        raise AngleError("sector angles alpha1 and alpha2 must be positive: give radians > 0")
    if np.any(np.asarray(alpha1) + np.asarray(alpha2) >= np.pi):
        raise AngleError("alpha1 + alpha2 must be less than pi: the mirror crease 4 is at pi")
    arguments = [np.asarray(a, dtype=float) for a in (alpha1, alpha2, phi2, phi3)]
    with np.errstate(all="ignore"):
        flat = _evaluate6(arguments)
        near = np.asarray(np.minimum(flat["u_squared"], flat["v_squared"]) < NEAR_SINGULAR)
        if np.any(near):
            points = [a[near].astype(np.longdouble) for a in np.broadcast_arrays(*arguments)]
            refine(flat, near, _evaluate6(points))
        jets = stack_jets(flat, ["phi_first", "phi_last"], ["phi2", "phi3"])
    reason = _reflection_reason(flat, not_finite(*arguments))
    return finish(jets, reason, np.asarray(flat["margin"]), np.ones(reason.shape, dtype=bool))


def times_crease(q: Sequence[Any], cos_half: Any, sin_half: Any, bx: Any, by: Any) -> list[Any]:
    """Quaternion q (cos_half, sin_half (bx, by, 0)) on components of NumPy arrays or CasADi."""
    w, x, y, z = q
    sx, sy = sin_half * bx, sin_half * by
    return [
        w * cos_half - x * sx - y * sy,
        w * sx + x * cos_half - z * sy,
        w * sy + y * cos_half + z * sx,
        z * cos_half + x * sy - y * sx,
    ]


def _times(p: Sequence[Any], q: Sequence[Any]) -> list[Any]:
    """Hamilton product on component lists."""
    a, b, c, d = p
    w, x, y, z = q
    return [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ]


def _inner_jets(azimuths: Sequence[float], folds: np.ndarray) -> tuple[np.ndarray, ...]:
    """M with dM/dphi_i = c_i M / 2 and d2M/dphi_i dphi_j = c_i c_j M / 4, i <= j (c_i deformed)."""
    shape, k = folds.shape[:-1], folds.shape[-1]
    one, zero = np.ones(shape), np.zeros(shape)
    so_far: list[Any] = [one, zero, zero, zero]
    creases = []
    for i, a in enumerate(azimuths):
        bx, by = np.cos(a), np.sin(a)
        conjugate = [so_far[0], -so_far[1], -so_far[2], -so_far[3]]
        creases.append(_times(times_crease(so_far, 0.0, 1.0, bx, by), conjugate))
        half = folds[..., i] / 2
        so_far = times_crease(so_far, np.cos(half), np.sin(half), bx, by)
    first = [_times(c, so_far) for c in creases]
    m1 = np.stack([np.stack(np.broadcast_arrays(*f), axis=-1) for f in first], axis=-1) / 2
    m2 = np.empty((*shape, 4, k, k))
    for j in range(k):
        for i in range(j + 1):
            entry = np.stack(np.broadcast_arrays(*_times(creases[i], first[j])), axis=-1) / 4
            m2[..., i, j] = entry
            m2[..., j, i] = entry
    return np.stack(np.broadcast_arrays(*so_far), axis=-1), m1, m2


def reflection(azimuths: Sequence[float], folds: Any) -> ChartPoint:
    """(phi_1, phi_k) of a D_1-symmetric vertex of any even degree N = 2 (k - 1).

    azimuths: of the inner creases 2 .. k-1, increasing, strictly between 0 and pi (crease 1 is at
        0 and crease k at pi), radians.
    folds: fold angles of the inner creases, shape S + (k - 2,), radians.
    value: S + (2,); first: S + (2, k - 2); second: S + (2, k - 2, k - 2).
    existence, reason: as in `degree6`.

    Raises AngleError for azimuths out of order or a wrong number of fold angles.
    """
    places = [float(a) for a in azimuths]
    if not places or any(b <= a for a, b in zip([0.0, *places], [*places, np.pi], strict=True)):
        raise AngleError(f"inner azimuths must increase strictly between 0 and pi, not {places}")
    angles = np.asarray(folds, dtype=float)
    if angles.ndim == 0 or angles.shape[-1] != len(places):
        raise AngleError(f"{len(places)} inner creases need folds of shape (.., {len(places)})")
    with np.errstate(all="ignore"):
        m, m1, m2 = _inner_jets(places, angles)
        components = [m[..., i] for i in range(4)]
        outputs = _mirror_numpy.mirror(*components)
        flat = dict(zip(_mirror_numpy.OUTPUTS, outputs, strict=True))
        value, by_m, by_mm = stack_jets(flat, ["phi_first", "phi_last"], ["mw", "mx", "my", "mz"])
        first = np.einsum("...aq,...qi->...ai", by_m, m1)
        second = np.einsum("...apq,...pi,...qj->...aij", by_mm, m1, m1)
        second += np.einsum("...aq,...qij->...aij", by_m, m2)
    reason = _reflection_reason(flat, ~np.all(np.isfinite(angles), axis=-1))
    jets = (value, first, second)
    return finish(jets, reason, np.asarray(flat["margin"]), np.ones(reason.shape, dtype=bool))
