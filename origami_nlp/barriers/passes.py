"""From the top of a lowest path to the exact mountain pass.

A pass is a state through which two components of {energy < level} first meet.  On a smooth stratum of the feasible
set it is a KKT point (contact multipliers >= 0) with exactly one direction of negative curvature: a saddle, or a
contact saddle.  Where pieces of the feasible set meet at an angle it may be a corner, and where they meet
in one state only that state itself is the pass.  A pass counts only with the evidence: a descent down either side.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import State, follow, judge_branch, newton, project
from origami_nlp.numerics import (
    BALANCED,
    CLOSURE_TOL,
    CURVED,
    DUPLICATE_TOL,
    ENDPOINT_TOL,
    NONZERO,
)
from origami_nlp.problem import Contact, Problem

PROVED = "proved: admissible states above and below the flat state meet there only"
EVERY = "no lower path: all curves of the one degree of freedom are known"
FOLLOWED = (
    "no lower path: motions from the first state follow traced curves, up to where others meet them"
)
NEVER = "no path: with less than 360 degrees of paper a vertex keeps its sign (proved)"
STOPPED = "no path: each makes a vertex flat, which a stop forbids (proved)"
RIGID = "no path: one of the two is isolated, as its certificate says"
LOWEST = (PROVED, EVERY, FOLLOWED, NEVER, STOPPED, RIGID)
"""What bounds a barrier from below by its own height."""
FOLLOWS = (EVERY, FOLLOWED)
"""Of these, what says that all paths are known up to that height, not only those between the two."""
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
    energy
        Of the pass [the scene's units]; inf where no admissible path joins the two.
    pass_kind
        ``saddle`` (interior), ``contact saddle``, ``corner`` (pieces of the feasible set meet), ``flat state``,
        ``singular`` (another state where two pieces meet in one point, or a thin set ends), ``bound`` (no pass: the
        energy is that of an explicit path, an upper bound), or ``none``.
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
    why
        What bounds the barrier from below.
    least
        Of a vertex: energy that every path has at least, where the flat state parts the two; nan elsewhere.
    """

    from_state: int
    to_state: int
    energy: Unbounded
    pass_kind: PassKind
    fold_angles: tuple[float, ...]
    contacts: tuple[str, ...]
    residual: float
    path: np.ndarray = field(repr=False)
    path_energy: np.ndarray = field(repr=False)
    why: str
    least: float = math.nan

    @property
    def is_lowest(self) -> bool:
        """Whether the barrier is its height, and not at most that."""
        return self.why in LOWEST


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
        Unit vector of negative curvature [n], or None.
    """

    x: np.ndarray
    rows: tuple[Contact, ...]
    index: int
    residual: float
    kind: PassKind
    direction: np.ndarray | None = field(repr=False, default=None)


@dataclass(frozen=True)
class Descent:
    """A path down from a pass: states [m, n] from next to the pass to where it ends.

    Attributes
    ----------
    lands_on
        Position of the minimum it ends in among those given, or None.
    """

    states: np.ndarray = field(repr=False)
    lands_on: int | None


def critical_near(model: Problem, starts: np.ndarray, reach: float) -> list[Critical]:
    """Return the KKT points of index 1 that Newton finds from `starts` [K, n] within `reach` [rad] of them."""
    found: list[Critical] = []
    tried: set[tuple[int, tuple[Contact, ...]]] = set()
    for k, x in enumerate(starts):
        sets: list[tuple[Contact, ...]] = [()]
        for rows in State(model, x, reach).pieces:
            sets += [(row,) for row in rows]
            sets += list(itertools.combinations(rows, 2))
        for rows in dict.fromkeys(sets):
            if len(rows) > model.dof or (k, rows) in tried:
                continue
            tried.add((k, rows))
            polished, _ = newton(model, x, rows)
            if polished is None or not polished.converged or np.abs(polished.x - x).max() > reach:
                continue
            if any(np.abs(polished.x - c.x).max() <= DUPLICATE_TOL for c in found):
                continue
            state = State(model, polished.x)
            what = critical_at(state)
            if what is not None and what.index == 1 and not state.refused:
                found.append(what)
    return found


def critical_at(state: State) -> Critical | None:
    """Judge a polished state: its index on the pieces of the feasible set; None if it is not stationary on each."""
    model, x = state.problem, state.x
    judged = [judge_branch(state.on(rows)) for rows in state.pieces]
    size = 1.0 + float(np.abs(state.gradient).max())
    residual = max(b.multipliers.residual for b in judged) / size
    residual = max(residual, state.residual)
    if residual > BALANCED:
        return None
    index, direction = 0, None
    for b in judged:
        scale = max(NONZERO, float(np.abs(b.eigenvalues).max(initial=0.0)))
        below = int((b.eigenvalues < -CURVED * scale).sum())
        if below >= index:
            # where pieces meet the largest index counts: down on one of them is down
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
    if direction is not None:
        direction = direction / np.linalg.norm(direction)
    return Critical(x, judged[0].rows, index, residual, kind, direction)


def slide(
    model: Problem, start: np.ndarray, minima: Sequence[np.ndarray], most_steps: int = 2000
) -> Descent | None:
    """Descend from an admissible state; None if the start is not admissible."""
    try:
        path = follow(model, start, most_steps=most_steps)
    except ValueError:
        return None
    near = [float(np.abs(path.end - m).max()) for m in minima]
    # None: a minimum that is not listed, or a descent that stopped on its way
    lands = int(np.argmin(near)) if near and min(near) <= ENDPOINT_TOL else None
    return Descent(path.states, lands)


def both_sides(
    model: Problem,
    pass_: Critical,
    minima: Sequence[np.ndarray],
    go: Callable[[Problem, np.ndarray, Sequence[np.ndarray]], Descent | None] = slide,
) -> tuple[Descent, Descent] | None:
    """Descend from a saddle along both senses of its unstable direction; None where one side has no lower state.

    `go` descends, as `slide`.
    """
    if pass_.direction is None:
        return None
    sides = []
    for sign in (1.0, -1.0):
        # far enough off the pass that the energy falls by more than rounding, near enough not to jump to another valley
        for off in OFF:
            held = pass_.rows if pass_.kind == "contact saddle" else ()
            y, residual = project(model, pass_.x + sign * off * pass_.direction, held)
            y = model.fold_limits.clip(y)
            lower = model.energy_change(pass_.x, y) < 0
            if residual <= CLOSURE_TOL and lower and not model.refuses(y):
                down = go(model, y, minima)
                if down is not None:
                    sides.append(down)
                    break
        else:
            return None
    return sides[0], sides[1]
