"""How a sheet folds: closed states from near flat until facets touch or a crease is fully folded.

With one degree of freedom the motion is the sheet's only one on its branch.  With more it is one of many: it starts
towards more folding in every crease, and goes on as straight as closure lets it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from origami_nlp.display import Content, Report, Section, Table, Viewable, angle_columns
from origami_nlp.errors import OptionError
from origami_nlp.io import OneBased
from origami_nlp.kkt import State
from origami_nlp.minima import lattice_table
from origami_nlp.numerics import CLOSURE_TOL, NEAR_SINGULAR_TOL
from origami_nlp.pattern import Pattern, as_pattern, listed
from origami_nlp.pattern_problem import (
    FoldedLattice,
    FoldedTube,
    PatternProblem,
    PopSigns,
    measured_cell,
    order_layers,
)
from origami_nlp.pattern_states.curve import ClosureCurve, follow_curve
from origami_nlp.pattern_states.mobility import Mobility, analyze_mobility

MOST_TRACED = 480
"""Creases of a sheet whose motion is traced."""
AHEAD = 0.3
"""A flat-folded state this near is where a walk was going that stopped before it [rad]."""
BISECTED = 45
"""Halvings of a step on which facets begin to cross."""
PRINTED = 9
"""States of a motion in its table."""


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Report, Viewable):
    """States along a folding motion.

    Attributes
    ----------
    pattern
        What folds.
    dof
        It has at a folded state.
    fold_angles
        Fold angles, from the least folded state on, [S, n] [rad].
    arc
        Length along it, in the norm over creases over sqrt n [rad], [S].
    energy
        Of the springs, [S].
    end
        Why it ends: a crease at its fold limit, two facets that touch, or where the walk was lost.
    touching
        The facets that touch at its end (from 0), or None.
    layers
        Where it ends folded flat: whether its layers can be ordered, in words; else empty.

    Examples
    --------
    >>> import origami_nlp as o
    >>> motion = o.find_motion(o.examples.pattern("metasheet", 3, 3))
    >>> motion.dof, motion.touching
    (1, (2, 3))
    """

    PICTURE = "draw_motion"
    SCHEMA = "origami-nlp/pattern/3"
    ALSO = ("lattices",)
    pattern: Pattern
    dof: int
    fold_angles: np.ndarray
    arc: np.ndarray
    energy: np.ndarray
    end: str
    touching: tuple[OneBased, OneBased] | None
    layers: str = ""

    def __post_init__(self) -> None:
        states = (len(self.arc), self.pattern.creases)
        if self.fold_angles.shape != states or self.energy.shape != self.arc.shape:
            raise OptionError(
                f"motion: fold_angles {self.fold_angles.shape}, arc {self.arc.shape} and energy {self.energy.shape} "
                f"must be of as many states, of {self.pattern.creases} fold angles each"
            )

    @cached_property
    def lattices(self) -> tuple[FoldedLattice | FoldedTube, ...]:
        """Of a cell that repeats the lattice or tube at each state; of one degree of freedom also how it gives way."""
        if self.pattern.cell is None:
            return ()
        lattice = measured_cell(self.pattern)
        problem = PatternProblem(self.pattern, contact=False)
        return tuple(lattice.at(State(problem, phi)) for phi in self.fold_angles)

    def view_content(self) -> Content:
        """Return the motion as plain data, see `view`."""
        content: Content = self._from_room("view_motion")(self)  # slow to import
        return content

    def report_sections(self) -> Iterator[Section]:
        """Return where it ends over a table of some of its states, and what it leaves open."""
        shown = self.shown(PRINTED)
        largest = np.degrees(np.abs(self.fold_angles).max(axis=1))
        rows = [
            (f"{k + 1}", f"{self.arc[k]:.4f}", f"{largest[k]:.2f}", f"{self.energy[k]:.6g}")
            for k in shown
        ]
        heads = "state", "along [rad]", "largest fold angle [deg]", "energy [J]"
        yield Table(heads, rows, self.verdict, "rrrr", framed=False)
        if self.lattices:
            numbers = [k + 1 for k in shown]
            yield lattice_table([self.lattices[k] for k in shown], numbers, "state")
        yield from PopSigns(self.pattern).alarms(self.fold_angles)
        if self.layers:
            yield f"folded flat there: {self.layers}"
        if self.dof > 1:
            yield f"{self.dof} degrees of freedom: one of many motions, as straight as closure lets it go"
        if self.touching is not None:
            yield (
                "the one degree of freedom is blocked by that contact"
                if self.dof == 1
                else "past that contact facets may slide along each other: not followed"
            )

    @property
    def verdict(self) -> str:
        """Where the motion ends, in a sentence."""
        last = math.degrees(np.abs(self.fold_angles[-1]).max())
        return f"{self.pattern.title}: folds until the largest fold angle is {last:.5g} deg: {self.end}"

    def shown(self, most: int) -> list[int]:
        """Return numbers of at most so many states, evenly along the motion, with both ends.

        Parameters
        ----------
        most
            How many, at least 2.

        Returns
        -------
        list of int
            Increasing, from 0.
        """
        if len(self.fold_angles) <= most:
            return list(range(len(self.fold_angles)))
        even = np.searchsorted(self.arc, np.linspace(0.0, self.arc[-1], most))
        found: list[int] = np.unique([0, *even.clip(0, len(self.arc) - 1)]).tolist()
        return found

    def _rows(self) -> Iterable[dict[str, object]]:
        for k, phi in enumerate(self.fold_angles):
            row = {"state": k + 1, "arc_rad": self.arc[k], "energy_J": self.energy[k]}
            yield row | angle_columns(phi)


def find_motion(
    pattern: Pattern | str | Path, mobility: Mobility | None = None, *, seed: int = 0
) -> Motion:
    """Trace the folding motion of a sheet up to its first contact.

    Parameters
    ----------
    pattern
        The sheet; the name of an example such as ``"miura:4x4"``, or a FOLD file.
    mobility
        Of `analyze_mobility`, if it is known.
    seed
        Of random starts, where a folded state is looked for.

    Returns
    -------
    Motion
        From the least folded state on the way.

    Raises
    ------
    OptionError
        If the sheet has too many creases, no folded state was found, or no degree of freedom is left.

    Examples
    --------
    >>> import origami_nlp as o
    >>> o.find_motion(o.examples.pattern("miura", 2, 3)).end
    'creases 1, 2, 3, 4, 5, 6, 7 are at their fold limits'
    """
    pattern = as_pattern(pattern)
    if not pattern.creases:
        raise OptionError("the pattern has no crease: there is nothing to fold")
    if pattern.creases > MOST_TRACED:
        raise OptionError(
            f"the pattern has {pattern.creases:,} creases: motions are traced up to {MOST_TRACED}"
        )
    mobility = analyze_mobility(pattern, seed=seed) if mobility is None else mobility
    if mobility.folded is None or mobility.dof is None:
        raise OptionError("no folded state was found from which to trace a motion")
    if mobility.dof == 0:
        raise OptionError("no degree of freedom is left: the sheet does not move with rigid facets")
    problem = PatternProblem(pattern)
    z = problem.kernel(mobility.folded)
    curve = follow_curve(problem, mobility.folded, z @ (z.T @ mobility.folded))
    here = int(np.linalg.norm(curve.phi - mobility.folded, axis=1).argmin())
    # both ways were followed: from the least folded state on, through the one that was found
    least = int(np.linalg.norm(curve.phi[: here + 1], axis=1).argmin())
    states = curve.phi[least:]
    if curve.ends[1].startswith("lost"):
        states = _at_limit(problem, states)
    phi, touching = _until_touch(problem, states)
    arc = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(phi, axis=0), axis=1))]
    end = _end(problem, curve, phi[-1], touching)
    return Motion(
        pattern,
        mobility.dof,
        phi,
        arc / math.sqrt(pattern.creases),
        np.asarray(pattern.energy(phi)),
        end,
        touching,
        _layers(problem, phi[-1]),
    )


def _layers(problem: PatternProblem, phi: np.ndarray) -> str:
    """Return whether the layers of a state that is folded flat can be ordered; empty where it is not."""
    if (np.minimum(np.abs(phi), math.pi - np.abs(phi)) > NEAR_SINGULAR_TOL).any():
        return ""
    flat, residual = problem.project(
        np.where(np.abs(phi) < NEAR_SINGULAR_TOL, 0.0, np.copysign(math.pi, phi))
    )
    if residual > CLOSURE_TOL or np.abs(flat - phi).max() > 2 * NEAR_SINGULAR_TOL:
        return (
            "whether its layers can be ordered is not known: no flat-folded state was found near it"
        )
    found = order_layers(problem, flat)
    return "its layers can be ordered" if found.verdict == "ordered" else found.reason


def _at_limit(problem: PatternProblem, phi: np.ndarray) -> np.ndarray:
    """Add the flat-folded state ahead, where many creases reach their fold limits at once and steps look alike."""
    last = phi[-1]
    limits = problem.fold_limits
    near = limits.room(last) < AHEAD
    end, residual = problem.project(
        np.where(near, limits.hold(last, limits.side(last)), last), near
    )
    good = near.any() and residual <= CLOSURE_TOL and np.abs(end - last).max() < AHEAD
    return np.vstack([phi, end]) if good and limits.inside(end).all() else phi


def _until_touch(
    problem: PatternProblem, phi: np.ndarray
) -> tuple[np.ndarray, tuple[int, int] | None]:
    """Cut a path where facets begin to cross; the last state is the one at which they touch."""
    for k, state in enumerate(phi):
        pairs = problem.crossings.find(state)
        if not pairs:
            continue
        if k == 0:
            raise OptionError("facets cross from the start: there is no motion of paper to show")
        a, b = phi[k - 1], state
        # no facets cross at a, some do at b
        for _ in range(BISECTED):
            middle, residual = problem.project(0.5 * (a + b))
            if residual > CLOSURE_TOL:
                break
            crossing = problem.crossings.find(middle)
            a, b = (a, middle) if crossing else (middle, b)
            pairs = crossing or pairs
        return np.vstack([phi[:k], a]), pairs[0]
    return phi, None


def _end(
    problem: PatternProblem, curve: ClosureCurve, phi: np.ndarray, touching: tuple[int, int] | None
) -> str:
    if touching is not None:
        return f"facets {touching[0] + 1} and {touching[1] + 1} touch"
    at_limit = (np.flatnonzero(problem.fold_limits.room(phi) <= NEAR_SINGULAR_TOL) + 1).tolist()
    if curve.ends[1] == "limit" or at_limit:
        if len(at_limit) == 1:
            return f"crease {at_limit[0]} is at its fold limit"
        return f"creases {listed(at_limit)} are at their fold limits"
    return "it returns to its start" if curve.ends[1] == "closed" else curve.ends[1]
