"""How many random errors states of a sheet survive: `minima.with_survival`, with the descents of sheets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp import minima
from origami_nlp.minima import NOISE as NOISE, JudgedState
from origami_nlp.pattern_problem import MOST_DENSE, CanonicalLabelling, PatternProblem
from origami_nlp.pattern_states.closed import close
from origami_nlp.pattern_states.contact_descents import contact_descent
from origami_nlp.pattern_states.descent import descend
from origami_nlp.pattern_states.judgement import judge

OPENED = 1.0, 0.99, 0.97, 0.94
"""Of a state's fold angles, from where it is gone down."""


def with_survival(
    problem: PatternProblem,
    labels: CanonicalLabelling,
    states: Sequence[JudgedState],
    contact: bool,
    degrees: float,
) -> list[JudgedState]:
    """Follow the minima of a sheet into sheets with random errors, facets apart or (without contact) not."""
    exact = problem.with_contact(contact)
    return minima.with_survival(exact, labels, states, degrees, _gone_down)


def _gone_down(problem: PatternProblem, x: np.ndarray) -> np.ndarray | None:
    """Descend from a closed state near one: at fully folded and flat creases errors may leave none."""
    pressed = problem.contact and problem.size <= MOST_DENSE
    for share in OPENED:
        start = close(problem, share * x)
        if start is None or (pressed and problem.crossings.find(start)):
            continue
        end = contact_descent(problem, start, keep=True) if pressed else descend(problem, start)
        state = judge(problem, end.phi, problem.contact) if end.arrived else None
        if state is not None and state.verdict == "minimum":
            return state.phi
    return None
