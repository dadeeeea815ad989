"""IPOPT asked for a second opinion on minima of a pattern: another solver, on symbols that share nothing with ours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt import State, classify
from origami_nlp.minima import MOST_CONFIRMED, Confirmation, JudgedState, confirm_posed, gaps_of
from origami_nlp.pattern_problem import PatternProblem, independent_rows, pose
from origami_nlp.problem import Contact


@dataclass(frozen=True)
class IpoptConfirmation:
    """What IPOPT says of a minimum of a pattern.

    Attributes
    ----------
    solver
        Whether it stays at the state; None where it was not asked.
    forces
        Multipliers of the closed contacts: ours and IPOPT's over the mean stiffness, [r] each.
    left
        Largest torque over the mean stiffness that IPOPT's multipliers leave along closure: where multipliers are not
        unique its are others than ours, and balance the springs as well.
    reason
        Why it was not asked; empty where it was.
    """

    solver: Confirmation | None
    forces: tuple[np.ndarray, np.ndarray]
    left: float
    reason: str = ""


def confirm_minimum(problem: PatternProblem, minimum: JudgedState) -> IpoptConfirmation:
    """Let IPOPT solve from a minimum with its contacts closed, and compare the multipliers.

    Parameters
    ----------
    problem
        The problem.
    minimum
        A minimum of it.

    Returns
    -------
    IpoptConfirmation
        The comparison; of patterns with more than `MOST_CONFIRMED` creases, and of states where closure loses rank so
        that no choice of its rows stands for all of them, why there is none.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern_problem import PatternProblem
    >>> from origami_nlp.pattern_states import confirm_minimum
    >>> found = o.find_minima("metasheet:3x3", starts=2)
    >>> said = confirm_minimum(PatternProblem(found.pattern), found.minima[0])
    >>> said.solver.agrees, said.left < 1e-6
    (True, True)
    """
    none = np.zeros(0), np.zeros(0)
    if problem.size > MOST_CONFIRMED:
        return IpoptConfirmation(None, none, np.nan, f"more than {MOST_CONFIRMED} creases")
    state = State(problem, minimum.phi)
    if not state.regular:
        return IpoptConfirmation(None, none, np.nan, "closure loses rank")
    stratum = state.on([c.contact for c in classify(state).contacts if c.contact is not None])
    rows = independent_rows(problem, state.x)
    touches = [problem.touch(Contact("gap", k, 1)) for k in gaps_of(stratum)]
    solver, forces = confirm_posed(pose(problem, rows, touches), stratum, rows)
    torque = state.kernel.T @ (state.gradient - stratum.slopes.T @ forces)
    left = float(np.abs(torque).max(initial=0.0))
    return IpoptConfirmation(solver, (stratum.multiplier_set.smallest, forces), left)
