"""What bounds barriers from below: the flat state of a vertex, and that states are isolated."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from origami_nlp.barriers.passes import Known, Pass
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import BESIDE_SINGULAR, DUPLICATE_TOL, INPUT_TOL
from origami_nlp.pattern_problem import PatternProblem, angle_sums

SHOWN = (
    "the lowest path that is known, on traced curves, by descents, straight, or over a saddle: an upper bound; "
    "contact may be missed between its states, and lower ones are not excluded"
)
FOLLOWED = (
    "no lower path: motions from the first state follow traced curves, up to where others meet them"
)
NONE = "no admissible path is known"
PROVED = "proved: admissible states above and below the flat state meet there only"
NEVER = "no path: with less than 360 degrees of paper a vertex keeps its sign (proved)"
STOPPED = "no path: each makes a vertex flat, which a stop forbids (proved)"
RIGID = "no path: one of the two is isolated, as its certificate says"


def side_of_flat(fold_angles: np.ndarray) -> np.ndarray:
    """Return on which side of the flat state admissible states [..., N] lie: the sign of the sum of all fold angles.

    Up (+1) and down (-1) are joined by admissible states only through the flat state (0), symmetric or not: round
    every other one |sum phi| >= 2 pi - area(K) > 0, with K the convex hull of the spherical polygon of the vertex,
    facets that touch included (proved in docs/validation/landscapes.md).
    """
    phi = np.asarray(fold_angles, dtype=float)
    total = phi.sum(axis=-1)
    unclear = np.abs(total) <= phi.shape[-1] * DUPLICATE_TOL
    flat = np.abs(phi).max(axis=-1) <= BESIDE_SINGULAR
    return np.where(flat | unclear, 0, np.sign(total)).astype(int)


def flat_bound(problem: PatternProblem) -> tuple[float, str]:
    """Return what paths between the sides of the flat state climb to at least, and why; nan: nothing parts them."""
    vertices, pattern = problem.pattern.vertices, problem.pattern
    if not problem.contact or len(vertices) != 1 or len(vertices[0].creases) != pattern.creases:
        return math.nan, SHOWN
    paper = angle_sums(pattern)[vertices[0].vertex] - 2 * math.pi
    if paper > INPUT_TOL:
        return math.nan, SHOWN
    if paper < -INPUT_TOL:
        return math.inf, NEVER
    flat = np.zeros(problem.size)
    if not problem.fold_limits.inside(flat).all():
        return math.inf, STOPPED
    return float(problem.energy(flat)), PROVED


def bounded(p: Pass, result: MinimaResult, flat: tuple[float, str], level: float) -> Pass:
    """Add what bounds a pass from below.

    flat: see `flat_bound`.  level: energies that are no more apart are the same.
    """
    one, two = (result.minima[k - 1] for k in p.pair)
    if not (len(p.path) or (one.local_dimension and two.local_dimension)):
        return replace(p, known=Known.EXACT, why=RIGID)
    least, why = flat
    across = side_of_flat(np.array(one.fold_angles)) * side_of_flat(np.array(two.fold_angles)) < 0
    if math.isnan(least) or not across or p.known is Known.EXACT:
        return p
    exact = {"known": Known.EXACT, "why": why} if p.energy <= least + level else {}
    return replace(p, least=least, **exact)  # type: ignore[arg-type]
