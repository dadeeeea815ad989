"""Follow a state downhill, inside the admissible set, to the stable state that it belongs to.

Steps go along the projection of the springs' pull on the linearised feasible cone, measured in the stiffness metric,
and are pulled back onto loop closure; every accepted state closes, is admissible and is lower than the one
before.  Unlike a restart of the solver, the path cannot jump to another basin: it is the evidence for
what becomes of a minimum that a grid reports.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt.classification import Classification, classify
from origami_nlp.kkt.neighbours import search_spheres
from origami_nlp.kkt.polishing import Polished, Solve, exact_beside, polish
from origami_nlp.kkt.projection import project
from origami_nlp.kkt.state import State, Stratum
from origami_nlp.numerics import (
    BESIDE,
    CLOSES,
    DECREASE,
    EPS,
    INDEPENDENT,
    LEVEL,
    NEAR_CONTACT,
    ROUNDED,
    SLIDES,
    nearest,
    null_space,
)
from origami_nlp.programme import Contact, Programme

LONGEST = 0.1
"""Longest step [rad]."""
RESCUE = (3e-2, 1e-2, 1e-3)
"""Radii [rad] of the search for a lower neighbour: where contacts crowd, the first long step is the easiest."""
MOST_GUESSES = 8
"""Sets of closed contacts that are tried when the end of a path is polished."""
TRIED = (1e-3, 3e-3, 1e-4)
"""Steps [rad] that are tried along the softest mode."""
SHORTEST = 1e-6
"""A path that cannot take a step this long [rad] has arrived, or is stuck."""


STOPPED = Classification("undecided", None, "the descent was stopped on its way", 0)
RISE = 1e-7
"""Relative rise of the energy that is allowed to the end of a path when it is polished."""


@dataclass(frozen=True)
class Followed:
    """A descent and where it ends.

    states: variables of the accepted states, [s, n], first the start.  energies: [s], strictly decreasing.
    end: the last state, polished if that succeeded nearby.  what: its classification.
    """

    states: np.ndarray
    energies: np.ndarray
    end: np.ndarray
    what: Classification


def follow(
    model: Programme,
    start: np.ndarray,
    *,
    most_steps: int = 2000,
    most_rescues: int = 12,
    until: Callable[[np.ndarray], bool] | None = None,
) -> Followed:
    """Follow the state `start` [n] downhill, `until` a state on the way is far enough: that one is not judged.

    Where no step along the linearised cone is possible but the state is no minimum (several contacts meet), a lower
    admissible neighbour is searched on small spheres, at most `most_rescues` times.

    Raises
    ------
    ValueError
        If the start does not close, or is not admissible.
    """
    x, residual = project(model, np.asarray(start, dtype=float), ())
    x = np.clip(x, -model.bound, model.bound)
    if residual > CLOSES or model.refuses(x):
        raise ValueError(f"the start is not a closed, admissible state: closure {residual:.1e}")
    states = [x]
    length = LONGEST
    rescues = 0
    while len(states) < most_steps:
        if until is not None and until(x):
            path = np.array(states)
            return Followed(path, model.energies(path), x, STOPPED)
        # wider than the shortest step, so that a path that cannot come closer slides along the contact
        moved = _step(State(model, x, SLIDES), length)
        if moved is not None:
            x, taken = moved
            states.append(x)
            length = min(LONGEST, 2 * taken)
            continue
        end = _level_with(model, x)
        what = classify(State(model, x if end is None else end), polished=end is not None)
        if what.verdict == "minimum" or rescues == most_rescues:
            break
        rescues += 1
        lower = _lower_neighbour(State(model, x), what.descent)
        if lower is None:
            break
        x, length = lower, LONGEST
        states.append(x)
    else:
        end = _level_with(model, x)
        what = classify(State(model, x if end is None else end), polished=end is not None)
    path = _strictly_decreasing(model, states, x if end is None else end)
    energies = model.energy(path[0]) + np.array([model.energy_change(path[0], y) for y in path])
    return Followed(path, energies, path[-1], what)


def _strictly_decreasing(model: Programme, states: list[np.ndarray], end: np.ndarray) -> np.ndarray:
    """Keep the states whose energy falls by more than rounding, and the end in place of what is level with it."""
    noise = 2 * EPS * max(model.energy(states[0]), model.scale)  # two roundings
    kept = [states[0]]
    for y in states[1:]:
        if model.energy_change(kept[-1], y) < -noise:
            kept.append(y)
    while len(kept) > 1 and model.energy_change(kept[-1], end) >= -noise:
        kept.pop()
    if model.energy_change(kept[-1], end) < -noise:
        kept.append(end)
    elif len(kept) == 1:
        kept = [end]
    return np.array(kept)


def _lower_neighbour(at: State, direction: np.ndarray | None) -> np.ndarray | None:
    """Return an admissible state near by with lower energy: along `direction` if that works, else by search."""
    model, x = at.programme, at.x
    noise = LEVEL * max(at.energy, model.scale)
    for step, sign in itertools.product(TRIED, (1.0, -1.0)):
        y = None if direction is None else _closed(model, x + sign * step * direction)
        if y is not None and model.energy_change(x, y) < -noise and not model.refuses(y):
            return y
    found = search_spheres(at, at.contacts.base, radii=RESCUE)
    return found.state if found.state is not None and found.lowest < -noise else None


def _closed(
    model: Programme, want: np.ndarray, held: tuple[Contact, ...] = ()
) -> np.ndarray | None:
    """Pull a state [n] onto closure with contacts held, within the fold limits; None where that does not close."""
    y, residual = project(model, want, held)
    y = np.clip(y, -model.bound, model.bound)
    closes = residual <= CLOSES and np.abs(model.closure(y)[0]).max() <= CLOSES
    return y if closes else None


def _step(state: State, length: float) -> tuple[np.ndarray, float] | None:
    """Take one admissible step down, of at most `length`; None if there is none."""
    model, x = state.programme, state.x
    choices = state.pieces
    best: tuple[float, np.ndarray, float] | None = None
    near = model.about_to_close(x, length)
    tries = [tuple(dict.fromkeys((*rows, *near))) for rows in choices] if near else []
    for rows in (*tries, *choices):
        if best is not None and rows in choices:
            break  # only where looking ahead to contacts that will close led nowhere
        d = _pull(state.on(rows))
        size = float(np.linalg.norm(d))
        if size < ROUNDED:
            continue
        slope = float(state.local.gradient @ d)
        held = _kept(state.on(rows), d)
        step = min(1.0, length / size)
        while step * size >= SHORTEST:
            y = _closed(model, x + step * d, held)
            change = math.inf if y is None else model.energy_change(x, y) / model.scale
            # sufficient decrease (Nocedal & Wright, 3.4), measured after the way back to closure
            if y is not None and change < DECREASE * step * slope and not model.refuses(y):
                if best is None or change < best[0]:
                    best = (change, y, step * size)
                break
            step /= 2
    return None if best is None else best[1:]


def _pull(piece: Stratum) -> np.ndarray:
    """Minimise grad U . d + d'Kd/2 over the linearised feasible set: gap + gradient . d >= 0 for each contact."""
    state = piece.state
    # with y = K^(1/2) d this is a projection: the step of sequential quadratic programming, K in place of the Hessian
    root = np.sqrt(state.programme.parameters.stiffness)  # the stiffness metric
    z = null_space(state.local.closure_jacobian / root)
    gaps, slopes = state.local.openings(piece.contacts)
    a = slopes / root @ z
    cost = z.T @ (state.local.gradient / root)
    if not len(a):
        return -(z @ cost) / root
    y = nearest(-cost, a, -np.maximum(gaps, 0.0))
    return np.zeros(len(root)) if y is None else (z @ y) / root


def _kept(piece: Stratum, d: np.ndarray) -> tuple[Contact, ...]:
    """Return the contacts that a direction keeps closed."""
    _, slopes = piece.state.local.openings(piece.contacts)
    return tuple(
        c
        for c, g in zip(piece.contacts, slopes, strict=True)
        if abs(g @ d) <= INDEPENDENT * np.linalg.norm(d)
    )


def _level_with(model: Programme, x: np.ndarray) -> np.ndarray | None:
    """Polish the end of a path: it may stand a contact tolerance inside a closed contact, so a little lower."""
    most = RISE * max(model.energy(x), model.scale)
    ends = (p.x for p in polished_nearby(model, x) if model.energy_change(x, p.x) <= most)
    return next(ends, None)


def polished_nearby(
    model: Programme, x: np.ndarray, tolerance: float = NEAR_CONTACT
) -> Iterator[Polished]:
    """Return stationary states that Newton reaches within `BESIDE` of x [n], contacts that are closed there held first.

    Parameters
    ----------
    model
        The programme.
    x
        A state, shape [n] [rad].
    tolerance
        Opening [rad] up to which a contact counts as closed.

    Returns
    -------
    iterator of Polished
        One for each set of closed contacts from which Newton converges.
    """
    state = State(model, x, tolerance)
    pull = np.zeros(model.size)
    for contact in state.contacts.base:
        if contact.is_limit:
            pull[contact.index] = 1.0
    answer = Solve(x, "followed", 0, 0.0, pull, None)
    # the contacts that are closed first: a guess from near gaps may close one that the path never met
    for guess in (*state.pieces[:MOST_GUESSES], None):
        done = polish(model, answer, guess)
        if not done.converged:
            done = exact_beside(model, done)
        if done.converged and np.abs(done.x - x).max() <= BESIDE:
            yield done
