"""How many random errors of what was made a state of a sheet survives: followed from the exact sheet.

Sector angles cannot be wrong one by one: round every vertex they sum to 360 degrees, and facets share sides.  What has
errors are the **positions of vertices** in the flat sheet: with them it still is a flat sheet of the same facets.  Each
crease is lengthened and turned about its middle at random, and a vertex moved by what its creases say together, so that
neither numbering nor the sheet's place matters; the size is such that sector angles round interior vertices have errors
of the size that is asked for (root mean square in each draw).

Closure of a sheet with as many equations as creases, such as one of 3 x 3 quadrilaterals, holds beside the flat state
for special positions only.  With errors rigid facets do not fold there, as paper that bends a little does: for such
sheets it is counted besides what errors of the springs alone leave.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from origami_nlp.kkt import State, newton
from origami_nlp.minima import GROWTH, TRIALS, JudgedState, Survival, count_survivals, drawn_errors
from origami_nlp.numerics import CARRIES, unit_normals
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import MOST_DENSE, CanonicalLabelling, PatternProblem
from origami_nlp.pattern_states.closed import close
from origami_nlp.pattern_states.contact_descents import contact_descent
from origami_nlp.pattern_states.descent import descend
from origami_nlp.pattern_states.judgement import judge

NOISE = "random errors that states survive"
"""Part of a search that its time may end."""
OPENED = 1.0, 0.99, 0.97, 0.94
"""Of a state's fold angles, from where it is gone down."""


class _NoiseStep(NamedTuple):
    """A sheet with errors, and the one with smaller errors before it."""

    before: PatternProblem
    after: PatternProblem


def with_survival(
    problem: PatternProblem,
    labels: CanonicalLabelling,
    states: Sequence[JudgedState],
    contact: bool,
    degrees: float,
) -> list[JudgedState]:
    """Follow the minima of a sheet into sheets with random errors.

    Parameters
    ----------
    problem
        The exact one.
    labels
        Of its creases.
    states
        Judged.
    contact
        Whether facets must not cross.
    degrees
        Standard deviation of the errors: of rest and sector angles in degrees, of stiffnesses as a share, in radians.

    Returns
    -------
    list of JudgedState
        With `survival` where they are minima.
    """
    flat, size = problem.flattened, math.radians(degrees)
    minima = [s.phi for s in states if s.verdict == "minimum"]

    def counts(corners: np.ndarray | None) -> list[int]:
        def way(trial: int) -> list[_NoiseStep]:
            problems = [problem, *_noisy(problem, corners, labels, size, trial)]
            return [_NoiseStep(a, b) for a, b in pairwise(problems)]

        return count_survivals(minima, way, _follower(contact))

    kept = counts(flat)
    alone = counts(None) if flat is not None and is_overdetermined(problem.pattern) else None
    reported = iter(
        Survival(degrees, many, TRIALS, None if alone is None else alone[k])
        for k, many in enumerate(kept)
    )
    return [replace(s, survival=next(reported)) if s.verdict == "minimum" else s for s in states]


def is_overdetermined(pattern: Pattern) -> bool:
    """Return whether closure has as many equations as creases: then folded states are there for special positions only.

    Parameters
    ----------
    pattern
        The pattern.

    Returns
    -------
    bool
        Three equations a vertex, six a hole.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern_states import is_overdetermined
    >>> [is_overdetermined(o.examples.pattern(*p)) for p in (("miura", 2, 2), ("miura", 3, 3), ("waterbomb", 2, 2))]
    [False, True, False]
    """
    return bool(
        pattern.vertices and 3 * len(pattern.vertices) + 6 * len(pattern.holes) >= pattern.creases
    )


def displacements(
    pattern: Pattern, labels: CanonicalLabelling, lengthened: np.ndarray, turned: np.ndarray
) -> np.ndarray:
    """Return by how much corners of a flat sheet move, so that sector angles change by one radian, root mean square.

    Parameters
    ----------
    pattern
        With flat corners.
    labels
        Of its creases.
    lengthened, turned
        Drawn in the order of labels: by how much creases become longer, over their lengths, and turn, [n] each.

    Returns
    -------
    numpy.ndarray
        Vectors in the plane, [V, 3], linear in what was drawn but for their size; zero where nothing depends on them.
    """
    normal = unit_normals(pattern.corners[list(pattern.polygons[0])])
    along = pattern.corners[pattern.ends[:, 1]] - pattern.corners[pattern.ends[:, 0]]
    # seen in the mirror, creases turn the other way
    hand = -1.0 if labels.mirrored else 1.0
    grows, turns = (labels.sign * labels.drawn(x) for x in (lengthened, hand * turned))
    half = 0.5 * (grows[:, None] * along + turns[:, None] * np.cross(normal, along))
    moved = np.zeros_like(pattern.corners)
    np.add.at(moved, pattern.ends[:, 0], -half)
    np.add.at(moved, pattern.ends[:, 1], half)
    change = moved[pattern.ends[:, 1]] - moved[pattern.ends[:, 0]]
    # turn of each crease in the plane, to first order
    azimuth = np.cross(along, change) @ normal / pattern.lengths**2
    sectors = [
        azimuth[list(loop.creases)] - np.roll(azimuth[list(loop.creases)], 1)
        for loop in pattern.vertices
    ]
    size = float(np.sqrt(np.mean(np.concatenate(sectors) ** 2))) if sectors else 0.0
    return moved / size if size else 0.0 * moved


def _noisy(
    problem: PatternProblem,
    corners: np.ndarray | None,
    labels: CanonicalLabelling,
    size: float,
    trial: int,
) -> list[PatternProblem]:
    """Return sheets with one draw of errors, which grow from one to the next; exact positions without corners."""
    rest, stiffness, lengthened, turned = drawn_errors(trial, 4, problem.size)
    rest, stiffness = labels.drawn(rest), labels.sign * labels.drawn(stiffness)
    exact, moved = problem.pattern, np.zeros(3)
    if corners is not None:
        exact = replace(exact, corners=corners, reference=np.zeros(problem.size))
        moved = displacements(exact, labels, lengthened, turned)
    out = []
    for t in GROWTH:
        made = PatternProblem(
            replace(
                exact,
                corners=exact.corners + t * size * moved,
                stiffness=exact.stiffness * np.exp(t * size * stiffness),
                rest=exact.rest + t * size * rest,
                laws=tuple(
                    law and law.times(math.exp(t * size * k)).shifted(t * size * by)
                    for law, k, by in zip(
                        exact.laws, stiffness.tolist(), rest.tolist(), strict=bool(exact.laws)
                    )
                ),
            )
        )
        made.until = problem.until
        out.append(made)
    return out


def _follower(contact: bool) -> Callable[[_NoiseStep, np.ndarray], np.ndarray | None]:
    """Return what goes from a minimum to the one beside it of a sheet with slightly larger errors."""

    def beside(step: _NoiseStep, x: np.ndarray) -> np.ndarray | None:
        try:
            tried = (find(step, x, contact) for find in (_solved, _gone_down))
            return next((y for y in tried if y is not None), None)
        except (np.linalg.LinAlgError, ArithmeticError):
            return None

    return beside


def _certified(problem: PatternProblem, x: np.ndarray | None, contact: bool) -> np.ndarray | None:
    state = None if x is None else judge(problem, x, contact)
    return state.phi if state is not None and state.verdict == "minimum" else None


def _solved(step: _NoiseStep, x: np.ndarray, contact: bool) -> np.ndarray | None:
    """Solve for the minimum with the same contacts pushing; the flat state stays where it is."""
    before, after = step
    if not x.any():
        return _certified(after, x, contact)
    if after.size > MOST_DENSE:
        return None
    state = State(before.with_contact(contact), x)
    held = state.on(state.contacts.base)
    pushing = zip(held.contacts, held.multiplier_set.found > CARRIES, strict=True)
    rows = [c if c.is_limit else after.contact_of(before.touch(c)) for c, on in pushing if on]
    done, _ = newton(after, x, tuple(rows))
    return None if done is None else _certified(after, done.x, contact)


def _gone_down(step: _NoiseStep, x: np.ndarray, contact: bool) -> np.ndarray | None:
    """Descend from a closed state near one: at fully folded and flat creases errors may leave none."""
    problem, pressed = step.after, contact and step.after.size <= MOST_DENSE
    for share in OPENED:
        start = close(problem, share * x)
        if start is None or (pressed and problem.crossings.find(start)):
            continue
        end = contact_descent(problem, start, keep=True) if pressed else descend(problem, start)
        found = _certified(problem, end.phi, contact) if end.arrived else None
        if found is not None:
            return found
    return None
