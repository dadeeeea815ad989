"""D_1, degree 6: the two mirror creases 1 and 4 from the fold angles 2 and 3 between them.

Paper: eq:reflection-condition, solved for degree 6 in eq:phi1-6-fold (which gives phi_1 only, for
one family of sector angles, and not its lift).  Here phi_1 = -2 arg(u v), phi_k = 2 arg(u conj v)
with u = m_w + i m_x, v = m_y + i m_z and M the quaternion of the creases strictly between the
mirror creases; see `origami_nlp.symbolic.generate_forms`.

Accuracy of values: 1e-14 (|phi| + sum |d phi/d x| |x|) everywhere, so 1e-12 relative next to the
book fold.  The relative error alone cannot stay small where phi_1 itself passes through zero, nor where
creases 1 and 4 coincide (u = 0: rounding turns arg u by eps/|u|).  Extended precision is used where
|u| or |v| < 0.03, so the error there is 1e-18/|u| with a 64-bit mantissa: 1e-12 down to |u| = 1e-6,
1e-10 at 1e-8.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from origami_nlp.closed_forms import _degree6_numpy
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
    """Reason codes from |u|^2, |v|^2 and the margin of the lift."""
    shape = np.broadcast_shapes(np.shape(flat["margin"]), np.shape(bad))
    reason = np.zeros(shape, dtype=np.int8)
    reason[np.broadcast_to(flat["margin"] < -ROUNDOFF, shape)] = Reason.OTHER_LIFT
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
    existence: |m_w m_y| - |m_x m_z|; the completion with |phi_1|, |phi_4| <= pi is on the lift
        q = +1 exactly where it is >= 0.  It is unique, except that +pi and -pi are the same shape
        on the boundary: there the sign is the one of the limit from inside when that exists.
    reason: SINGULAR at (0, 0), where crease 4 is opposite to crease 1 and phi_1 = phi_4 is free
        (book fold), and where creases 1 and 4 coincide (phi_1 = -phi_4 + const is free), which
        happens for alpha_1, alpha_2, alpha_3 <= pi/2; OTHER_LIFT where no state exists.

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
