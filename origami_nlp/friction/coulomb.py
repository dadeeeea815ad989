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
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.display import Details, Report, Section, Table
from origami_nlp.errors import OptionError
from origami_nlp.io import Unbounded
from origami_nlp.kkt import ContactForce, State
from origami_nlp.numerics import BALANCED, BALL, CLOSURE_TOL, EQUAL, POSITIVE, ConicProgram, cross
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import ContactPair, FoldedGeometry, PatternProblem
from origami_nlp.problem import Contact

LARGEST, HALVINGS = 100.0, 40
"""Coefficient beyond which a state is called not held, and halvings of the interval."""


@dataclass(frozen=True, repr=False)
class CoulombHold(Report):
    """What friction between facets a state of a pattern needs.

    Attributes
    ----------
    pattern
        With its springs.
    fold_angles
        The state, [n] [rad].
    coefficient
        Least Coulomb coefficient that holds it: 0 where none is needed, inf where none up to 100 does.
    contacts
        What is closed at the state, with normal forces that balance at that coefficient; where several pieces of the
        set of states meet, on the one that needs most.
    friction
        Friction force of each, in the plane of contact [N m per unit of length].
    residual
        Largest torque that is not balanced, over the largest torque.

    Examples
    --------
    >>> import origami_nlp as o
    >>> sheet = o.examples.pattern("miura", 2, 2).with_springs(1.0, 0.8)
    >>> minimum = o.find_minima(sheet, escape=False).minima[0]
    >>> o.least_coulomb(sheet, minimum.fold_angles).verdict
    'in equilibrium without friction between facets'
    """

    pattern: Pattern
    fold_angles: tuple[float, ...]
    coefficient: Unbounded
    contacts: tuple[ContactForce, ...]
    friction: tuple[float, ...]
    residual: float

    PICTURE, SCHEMA = "draw_coulomb", "origami-nlp/coulomb/1"

    @property
    def verdict(self) -> str:
        """What holds the state, in words."""
        if self.coefficient == 0:
            return "in equilibrium without friction between facets"
        if self.coefficient == math.inf:
            more = "" if self.contacts else ": nothing touches"
            return f"not held by friction between facets, whatever the coefficient up to {LARGEST:g}{more}"
        return f"held by friction between facets from a Coulomb coefficient of {self.coefficient:.6g} on"

    def report_sections(self) -> Iterator[Section]:
        """Return the verdict, the forces that balance, and the state."""
        yield f"{self.pattern.title}: {self.verdict}"
        if self.contacts and self.coefficient < math.inf:
            rows = [
                [c.text, f"{c.force:.4g}", f"{t:.4g}" if c.is_force else ""]
                for c, t in zip(self.contacts, self.friction, strict=True)
            ]
            heads = ["contact", "normal force", "friction"]
            title = "Forces that balance [N m per unit of length], of fold limits moments [N m]"
            yield Table(heads, rows, title, "Lrr")
            yield f"Balanced to {self.residual:.1g} of the largest torque."
        angles = ", ".join(f"{math.degrees(phi):.3f}" for phi in self.fold_angles)
        yield Details((f"Fold angles [deg]: {angles}.",), "the fold angles of the state")

    def _rows(self) -> Iterator[dict[str, object]]:
        for c, t in zip(self.contacts, self.friction, strict=True):
            yield {"contact": c.text, "normal": c.force, "friction": t}


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

    Examples
    --------
    Flat, a sheet whose springs want to fold it is held by no friction: no facets touch.

    >>> import math
    >>> import origami_nlp as o
    >>> sheet = o.examples.pattern("miura", 2, 2)
    >>> o.least_coulomb(sheet.with_springs(1.0, math.pi), sheet.reference).coefficient
    inf
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
            f"fold_angles: no state of this pattern: {state.refused or f'it does not close, by {state.residual:.1g}'}"
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
    largest = float(np.abs(state.gradient).max(initial=0.0)) or 1.0
    size = float(np.abs(torque).max(initial=0.0)) or 1.0
    unknowns = 3 * len(touches) + len(limits)

    def held(coefficient: float) -> np.ndarray | None:
        """Return forces [3 contacts + limits] that balance with a coefficient, or None."""
        n = 3 * len(touches)
        program = ConicProgram(unknowns)
        program.add(EQUAL, np.vstack([*columns, rows]).T, -torque / size, "balance")
        for k in range(len(touches)):
            cone = np.zeros((3, unknowns))
            cone[[0, 1, 2], [3 * k, 3 * k + 1, 3 * k + 2]] = coefficient, 1.0, 1.0
            program.add(BALL, cone, np.zeros(3), "friction")
        signs = np.eye(unknowns)[[*range(0, n, 3), *range(n, unknowns)]]
        program.add(POSITIVE, signs, np.zeros(len(signs)), "push")
        found = program.maximise(np.zeros(program.size))
        return found.v * size if found.solved else None

    def answer(coefficient: float, forces: np.ndarray | None) -> CoulombHold:
        """Return forces of contacts, first those between facets, in the units of the pattern."""
        known = np.zeros(unknowns) if forces is None else problem.scale * forces
        each = known[: 3 * len(touches)].reshape(-1, 3)
        unbalanced = torque if forces is None else torque - np.vstack([*columns, rows]).T @ forces
        carried = [*each[:, 0], *known[3 * len(touches) :]]
        contacts = []
        for contact, force in zip([*touches, *limits], map(float, carried), strict=True):
            who = problem.words(contact, state.x)
            about = who.creases, who.facets, who.corners, who.side, who.place
            contacts.append(ContactForce(who.type, force, (force, force), who.text, *about))
        friction = (*np.hypot(each[:, 1], each[:, 2]).tolist(), *[0.0] * len(limits))
        error = float(np.abs(unbalanced).max(initial=0.0)) / largest
        angles = tuple(state.x.tolist())
        return CoulombHold(problem.pattern, angles, coefficient, tuple(contacts), friction, error)

    rests = bool(np.abs(torque).max(initial=0.0) <= BALANCED * largest)
    if rests or not piece:
        return answer(0.0 if rests else math.inf, None)
    low, high = 0.0, LARGEST
    forces = held(low)
    if forces is None:
        if (forces := held(high)) is None:
            return answer(math.inf, None)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            found = held(middle)
            low, high, forces = (
                (low, middle, found) if found is not None else (middle, high, forces)
            )
        low = high
    return answer(low, forces)


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
