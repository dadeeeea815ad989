"""Flat-folded states of a pattern, every crease flat or at its limit: enumerated, with the branch directions of each.

A vertex that is folded flat is singular as the flat one is, and several ways lead out of it: a Miura sheet whose first
row of creases is fully folded folds on across the fully folded row, along curves that the flat state is not on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from origami_nlp.errors import OrigamiError
from origami_nlp.kkt import TangentCone, by_known, combine, cone_of, loop_modes
from origami_nlp.numerics import ANSWERED, CLOSURE_TOL, quaternion
from origami_nlp.pattern import Loop, Pattern, Vertex
from origami_nlp.pattern_problem import Closure, PatternProblem, check_admissible, pose_paper


def list_branches(problem: PatternProblem, phi: np.ndarray | None = None) -> TangentCone:
    """Enumerate the branch directions of a closed state.

    Parameters
    ----------
    problem
        Of a vertex or a sheet.
    phi
        The state [n] [rad]; the reference state without.

    Returns
    -------
    TangentCone
        Candidates to second order at each vertex: whether states follow is seen when they are walked.
    """
    pattern, nothing = problem.pattern, np.zeros((0, problem.size))
    if phi is None:
        phi = problem.reduce(pattern.reference)
        if not pattern.lies_flat:
            return TangentCone(nothing, (), "the reference state is not flat")
    if pattern.holes:
        return TangentCone(nothing, (), "ways round holes are not enumerated")
    cone = cone_of(problem, phi)
    if not cone.split:
        degree = max(len(loop.creases) for loop in pattern.vertices)
        why = f"vertices of degree {degree} have no modes to be enumerated"
        if degree <= 4:
            why = "walks along the lattice have no modes to be enumerated"
        return TangentCone(nothing, (), why)
    return cone


MOST_CHOICES = 3**9
"""Ways to fold the variables round a vertex by multiples of pi that are gone through one by one."""
MOST_STATES = 500
"""Flat-folded states that are listed."""


def _vertex_foldings(
    problem: PatternProblem, loop: Loop, variables: np.ndarray, place: np.ndarray
) -> np.ndarray:
    """Return the ways to fold a vertex flat, each variable by so many times pi, [F, d].

    Parameters
    ----------
    problem
        Of a flat sheet, or of one vertex.
    loop
        Round the vertex.
    variables, place
        Which turn there [d], and the place of each crease's among them.
    """
    pattern, creases = problem.pattern, list(loop.creases)
    axes = np.array(loop.signs)[:, None] * pattern.directions[creases]
    sign = np.ones(len(creases)) if problem.orbits is None else problem.orbits.sign[creases]
    choices = np.array(list(product(_multiples(problem), repeat=len(variables))), float)
    low, high = problem.fold_limits.low[variables], problem.fold_limits.high[variables]
    choices = choices[((math.pi * choices >= low) & (math.pi * choices <= high)).all(axis=1)]
    if not pattern.lies_flat:
        missed = np.abs(problem.constraints(math.pi * choices)[0]).max(axis=1)
        choices = choices[missed <= CLOSURE_TOL]
        return choices[problem.lifts_to_one(math.pi * choices)]
    q = tuple(np.full(len(choices), x) for x in (1.0, 0.0, 0.0, 0.0))
    for v, s, axis in zip(place, sign, axes, strict=True):
        turn = s * choices[:, v]
        # cosine and sine of half of 0 or +-pi are 1 and 0, or 0 and +-1: exact
        q = quaternion.multiply(quaternion.fold(turn == 0, turn, axis), q)
    closed = (np.abs(q[1:]).max(axis=0) <= CLOSURE_TOL) & (q[0] > 0)
    # a vertex that is the whole is judged as a state is
    part = problem.contact and len(pattern.vertices) > 1
    at = _round_vertex(pattern, loop) if part else None
    foldings = choices[closed]
    if at is None:
        return foldings
    paper = pose_paper(at)
    return foldings[
        [check_admissible(paper, math.pi * sign * f[place]).admissible for f in foldings]
    ]


def _round_vertex(pattern: Pattern, loop: Loop) -> Vertex | None:
    """Return an interior vertex with its creases in the order of its loop; None where no `Vertex` describes it."""
    # a walk counter-clockwise crosses from its right to its left what runs out of the vertex
    out = np.array(loop.signs)[:, None] * pattern.directions[list(loop.creases)]
    after = np.roll(out, -1, axis=0)
    angles = np.arctan2(
        np.linalg.norm(np.cross(out, after), axis=1), np.einsum("ki,ki->k", out, after)
    )
    if pattern.is_flat and abs(float(angles.sum()) - 2 * math.pi) > ANSWERED:
        return None  # a reflex sector
    try:
        return Vertex(tuple(angles.tolist()))
    except OrigamiError:
        return None


def _multiples(problem: PatternProblem) -> tuple[int, ...]:
    """Return by how many times pi creases may be folded: of cones without limits by whole turns as well.

    Whole turns of flat sheets are found like other states; those of a cone may be isolated.
    """
    return (0, 1, -1) if problem.has_limits or problem.pattern.lies_flat else (0, 1, -1, 2, -2)


@dataclass(frozen=True, eq=False)
class FlatFolded:
    """Flat-folded states of a pattern.

    Attributes
    ----------
    states
        Fold angles, each a multiple of pi, those least folded first, [S, n] [rad].
    reason
        Why they were not enumerated; empty where they were.
    """

    states: np.ndarray
    reason: str = ""


def list_flat_folded(problem: PatternProblem) -> FlatFolded:
    """Enumerate the flat-folded states of a problem whose reference state is flat, or of one vertex.

    Parameters
    ----------
    problem
        Its limit of time counts.  Where facets must not cross, states in which the layers round a vertex have no order
        are left out.

    Returns
    -------
    FlatFolded
        Every choice of open and fully folded creases that closes round each vertex; layers of the whole are not ordered
        here.
    """
    pattern, n = problem.pattern, problem.size
    none = np.zeros((0, n))
    if not pattern.lies_flat and len(pattern.vertices) != 1:
        return FlatFolded(none, "the reference state is not flat")
    if pattern.holes:
        return FlatFolded(none, "states folded round holes are not enumerated")
    if pattern.lies_flat and not problem.has_limits:
        return FlatFolded(np.zeros((1, n)))
    of = np.arange(n) if problem.orbits is None else problem.orbits.orbit
    each = [
        np.unique(of[list(loop.creases)], return_inverse=True) for loop in problem.pattern.vertices
    ]
    most = max((len(variables) for variables, _ in each), default=0)
    if len(_multiples(problem)) ** most > MOST_CHOICES:
        return FlatFolded(none, f"round a vertex {most} creases turn: too many for all choices")
    tables = []
    for loop, around in zip(pattern.vertices, each, strict=True):
        problem.check_time()
        tables.append(_vertex_foldings(problem, loop, *around))
    level, known = np.zeros((1, n), np.int8), np.zeros(n, bool)
    # as many creases as can be are known already, few foldings
    for v in by_known([variables for variables, _ in each], [len(table) for table in tables]):
        problem.check_time()
        variables = each[v][0]
        # a join: foldings of a vertex that agree with the states so far in all creases that these have
        fits = (level[:, None, variables] == tables[v]) | ~known[variables]
        state, folding = np.nonzero(fits.all(axis=2))
        if len(state) > 20 * MOST_STATES:
            return FlatFolded(none, f"there are more than {MOST_STATES:,}")
        level = level[state]
        level[:, variables] = tables[v][folding].astype(np.int8)
        known[variables] = True
    if pattern.cell:  # its copies must come to lie parallel
        level = np.unique(level, axis=0)
        level = level[[problem.closure.closes(math.pi * x) for x in level]]
    if len(level) > MOST_STATES:
        return FlatFolded(none, f"there are more than {MOST_STATES:,}")
    return FlatFolded(math.pi * level[np.argsort(np.abs(level).sum(axis=1), kind="stable")])


def escape_paths(
    pattern: Pattern, states: np.ndarray, check: Callable[[], None] = lambda: None
) -> Iterator[tuple[np.ndarray, TangentCone]]:
    """Go through flat-folded states [S, n] with the branch directions of each.

    Parameters
    ----------
    pattern
        The pattern, of vertices of degree four or less: others have no modes.
    states
        Of `list_flat_folded`.
    check
        Called every now and then: may raise to end it.

    Yields
    ------
    tuple
        A state and its `TangentCone`.
    """
    closure = Closure(pattern)
    known: dict[tuple[int, bytes], list[np.ndarray]] = {}
    for phi in states:
        modes, variables = [], []
        for v, loop in enumerate(closure.loops(phi)):
            key = v, phi[loop.variables].tobytes()
            if key not in known:
                found = loop_modes(loop)
                if found is None:
                    return
                known[key] = found
            modes.append(known[key])
            variables.append(loop.variables)
        yield phi, combine(variables, modes, pattern.creases, check)
