"""Follow a state downhill, inside the admissible set, to the stable state that it belongs to.

Steps go along the projection of the springs' pull on the linearised feasible cone, measured in the stiffness metric,
and are pulled back onto loop closure; a backtracking line search shortens them until the state closes, is admissible
and lower than the one before. Unlike a restart of the solver, the path cannot jump to another basin: it is the
evidence for what becomes of a minimum that a grid reports.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from origami_nlp.kkt.choices import Choices
from origami_nlp.kkt.classification import Classification, classify
from origami_nlp.kkt.neighbourhood import sample_neighbourhood
from origami_nlp.kkt.polishing import Polished, Solve, exact_beside, newton, polish
from origami_nlp.kkt.projection import project
from origami_nlp.kkt.state import State, Stratum
from origami_nlp.numerics import (
    CARRIES,
    CLOSURE_TOL,
    DECREASE,
    EPS,
    INDEPENDENT,
    LEVEL,
    NEAR_CONTACT,
    NEAR_SINGULAR_TOL,
    ROUNDED,
    SLIDES,
    nearest,
    nonnegative_least_squares,
    null_space,
)
from origami_nlp.problem import Contact, Problem

LONGEST = 0.1
"""Longest step [rad]."""
RESCUE = (3e-2, 1e-2, 1e-3)
"""Radii [rad] of the search for a lower neighbour: where contacts crowd, the first long step is the easiest."""
MOST_GUESSES = 8
"""Sets of closed contacts that are tried when the end of a path is polished."""
MOST_PASSED = 10
"""Rounds in which contacts that a trial state passes are held."""
STALLS = 0.3
"""Share of the residual that a step of its projection leaves where contacts cannot be met together."""
SOFTEST = 1e-6
"""Of curvatures in steps, over the mean stiffness."""
TRIED = (1e-3, 3e-3, 1e-4)
"""Steps [rad] that are tried along the softest mode."""
MOST_WAYS = 300
"""Sets of contacts that a step is computed for where more pieces meet than can be listed."""
SHORTEST = 1e-6
"""A path that cannot take a step this long [rad] has arrived, or is stuck."""


_Found: TypeAlias = tuple[float, np.ndarray, float]
"""Change of energy, a lower state, and the length of the step to it."""
LONG = 5
"""Steps along a way, each half as long as the one before, that are tried before those of the next way."""
AT_ONCE = 8
"""Ways whose short steps are tried together."""
SHORTER = 0.25
"""Of further ones, tried where no long step of any way leads down."""
STOPPED = Classification("undecided", None, "the descent was stopped on its way", 0)
KNOWN = Classification("minimum", None, "judged before", 0)
DescentDirection: TypeAlias = tuple[tuple[Contact, ...], np.ndarray, tuple[Contact, ...]]
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
    model: Problem,
    start: np.ndarray,
    *,
    curved: bool = False,
    longest: float = LONGEST,
    most_steps: int = 2000,
    most_rescues: int = 12,
    most_ways: int | None = None,
    until: Callable[[np.ndarray], bool] | None = None,
    leads: Callable[[np.ndarray, np.ndarray], bool] | None = None,
    known: Callable[[np.ndarray], bool] | None = None,
) -> Followed:
    """Follow the state `start` [n] downhill, `until` a state on the way is far enough: that one is not judged.

    Steps are downhill in the metric of the springs or, `curved`, Newton's: fewer, and from farther.  Their length is at
    most `longest` [rad], of Newton's their largest entry; those that `leads`, of a state and the next, refuses are made
    shorter.  An end of which `known` says that it is a minimum is not judged again: it is `KNOWN`.

    Where no step along the linearised cone is possible but the state is no minimum (several contacts meet), a lower
    admissible neighbour is searched on small spheres, at most `most_rescues` times.  Of the ways that
    a step may go on pieces that meet at a state `most_ways` are tried; None: all.

    Raises
    ------
    ValueError
        If the start does not close, or is not admissible.
    """
    x, residual = project(model, np.asarray(start, dtype=float), ())
    x = model.fold_limits.clip(x)
    refused = f"closure {residual:.1e}" if residual > CLOSURE_TOL else model.refuses(x)
    if refused:
        raise ValueError(f"the start is not a closed, admissible state: {refused}")
    states = [x]
    length = longest
    rescues = 0
    while len(states) < most_steps:
        if until is not None and until(x):
            path = np.array(states)
            return Followed(path, model.energies(path), x, STOPPED)
        # wider than the shortest step, so that a path that cannot come closer slides along the contact
        moved = _step(State(model, x, SLIDES), length, curved, leads, most_ways)
        if moved is not None:
            x, taken = moved
            states.append(x)
            length = min(longest, 2 * taken)
            continue
        end = _level_with(model, x)
        what = _judged(model, x, end, known)
        if what.verdict == "minimum" or rescues == most_rescues:
            break
        rescues += 1
        lower = what.lower
        if lower is None:
            lower = _lower_neighbour(State(model, x), what.descent)
        elif curved:
            lower = _farther(State(model, x), lower, longest, leads)
        if lower is None:
            break
        x, length = lower, longest
        states.append(x)
    else:
        end = _level_with(model, x)
        what = _judged(model, x, end, known)
    path = _strictly_decreasing(model, states, x if end is None else end)
    energies = model.energy(path[0]) + np.array([model.energy_change(path[0], y) for y in path])
    return Followed(path, energies, path[-1], what)


def _judged(
    model: Problem,
    x: np.ndarray,
    end: np.ndarray | None,
    known: Callable[[np.ndarray], bool] | None,
) -> Classification:
    """Judge the end of a path, polished or (None) not."""
    if end is not None and known is not None and known(end):
        return KNOWN
    return classify(State(model, x if end is None else end), polished=end is not None)


def _strictly_decreasing(model: Problem, states: list[np.ndarray], end: np.ndarray) -> np.ndarray:
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
    model, x = at.problem, at.x
    noise = LEVEL * max(abs(at.energy), model.scale)
    for step, sign in itertools.product(TRIED, (1.0, -1.0)):
        y = None if direction is None else _closed(model, x + sign * step * direction)
        if y is not None and model.energy_change(x, y) < -noise and not model.refuses(y):
            return y
    found = sample_neighbourhood(at, at.contacts.base, radii=RESCUE)
    return found.state if found.state is not None and found.lowest < -noise else None


def _farther(
    at: State,
    lower: np.ndarray,
    longest: float,
    leads: Callable[[np.ndarray, np.ndarray], bool] | None,
) -> np.ndarray:
    """Return the stationary state ahead of a lower one [n] on the contacts that both hold, if it is lower still.

    Where more pieces meet than can be looked at one by one, no step finds the way: the lower state does.
    """
    model = at.problem
    both = at.at(lower).contacts.base
    done, _ = newton(model, lower, tuple(c for c in at.contacts.base if c in both))
    if done is None or not done.converged or np.linalg.norm(done.x - lower) > longest:
        return lower
    good = model.energy_change(lower, done.x) < 0 and (leads is None or leads(lower, done.x))
    return done.x if good and not model.refuses(done.x) else lower


def _closed(
    model: Problem,
    want: np.ndarray,
    held: tuple[Contact, ...] = (),
    rows: tuple[Contact, ...] = (),
) -> np.ndarray | None:
    """Pull a state [n] onto closure with contacts held, within the fold limits; None where that does not close.

    Those of `rows` that it passes are held as well, and fold limits that the way back to closure passes: a straight
    step passes what bends towards it.
    """
    for _ in range(MOST_PASSED):
        y, residual = project(model, want, held, stalls=STALLS if rows else math.inf)
        inside = model.fold_limits.clip(y)
        if residual > CLOSURE_TOL:
            return None
        if np.abs(model.local(inside).closure).max(initial=0.0) > CLOSURE_TOL:
            over = tuple(c for c in model.beyond(y) if c not in held)
            if not (rows and over):
                return None
            held = (*held, *over)
            continue
        y = inside
        try:
            values, _ = model.local(y).openings(rows)
        except ArithmeticError:  # sides that come to run along each other have no gap
            return None
        passed = [c for c, v in zip(rows, values, strict=True) if v < -ROUNDED and c not in held]
        if not passed:
            return y
        held = (*held, *passed)
    return None


def _step(
    state: State,
    length: float,
    curved: bool,
    leads: Callable[[np.ndarray, np.ndarray], bool] | None,
    most_ways: int | None = None,
) -> tuple[np.ndarray, float] | None:
    """Take one admissible step down, of at most `length`, by a backtracking line search; None where no step is
    lower."""
    near = state.problem.about_to_close(state.x, length)
    listed = state.pieces if state.few else []
    for ahead in (near, ()) if near else ((),):
        best: _Found | None = None
        waiting = list[Iterator[_Found | None]]()
        for rows, d, held in itertools.islice(_ways_down(state, ahead, curved), most_ways):
            if best is not None and (rows in listed or not state.few):
                break  # of the pieces themselves the first that leads down
            if _length(d, curved) < ROUNDED:
                continue
            way = _shorter_and_shorter(state, (rows, d, held), length, curved, leads)
            best = _lowest_of((best, *itertools.islice(way, LONG)))
            waiting.append(way)
            if len(waiting) == AT_ONCE:
                best, waiting = best or _shorter(waiting), []
        if (best := best or _shorter(waiting)) is not None:
            return best[1:]  # not looking ahead only where that led nowhere
    return None


def _shorter(ways: Sequence[Iterator[_Found | None]]) -> _Found | None:
    """Go on with shorter steps along all ways, where no long one leads down."""
    return next(filter(None, map(_lowest_of, itertools.zip_longest(*ways))), None)


def _lowest_of(found: Iterable[_Found | None]) -> _Found | None:
    """Return the one with the lowest energy; None where there is none."""
    return min((one for one in found if one is not None), key=lambda one: one[0], default=None)


def _shorter_and_shorter(
    state: State,
    way: DescentDirection,
    length: float,
    curved: bool,
    leads: Callable[[np.ndarray, np.ndarray], bool] | None,
) -> Iterator[_Found | None]:
    """Try steps along a way, each shorter than the one before, until one leads down: the last that is yielded."""
    rows, d, held = way
    size, slope = _length(d, curved), float(state.local.gradient @ d)
    step, many = min(1.0, length / size), 0
    # sufficient decrease (Nocedal & Wright, 3.4), along states that are pulled back onto closure
    while step * size >= SHORTEST:
        enough = DECREASE * step * slope
        found = _lower(state, step * d, enough, held, leads)
        if found is None and curved:
            found = _lower(state, step * d, enough, held, leads, rows)
        if found is not None:
            yield (*found, step * size)
            return
        yield None
        many += 1
        step *= 0.5 if many < LONG else SHORTER


def _length(d: np.ndarray, curved: bool) -> float:
    """Return the length of a step [n]: of Newton's its largest entry."""
    return float(np.abs(d).max(initial=0.0) if curved else np.linalg.norm(d))


def _ways_down(
    state: State, ahead: tuple[Contact, ...], curved: bool
) -> Iterator[DescentDirection]:
    """Go through steps down: contacts that they keep open, `ahead` among them, the step [n], and what it keeps closed.

    Of each piece that meets here one; where these are too many to be listed the contacts of all pieces come first, and
    those of a choice are added where the step passes it (branch and bound, steepest first).
    """

    def way(rows: tuple[Contact, ...]) -> DescentDirection:
        rows = tuple(dict.fromkeys((*rows, *ahead)))
        return rows, *_pull(state.on(rows), curved)

    if state.few:
        yield from map(way, state.pieces)
        return
    choices = Choices(state)
    pending, asked, seen = [way(state.contacts.base)], 1, set[int]()
    while pending and asked < MOST_WAYS:
        rows, d, held = pending.pop()
        still, before = _length(d, curved) < ROUNDED, choices.said(rows)
        passed = [] if still else choices.passed(choices.open(before), d)
        if not passed:
            yield rows, d, held
            continue
        options = []
        for option in choices.branches[passed[0]]:
            said = before | choices.said(option)
            if said not in seen:
                seen.add(said)
                options.append(way((*rows, *option)))
        asked += len(options)
        gradient = state.local.gradient
        # the steepest of a step's length is taken first
        options.sort(key=lambda w: -gradient @ w[1] / max(1.0, _length(w[1], curved)))
        pending += options


def _lower(
    state: State,
    move: np.ndarray,
    enough: float,
    held: tuple[Contact, ...],
    leads: Callable[[np.ndarray, np.ndarray], bool] | None,
    rows: tuple[Contact, ...] = (),
) -> tuple[float, np.ndarray] | None:
    """Return the change of energy to the admissible state that a move [n] leads to, and that state; None if not lower.

    The change is to be below `enough`.
    """
    model, x = state.problem, state.x
    y = _closed(model, x + move, held, rows)
    if y is None:
        return None
    change = model.energy_change(x, y) / model.scale
    # sufficient decrease (Nocedal & Wright, 3.4), measured after the way back to closure
    lower = change < enough and (leads is None or leads(x, y))
    return (change, y) if lower and not model.refuses(y) else None


def _pull(piece: Stratum, curved: bool) -> tuple[np.ndarray, tuple[Contact, ...]]:
    """Return the step and the closed contacts that it keeps closed.

    It is to minimise grad U . d + d'Hd/2 over the linearised feasible set: gap + gradient . d >= 0 for each contact.

    H is the stiffness of the springs or, `curved`, the Hessian of the Lagrangian with multipliers of the contacts that
    are closed, its negative curvatures turned round.  They are so along what contacts that push leave free, and across
    it apart: what a gap adds to the curvature across would otherwise stiffen directions along which the energy hardly
    curves.  Of contacts that are dependent, and may not be kept closed together beyond first order, those that push are
    kept then.
    """
    state = piece.state
    p, z, gaps, slopes = state.problem, state.kernel, piece.openings, piece.slopes
    cost, rows = z.T @ state.gradient, slopes @ z
    # sequential quadratic programming, with K in place of the Hessian where that is not asked for
    free, h = np.eye(len(cost)), np.diag(p.parameters.stiffness / p.root**2)
    closed = gaps <= state.tolerance
    keeps = closed.copy()
    if curved:
        forces = np.zeros(len(gaps))
        forces[closed] = nonnegative_least_squares(rows[closed].T, cost)
        rest = state.gradient - slopes.T @ forces
        multipliers = state.balancing(rest)
        h = piece.hessian_with(np.append(multipliers, forces))
        keeps &= forces > CARRIES
        free = null_space(rows[keeps])
    scaled = []  # d = scaled y, with y'y/2 the quadratic form: what is left is a projection
    for basis in (z @ free, z @ null_space(free.T)) if curved else (z,):
        values, vectors = np.linalg.eigh(basis.T @ h @ basis)
        scaled.append(basis @ vectors / np.sqrt(np.maximum(np.abs(values), SOFTEST)))
    whole = np.hstack(scaled)
    y = nearest(-whole.T @ state.gradient, slopes @ whole, -np.maximum(gaps, 0.0))
    d = np.zeros(len(state.x)) if y is None else whole @ y
    keeps &= np.abs(slopes @ d) <= INDEPENDENT * np.linalg.norm(d)
    return d / p.root, tuple(c for c, on in zip(piece.contacts, keeps, strict=True) if on)


def _pushing(piece: Stratum) -> tuple[Contact, ...]:
    """Return the contacts with a positive multiplier."""
    forces = piece.multiplier_set.found
    return tuple(c for c, f in zip(piece.contacts, forces, strict=True) if f > CARRIES)


def _level_with(model: Problem, x: np.ndarray) -> np.ndarray | None:
    """Polish the end of a path: it may stand a contact tolerance inside a closed contact, so a little lower."""
    most = RISE * max(model.energy(x), model.scale)
    ends = (p.x for p in polished_nearby(model, x) if model.energy_change(x, p.x) <= most)
    return next(ends, None)


def polished_nearby(
    model: Problem, x: np.ndarray, tolerance: float = NEAR_CONTACT
) -> Iterator[Polished]:
    """Return stationary states that Newton reaches within `NEAR_SINGULAR_TOL` of x [n], contacts that are closed there
    held first.

    Parameters
    ----------
    model
        The problem.
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
    answer = Solve(x, "followed", 0, 0.0, pull)
    # the contacts that are closed first: a guess from near gaps may close one that the path never met
    if state.few:
        guesses = state.pieces[:MOST_GUESSES]
    else:  # those that push
        ways = itertools.islice(_ways_down(state, (), True), MOST_GUESSES)
        guesses = [_pushing(state.on(rows)) for rows, _, _ in ways]
    for guess in (*guesses, None):
        done = polish(model, answer, guess)
        if not done.converged:
            done = exact_beside(model, done)
        if done.converged and np.abs(done.x - x).max() <= NEAR_SINGULAR_TOL:
            yield done
