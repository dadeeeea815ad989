"""D_n wedge with three creases (degree 4 n): creases 1 and 3 from (elevation, phi_2), of states that wind once.

Paper: eq:rotation-reflection-condition; for n = 2 (degree 8) its solution in section 3, with the
realness condition on J.  Chart: the elevation v of crease 1 (F_1 = Q(e2, v) Q(b_1, phi_1/2): v > 0
LOWERS the mirror creases 1) and phi_2.  Branch +1 and -1 are the sign in front of D as in
`origami_nlp.symbolic.derive.TrigEquation`; negating v and all fold angles exchanges them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from origami_nlp.closed_forms import _dihedral3_numpy
from origami_nlp.closed_forms._chart import (
    ROUNDOFF,
    ChartPoint,
    Reason,
    finish,
    not_finite,
    refine,
    stack_jets,
)
from origami_nlp.errors import AngleError, OptionError

NEAR_FOLD = 1e-3  # below this D^2 its cancellation costs more than three digits


def mirror_pair(n: int) -> tuple[float, float]:
    """(cos pi/n, sin pi/n), exact for n = 2 (the flat state needs cos = 0 exactly)."""
    if int(n) != n or n < 2:
        raise OptionError(f"n must be an integer >= 2 (mirrors of D_n), not {n!r}")
    return (0.0, 1.0) if n == 2 else (float(np.cos(np.pi / n)), float(np.sin(np.pi / n)))


def _evaluate(n: int, alpha1: Any, v: Any, phi2: Any, sign: Any, dtype: Any) -> dict[str, Any]:
    """Flat outputs of the generated function, computed in `dtype`."""
    alpha1, v, phi2, sign = (np.asarray(a, dtype=dtype) for a in (alpha1, v, phi2, sign))
    wedge = np.arctan2(dtype(0), dtype(-1)) / n  # pi/n in the working precision
    c, s = (dtype(0), dtype(1)) if n == 2 else (np.cos(wedge), np.sin(wedge))
    outputs = _dihedral3_numpy.dihedral3(c, s, alpha1, wedge - alpha1, v, phi2, sign)
    return dict(zip(_dihedral3_numpy.OUTPUTS, outputs, strict=True))


def wedge3(n: int, alpha1: Any, elevation: Any, phi2: Any, branch: Any) -> ChartPoint:
    """(phi_1, phi_3) of a D_n-symmetric vertex of degree 4 n on one branch, vectorised.

    n: number of mirrors, >= 2 (n = 2: degree 8); alpha1: sector angle between creases 1 and 2,
        0 < alpha1 < pi/n (alpha_2 = pi/n - alpha1).
    elevation: v in radians, paper's sign; phi2: fold angle of crease 2; branch: +1 or -1.
    existence: D^2 = 1 - p_x^2 - sin(pi/n)^2 cos(v)^2, p_x = c_1 . c_3; the paper's J^2 is 16 D^2
        (n = 2, with cos 2v where 8 cos v is printed).
    reason: NO_SOLUTION where D^2 < 0; FOLD on D = 0, where the branches meet and derivatives are
        infinite; OTHER_LIFT where |phi_1| or |phi_3| would exceed pi; SINGULAR where c_1 = +-c_3,
        and for n = 2 at v = 0 (crease 1 in the sheet's plane: phi_1 is free there).
    own_side: cos v >= 0 and c_3 . b_3 >= 0, needed of an embedded state (not of closure).  For
        n = 2 and v > 0 this is branch -1, for v < 0 branch +1.

    Accuracy of values: 1e-14 (|phi| + sum |d phi/d x| |x|).  On D = 0 the derivatives are infinite
    and D^2 is a difference of two rounded numbers, so points with D^2 < 1e-3 are evaluated in
    extended precision: 1e-12 relative down to |D^2| = 1e-12 where the platform's long double has
    64 bits of mantissa; with a plain double, next to c_1 = c_3 (alpha_1 = alpha_2, phi_2 = pi) and
    where a fold angle passes through zero only the first bound holds.
    Raises AngleError for a sector angle outside the wedge, OptionError for n or branch.
    """
    s = mirror_pair(n)[1]
    first = np.asarray(alpha1, dtype=float)
    if np.any(first <= 0) or np.any(first >= np.pi / n):
        raise AngleError(f"alpha1 must lie strictly between 0 and pi/{n}")
    sign = np.asarray(branch, dtype=float)
    if np.any(np.abs(sign) != 1):
        raise OptionError("branch must be +1 or -1")
    v, fold = np.asarray(elevation, dtype=float), np.asarray(phi2, dtype=float)
    with np.errstate(all="ignore"):
        flat = _evaluate(n, first, v, fold, sign, np.float64)
        near = np.abs(flat["existence"]) < NEAR_FOLD
        if np.any(near):
            a, b, c, d = (x[near] for x in np.broadcast_arrays(first, v, fold, sign))
            refine(flat, near, _evaluate(n, a, b, c, d, np.longdouble))
        value, d1, d2 = stack_jets(flat, ["phi1", "phi3"], ["elevation", "phi2"])
        elev = (s * np.sin(v)) ** 2
        existence = np.asarray(flat["existence"])
        on_fold = np.abs(existence) <= ROUNDOFF * (2 * elev - existence)
        reason = np.zeros(value.shape[:-1], dtype=np.int8)

        def mark(mask: Any, code: Reason) -> None:
            reason[np.broadcast_to(mask, reason.shape)] = code

        # what is marked later overrides
        mark(np.any(np.abs(value) > np.pi * (1 + ROUNDOFF), axis=-1), Reason.OTHER_LIFT)
        mark(on_fold & (reason == Reason.OK), Reason.FOLD)
        mark((existence < 0) & ~on_fold, Reason.NO_SOLUTION)
        singular = (flat["ring"] < ROUNDOFF**2) | (flat["pole"] < ROUNDOFF**2)
        mark(singular, Reason.SINGULAR)
        mark(not_finite(first, v, fold), Reason.NOT_FINITE)
    own = (flat["side"] >= 0) & (np.cos(v) >= 0)
    own_side = np.broadcast_to(own, reason.shape)
    return finish((value, d1, d2), reason, np.broadcast_to(existence, reason.shape), own_side)
