"""A descent that anyone can replay: states that close, are admissible, fall in energy, and end at a stable state.

Between states at which it decides anew the batch goes down (`Follower.steps`); from one that is refuted it goes on at
the lower state that refutes it.  Unlike a restart of a solver it does not jump to another basin: it is the evidence
for what becomes of a state that is not stable.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt import Classification, classified, polished_nearby, project
from origami_nlp.numerics import CLOSURE_TOL, EPS
from origami_nlp.pattern_problem import PatternProblem, find_labels
from origami_nlp.search.follow import Follower
from origami_nlp.search.newton import descend_by_newton

LONGEST = 0.1
"""Step [rad]."""
MOST_REFUTED = 12
"""Refuted states that it goes on from."""
TRIED = (1e-3, 3e-3, 1e-4)
"""Steps [rad] along a direction of descent."""
RISE = 1e-7
"""Relative rise of the energy that is allowed to the end when it is polished."""


@dataclass(frozen=True)
class DescentPath:
    """A descent and where it ends.

    Attributes
    ----------
    states
        Closed and admissible, [S, n] [rad], the start first.
    energies
        Of them, [S], strictly decreasing.
    what
        The last one, classified.
    """

    states: np.ndarray
    energies: np.ndarray
    what: Classification

    @property
    def end(self) -> np.ndarray:
        """The last state, [n]."""
        last: np.ndarray = self.states[-1]
        return last

    @property
    def arrives(self) -> bool:
        """Whether it ends at a minimum."""
        return self.what.verdict == "minimum"


def descent_path(
    problem: PatternProblem, start: np.ndarray, *, longest: float = LONGEST
) -> DescentPath:
    """Follow a state downhill to a stable one.

    Parameters
    ----------
    problem
        Of a vertex or a sheet.
    start
        A state, [n] [rad]; it is closed first.
    longest
        Step [rad].

    Returns
    -------
    DescentPath
        The states; of one that is left by no step the start alone.

    Raises
    ------
    ValueError
        If the start does not close, or is not admissible.

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp import examples, pose
    >>> from origami_nlp.search import descent_path
    >>> problem = pose(examples.miura("pi/3"))
    >>> path = descent_path(problem, problem.project(np.full(problem.size, 0.5))[0])
    >>> path.arrives, bool(path.energies[-1] < path.energies[0])
    (True, True)
    """
    x, residual = project(problem, np.asarray(start, dtype=float), ())
    x = problem.fold_limits.clip(x)
    refused = f"closure {residual:.1e}" if residual > CLOSURE_TOL else problem.refuses(x)
    if refused:
        raise ValueError(f"the start is not a closed, admissible state: {refused}")
    follower, aside, states = Follower(problem), side_of_saddles(problem), [x]
    for left in reversed(range(MOST_REFUTED)):
        states += _steps(problem, follower, states[-1], aside, longest)
        what = classified(problem, states[-1])
        if what.verdict == "undecided" and (end := _polished(problem, states[-1])) is not None:
            states[-1], what = end, classified(problem, end)
        lower = None if what.verdict == "minimum" else lower_beside(problem, states[-1], what)
        if lower is None or not left:
            break
        states.append(lower)
    path = _falling(problem, states)
    energies = problem.energy(x) + np.array([problem.energy_change(x, y) for y in path])
    return DescentPath(path, energies, what)


def side_of_saddles(problem: PatternProblem) -> np.ndarray:
    """Return a direction [n] that labels do not change: to which side descents leave saddles."""
    drawn = np.random.default_rng(0).normal(size=problem.pattern.creases)
    side: np.ndarray = problem.reduce(find_labels(problem.pattern).drawn(drawn))
    return side


def lower_beside(problem: PatternProblem, x: np.ndarray, what: Classification) -> np.ndarray | None:
    """Return the lower admissible state beside one that is no minimum, or a step along its direction of descent."""
    if what.lower is not None or what.descent is None:
        return what.lower
    for step in TRIED:
        y, residual = project(problem, x + step * what.descent, ())
        y = problem.fold_limits.clip(y)
        closes = max(float(residual), problem.residual(y)) <= CLOSURE_TOL
        if closes and problem.energy_change(x, y) < -_noise(problem, x) and not problem.refuses(y):
            return y
    return None


def _steps(
    problem: PatternProblem, follower: Follower, x: np.ndarray, aside: np.ndarray, longest: float
) -> list[np.ndarray]:
    """Return where steps down lead, without compiled descents Newton's, as far as no facets cross."""
    if follower.usable:
        path = follower.steps(x, aside, longest)
    else:
        path = np.array(descend_by_newton(problem, x, side=aside).path[1:]).reshape(-1, len(x))
    return list(itertools.takewhile(lambda y: not problem.refuses(y), path))


def _polished(problem: PatternProblem, x: np.ndarray) -> np.ndarray | None:
    """Return the stationary state beside an end that no step leaves."""
    most = RISE * max(float(problem.energy(x)), float(problem.scale))
    ends = (p.x for p in polished_nearby(problem, x) if problem.energy_change(x, p.x) <= most)
    return next((y for y in ends if not problem.refuses(y)), None)


def _noise(problem: PatternProblem, x: np.ndarray) -> float:
    return float(2 * EPS * max(abs(problem.energy(x)), problem.scale))  # two roundings


def _falling(problem: PatternProblem, states: list[np.ndarray]) -> np.ndarray:
    """Keep the states whose energy falls by more than rounding, and the end in place of what is level with it."""
    noise = _noise(problem, states[0])
    kept = [states[0]]
    for y in states[1:]:
        while len(kept) > 1 and y is states[-1] and problem.energy_change(kept[-1], y) >= -noise:
            kept.pop()
        if problem.energy_change(kept[-1], y) < -noise:
            kept.append(y)
        elif len(kept) == 1 and y is states[-1]:
            kept = [y]
    return np.array(kept)
