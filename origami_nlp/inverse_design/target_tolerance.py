"""Targets moved within their tolerances to where springs hold them better, or at all."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from origami_nlp.arguments import check_whole
from origami_nlp.errors import OptionError, OrigamiError
from origami_nlp.inverse_design.contact_choice import solve
from origami_nlp.inverse_design.convex import ConvexDesign, scene_of, springs_of
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.kkt import State, classify, project
from origami_nlp.numerics import CLOSURE_TOL

PRICE = 100.0
"""Of torques out of balance, over the margin, while targets move: large enough to be exact where springs exist."""


@dataclass(frozen=True)
class MovedTargets:
    """Targets that were moved.

    Attributes
    ----------
    targets
        The question with the new fold angles.
    before, after
        Largest margin with the states as given, and as moved; -inf where there are no springs.
    by
        Largest change of a fold angle of each state [rad].
    programs
        How many were solved.
    """

    targets: Targets
    before: float
    after: float
    by: tuple[float, ...]
    programs: int


def move_targets(targets: Targets, *, rounds: int = 40) -> MovedTargets:
    """Move the targets that have a tolerance to where the margin of the best springs is larger.

    The margin is a function of the states' coordinates along their closed motions; where no springs hold them the
    imbalance that is left is paid for, so that the search has a slope to follow.  A local search: that it finds nothing
    proves nothing.

    Parameters
    ----------
    targets
        The question; `Target.tolerance` bounds the change of each fold angle.
    rounds
        Most steps of the search.

    Returns
    -------
    MovedTargets
        With the question of the states found, which are those given where none are better.

    Raises
    ------
    OptionError
        If no state has a tolerance.
    """
    check_whole("rounds", rounds, 1)
    model = targets.model
    start = [p.state.x for p in targets.placed]
    contacts = [p.state.pieces[0] for p in targets.placed]
    # coordinates along the motions that keep the contacts; projection takes care of the rest
    bases = [
        State(model, x).on(c).tangent / model.root[:, None]
        for x, c in zip(start, contacts, strict=True)
    ]
    sizes = [
        b.shape[1] if t.tolerance > 0 else 0 for b, t in zip(bases, targets.states, strict=True)
    ]
    if not sum(sizes):
        raise OptionError("no state can move: give states that are not pinned a tolerance_deg")
    ends = np.cumsum(sizes)[:-1]
    known: dict[bytes, float] = {}

    def states(y: np.ndarray) -> list[np.ndarray] | None:
        out = []
        for x, c, b, part, t in zip(
            start, contacts, bases, np.split(y, ends), targets.states, strict=True
        ):
            if not len(part):
                out.append(x)
                continue
            new, residual = project(model, x + b @ part, c)
            given = model.reduce(np.array(t.fold_angles))
            if (
                residual > CLOSURE_TOL
                or np.abs(new - given).max() > t.tolerance
                or model.refuses(new)
            ):
                return None
            out.append(new)
        return out

    def cost(y: np.ndarray) -> float:
        key = y.tobytes()
        if key not in known:
            at = states(y)
            # the best margin has kinks in the coordinates, and no derivative that is known: Nelder and Mead
            known[key] = 1e3 if at is None else -_margin(_question(targets, at))
        return known[key]

    y0 = np.zeros(sum(sizes))
    reach = np.concatenate(
        [np.full(n, t.tolerance) for n, t in zip(sizes, targets.states, strict=True)]
    )
    first = np.vstack([y0, y0 + np.diag(0.4 * reach)])
    found = minimize(
        cost,
        y0,
        method="Nelder-Mead",
        options={"initial_simplex": first, "maxfev": rounds * (len(y0) + 1), "adaptive": True},
    )
    best = states(found.x)
    before = solve(targets)
    held = before.margin if before.feasible else -math.inf
    if best is not None:
        moved = _question(targets, best)
        after = solve(moved)
        if after.feasible and after.margin > held and _holds(after):
            by = tuple(float(np.abs(a - b).max()) for a, b in zip(start, best, strict=True))
            return MovedTargets(moved, held, after.margin, by, len(known))
    return MovedTargets(targets, held, held, (0.0,) * len(start), len(known))


def _holds(posed: ConvexDesign) -> bool:
    """Whether the springs hold the states: next to where conditions depend on each other the optimum need not."""
    try:
        model = posed.targets.posed(scene_of(posed.targets, springs_of(posed)))
    except (OrigamiError, ValueError):
        return False
    return all(classify(State(model, p.state.x)).verdict == "minimum" for p in posed.targets.placed)


def _question(targets: Targets, at: list[np.ndarray]) -> Targets:
    """Return the question with its states at other places, which are exact."""
    model = targets.model
    states = tuple(
        replace(t, fold_angles=tuple(model.expand(x).tolist()))
        for t, x in zip(targets.states, at, strict=True)
    )
    return replace(targets, states=states)


def _margin(targets: Targets) -> float:
    """Margin less the price of what is out of balance."""
    try:
        answer = ConvexDesign(targets, elastic=PRICE).answer
    except OrigamiError:
        return -1e3
    return answer.bound if answer.solved else -1e3
