"""Curvature along the curves that leave a flat state where the energy is level along all of them.

A line of the tangent cone that is met once is the tangent of one curve of closed states.  Turned over, a closed state x
is -x, so that the curve is its own mirror image, x(-t) = -x(t): it has no part in t^2, and the energy changes by
d' K d t^2 / 2 + O(t^3), whatever multipliers closure lacks.
"""

from __future__ import annotations

import numpy as np

from origami_nlp.kkt.projection import project
from origami_nlp.kkt.state import State
from origami_nlp.numerics import CLOSURE_TOL, CURVED, INDEPENDENT, RANK

BESIDE_FLAT = 1e-3
"""Distance from the flat state at which its curves are looked at [rad]: closure misses by its square, no rounding."""


def curves_up(state: State) -> bool:
    """Return whether the energy at a flat state is level along all curves that leave it, and curves up on each."""
    cone, p = state.tangent_cone, state.problem
    if state.x.any() or cone.reason or not cone.split or cone.families or not len(cone.lines):
        return False
    level = INDEPENDENT * float(np.abs(state.gradient).max(initial=0.0))
    if any(abs(state.gradient @ d) > level or not _met_once(state, d) for d in cone.lines):
        return False
    h = p.lagrangian_hessian(state.x, np.zeros(p.equation_count)) / np.outer(p.root, p.root)
    return min(float(d @ h @ d) for d in cone.lines) > CURVED


def _met_once(state: State, d: np.ndarray) -> bool:
    """Return whether closed states leave the flat one along d on one curve, and closure bends as it should there.

    What holds them to the curve grows as the distance where the line is a single root of closure to second order, and
    as its square where two curves are tangent.
    """
    p = state.problem
    held = []
    for far in (BESIDE_FLAT, BESIDE_FLAT / 2):
        x, residual = project(p, far * d / p.root)
        if residual > CLOSURE_TOL or np.abs(x * p.root / far - d).max() > 10 * BESIDE_FLAT:
            return False
        values = np.linalg.svd(p.closure(x)[1] / p.root, compute_uv=False)
        # n - 1 singular values do not vanish where one degree of freedom is left, and the last of them measures how
        # sharply
        across = len(x) - 2  # of all directions but the one along the curve the weakest
        held.append(float(values[across]) if 0 <= across < len(values) else 0.0)
    return held[1] > RANK and held[0] < 3 * held[1]
