"""The one projection onto closure: Gauss-Newton with contacts or fold angles held, one state or many."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from origami_nlp.numerics import CONTACT_TOL, NONZERO, ROUNDED, shortest_solution
from origami_nlp.problem import Contact, Problem, held

UNRESOLVED = CONTACT_TOL
"""Singular values below this share of the largest are left out, those that closure has this far [rad] from a singular
state: what it does not resolve does not move."""
LONGEST_MOVE = 1.0
"""Steps are cut to this length [rad], within which a product of folds is nearly linear."""
PROJECTED = 30
"""Steps of a projection."""


def project(
    problem: Problem,
    x: np.ndarray,
    contacts: Sequence[Contact] = (),
    *,
    frozen: np.ndarray | None = None,
    steps: int = PROJECTED,
    dependent: float = UNRESOLVED,
    stalls: float = math.inf,
) -> tuple[np.ndarray, np.ndarray]:
    """Move states onto closure with contacts held, by steps of smallest length in the metric of all fold angles.

    Parameters
    ----------
    x
        One state [n] or states [K, n].
    contacts
        Held closed; fold limits exactly.
    frozen
        Entries of x that stay as they are, same shape as x.
    dependent
        Singular values below this share of the largest are left out.
    stalls
        One state is given up where steps, from the second on, leave more than this share of the residual: constraints
        that cannot be met together.

    Returns
    -------
    x
        Where the steps ended, same shape.
    residual
        Largest entry of closure and openings, [] or [K]: whether that is close enough is for the caller to say; inf
        where steps of one state led to where a gap is not defined.
    """
    problem.check_time()  # where constraints cannot be met together, there are many in a row
    x = held(x, contacts)
    root = problem.root
    if x.ndim == 1:
        still = ~frozen if frozen is not None else None
        before = math.inf
        for step in range(steps + 1):
            # the retraction of the paper's eq. A8, with normal directions taken at each iterate, not at the first state
            try:
                f, jac = problem.constraints(x, contacts)
            except ArithmeticError:  # where sides run along each other there is no gap between them
                return x, np.array(math.inf)
            residual = np.abs(f).max(initial=0.0)
            if residual <= ROUNDED or step == steps or (step > 1 and residual > stalls * before):
                break
            before = residual
            # columns of what is frozen are zero, so that the step of smallest norm does not move it
            jac = jac / root if still is None else jac / root * still
            move = shortest_solution(jac, f, dependent)
            x = x - move * (
                min(1.0, LONGEST_MOVE / max(float(np.linalg.norm(move)), NONZERO)) / root
            )
            for contact in contacts:
                contact.hold(x)
        return x, residual
    residual = np.full(len(x), np.inf)
    todo = np.arange(len(x))
    for step in range(steps + 1):
        f, jac = problem.constraints(x[todo], contacts)
        residual[todo] = np.abs(f).max(axis=1, initial=0.0)
        far = residual[todo] > ROUNDED
        todo, f, jac = todo[far], f[far], jac[far] / root
        if not len(todo) or step == steps:  # the residual is that of the state returned
            break
        if frozen is not None:
            jac = np.where(frozen[todo][:, None, :], 0.0, jac)
        move = np.einsum("kij,kj->ki", np.linalg.pinv(jac, rcond=dependent), f)
        length = np.linalg.norm(move, axis=1, keepdims=True)
        x[todo] -= move * np.minimum(1.0, LONGEST_MOVE / np.maximum(length, NONZERO)) / root
        for contact in contacts:
            contact.hold(x)
    return x, residual
