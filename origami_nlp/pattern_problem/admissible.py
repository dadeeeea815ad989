"""Does a state close, and may its facets be where they are?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_angles, check_number
from origami_nlp.numerics import CLOSURE_TOL, CONTACT_TOL
from origami_nlp.pattern import Scene, Stated, Vertex, as_origami
from origami_nlp.pattern_problem.posing import pose
from origami_nlp.pattern_problem.problem import PatternProblem

LARGEST_TOLERANCE = 0.01
"""Wider, and facets that stand apart would be ordered as if they touched [rad]."""


@dataclass(frozen=True)
class Embedding:
    """What is wrong with a state as a piece of paper, if anything.

    Attributes
    ----------
    admissible
        Whether it closes on the lift q = +1, keeps its fold limits and its facets do not cross.
    reason
        Why not, or why it is not known; empty when admissible.
    closure_residual
        Largest entry of closure as the state is given.
    """

    admissible: bool
    reason: str
    closure_residual: float


def check_admissible(
    origami: Vertex | Stated | PatternProblem,
    fold_angles: np.ndarray,
    *,
    tolerance: float = CONTACT_TOL,
) -> Embedding:
    """Return whether a state is admissible with full contact, and why not if not.

    Parameters
    ----------
    origami
        A vertex, what `as_origami` takes, or either as `pose_paper` poses it.  Of a scene with a symmetry touching
        layers must have an order with that symmetry as well: equal fold angles do not make a stack symmetric.
    fold_angles
        Of one state, shape [N] [rad], valley positive.
    tolerance
        By how much they may be off [rad], 0 to 0.01: creases that are so near to a limit are at it, and the closed
        state beside them is asked for.

    Returns
    -------
    Embedding
        Whether it is admissible, the reason why not, and how well it closes.

    Raises
    ------
    AngleError
        If `fold_angles` are not N finite numbers.
    OptionError
        If another argument is not what it must be.

    Examples
    --------
    >>> from origami_nlp import Vertex, check_admissible
    >>> check_admissible(Vertex(("pi/2",) * 4), [1, 0, 1, 0]).admissible
    True
    >>> check_admissible(Vertex(("pi/2",) * 4), [1, 0, 1, 0.5]).reason
    'does not close: 2.5e-01'
    >>> check_admissible("miura:2x2", [0] * 4).admissible
    True
    """
    problem = origami if isinstance(origami, PatternProblem) else pose_paper(origami)
    phi = check_angles("fold_angles", fold_angles, problem.pattern.creases, one=True)
    check_number("tolerance", tolerance, 0.0, LARGEST_TOLERANCE)
    x = problem.reduce(phi)
    residual = problem.residual(x)

    def bad(reason: str) -> Embedding:
        return Embedding(False, reason, residual)

    if (off := float(np.abs(problem.expand(x) - phi).max())) > tolerance:
        return bad(f"does not have the symmetry {problem.symmetry}: {off:.1e} off")
    if over := problem.beyond(x, tolerance):
        return bad(f"beyond the fold limit {problem.name(over[0])}")
    limits = problem.fold_limits
    near = limits.room(x) <= tolerance
    x = np.where(near, limits.hold(x, limits.side(x)), x)
    closed, left = problem.project(x, near)
    if residual > max(tolerance, CLOSURE_TOL) or left > CLOSURE_TOL:
        return bad(f"does not close: {residual:.1e}")
    reason = problem.refuses(closed) or problem.doubt(closed)
    return Embedding(not reason, reason, residual)


def pose_paper(origami: Vertex | Stated) -> PatternProblem:
    """Pose an origami with full contact, whatever it asks for; a vertex with springs of 1 that rest flat."""
    if isinstance(origami, Vertex):
        n = origami.degree
        origami = Scene(origami, (1.0,) * n, (0.0,) * n, symmetry="none")
    return pose(as_origami(origami).with_contact("full"))
