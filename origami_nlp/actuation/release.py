"""From the flat state along a branch, under torques: to the first minimum, along states in which no facets cross."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from origami_nlp.minima import JudgedState
from origami_nlp.numerics import CLOSURE_TOL, SAME_DIRECTION
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import (
    Interpolant,
    contact_descent_off,
    descend,
    follow_curve,
    follow_from_flat,
    halves,
    interpolate,
    judge_end,
    wells,
)

STEP = 0.05
"""Of curves, and first step into a family of several dimensions [rad], root mean square over creases."""
SHRINKS = 0.75
"""How much nearer, over its length, the half of a step must be to closed states than the whole."""
HALVINGS = 0.5, 0.25
"""Of that first step, where a descent does not arrive."""
LOST = "no states follow from the flat one"


def follows(problem: PatternProblem, direction: np.ndarray) -> bool:
    """Return whether closed states leave the flat one along a direction [n].

    Parameters
    ----------
    problem
        Of a flat pattern.
    direction
        Of flat velocities, [n].

    Returns
    -------
    bool
        Whether closed states are near at a step and at half of it, at an angle that shrinks with the step.
    """
    off = []
    for share in (1.0, 0.5):
        step = share * _step(problem, direction)
        phi, residual = problem.project(step)
        if residual > CLOSURE_TOL:
            return False
        off.append(float(np.linalg.norm(phi - step) / np.linalg.norm(step)))
    return off[1] <= max(SHRINKS * off[0], SAME_DIRECTION)


def release_along(
    problem: PatternProblem, direction: np.ndarray, is_line: bool
) -> tuple[JudgedState | None, str]:
    """Go down from the flat state along a branch.

    Parameters
    ----------
    problem
        Of the flat pattern, its springs wound by the torques.
    direction
        Flat velocity on whose side the energy falls, [n].
    is_line
        Whether the branch has one degree of freedom: then it is traced, and its first well is taken.

    Returns
    -------
    state : JudgedState or None
        The first minimum; None where none was reached.
    why : str
        Why not; "" otherwise.
    """
    start, residual = problem.project(_step(problem, direction))
    if residual > CLOSURE_TOL:
        return None, LOST
    if is_line:
        half = _half(problem, start, direction)
        found = wells(problem, half)
        if not found:
            return None, f"no minimum along the branch: {half.ends[1]}"
        well, residual = problem.project(found[0])
        if residual > CLOSURE_TOL:
            return None, f"no minimum along the branch: does not close, {residual:.1e}"
        upto = 1 + int(np.linalg.norm(half.states - well, axis=1).argmin())
        path, end = [*half.states[1:upto], well], descend(problem, well)
    else:
        end = descend(problem, start)
        for share in HALVINGS:  # a descent may stall in rounding beside its end
            if end.arrived:
                break
            start, residual = problem.project(share * _step(problem, direction))
            end = descend(problem, start) if residual <= CLOSURE_TOL else end
        path = [start, *end.path]
    held = contact_descent_off(problem, path)
    end = end if held is None else held
    if not end.arrived:
        return None, end.why
    state = judge_end(problem, end.phi)
    return (state, "") if state.verdict == "minimum" else (None, state.certificate)


def _step(problem: PatternProblem, direction: np.ndarray) -> np.ndarray:
    size = STEP * np.sqrt(problem.size) / np.linalg.norm(direction)
    out: np.ndarray = size * direction
    return out


def _half(problem: PatternProblem, start: np.ndarray, direction: np.ndarray) -> Interpolant:
    """Return the curve through a state beside the flat one [n], from the flat state on."""
    odd = follow_from_flat(problem, start, STEP)
    if odd is not None:
        whole = interpolate(problem, odd)
        at = len(whole.control) // 2
        states = np.concatenate([np.zeros((1, problem.size)), whole.states[at + 1 :]])
        control = np.concatenate([halves(whole.control[at])[1][None], whole.control[at + 1 :]])
        return replace(
            whole, states=states, control=control, ends=("flat", whole.ends[1]), odd=False
        )
    # fold limits differ on the two sides
    curve = follow_curve(problem, np.zeros(problem.size), direction, STEP)
    at = int(np.linalg.norm(curve.phi, axis=1).argmin())
    return interpolate(
        problem,
        replace(
            curve,
            phi=curve.phi[at:],
            arc=curve.arc[at:],
            tangents=curve.tangents[at:],
            bends=curve.bends[at:],
            ends=("flat", curve.ends[1]),
        ),
    )
