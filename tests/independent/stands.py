"""Does a claimed minimum stand?  The judge of every state that the package reports.

A state stands when it closes (a plain product of rotation matrices), lies next to a state that
closes in extended precision, and no admissible neighbour at the radii 1e-6, 1e-4 and 1e-2 that hangs
together with it is lower in energy.  Neighbours are drawn in random directions and down the torques,
in all strata of creases that stay fully folded or flat, and by turning few creases while all others are
held (two creases on one line turn as a hinge); they are closed in extended precision, and those that
are lower are closed again, asked for crossings and layers, and compared with 80 digits.  From the
lowest a descent that stays admissible tells how much lower it goes, and how far.

What it does not see: sets of states that exist only while facets touch at fold angles other than 0
and +-pi (`pockets` looks for these), and lower states that no level straight way joins to the state
(`elsewhere` counts them: basins can be narrower than the radius).

Nothing here uses the package but the numbers that it reports.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from tests.independent.exact_states import admissible_to_rounding, base
from tests.independent.sheet import PatternProblem, product_of_folds
from tests.independent.ways_down import descend, look

RADII = (1e-6, 1e-4, 1e-2)
CLOSURE_TOL = 1e-12
"""Largest entry of M - 1 of a state that may be reported."""
NEXT = 1e-6
"""A reported state lies this close [rad] to one that closes in extended precision."""


@dataclass(frozen=True)
class Verification:
    """What the judge found.

    closure: largest entry of M - 1 of the reported numbers.  offset: distance [rad] of the reported
    state from the nearest one found that closes in extended precision; inf if none is near.
    allowed: whether the reported state itself is admissible.
    looked: admissible neighbours at each radius.  elsewhere: verified lower neighbours that no level
    way joins to the state, at each radius.
    neighbour, radius, change: the lowest verified neighbour that hangs together with the state [N],
    and its energy less that of the state.  end, drop, reach: where the descent from it ends, how much
    lower, how far away [rad].  why: why the state is false; empty where it stands.
    """

    closure: float
    offset: float
    allowed: bool
    looked: tuple[int, ...] = ()
    elsewhere: tuple[int, ...] = ()
    neighbour: tuple[float, ...] | None = None
    radius: float = 0.0
    change: float = 0.0
    end: tuple[float, ...] | None = None
    drop: float = 0.0
    reach: float = 0.0
    why: str = ""

    @property
    def false(self) -> bool:
        return bool(self.why)


def judge(problem: PatternProblem, fold_angles, count: int = 2000, seed: int = 0) -> Verification:
    """Judge a claimed minimum; see the module."""
    phi = np.asarray(fold_angles, dtype=float)
    closure = float(np.abs(product_of_folds(problem.sectors, phi) - np.eye(3)).max())
    rng = np.random.default_rng(seed)
    x = base(problem, phi)
    if x is None:
        return Verification(closure, math.inf, False, why="no state that closes is near")
    offset = float(np.abs(x[problem.orbit] - phi).max())
    allowed = admissible_to_rounding(problem, x)
    why = ""
    if closure > CLOSURE_TOL:
        why = f"closes to {closure:.1e}"
    elif offset > NEXT:
        why = f"is {offset:.1e} rad from a state that closes"
    elif not allowed:
        why = "is not admissible"
    if why:
        return Verification(closure, offset, allowed, why=why)
    return _around(problem, x, Verification(closure, offset, allowed), count, rng)


def _around(
    problem: PatternProblem, x: np.ndarray, stand: Verification, count: int, rng
) -> Verification:
    """Look at the neighbours of x at all radii, and go down from the lowest."""
    margin = 1e-8 * problem.scale(x) + 1e-13 * float(problem.stiffness.sum())
    for radius in RADII:
        seen, apart, found = look(problem, x, radius, count, rng)
        stand = replace(stand, looked=(*stand.looked, seen), elsewhere=(*stand.elsewhere, apart))
        if not found:
            continue
        y = min(found, key=lambda one: float(problem.change(one, x)))
        end = descend(problem, y, rng)
        drop, reach = -float(problem.change(end, x)), float(np.abs(end - x).max())
        if drop <= margin * reach:
            continue  # the state is known to rounding only
        return replace(
            stand,
            neighbour=tuple(y[problem.orbit].astype(float).tolist()),
            radius=radius,
            change=float(problem.change(y, x)),
            end=tuple(end[problem.orbit].astype(float).tolist()),
            drop=drop,
            reach=reach,
            why=f"a neighbour at {radius:g} leads down by {drop:.2e} to {reach:.1e} rad away",
        )
    return stand
