"""Barriers where one degree of freedom is left: passes along all curves of closed states, of a vertex or of a pattern.

With one degree of freedom a motion follows its curve, and leaves it at states where curves meet alone: the merge tree
of the curves, cut where the energy is stationary, holds the lowest pass between every two states on them.
"""

from __future__ import annotations

import numpy as np

from origami_nlp.barriers.graph import passes_over
from origami_nlp.barriers.result import Barriers
from origami_nlp.kkt import energy_scale, level_of
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern_states import TracedPasses, curve_passes

FOLLOWED = (
    "no lower path: motions from the first state follow traced curves, up to where others meet them"
)


def pattern_passes(result: MinimaResult) -> tuple[Barriers, TracedPasses] | None:
    """Return the barriers of a pattern on its traced curves, and these curves; None where none are known."""
    problem = result.model
    states = np.array([problem.reduce(m.phi) for m in result.minima])
    traced = curve_passes(problem, result.curves, states) if len(states) else None
    if traced is None:
        return None
    scale = energy_scale(problem.pattern.stiffness)
    level = level_of(problem.energies(states), scale) / problem.scale

    def why(i: int, j: int, height: float) -> str:
        if result.minima[i].dof > 1:
            return ""
        sure = traced.sure.tree.barrier(i, j)
        known = sure is not None and sure.height <= height + level
        # over states at which other curves may leave, no more is known than that energy
        return FOLLOWED if known and traced.least(i, [j], level) >= height - level else ""

    return passes_over(problem, result, traced.passes, problem.scale, why), traced.passes
