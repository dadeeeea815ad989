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
from origami_nlp.folding import check_admissible
from origami_nlp.kkt import TangentCone, by_known, combine, loop_modes, tangent_cone
from origami_nlp.numerics import CLOSURE_TOL, quaternion
from origami_nlp.pattern import Loop, Pattern
from origami_nlp.pattern_problem import Closure, round_vertex


def list_branches(
    pattern: Pattern,
    phi: np.ndarray | None = None,
    check: Callable[[], None] = lambda: None,
    closure: Closure | None = None,
) -> TangentCone:
    """Enumerate the branch directions of a closed state.

    Parameters
    ----------
    pattern
        The pattern.
    phi
        The state [n] [rad]; the reference state without.
    check
        Called every now and then: may raise to end it.
    closure
        In whose variables; None: the fold angles of all creases.

    Returns
    -------
    TangentCone
        Candidates to second order at each vertex: whether states follow is seen when they are walked.
    """
    closure = closure or Closure(pattern)
    n = closure.variables
    nothing = np.zeros((0, n))
    if phi is None:
        phi = pattern.reference
        if not pattern.lies_flat:
            return TangentCone(nothing, (), "the reference state is not flat")
    if pattern.holes:
        return TangentCone(nothing, (), "ways round holes are not enumerated")
    cone = tangent_cone(closure.loops(phi), n, check)
    if not cone.split:
        degree = max(len(loop.creases) for loop in pattern.vertices)
        why = f"vertices of degree {degree} have no modes to be enumerated"
        if degree <= 4:
            why = "walks along the lattice have no modes to be enumerated"
        return TangentCone(nothing, (), why)
    return cone


LARGEST_DEGREE = 8
"""Of vertices whose flat foldings are listed one by one."""
MOST_STATES = 500
"""Flat-folded states that are listed."""


def _vertex_foldings(pattern: Pattern, loop: Loop, contact: bool) -> np.ndarray:
    """Return the ways to fold a vertex flat, 0, 1 or -1 a crease, [F, d].

    Parameters
    ----------
    pattern
        Flat.
    loop
        Round the vertex, of few creases: 3 to the power of their number are tried.
    contact
        Whether to leave out those whose layers have no order.
    """
    axes = np.array(loop.signs)[:, None] * pattern.directions[list(loop.creases)]
    choices = np.array(list(product((0, 1, -1), repeat=len(axes))), float)
    low, high = pattern.limit_angles[:, list(loop.creases)]
    choices = choices[((math.pi * choices >= low) & (math.pi * choices <= high)).all(axis=1)]
    q = tuple(np.full(len(choices), x) for x in (1.0, 0.0, 0.0, 0.0))
    for turn, axis in zip(choices.T, axes, strict=True):
        # cosine and sine of half of 0 or +-pi are 1 and 0, or 0 and +-1: exact
        q = quaternion.multiply(quaternion.fold(turn == 0, turn, axis), q)
    closed = (np.abs(q[1:]).max(axis=0) <= CLOSURE_TOL) & (q[0] > 0)
    at = round_vertex(pattern, loop) if contact else None
    foldings = choices[closed]
    if at is None:
        return foldings
    try:
        return foldings[[check_admissible(at, math.pi * f).admissible for f in foldings]]
    except OrigamiError:
        return foldings


@dataclass(frozen=True, eq=False)
class FlatFolded:
    """Flat-folded states of a pattern.

    Attributes
    ----------
    states
        Fold angles, each 0, pi or -pi, the flat state first, [S, n] [rad].
    reason
        Why they were not enumerated; empty where they were.
    """

    states: np.ndarray
    reason: str = ""


def list_flat_folded(
    pattern: Pattern, contact: bool = True, check: Callable[[], None] = lambda: None
) -> FlatFolded:
    """Enumerate the flat-folded states of a pattern whose reference state is flat.

    Parameters
    ----------
    pattern
        The pattern.
    contact
        Whether to leave out states in which the layers round a vertex have no order: near them facets cross.
    check
        Called every now and then: may raise to end it.

    Returns
    -------
    FlatFolded
        Every choice of open and fully folded creases that closes round each vertex; layers of the whole are not ordered
        here.
    """
    n = pattern.creases
    none = np.zeros((0, n))
    if not pattern.lies_flat:
        return FlatFolded(none, "the reference state is not flat")
    if pattern.holes:
        return FlatFolded(none, "states folded round holes are not enumerated")
    degree = max((len(loop.creases) for loop in pattern.vertices), default=0)
    if degree > LARGEST_DEGREE:
        return FlatFolded(none, f"a vertex has degree {degree}, more than {LARGEST_DEGREE}")
    tables = []
    for loop in pattern.vertices:
        check()
        tables.append(_vertex_foldings(pattern, loop, contact))
    around = [np.array(loop.creases) for loop in pattern.vertices]
    level, known = np.zeros((1, n), np.int8), np.zeros(n, bool)
    # as many creases as can be are known already, few foldings
    for v in by_known(around, [len(table) for table in tables]):
        check()
        creases = list(pattern.vertices[v].creases)
        # a join: foldings of a vertex that agree with the states so far in all creases that these have
        fits = (level[:, None, creases] == tables[v]) | ~known[creases]
        state, folding = np.nonzero(fits.all(axis=2))
        if len(state) > 20 * MOST_STATES:
            return FlatFolded(none, f"there are more than {MOST_STATES:,}")
        level = level[state]
        level[:, creases] = tables[v][folding].astype(np.int8)
        known[creases] = True
    if pattern.cell:  # its copies must come to lie parallel
        closure = Closure(pattern)
        level = np.unique(level, axis=0)
        level = level[[closure.closes(math.pi * x) for x in level]]
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
