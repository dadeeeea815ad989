"""Stable states with descents between them, of a vertex or of a sheet: what `escape_paths` walks on.

Rays lead out of a state; descents from their states, many at a time, say where they begin to end elsewhere.  A way is
what is gone down step by step: each state closed and admissible.  Vertices pass their flat state exactly there.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from origami_nlp.kkt import GOES, State, classified
from origami_nlp.numerics import (
    CLOSURE_TOL,
    LEVEL,
    NEAR_SINGULAR_TOL,
    NONZERO,
    OUTSIDE,
    RESOLVED,
    SETTLED,
    SHALLOW,
    coarse,
)
from origami_nlp.pattern_problem import PatternProblem, PopSigns
from origami_nlp.problem import Contact
from origami_nlp.search import (
    CLOSES_NOT,
    STAYS,
    CompiledDescent,
    Follower,
    Slot,
    StartState,
    at_limits,
    lower_beside,
    side_of_saddles,
)

FIRST, LARGEST = 1e-3, 0.25
"""First and longest step along a ray [rad]; each is twice the one before."""
DENSE = 0.1
"""Longest step of a straight walk [rad]."""
LONGEST = 0.1
"""Step of a descent [rad]."""
FLOOR = SHALLOW / 100
"""Share of `energy_scale` below which no bound is stated: how much less a way climbs is not looked at."""


def energy_scale(stiffness: np.ndarray) -> float:
    """Return the energy that it takes to fold every crease by pi from rest: what barriers are measured by.

    Parameters
    ----------
    stiffness
        Of all creases, [N].

    Returns
    -------
    float
        sum k pi^2 / 2, in the units of the stiffness.
    """
    return float(np.sum(stiffness)) * math.pi**2 / 2


def number_of(x: np.ndarray, states: np.ndarray) -> int:
    """Return which of some states [M, n] this is, -1 for none of them."""
    apart = np.abs(states - x).max(axis=1)
    return int(apart.argmin()) if apart.min() <= NEAR_SINGULAR_TOL else -1


class Terrain:
    """Stable states of a problem with descents between them.

    Parameters
    ----------
    problem
        Of a vertex or a sheet.
    minima
        The states, by number, [M, n].
    aside
        Direction [n] that says to which side saddles are left; None: one that labels do not change.
    most
        Counted work of descents (evaluations of closure) after which none is made.

    Attributes
    ----------
    problem, minima
        As given.
    floor
        Energies over a state that are not distinguished from nothing.
    worth
        Heights above this are made lower where a pass shows how.
    noise
        Of the energy of each state, [M].
    pops
        On which side of flat vertices are.
    together
        Descents from states along the rays of one state that are made at once, from low ones before high ones.
    """

    together = 64

    def __init__(
        self,
        problem: PatternProblem,
        minima: np.ndarray,
        aside: np.ndarray | None = None,
        most: float = math.inf,
    ) -> None:
        scale = energy_scale(problem.pattern.stiffness)
        self.problem, self.minima = problem, minima
        self.floor, self.worth = FLOOR * scale, SHALLOW * scale
        self.noise = LEVEL * np.maximum(np.abs(problem.energies(minima)), problem.scale)
        self._go, self._most = Follower(problem), most
        self._aside = side_of_saddles(problem) if aside is None else aside
        self._closing = CompiledDescent(problem, problem.root)  # whatever the springs
        self.pops = PopSigns(problem.pattern)
        self._landed, self._down = dict[bytes, np.ndarray](), dict[bytes, np.ndarray]()
        self._shut = dict[bytes, tuple[Contact, ...]]()

    @property
    def usable(self) -> bool:
        """Whether descents are compiled."""
        return self._go.usable

    def is_admissible(self, x: np.ndarray) -> bool:
        """Whether a closed state is within the fold limits, and no facets cross where that is asked for."""
        p = self.problem
        within = p.residual(x) <= CLOSURE_TOL and bool(p.fold_limits.inside(x).all())
        within = within and p.closure.lifts_to_one(x)
        return within and not (p.contact and p.crossings.find(x))

    def _jumps(self, a: np.ndarray, b: np.ndarray) -> bool:
        """Whether a step takes a vertex past its flat state, through facets."""
        p = self.problem
        return bool(p.contact and self.pops.around) and self.pops.is_jump(p.expand(a), p.expand(b))

    def sides(self, states: np.ndarray) -> np.ndarray:
        """On which side of its flat state each vertex is, in states [S, n]: 1, -1, or 0 where it is flat, [S, v]."""
        phi = self.problem.expand(states)
        flat = np.array(list(map(self.pops.flat, phi)))
        return np.asarray(self.problem.contact * np.sign(self.pops.sums(phi)) * ~flat)

    def contacts(self, x: np.ndarray) -> tuple[Contact, ...]:
        """Return the gaps that are closed at a state, whichever way facets pass."""
        if (key := x.tobytes()) not in self._shut:
            base = State(self.problem, x).contacts.base if self.problem.contact else ()
            self._shut[key] = tuple(c for c in base if not c.is_limit)
        return self._shut[key]

    def _closed(
        self,
        x: np.ndarray,
        still: np.ndarray | None = None,
        slots: Sequence[Sequence[Contact]] = (),
        free: np.ndarray | None = None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Close states [K, n], with what is `still` as it is, and gaps closed; and which are admissible.

        What is at a limit stays there, but in states that are `free`, [K].
        """
        p = self.problem
        x = p.fold_limits.clip(x)
        side = p.fold_limits.near(x, OUTSIDE) * p.has_limits
        if free is not None:
            side = np.where(free[:, None], 0, side)
        if still is not None:
            side = np.where(still & (side == 0), STAYS, side)
        if not self.usable:
            each = [p.project(y, s != 0)[0] for y, s in zip(x, side, strict=True)]
            y = p.fold_limits.clip(np.array(each).reshape(x.shape))
            return y, np.array([self.is_admissible(one) for one in y], dtype=bool)
        corners, held = p.crossings.pattern.corners, slots or [()] * len(x)
        starts = [
            StartState(y, s, tuple(Slot.of(p.touch(c), corners) for c in rows), True, most=0)
            for y, s, rows in zip(x, side, held, strict=True)
        ]
        ends = self._closing(starts, np.zeros(x.shape)) if starts else []
        self._go.work += sum(end.work for end in ends)
        y = np.array([end.x for end in ends]).reshape(x.shape)
        return y, np.array([end.why != CLOSES_NOT for end in ends], dtype=bool)

    def between(self, a: np.ndarray, b: np.ndarray, shares: Any) -> np.ndarray | None:
        """States at shares [S] of the way from a to b, or from each of a [S, n] to each of b; None where one lacks.

        What both hold stays so.
        """
        a, b, shares = np.broadcast_arrays(a, b, np.reshape(shares, (-1, 1)))
        want, still = a + shares * (b - a), (a == b) & ((a == 0) | self._at_limit(a))
        x, good = self._closed(want, still)
        if not good.all():  # with gaps held that both states hold
            rows = [
                tuple(c for c in self.contacts(y) if c in self.contacts(z))
                for y, z in zip(a[~good], b[~good], strict=True)
            ]
            if not all(rows):
                return None
            x[~good], better = self._closed(want[~good], still[~good], rows)
            if not better.all():
                return None
            for y, held in zip(x[~good], rows, strict=True):  # what a step holds, its middle holds
                self._shut[y.tobytes()] = held
        if (np.abs(x - want).max(axis=1) > np.abs(b - a).max(axis=1) + CLOSURE_TOL).any():
            return None
        for y, one, other in zip(x, a, b, strict=True):
            if self._jumps(one, y) or self._jumps(y, other) or self._loses_order(one, other, y):
                return None
        return x

    def _at_limit(self, x: np.ndarray) -> np.ndarray:
        """Return what of states [..., n] is at a fold limit."""
        return np.asarray(self.problem.fold_limits.room(x) <= OUTSIDE)

    def _loses_order(self, a: np.ndarray, b: np.ndarray, y: np.ndarray) -> bool:
        """Whether facets that lie on each other all along a step have no order at a state of it."""
        held = self.problem.contact and ((a == b) & self._at_limit(a)).any()
        return bool(held and self.problem.refuses(y))

    def land(self, states: np.ndarray) -> np.ndarray:
        """Where descents end."""
        out = np.full(states.shape, math.nan)
        # at the flat state closure has no rank, steps no direction: rounding would choose one
        left = np.abs(states).max(axis=1) > RESOLVED
        for y in self.minima:
            stays = left & (np.abs(states - y).max(axis=1) <= RESOLVED)
            out[stays], left[stays] = y, False
        # rays share states: to the flat state, and from there
        keys = [x.tobytes() for x in states]
        new = {keys[i]: i for i in np.flatnonzero(left) if keys[i] not in self._landed}
        some = sorted(new.values())
        for at in range(0, len(some), self.together):
            self._land(states[some[at : at + self.together]])
        for i in np.flatnonzero(left):
            out[i] = self._landed.get(keys[i], out[i])
        return out

    def _land(self, states: np.ndarray) -> None:
        """Go down from some states."""
        if self._go.work > self._most or not self.usable:
            return
        self.problem.check_time()
        # where facets lie on each other they may pass: what is gone down step by step tells
        starts = [StartState(x, at_limits(self.problem, x)) for x in states]
        # by short steps: long ones jump over what lies between
        asides = np.tile(self._aside, (len(states), 1))
        ends = self._go.descents(starts, asides, False, LONGEST)
        self._go.work += sum(end.work for end in ends)
        for x, end in zip(states, ends, strict=True):
            near = np.abs(end.x - self.minima).max(axis=1).min() <= NEAR_SINGULAR_TOL
            self._landed[x.tobytes()] = end.x if end.arrived or near else np.full(len(x), math.nan)

    def listed(self, x: np.ndarray) -> int:
        """Number of the stable state at x [n], -1 for none."""
        return number_of(x, self.minima)

    def path_down(
        self, state: np.ndarray, until: Callable[[np.ndarray], Any] = lambda x: False
    ) -> np.ndarray:
        """Go down as descents in batches do, by short steps, as far as they are admissible and lower, [S, n].

        `until` says where to stop.  Paths to their ends are kept, as other states ask for them again.
        """
        path = self._down.get(state.tobytes(), state[None])
        if self.usable and state.tobytes() not in self._down:
            path = self._steps(state)
            # so many refuted states it goes on from
            for _ in range(2):
                end = path[-1]
                if self.listed(end) >= 0:
                    break
                # held by contacts that only a way aside leaves
                lower = lower_beside(self.problem, end, classified(self.problem, end))
                if lower is None or self._jumps(end, lower):
                    break
                path = np.concatenate([path, self._steps(lower)])
            self._down[state.tobytes()] = path
        stops = (i for i, x in enumerate(path) if until(x))
        return path[: next(stops, len(path)) + 1]

    def _steps(self, state: np.ndarray) -> np.ndarray:
        """Return the steps down from a state [S, n], it the first, up to where they rise or take a vertex past flat."""
        p = self.problem
        x = np.array([state, *self._go.steps(state, self._aside, LONGEST)])
        x = x[np.append(True, np.abs(np.diff(x, axis=0)).max(axis=1) > 0)]
        over, level = self.over(state, x), LEVEL * max(abs(p.energy(state)), p.scale)
        # beside a saddle steps are level: a rise by rounding is none
        good = over - np.minimum.accumulate(over) <= level
        good[1:] &= np.array([not self._jumps(a, b) for a, b in itertools.pairwise(x)], dtype=bool)
        return x[: len(x) if good.all() else max(int(np.argmin(good)), 1)]

    def walk(
        self,
        x: np.ndarray,
        along: np.ndarray | None,
        goal: np.ndarray,
        slots: Sequence[tuple[Contact, ...]] = (),
        free: np.ndarray | None = None,
        largest: float = LARGEST,
    ) -> list[np.ndarray]:
        """Walk from states [R, n] along directions, or to goals (nan: none), as far as states are admissible."""
        p, at = self.problem, x.copy()
        aimed = np.isfinite(goal).all(axis=1)
        along = np.zeros(x.shape) if along is None else np.where(aimed[:, None], 0.0, along)
        driven = (along != 0).sum(axis=1) == 1  # one variable turns, the others follow
        walked, live, step, gone = [[y] for y in x], np.arange(len(x)), FIRST, 0.0
        # fifteen creases turned by pi are as far [rad]
        while len(live) and gone < 12.0:
            p.check_time()
            to = aimed[live]
            way = np.where(to[:, None], goal[live] - at[live], along[live]) * p.root
            left = np.linalg.norm(way, axis=1)
            length = np.where(to, np.minimum(step, left), step)[:, None]
            move = length * way / np.maximum(left, NONZERO)[:, None] / p.root
            # straight ahead rounding would grow from step to step
            want = at[live] + np.where(to[:, None], move, [coarse(m) for m in move])
            arrives = to & (left <= step)
            # nothing beside it: at the flat state closure has no rank, and rounding would choose a side
            want[arrives] = goal[live][arrives]
            still = to[:, None] & (at[live] == goal[live]) & (goal[live] == 0)
            still |= driven[live, None] & (along[live] != 0)
            rows = [slots[r] for r in live.tolist()] if slots else ()
            y, good = self._closed(want, still, rows, None if free is None else free[live])
            moved = np.linalg.norm(p.root * (y - at[live]), axis=1)
            good &= (left > 0) & (moved > GOES[0] * length[:, 0]) & (moved < GOES[1] * step)
            each = [not self._jumps(a, b) for a, b in zip(at[live], y, strict=True)]
            good &= np.array(each, dtype=bool)
            live, y = live[good], y[good]
            ahead = ~(aimed | driven)[live]
            along[live[ahead]] = (y - at[live])[ahead]
            at[live] = y
            for r, one in zip(live, y, strict=True):
                walked[r].append(one)
            gone += step
            step = min(2 * step, largest)
        return [np.array(path) for path in walked]

    def walk_to(self, x: np.ndarray, goal: np.ndarray) -> tuple[np.ndarray, bool]:
        """Walk straight from state x [n] to another, over any height: states looked at [S, n]; whether it arrives."""
        (path,) = self.walk(x[None], None, goal[None], largest=DENSE)
        arrives = bool(np.abs(path[-1] - goal).max() <= NEAR_SINGULAR_TOL)
        if arrives:
            path[-1] = goal
        return path, arrives

    def through_flat(self, path: np.ndarray) -> np.ndarray | None:
        """Add to a path [S, n] the states in which vertices are exactly flat that it takes to their other side.

        Short steps may, see `PopSigns.is_jump`; None where there is no such admissible state beside them.
        """
        sums, out = self.sides(path), [path[0]]
        for k, x in enumerate(path[1:]):
            if (passed := sums[k] * sums[k + 1] < 0).any():
                around = [self.pops.around[v] for v in np.flatnonzero(passed)]
                creases = np.isin(np.arange(self.problem.pattern.creases), np.concatenate(around))
                kept = self.problem.reduce(1.0 * creases) != 0
                flat = np.where(kept, 0.0, 0.5 * (path[k] + x))
                (middle,), (good,) = self._closed(flat[None], kept[None])
                if not good or np.abs(middle - x).max() > DENSE:
                    return None
                out.append(middle)
            out.append(x)
        return np.array(out)

    def with_tops(self, path: np.ndarray) -> np.ndarray | None:
        """Add states beside those of a path [S, n] that are higher than both neighbours, closer and closer.

        None where there is no admissible state beside them.
        """
        # halved so often, a way climbs by a millionth more at most
        for _ in range(7):
            rises = self.over(path[0], path)
            tops = 1 + np.flatnonzero((rises[1:-1] >= rises[:-2]) & (rises[1:-1] >= rises[2:]))
            after = np.unique(np.concatenate([tops, tops + 1]))
            if len(after):
                middles = self.between(path[after - 1], path[after], 0.5)
                if middles is None:
                    return None
                path = np.insert(path, after, middles, axis=0)
        return path

    def over(self, at: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Energies of states [..., n] over those of others, without cancellation."""
        p = self.problem
        return np.asarray(p.scale * p.parameters.energy_change(at, states))

    def rise(self, k: int, states: np.ndarray) -> np.ndarray:
        """Energies of states [..., n] over that of state k."""
        return self.over(self.minima[k], states)

    def torque(self, x: np.ndarray) -> np.ndarray:
        """The energy's gradient at states [..., n], in the metric of all fold angles, same shape."""
        p = self.problem
        return np.asarray(p.scale * p.parameters.torque(x) / p.root)

    def distance(self, a: np.ndarray, b: np.ndarray) -> Any:
        """Distances of states [..., n] from others, in the same metric, [...]."""
        return np.linalg.norm(self.problem.root * (a - b), axis=-1)

    def is_lower(self, k: int, x: np.ndarray) -> Any:
        """Whether states [..., n] have less energy than state k, by more than rounding, [...]."""
        return self.rise(k, x) < -self.noise[k]

    def is_way(self, k: int, ends: np.ndarray) -> Any:
        """Whether ends [..., n] are another state, of no more energy; of any where no listed one has less, [...].

        nan is none.
        """
        at = self.minima[k]
        apart = np.abs(ends - at).max(axis=-1) > NEAR_SINGULAR_TOL
        others = np.arange(len(self.minima)) != k
        if not (self.rise(k, self.minima[others]) <= self.noise[k]).any():
            return apart
        # known to `NEAR_SINGULAR_TOL` only: that is no more energy as well as can be determined
        p = self.problem  # squares of torques in N m may overflow
        slopes = [np.linalg.norm(p.parameters.torque(x) / p.root, axis=-1) for x in (ends, at)]
        return apart & (self.rise(k, ends) <= p.scale * sum(slopes) * NEAR_SINGULAR_TOL)

    def others(self, k: int) -> np.ndarray:
        """The other states that are nearest to one, [S, n]."""
        apart = self.distance(self.minima, self.minima[k])
        apart[k] = math.inf
        # all at the distance of the last one: labels do not choose among them
        last = np.sort(apart)[min(3, len(apart)) - 1]
        near = (apart <= last * (1 + SETTLED)) & np.isfinite(apart)
        return np.asarray(self.minima[near])
