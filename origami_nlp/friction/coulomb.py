"""Coulomb friction between facets: the least coefficient that holds a given state of a pattern.

At a contact c of two facets the force F_c = N n + T acts, N >= 0 along the normal and T in the plane of contact.  The
state is in equilibrium if closure, fold limits and these forces balance the torques,

    grad U = J' lambda + L' mu + sum_c W_c' F_c,    N >= 0, mu >= 0, |T| <= m N,

W_c the derivative of the point of one facet relative to the other.  Where facets touch at corners and edges several
pieces of the set of states meet; a state rests where these forces, of the contacts of a piece, balance on each.  For a
coefficient m this is a second-order cone program (Clarabel); what one coefficient holds a larger one does, so that the
least is found by bisection.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import State
from origami_nlp.numerics import BALL, CLOSURE_TOL, EQUAL, POSITIVE, ConicProgram, cross
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import ContactPair, FoldedGeometry, PatternProblem
from origami_nlp.problem import Contact

LARGEST, HALVINGS = 100.0, 40
"""Coefficient beyond which a state is called not held, and halvings of the interval."""


@dataclass(frozen=True, repr=False)
class CoulombHold(ShortRepr):
    """What friction between facets a state needs.

    Attributes
    ----------
    coefficient
        Least Coulomb coefficient that holds it: 0 where none is needed, inf where none does.
    contacts
        Names of the contacts between facets at the state; where several pieces of the set of states meet, of the one
        that needs most.
    forces
        Normal force and friction force of each at that coefficient, [N m over the unit of the corners].
    """

    coefficient: Unbounded
    contacts: tuple[str, ...]
    forces: tuple[tuple[float, float], ...]


def least_coulomb(pattern: Pattern, fold_angles: Sequence[float]) -> CoulombHold:
    """Find the least Coulomb coefficient between facets that holds a state of a pattern.

    Parameters
    ----------
    pattern
        With its springs.
    fold_angles
        A closed state in which facets touch, not necessarily in equilibrium without friction, [n] [rad].

    Returns
    -------
    CoulombHold
        The coefficient, to some 1e-8, and forces that balance.

    Raises
    ------
    OptionError
        If the state is not closed, facets cross in it, or more pieces of the set of states meet there than are listed.
    """
    check_type("pattern", pattern, Pattern)
    problem = PatternProblem(pattern)
    phi = np.array(fold_angles, float)
    if phi.shape != (problem.size,):
        raise OptionError(
            f"fold_angles has shape {phi.shape}: give one for each of {problem.size} creases"
        )
    state = State(problem, phi)
    if state.residual > CLOSURE_TOL or state.refused:
        raise OptionError(
            f"fold_angles: no state of this pattern: {state.refused or 'it does not close'}"
        )
    if (pieces := problem.closed(phi).combinations()) is None:
        raise OptionError(
            "fold_angles: what touches there leaves more pieces of the set of states than are listed: not decided"
        )
    # a state rests where it does on each of the pieces that meet there
    return max((_hold(state, piece) for piece in pieces), key=lambda hold: hold.coefficient)


def _hold(state: State, piece: tuple[Contact, ...]) -> CoulombHold:
    """Return what friction a state needs on one piece of the set of states, on which these contacts push."""
    problem = state.problem
    assert isinstance(problem, PatternProblem)
    limits = tuple(c for c in piece if c.is_limit)
    touches = [c for c in piece if not c.is_limit]
    z = state.kernel
    at = problem.placed(state.x)
    arms = [_arms(problem.touch(c), at, problem.size) for c in touches]
    columns = [frame @ w @ z for frame, w in arms]
    rows = state.on(limits).slopes @ z if limits else np.zeros((0, z.shape[1]))
    torque = z.T @ state.gradient
    size = float(np.abs(torque).max(initial=0.0)) or 1.0

    def held(coefficient: float) -> np.ndarray | None:
        """Return forces [3 contacts + limits] that balance with a coefficient, or None."""
        n = 3 * len(touches)
        program = ConicProgram(n + len(limits))
        stacked = np.vstack([*columns, rows]) if n + len(limits) else np.zeros((0, len(torque)))
        program.add(EQUAL, stacked.T, -torque / size, "balance")
        for k in range(len(touches)):
            cone = np.zeros((3, n + len(limits)))
            cone[[0, 1, 2], [3 * k, 3 * k + 1, 3 * k + 2]] = coefficient, 1.0, 1.0
            program.add(BALL, cone, np.zeros(3), "friction")
        signs = np.eye(n + len(limits))[[*range(0, n, 3), *range(n, n + len(limits))]]
        program.add(POSITIVE, signs, np.zeros(len(signs)), "push")
        found = program.maximise(np.zeros(program.size))
        return found.v * size if found.solved else None

    names = tuple(problem.name(c) for c in touches)
    if not piece or not len(torque):
        rests = float(np.abs(torque).max(initial=0.0)) <= CLOSURE_TOL
        return CoulombHold(0.0 if rests else math.inf, names, ())
    low, high = 0.0, LARGEST
    forces = held(low)
    if forces is None:
        if (forces := held(high)) is None:
            return CoulombHold(math.inf, names, ())
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            found = held(middle)
            low, high, forces = (
                (low, middle, found) if found is not None else (middle, high, forces)
            )
        low = high
    each = (problem.scale * forces[: 3 * len(touches)]).reshape(-1, 3)
    pairs = tuple((float(f[0]), float(np.hypot(f[1], f[2]))) for f in each)
    return CoulombHold(low, names, pairs)


def _arms(touch: ContactPair, at: FoldedGeometry, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return normal and two tangents of a contact, [3, 3], and how the point of contact moves with folds, [3, n]."""
    creases, axes, origins = at.walk(*touch.facets)
    p = touch.points(at)
    if touch.type == "edge-edge":
        u, v, r = p[1] - p[0], p[3] - p[2], p[2] - p[0]
        normal = cross(u, v)
        # the point of the second side next to the first one
        place = p[2] + float(np.linalg.lstsq(np.column_stack([u, -v]), r, rcond=None)[0][1]) * v
    else:
        normal, place = cross(p[2] - p[1], p[3] - p[1]), p[0]
    normal = touch.sign * normal / np.linalg.norm(normal)
    first = cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    first /= np.linalg.norm(first)
    w = np.zeros((3, size))
    w[:, creases] = cross(axes, place - origins).T
    return np.stack([normal, first, cross(normal, first)]), w
