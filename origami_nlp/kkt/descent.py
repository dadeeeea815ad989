"""Follow a state downhill, inside the admissible set, to the stable state that it belongs to.

Steps go along the projection of the springs' pull on the linearised feasible cone, measured in the stiffness metric,
and are pulled back onto loop closure; every accepted state closes, is admissible and is lower than the one
before.  Unlike a restart of the solver, the path cannot jump to another basin: it is the evidence for
what becomes of a minimum that a grid reports.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt.classification import Classification, classify
from origami_nlp.kkt.neighbours import project, search_spheres
from origami_nlp.kkt.polishing import Solve, exact_beside, polish
from origami_nlp.numerics import nearest, null_space
from origami_nlp.programme import (
    CLOSED,
    Model,
    Row,
    closed_contacts,
    is_admissible,
    row_values,
    same_gap,
)

LONGEST = 0.1
"""Longest step [rad]."""
CLOSED_TO = 1e-12
"""Every state of a path closes at least this well."""
RESCUE = (3e-2, 1e-2, 1e-3)
"""Radii [rad] of the search for a lower neighbour: where contacts crowd, the first long step is the easiest."""
NEAR = 3e-5
"""Contacts open by less [rad] are slid along."""
MOST_GUESSES = 8
"""Sets of closed contacts that are tried when the end of a path is polished."""
SHORTEST = 1e-6
"""A path that cannot take a step this long [rad] has arrived, or is stuck."""


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
    model: Model, start: np.ndarray, *, most_steps: int = 2000, most_rescues: int = 12
) -> Followed:
    """Follow the state `start` [n] downhill.

    Where no step along the linearised cone is possible but the state is no minimum (several contacts meet), a lower
    admissible neighbour is searched on small spheres, at most `most_rescues` times.

    Raises
    ------
    ValueError
        If the start does not close, or is not admissible.
    """
    x, residual = project(model, np.asarray(start, dtype=float), ())
    x = np.clip(x, -model.bound, model.bound)
    if residual > CLOSED_TO or not is_admissible(model, x):
        raise ValueError(f"the start is not a closed, admissible state: closure {residual:.1e}")
    states = [x]
    length = LONGEST
    rescues = 0
    while len(states) < most_steps:
        moved = _step(model, x, length)
        if moved is not None:
            x, taken = moved
            states.append(x)
            length = min(LONGEST, 2 * taken)
            continue
        end = _polish_nearby(model, x)
        what = classify(model, x if end is None else end, polished=end is not None)
        if what.verdict == "minimum" or rescues == most_rescues:
            break
        rescues += 1
        lower = _lower_neighbour(model, x, what.descent)
        if lower is None:
            break
        x, length = lower, LONGEST
        states.append(x)
    else:
        end = _polish_nearby(model, x)
        what = classify(model, x if end is None else end, polished=end is not None)
    path = _strictly_decreasing(model, states, x if end is None else end)
    energies = model.energy(path[0]) + np.array([model.energy_change(path[0], y) for y in path])
    return Followed(path, energies, path[-1], what)


def _strictly_decreasing(model: Model, states: list[np.ndarray], end: np.ndarray) -> np.ndarray:
    """Keep the states whose energy falls by more than rounding, and the end in place of what is level with it."""
    noise = 4e-16 * max(model.energy(states[0]), model.scale)
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


def _lower_neighbour(
    model: Model, x: np.ndarray, direction: np.ndarray | None
) -> np.ndarray | None:
    """Return an admissible state near x with lower energy: along `direction` if that works, else by search."""
    noise = 1e-13 * max(model.energy(x), model.scale)
    if direction is not None:
        for step in (1e-3, 3e-3, 1e-4):
            for sign in (1.0, -1.0):
                y, residual = project(model, x + sign * step * direction, ())
                y = np.clip(y, -model.bound, model.bound)
                if (
                    residual <= CLOSED_TO
                    and np.abs(model.closure(y)[0]).max() <= CLOSED_TO
                    and model.energy_change(x, y) < -noise
                    and is_admissible(model, y)
                ):
                    return y
    rows = closed_contacts(model, x, model.local(x).gaps).base
    found = search_spheres(model, x, rows, radii=RESCUE)
    return found.state if found.state is not None and found.lowest < -noise else None


def _step(model: Model, x: np.ndarray, length: float) -> tuple[np.ndarray, float] | None:
    """Take one admissible step down, of at most `length`; None if there is none."""
    local = model.local(x)
    # wider than the shortest step, so that a path that cannot come closer slides along the contact
    contacts = closed_contacts(model, x, local.gaps, NEAR)
    choices = contacts.combinations() or [contacts.base]
    best: tuple[float, np.ndarray, float] | None = None
    near = _nearly_closed(model, x, local.gaps, length)
    tries = [tuple(dict.fromkeys((*rows, *near))) for rows in choices] if near else []
    for rows in (*tries, *choices):
        if best is not None and rows in choices:
            break  # only where looking ahead to contacts that will close led nowhere
        d = _pull(model, x, rows)
        size = float(np.linalg.norm(d))
        if size < 1e-14:
            continue
        slope = float(local.gradient @ d)
        held = _kept(model, x, rows, d)
        step = min(1.0, length / size)
        while step * size >= SHORTEST:
            y, residual = project(model, x + step * d, held)
            y = np.clip(y, -model.bound, model.bound)
            change = model.energy_change(x, y) / model.scale
            if (
                residual <= CLOSED_TO
                and np.abs(model.closure(y)[0]).max() <= CLOSED_TO
                and change < 1e-4 * step * slope
                and is_admissible(model, y)
            ):
                if best is None or change < best[0]:
                    best = (change, y, step * size)
                break
            step /= 2
    return None if best is None else best[1:]


def _pull(model: Model, x: np.ndarray, rows: tuple[Row, ...]) -> np.ndarray:
    """Minimise grad U . d + d'Kd/2 over the linearised feasible set: gap + gradient . d >= 0 for each row."""
    local = model.local(x)
    n = model.size
    root = np.sqrt(model.parameters[-2 * n : -n])
    z = null_space(local.closure_jacobian / root)
    gaps, a = row_values(model, x, rows, local.gaps, local.gaps_jacobian)
    a = a / root @ z
    cost = z.T @ (local.gradient / root)
    if not len(a):
        return -(z @ cost) / root
    y = nearest(-cost, a, -np.maximum(gaps, 0.0))
    return np.zeros(n) if y is None else (z @ y) / root


def _nearly_closed(model: Model, x: np.ndarray, gaps: np.ndarray, length: float) -> tuple[Row, ...]:
    """Return contacts that are open but could close within a step of `length`."""
    rows = []
    if model.structure.limits:
        for v in range(model.size):
            slack = math.pi - abs(x[v])
            if CLOSED < slack <= 2 * length:
                rows.append(Row("limit", v, 1 if x[v] > 0 else -1))
    same = same_gap(model.structure)
    for index, gap in enumerate(model.structure.gaps):
        if same[index] == index and CLOSED < abs(gaps[index]) <= 2 * length:
            if gap.type != "facet-pair" or gap.pair is None:
                rows.append(Row("gap", index, 1))
    return tuple(rows)


def _kept(model: Model, x: np.ndarray, rows: tuple[Row, ...], d: np.ndarray) -> tuple[Row, ...]:
    """Return the rows that a direction keeps closed."""
    local = model.local(x)
    _, a = row_values(model, x, rows, local.gaps, local.gaps_jacobian)
    return tuple(
        row for row, g in zip(rows, a, strict=True) if abs(g @ d) <= 1e-9 * np.linalg.norm(d)
    )


def _polish_nearby(model: Model, x: np.ndarray) -> np.ndarray | None:
    """Polish x if that stays close to it."""
    rows = closed_contacts(model, x, model.local(x).gaps, 1e-6)
    pull = np.zeros(model.size)
    for row in rows.base:
        if row.kind == "limit":
            pull[row.index] = 1.0
    force = {g.pair: 1.0 for g in model.structure.gaps if g.pair is not None}
    answer = Solve(x, "followed", 0, 0.0, pull, force)
    # the contacts that are closed first: a guess from near gaps may close one that the path never met
    for guess in (*(rows.combinations() or [rows.base])[:MOST_GUESSES], None):
        done = polish(model, answer, guess)
        if not done.converged:
            done = exact_beside(model, done)
        close = np.abs(done.x - x).max() <= 1e-3
        # the path may stand a contact tolerance inside a closed contact, so a little below the exact state
        lower = model.energy_change(x, done.x) <= 1e-7 * max(model.energy(x), model.scale)
        if done.converged and close and lower:
            return done.x
    return None
