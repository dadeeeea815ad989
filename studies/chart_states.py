"""The coordinates in which the paper's grids sample a vertex, and where those charts end.

Degree 6: (phi_2, phi_3).  The chart is singular at (0, 0): there the half-vertex is straight and phi_1 = phi_4 is
free, so that a whole family of states (the book fold) sits on one point, and one step of the grid next to it
spans a radian and more of fold angle.

Degree 8: (elevation v of crease 1, phi_2).  The chart folds over at J = 0, sin |v| = sin(2 alpha_1)
sin(phi_2/2)^2 (the corrected radicand, docs/validation/errata.md, `s3.J`), where its two solution branches meet; and
the solution formula changes case at phi_2 = 0.  The manifold of states is smooth at both.
"""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.chart import chart_of, chart_points
from origami_nlp.numerics import null_space
from origami_nlp.problem import Model

STRETCHED = 1.0
"""A grid step that spans at least this many radians of fold angle is next to a singular chart point."""


def chart_point(model: Model, x: np.ndarray) -> tuple[float, float]:
    """Return the chart coordinates of a state: (phi_2, phi_3), or (elevation, phi_2) with degree 8."""
    chart = chart_of(model.scene)
    assert chart is not None
    first, second = chart_points(chart, model.expand(x)).tolist()
    return (first, second) if chart.kind == "degree6" else (second, first)


def chart_distance(model: Model, x: np.ndarray, y: np.ndarray) -> float:
    """Return the larger difference of the two chart coordinates of two states [rad]."""
    first, second = chart_point(model, x), chart_point(model, y)
    return max(abs(a - b) for a, b in zip(first, second, strict=True))


def chart_end(model: Model, x: np.ndarray, step: float) -> str:
    """Return which end of the chart lies within one grid `step` of state x; empty if none does."""
    if model.scene.degree == 6:
        jac = model.closure(x)[1]
        shown = null_space(jac)[1:3]
        singular = float(np.linalg.svd(shown, compute_uv=False).min())
        span = step / max(singular, 1e-300)
        if span < STRETCHED or max(abs(x[1]), abs(x[2])) > math.pi / 2:
            return ""
        return f"next to (phi_2, phi_3) = (0, 0): one grid step spans {min(span, math.pi):.1f} rad"
    v, fold = chart_point(model, x)
    alpha = model.scene.vertex.sector_angles[0]
    edge = math.asin(min(1.0, math.sin(2 * alpha) * math.sin(fold / 2) ** 2))
    if abs(fold) <= step:
        return "next to phi_2 = 0, where the solution formula changes case"
    if abs(abs(v) - edge) <= step:
        return f"next to J = 0: {abs(abs(v) - edge) / step:.2f} grid steps"
    return ""
