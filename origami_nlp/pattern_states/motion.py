"""How a sheet folds: closed states from near flat until facets touch or a crease is fully folded.

With one degree of freedom the motion is the sheet's only one on its branch.  With more it is one of many: it starts
towards more folding in every crease, and goes on as straight as closure lets it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from origami_nlp.display import (
    Content,
    Keyframe,
    Poser,
    Report,
    Section,
    Viewable,
    angle_columns,
    record_row,
    record_table,
    shown,
)
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
    measured_cell,
    order_layers,
)
from origami_nlp.pattern_states.clearance import last_free
from origami_nlp.pattern_states.curve import ClosureCurve, follow_curve
from origami_nlp.pattern_states.mobility import Mobility, analyze_mobility

MOST_TRACED = 480
"""Creases of a sheet whose motion is traced."""
AHEAD = 0.3
"""A flat-folded state this near is where a walk was going that stopped before it [rad]."""


@dataclass(frozen=True)
class MotionRow:
    """A state of a motion as it is listed.

    Attributes
    ----------
    state
        Its number, from 1.
    arc, energy
        As of `Motion`.
    largest
        Of its fold angles [rad].
    """

    state: int = field(metadata=shown("state"))
    arc: float = field(metadata=shown("along", "rad", ".1f"))
    largest: float = field(metadata=shown("largest fold angle", "rad", ".2f"))
    energy: float = field(metadata=shown("energy", "J", ".6g"))

    def caption(self) -> str:
        """Return what stands over a picture of it."""
        along, largest = math.degrees(self.arc), math.degrees(self.largest)
        return f"{along:.1f} deg along, largest fold {largest:.0f} deg"


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
                f"must be of as many states, of {states[1]} fold angles each"
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
        poser, phi = Poser(self.pattern), self.fold_angles
        last = poser.folded(phi[-1], self.energy[-1]), poser.view(phi[-1])
        end = Keyframe(f"end: {self.end}", *last)
        label = "along the motion [rad]"
        track = poser.track("folding motion", phi, self.energy, parameter=self.arc, label=label)
        name, pieces = self.pattern.name or "pattern", tuple(self.report_sections())
        return Content(name, poser.body, (end,), (track,), pieces=pieces)

    def rows(self, most: int = 0) -> list[MotionRow]:
        """Return states as tables, frames and captions have them, evenly along the motion.

        Parameters
        ----------
        most
            How many, with both ends; 0 for all.

        Returns
        -------
        list of MotionRow
            In order.
        """
        number, s = np.arange(len(self.arc)), self.arc
        if 0 < most < len(s):
            number = np.unique([0, *np.searchsorted(s, np.linspace(0.0, s[-1], most))])
        largest = np.abs(self.fold_angles).max(axis=1)
        each = zip(number + 1, s[number], largest[number], self.energy[number], strict=True)
        return [MotionRow(int(k), *map(float, more)) for k, *more in each]

    def report_sections(self) -> Iterator[Section]:
        """Return where it ends over a table of some of its states, and what it leaves open."""
        shown = self.rows(9)
        yield record_table(shown, self.verdict)
        if self.lattices:
            numbers = [row.state for row in shown]
            yield lattice_table([self.lattices[k - 1] for k in numbers], numbers, "state")
        if self.layers:
            yield f"folded flat there: {self.layers}"

    @property
    def verdict(self) -> str:
        """Where the motion ends, in a sentence."""
        last = math.degrees(np.abs(self.fold_angles[-1]).max())
        many = f"one of many motions ({self.dof} degrees of freedom) " * (self.dof > 1)
        return f"{self.pattern.title}: {many}folds until the largest fold angle is {last:.5g} deg: {self.end}"

    def _rows(self) -> Iterable[dict[str, object]]:
        for row, phi in zip(self.rows(), self.fold_angles, strict=True):
            yield record_row(row) | angle_columns(phi)


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
    exact = np.where(np.abs(phi) < NEAR_SINGULAR_TOL, 0.0, np.copysign(math.pi, phi))
    flat, residual = problem.project(exact)
    if residual > CLOSURE_TOL or np.abs(flat - phi).max() > 2 * NEAR_SINGULAR_TOL:
        return "not known to have an order of layers: no flat-folded state was found near it"
    found = order_layers(problem, flat)
    return "its layers can be ordered" if found.verdict == "ordered" else found.reason


def _at_limit(problem: PatternProblem, phi: np.ndarray) -> np.ndarray:
    """Add the flat-folded state ahead, where many creases reach their fold limits at once and steps look alike."""
    last, limits = phi[-1], problem.fold_limits
    near = limits.room(last) < AHEAD
    held = np.where(near, limits.hold(last, limits.side(last)), last)
    end, residual = problem.project(held, near)
    good = near.any() and residual <= CLOSURE_TOL and np.abs(end - last).max() < AHEAD
    return np.vstack([phi, end]) if good and limits.inside(end).all() else phi


def _until_touch(
    problem: PatternProblem, phi: np.ndarray
) -> tuple[np.ndarray, tuple[int, int] | None]:
    """Cut a path where facets begin to cross; the last state is the one at which they touch."""
    first = next((k for k, x in enumerate(phi) if problem.crossings.find(x)), None)
    if first == 0:
        raise OptionError("facets cross from the start: there is no motion of paper to show")
    if first is None:
        return phi, None
    free, crossed = last_free(problem, phi[first - 1], phi[first], 45)
    return np.vstack([phi[:first], free]), problem.crossings.find(crossed)[0]


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
