"""How many random errors of what was made a minimum survives: followed from the exact origami, not searched for again.

Sector angles of one vertex are wrong one by one, but for their sum.  Those of a sheet cannot be: round every vertex
they sum to 360 degrees, and facets share sides.  What has errors are the **positions of vertices** in the flat sheet:
with them it still is a flat sheet of the same facets.  Each crease is lengthened and turned about its middle at random,
and a vertex moved by what its creases say together, so that neither numbering nor the sheet's place matters; the size
is such that sector angles round interior vertices have errors of the size that is asked for (root mean square in each
draw).

Closure of a sheet with as many equations as creases, such as one of 3 x 3 quadrilaterals, holds beside the flat state
for special positions only.  With errors rigid facets do not fold there, as paper that bends a little does: for such
sheets it is counted besides what errors of the springs alone leave.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.kkt import State, classify, newton
from origami_nlp.minima.minimum import TRIALS, JudgedState, Survival
from origami_nlp.numerics import CARRIES, unit_normals
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import MOST_DENSE, CanonicalLabelling, PatternProblem
from origami_nlp.search import StartState, at_limits, way_down

NOISE = "random errors that states survive"
"""Part of a search that its time may end."""


def check_noise(noise: float | None) -> None:
    """Check the size of random errors.

    Parameters
    ----------
    noise
        In degrees, or None for none.

    Raises
    ------
    OptionError
        If it is no number from 0 to 10: larger errors are no longer small beside sector angles.
    """
    if noise is not None:
        check_number("noise", noise, 0.0, 10.0)


def downhill(
    problem: PatternProblem, x: np.ndarray, aside: np.ndarray, engine: Callable[[Any], Any]
) -> np.ndarray | None:
    """Return the certified minimum downhill from beside a state [n]; None where there is none.

    aside: direction [n] that says to which side saddles are left.  engine: makes ways down of a problem.
    """
    go_down = engine(problem)
    # opened a little: at fully folded and flat creases errors may leave none
    for share in (1.0, 0.99, 0.97, 0.94):
        start = problem.fold_limits.clip(share * x)
        end, why = go_down(StartState(start, at_limits(problem, start)), aside)
        if not why and classify(State(problem, end)).verdict == "minimum":
            return end
    return None


def with_survival(
    problem: PatternProblem,
    states: Sequence[JudgedState],
    degrees: float,
    engine: Callable[[Any], Any] | None = None,
) -> list[JudgedState]:
    """Follow minima of an origami into origamis with random errors.

    The errors are the same for all minima, drawn by labels that do not depend on how creases are numbered, and break
    every symmetry: a minimum among symmetric states that is not one beside them does not survive.

    Parameters
    ----------
    problem
        The exact one, of all fold angles.
    states
        Judged.
    degrees
        Standard deviation of the errors: of rest and sector angles in degrees, of stiffnesses as a share, in radians.
    engine
        What goes downhill where the minimum with the same contacts is lost, made of a problem; None: compiled descents,
        or IPOPT where there are none.

    Returns
    -------
    list of JudgedState
        With `survival` where they are minima.
    """
    minima = [np.array(s.fold_angles) for s in states if s.verdict == "minimum"]
    labels = problem.labels
    aside = labels.drawn(np.sin(1.0 + np.arange(problem.size)))
    down = engine or way_down

    def counts(moves: bool) -> list[int]:
        kept = [0] * len(minima)
        for trial in range(TRIALS):
            way = [problem, *_noisy(problem, labels, math.radians(degrees), trial, moves)]
            for k, x in enumerate(minima):
                kept[k] += _survives(way, x, aside, down)
        return kept

    sheet = problem.flattened is not None and not len(problem.parameters.sectors)
    kept = counts(True)
    alone = counts(False) if sheet and is_overdetermined(problem.pattern) else [None] * len(kept)
    reported = (Survival(degrees, k, TRIALS, a) for k, a in zip(kept, alone, strict=True))
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
    >>> from origami_nlp.minima.noise import is_overdetermined
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
    problem: PatternProblem, labels: CanonicalLabelling, size: float, trial: int, moves: bool
) -> Iterator[PatternProblem]:
    """Go through problems with one draw of errors, which grow; sector angles have some where it `moves` the creases."""
    rest, stiffness, first, second = size * np.random.default_rng(trial).normal(
        size=(4, problem.size)
    )
    # a rest angle turns with the sheet when labels are of its other side
    rest, stiffness = labels.drawn(rest), labels.sign * labels.drawn(stiffness)
    p, paper, flat = problem.parameters, problem.pattern, problem.flattened
    sectors, moved = np.zeros_like(p.sectors), np.zeros(3)
    if len(sectors) and moves:
        beside = np.sort(np.stack([labels.rank, np.roll(labels.rank, -1)]), axis=0)
        facets = np.lexsort(beside[::-1])
        # the sum of sector angles stays
        sectors[facets] = first - first.mean()
    elif flat is not None and moves:
        paper = replace(paper, corners=flat, reference=np.zeros(problem.size))
        moved = size * displacements(paper, labels, first, second)
    # from one share of the errors to the next states are followed
    for t in (0.25, 0.5, 0.75, 1.0):
        corners, reference = paper.corners + t * moved, paper.reference
        if len(sectors):
            corners, reference = problem.shape(p.sectors + t * sectors)
        made = PatternProblem(
            replace(paper, corners=corners, reference=reference),
            problem.contact,
            limited=problem.has_limits,
        ).numbered_as(problem)
        yield made.varied(
            replace(
                p,
                sectors=p.sectors + t * sectors,
                stiffness=p.stiffness * np.exp(t * stiffness),
                rest=p.rest + t * rest,
                laws=p.laws and p.laws.along(replace(p.laws, weight=stiffness, shift=rest), t),
            )
        )


def _survives(
    way: Sequence[PatternProblem], x: np.ndarray, aside: np.ndarray, engine: Callable[[Any], Any]
) -> bool:
    """Return whether a state [n] can be followed, and is a minimum at the end."""
    for before, after in pairwise(way):
        try:
            new = _solved(before, after, x)
            new = downhill(after, x, aside, engine) if new is None else new
        except (np.linalg.LinAlgError, ArithmeticError):
            return False
        # further than any follows [rad] in one step
        if new is None or np.abs(new - x).max() > 0.2:
            return False
        x = new
    return True


def _solved(before: PatternProblem, after: PatternProblem, x: np.ndarray) -> np.ndarray | None:
    """Solve for the minimum with the same contacts pushing; the flat state stays where it is."""
    new = x
    if x.any():
        if after.size > MOST_DENSE:
            return None
        state = State(before, x)
        held = state.on(state.contacts.base)
        pushing = zip(held.contacts, held.multiplier_set.found > CARRIES, strict=True)
        rows = [c if c.is_limit else after.contact_of(before.touch(c)) for c, on in pushing if on]
        done, _ = newton(after, x, tuple(rows))
        if done is None:
            return None
        new = done.x
    return new if classify(State(after, new)).verdict == "minimum" else None
