"""From the top of a lowest path to the exact mountain pass.

A pass is a state through which two components of {energy < level} first meet.  On a smooth stratum of the feasible
set it is a KKT point (contact multipliers >= 0) with exactly one direction of negative curvature: a saddle, or a
contact saddle.  Where pieces of the feasible set meet at an angle it may be a corner, and where they meet
in one state only that state itself is the pass.  A pass counts only with the evidence: a descent down either side.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from enum import Enum
from typing import Literal

import numpy as np

from origami_nlp.display import shown
from origami_nlp.escapes import Terrain, down_to
from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import State, judge_branch, newton, project
from origami_nlp.numerics import (
    BALANCED,
    CLOSURE_TOL,
    CURVED,
    DUPLICATE_TOL,
    NONZERO,
)
from origami_nlp.problem import Contact, Problem


class Known(Enum):
    """What is known of a barrier."""

    EXACT = "exact"
    """It is the height that is stated; inf: no path leads from one state to the other."""
    BOUND = "bound"
    """It is at most that."""

    def __str__(self) -> str:
        return str(self.value)


PassKind = Literal["saddle", "contact saddle", "corner", "flat state", "singular", "bound", "none"]
OFF = (1e-2, 3e-2, 3e-3, 1e-3)
"""First steps [rad] of the descents from a saddle."""


@dataclass(frozen=True, repr=False)
class Pass(ShortRepr):
    """The lowest pass between two minima.

    Attributes
    ----------
    from_state, to_state
        Numbers (1-based) among the minima.
    rises, back
        What the pass is above either minimum.
    energy
        Of the pass [the scene's units]; inf where no admissible path joins the two.
    least
        Of a vertex: energy that every path has at least, where the flat state parts the two; None elsewhere.
    pass_kind
        ``saddle`` (interior), ``contact saddle``, ``corner`` (pieces of the feasible set meet), ``flat state``,
        ``singular`` (another state where two pieces meet in one point, or a thin set ends), ``bound`` (no pass: the
        energy is that of an explicit path, an upper bound), or ``none``.
    known
        ``exact`` or ``bound``: whether the barrier is its height, or at most that.
    why
        What bounds the barrier from below.
    fold_angles
        Of the pass, all N [rad]; empty for ``none``.
    contacts
        Closed there, in words.
    residual
        Of its KKT system (scaled; nan where no such system holds: at singular passes and of bounds).
    path
        Fold angles [M, N] from the first minimum over the pass to the second.
    path_energy
        [M].
    every
        Whether all paths up to that height are known, not only those between the two.
    """

    from_state: int = field(metadata=shown("from", spec="#{}".format, side="r"))
    to_state: int = field(metadata=shown("to", spec="#{}".format, side="r"))
    rises: Unbounded = field(metadata=shown("barrier", "J", ".6g"))
    back: Unbounded = field(metadata=shown("and back", "J", ".6g"))
    energy: Unbounded = field(metadata=shown("energy at the pass", "J", ".9g"))
    least: float | None = field(metadata=shown("at least", "J", ".9g"))
    pass_kind: PassKind = field(metadata=shown("kind"))
    known: Known = field(metadata=shown("known"))
    why: str
    path: np.ndarray = field(repr=False)
    path_energy: np.ndarray = field(repr=False)
    fold_angles: tuple[float, ...] = ()
    contacts: tuple[str, ...] = ()
    residual: float = math.nan
    every: bool = False

    @property
    def pair(self) -> tuple[int, int]:
        """Numbers of the minima on either side."""
        return self.from_state, self.to_state

    @property
    def name(self) -> str:
        """How reports call it."""
        return f"#{self.from_state} - #{self.to_state}"


@dataclass(frozen=True)
class Critical:
    """An exact critical state that may be a pass.

    Attributes
    ----------
    x
        [n].
    rows
        Closed contacts.
    index
        Directions of negative curvature on the loaded contacts.
    residual
        Of stationarity, closure and contacts (scaled).
    kind
        See `PassKind`.
    direction
        Of negative curvature [n], or None.
    """

    x: np.ndarray
    rows: tuple[Contact, ...]
    index: int
    residual: float
    kind: PassKind
    direction: np.ndarray | None = field(repr=False, default=None)


def critical_near(model: Problem, start: np.ndarray, reach: float) -> list[Critical]:
    """Return the KKT points of index 1 that Newton finds from a state [n] within `reach` [rad] of it."""
    found, sets = list[Critical](), [tuple[Contact, ...]()]
    for rows in State(model, start, reach).pieces:
        sets += [*((row,) for row in rows), *itertools.combinations(rows, 2)]
    for rows in dict.fromkeys(sets):
        polished = newton(model, start, rows)[0] if len(rows) <= model.dof else None
        if polished is None or not polished.converged or np.abs(polished.x - start).max() > reach:
            continue
        if not any(np.abs(polished.x - c.x).max() <= DUPLICATE_TOL for c in found):
            what = critical_at(state := State(model, polished.x))
            found += [what] if what is not None and what.index == 1 and not state.refused else []
    return found


def critical_at(state: State) -> Critical | None:
    """Judge a polished state: its index on the pieces of the feasible set; None if it is not stationary on each."""
    model, x = state.problem, state.x
    judged = [judge_branch(state.on(rows)) for rows in state.pieces]
    size = 1.0 + float(np.abs(state.gradient).max())
    residual = max(max(b.multipliers.residual for b in judged) / size, state.residual)
    if residual > BALANCED:
        return None
    index, direction = 0, None
    for b in judged:
        scale = max(NONZERO, float(np.abs(b.eigenvalues).max(initial=0.0)))
        # where pieces meet the largest index counts: down on one of them is down
        if (below := int((b.eigenvalues < -CURVED * scale).sum())) >= index:
            index, direction = below, b.direction
    if not state.regular:
        kind: PassKind = "flat state" if np.abs(x).max() <= DUPLICATE_TOL else "singular"
    elif len(judged) > 1 or len(judged[0].rows) >= model.dof:
        # as many contacts as degrees of freedom leave a point, where the energy need not be stationary
        kind = "corner"
    else:
        kind = "contact saddle" if judged[0].rows else "saddle"
    if direction is None and index:
        direction = state.on(judged[0].rows).softest
    return Critical(x, judged[0].rows, index, residual, kind, direction)


def both_sides(terrain: Terrain, critical: Critical) -> list[tuple[np.ndarray, int]]:
    """Descend from a saddle along both senses of its unstable direction: states [S, n] and numbers of minima.

    None where one side has no lower state, or does not end at a minimum.
    """
    problem, sides = terrain.problem, list[tuple[np.ndarray, int]]()
    if critical.direction is None:
        return []
    held = critical.rows if critical.kind == "contact saddle" else ()
    aside = critical.direction / np.linalg.norm(critical.direction)
    for sign in (1.0, -1.0):
        # far enough off the pass that the energy falls by more than rounding, near enough not to jump to another valley
        for off in OFF:
            y, residual = project(problem, critical.x + sign * off * aside, held)
            y = problem.fold_limits.clip(y)
            lower = problem.energy_change(critical.x, y) < 0
            if residual <= CLOSURE_TOL and lower and not problem.refuses(y):
                if (down := down_to(terrain, y)) is not None:
                    sides.append((np.concatenate([critical.x[None], down[0]]), down[1]))
                    break
        else:
            return []
    return sides
