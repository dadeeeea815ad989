"""Judges a state of a pattern, by the kernel (`kkt.classify`): does it close, do facets cross, is it a minimum."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from origami_nlp.kkt import (
    classified,
    not_told_apart,
    polished_nearby,
    singular_beside,
)
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import (
    ANSWERED,
    BESIDE_SINGULAR,
    CLOSURE_TOL,
    LEVEL,
    NEAR_CONTACT,
    NONZERO,
    STATIONARY,
    energy_or_zero,
)
from origami_nlp.pattern_problem import MOST_DENSE, PatternProblem
from origami_nlp.search import stationary_beside

FAR_ALONG = 1e-2
"""How far along a mode the energy is asked for [rad]."""
LEFT = 1e-12
"""Torque, relative to the largest, that Newton takes away."""


def judge(problem: PatternProblem, phi: np.ndarray) -> JudgedState:
    """Judge a state.

    Parameters
    ----------
    problem
        The problem.
    phi
        Fold angles [rad], [n]; those off multiples of pi by less than closure can resolve are there.

    Returns
    -------
    JudgedState
        With the verdict and what it rests on.
    """
    phi = np.asarray(phi, float)
    at_limit = problem.fold_limits.clip(phi)
    if np.abs(phi - at_limit).max(initial=0.0) <= CLOSURE_TOL:  # as exactly as states close
        phi = at_limit
    whole = math.pi * np.round(phi / math.pi)
    phi = np.where(np.abs(phi - whole) <= CLOSURE_TOL, whole, phi)
    residual = problem.residual(phi)
    energy = float(energy_or_zero(problem.energy(phi), problem.pattern.stiffness))
    angles = tuple(problem.expand(phi).tolist())
    why = ""
    if not residual <= CLOSURE_TOL:
        why = f"does not close: {residual:.1e}"
    elif not problem.closure.lifts_to_one(phi):
        why = "closes with q = -1 round a vertex: not a sheet of paper"
    elif beyond := problem.beyond(phi, 0.0):
        why = f"beyond the fold limit {problem.name(beyond[0])}"
    if why:
        return JudgedState(energy, angles, "not admissible", why, closure_residual=residual)
    what = classified(problem, phi)
    missing = what.stationarity
    if math.isnan(missing):
        missing = float(np.abs(problem.along(phi, problem.torque(phi))).max(initial=0.0))
    largest = max(float(np.abs(problem.torque(phi)).max(initial=0.0)), NONZERO)
    crossed = problem.crossed(phi) if what.verdict == "not admissible" else ()
    state = JudgedState(
        energy,
        angles,
        what.verdict,
        what.reason,
        what.kind or "",
        what.local_dimension,
        dof=problem.size - problem.rank(phi),
        closure_residual=residual,
        kkt_residual=missing / largest,
        # the numbers of their gaps are those of this problem alone
        contacts=tuple(replace(c, contact=None) for c in what.contacts),
        hessian_eigenvalues=what.eigenvalues,
        crossings=tuple((a + 1, b + 1) for a, b in crossed),
        softest_mode=() if what.mode is None else tuple(problem.expand(what.mode).tolist()),
    )
    mode = what.mode if problem.pattern.laws and state.verdict == "minimum" else None
    if mode is not None and is_level_along(problem, phi, mode[None]):
        why = "hinges are slack beside it: the energy is level one way"
        return replace(state, verdict="undecided", kind="", certificate=why)
    # lower states as well: what closes to rounding may be further off the curve than they are away
    if state.refuted and (why := not_told_apart(problem, phi)):
        return replace(state, verdict="undecided", kind="", certificate=why)
    if state.verdict != "not admissible" and problem.size <= MOST_DENSE:
        left = problem.null_spaces(phi).left_out(problem.closure.values(phi))
        if left > BESIDE_SINGULAR:
            why = f"not decided: closes to {residual:.1e}, and to do so exactly would take a step of {left:.1g} rad"
            return replace(state, verdict="undecided", kind="", certificate=why)
    return state


def is_level_along(problem: PatternProblem, phi: np.ndarray, modes: np.ndarray) -> bool:
    """Return whether the energy is level to one side of a state along some of the directions [k, n].

    Hinges by laws leave whole sets of such states.  Curvature says nothing there: at the edge of a level piece, or
    beyond it by less than rounding, it may be positive.
    """
    for along in (*modes, *-modes):
        end, residual = problem.project(phi + FAR_ALONG * along)
        level = abs(problem.energy_change(phi, end)) <= LEVEL * problem.scale
        if residual <= CLOSURE_TOL and level:
            return True
    return False


def judge_end(problem: PatternProblem, phi: np.ndarray) -> JudgedState:
    """Judge the end of a descent, as `judge`; where torque is left, or closing leaves it loose, the state beside it.

    One held by contacts that leave torque gives way to what is beside it with less, and one that is not decided to the
    state beside it at which creases are flat or fully folded, if that is.
    """
    state = judge(problem, phi)
    better = beside(problem, state)
    state = state if better is None else judge(problem, better)
    if state.verdict == "minimum" and state.contacts and state.kkt_residual > STATIONARY:
        # a soft hinge may pull off a limit by less than is seen beside stiff ones
        ends = polished_nearby(problem, problem.reduce(state.phi), NEAR_CONTACT)
        others = (judge(problem, end.x) for end in ends if end.converged)
        state = min((state, *others), key=lambda s: s.kkt_residual)
    if (
        state.verdict == "undecided"
        and (near := singular_beside(problem, problem.reduce(state.phi))) is not None
    ):
        exact = judge(problem, near)
        state = state if exact.verdict == "undecided" else exact
    return state


def beside(problem: PatternProblem, state: JudgedState) -> np.ndarray | None:
    """Return the stationary state beside one that leaves some torque or closes loosely, [n]; None: there is none."""
    left = state.kkt_residual > LEFT
    if state.refuted:
        left &= state.kkt_residual < ANSWERED
    elif state.verdict in ("minimum", "undecided"):
        left |= problem.loose(problem.reduce(state.phi))
    else:
        return None
    return stationary_beside(problem, problem.reduce(state.phi)) if left else None
