"""Where a curve of equilibria passes the flat state: multipliers pass infinity there.

At such a state x0 closure and held contacts C lose one rank, w' C = 0.  On the curve x = x0 + h d + ..., and the
multipliers are eta w / h + ...; torques balance on the kernel Z of C at h = 0 only if, with Q the second derivative of
w' (closure, openings) on Z,

    Z' grad U(x0; s) = eta Q d,        d' Q d = 0 (closure to second order),

so that g' Q^-1 g = 0 with g = Z' grad U(x0; s): one equation for s, without the curve.  At each of its roots one curve
passes x0, in the direction d = Q^-1 g: where a minimum lies on either side of it, it is born there.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev

from origami_nlp.continuation.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.continuation.line import Line
from origami_nlp.continuation.system import BorderedSystem
from origami_nlp.numerics import CLOSURE_TOL, RANK, SETTLED

MOST_ROWS = 400
"""Equations, or variables, beyond which no curve is asked for: sheets with more have many vertices, and lose a rank of
closure at each of them."""
DEGREES = (4, 16, 64)
"""Of the polynomials through g' Q^-1 g: the first whose last terms are rounding.  Loads and rest angles: 2."""
BESIDE_FLAT = (0.03, 0.01, 0.003)
"""Distance from the flat state [rad] at which a curve that passes it is begun: the first that Newton reaches."""
AT_FLAT = "a flat state: closure loses rank, and multipliers pass infinity"
"""Why a curve is singular there."""
NEAR, ARRIVED, STRAIGHT = 1.0, 0.02, 0.9
"""A curve passes the flat state between two points so near to it [rad], or just after one that is nearer, where the
cosine of both with the direction at a root is so large."""


FlatRoot = tuple[float, np.ndarray]
"""Value of s at which a curve passes the flat state, and the direction in which it goes on, in the metric."""


def flat_event(line: Line, s: float) -> tuple[Equilibrium, float]:
    """Return the flat state at s, and g' Q^-1 g there over the sizes of g and Q^-1; nan where it does not decide."""
    still = np.zeros(line.problem.size)
    system = BorderedSystem(line, np.append(still, s))
    frame = Equilibrium(np.append(still, s), np.append(still, 1.0), system)
    forms = _forms(system, [])
    if forms is None or not forms[0].any():
        return frame, np.nan
    g, q, _ = forms
    size = np.abs(np.linalg.eigvalsh(q))
    # times the smallest |eigenvalue| of Q: between -1 and 1, whatever the units of g and Q are
    return frame, float(g @ np.linalg.solve(q, g) / (g @ g) * size.min())


def flat_roots(line: Line, low: float, high: float) -> list[FlatRoot]:
    """Find where curves of equilibria pass the flat state, whatever curves are known.

    Parameters
    ----------
    line
        The parameters.
    low, high
        The range of s.

    Returns
    -------
    list of tuple
        Each s and the direction d of the curve in the metric, [n], of length 1; none where the flat state is no state,
        or loses more ranks than one.
    """
    flat, first = np.zeros(line.problem.size), list[np.ndarray]()

    def tip(s: float) -> FlatRoot | None:
        """Return g' Q^-1 g and the unit direction of Q^-1 g in the metric; None where they say nothing."""
        if (forms := _forms(BorderedSystem(line, np.append(flat, s)), first)) is None:
            return None
        g, q, z = forms
        d = np.linalg.solve(q, g)
        size = float(np.linalg.norm(d))
        return (float(g @ d), z @ d / size) if size > 0.0 else None

    if tip(low) is None or not line.problem.lifts_to_one(flat):
        return []
    where, half = 0.5 * (low + high), 0.5 * (high - low)

    def value(u: np.ndarray) -> np.ndarray:
        tips = (tip(where + half * float(v)) for v in u)
        return np.array([np.nan if t is None else t[0] for t in tips])

    for degree in DEGREES:
        # g is linear in loads and rest angles and Q does not change with them: a parabola; other lines need higher
        # degrees
        terms = np.asarray(chebyshev.chebinterpolate(value, degree), dtype=float)  # type: ignore[type-var]
        size = np.abs(terms).max()
        if not np.isfinite(size) or size == 0.0:
            return []
        if np.abs(terms[-2:]).max() <= CLOSURE_TOL * size:
            break
    roots = chebyshev.chebroots(chebyshev.chebtrim(terms, CLOSURE_TOL * size))
    real = np.sort(roots.real[(np.abs(roots.imag) <= SETTLED) & (np.abs(roots.real) <= 1.0)])
    at = (where + half * real).tolist()
    return [(s, found[1]) for s in at if (found := tip(s)) is not None]


def passes(roots: Callable[[], list[FlatRoot]], a: Equilibrium, b: Equilibrium) -> FlatRoot | None:
    """Return the root at which a curve passes the flat state between a and b, or just after b; None where it does not.

    The direction is that in which it goes on.  roots: asked for only where both points are near.
    """
    y, z = (f.problem.root * f.state for f in (a, b))
    sizes = np.linalg.norm(y), np.linalg.norm(z)
    if a.hold or max(sizes) > NEAR:
        return None
    out = []
    for s, d in roots():
        onward = d * np.copysign(1.0, d @ (z - y))
        before, after = float(onward @ y), float(onward @ z)
        straight = min(-before / sizes[0], abs(after) / sizes[1]) > STRAIGHT
        if straight and (after > 0 or sizes[1] <= ARRIVED):
            out.append((s, onward))
    return min(out, key=lambda root: abs(root[0] - b.s), default=None)


Sides = tuple[Equilibrium | None, Equilibrium | None]


def beside_flat(line: Line, s: float, direction: np.ndarray) -> Sides:
    """Return a point on either side of the flat state on the curve that passes it at s; None where Newton fails.

    direction: in the metric; the side that it leads to is first, and tangents lead away from the flat state.
    """
    root = line.problem.root
    curve = EquilibriumCurve(line)
    out: list[Equilibrium | None] = []
    # closed states x and -x come in pairs there, equilibria do not: each side is found by itself
    for sign in (1.0, -1.0):
        out.append(None)
        along = np.append(sign * direction, 0.0)
        for h in BESIDE_FLAT:

            def so_far(point: np.ndarray, _: BorderedSystem) -> tuple[np.ndarray, float]:
                return along, h - float(along[:-1] @ (root * point[:-1]))  # noqa: B023

            frame = curve.frame_of(curve.solve(np.append(h * along[:-1] / root, s), so_far), along)
            if frame is not None and np.linalg.norm(root * frame.state) < 2 * h:
                out[-1] = frame
                break
    return out[0], out[1]


def _forms(system: BorderedSystem, first: list[np.ndarray]) -> tuple[np.ndarray, ...] | None:
    """Return g, Q and Z; None where more than one rank is lost, or Q loses one.  first: w, for its sign."""
    if min(system.jacobian.shape) > MOST_ROWS:
        return None
    u, values, vt = np.linalg.svd(system.jacobian)
    rank = int((values > RANK).sum())
    if len(u) == rank or np.abs(system.values).max() > CLOSURE_TOL:
        return None
    lost, z = u[:, rank:], vt[rank:].T
    p, contacts = system.problem, system.hold
    inside = z / p.root[:, None]
    # weight 0 and multipliers -w: the second derivative of w' (closure, openings)
    bends = (p.lagrangian_hessian(system.x, -w, contacts, 0.0) for w in lost.T)
    every = np.array([inside.T @ bend @ inside for bend in bends])
    # rows that depend on each other all along the set say nothing to second order either
    mix, sizes, _ = np.linalg.svd(every.reshape(len(every), -1))
    if int((sizes > RANK).sum()) != 1:
        return None
    w, q = lost @ mix[:, 0], np.tensordot(mix[:, 0], every, 1)
    first[:] = first or [w]
    # a singular vector is known but for its sign, which Q and so g' Q^-1 g take along
    q = q * np.copysign(1.0, w @ first[0])
    size = np.abs(np.linalg.eigvalsh(q))
    if not len(size) or size.min() <= RANK * size.max():
        return None
    return z.T @ system.imbalance, q, z
