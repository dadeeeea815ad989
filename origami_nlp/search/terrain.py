"""Stable states with descents between them, of a vertex or of a sheet: what `kkt.escape_paths` walks on.

Rays lead out of a state; descents from their states, many at a time, say where they begin to end elsewhere.  A way is
what is gone down step by step: each state closed and admissible.  Vertices pass their flat state exactly there.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from origami_nlp.kkt import (
    FARTHEST,
    GOES,
    LONGEST,
    State,
    Terrain,
    energy_scale,
    follow,
    newton,
    over_flat,
    project,
)
from origami_nlp.numerics import (
    CLOSURE_TOL,
    LEVEL,
    NEAR_SINGULAR_TOL,
    NONZERO,
    OUTSIDE,
    RESOLVED,
    coarse,
)
from origami_nlp.pattern_problem import PatternProblem, PopSigns
from origami_nlp.problem import Contact
from origami_nlp.search.descend import CLOSES_NOT, STAYS, CompiledDescent, Slot, StartState
from origami_nlp.search.follow import Follower
from origami_nlp.search.newton import descend_by_newton
from origami_nlp.search.starts import at_limits

FIRST, LARGEST = 1e-3, 0.25
"""First and longest step along a ray [rad]; each is twice the one before."""
PASS_NEAR = 0.5
"""Newton finds a pass within this distance [rad] of where descents part."""
POPPED = 0.02
"""Share of a state by which creases round a vertex are folded beside its flat state."""
SHRUNK = 1.0, 0.75, 0.5, 0.25, 0.0
"""Of a state, its folds times these, whose vertex is made flat: the first at which facets do not cross."""
NEARLY = 1.0, 0.97, 0.9
"""Of a state with a vertex flat, its other folds times these, beside which the vertex pops."""
HALVINGS = 12
"""Of a step into contact."""
DENSE = 0.1
"""Steps of a way down are cut to this length [rad], and each state on it looked at."""
FINER = 7
"""How often steps beside the highest states of other ways are halved: these climb by a millionth more at most."""
MOST_TURNED = 12
"""Variables up to which rays turn each of them by itself."""


class DescentTerrain(Terrain):
    """Stable states of a problem with descents between them.

    Parameters
    ----------
    problem
        Of a vertex or a sheet.
    minima
        The states, by number, [M, n].
    aside
        A direction [n] that labels do not change: to which side saddles are left; None: drawn in the problem's order.
    leaving
        Directions out of states, by number.
    around
        Variables round vertices that pop, by number.
    most
        Counted work of descents (evaluations of closure) after which none is made.
    """

    problem: PatternProblem

    def __init__(
        self,
        problem: PatternProblem,
        minima: np.ndarray,
        aside: np.ndarray | None = None,
        leaving: Mapping[int, Sequence[np.ndarray]] | None = None,
        around: Mapping[int, Sequence[list[int]]] | None = None,
        most: float = math.inf,
    ) -> None:
        super().__init__(problem, minima, energy_scale(problem.pattern.stiffness))
        self._go, self._most = Follower(problem), most
        drawn = np.random.default_rng(0).normal(size=problem.size)
        self._aside = drawn if aside is None else aside
        self._closing = CompiledDescent(problem, problem.root)  # whatever the springs
        self._leaving, self._around = leaving or {}, around or {}
        self._pops = PopSigns(problem.pattern)
        self._landed, self._down, self._short = (dict[bytes, np.ndarray]() for _ in range(3))
        self._shut = dict[bytes, tuple[Contact, ...]]()
        self._orders = dict[bytes, bool]()

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
        return bool(p.contact and self._pops.around) and self._pops.is_jump(
            p.expand(a), p.expand(b)
        )

    def sides(self, states: np.ndarray) -> np.ndarray:
        """On which side of its flat state each vertex is, in states [S, n]: 1, -1, or 0 where it is flat, [S, v]."""
        phi = self.problem.expand(states)
        flat = np.array(list(map(self._pops.flat, phi)))
        return np.asarray(self.problem.contact * np.sign(self._pops.sums(phi)) * ~flat)

    def _contacts(self, x: np.ndarray) -> tuple[Contact, ...]:
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

    def _closed_one(self, start: np.ndarray, kept: np.ndarray | None = None) -> np.ndarray | None:
        """Close a start [n], what is kept as it is; None where that is no admissible state."""
        still = None if kept is None else kept[None]
        # first with what is at its limit there
        for opened in (False, True) if kept is None else (False,):
            (x,), (good,) = self._closed(start[None], still, free=np.array([opened]))
            if good:
                return np.asarray(x)
        return None

    def between(self, a: np.ndarray, b: np.ndarray, shares: np.ndarray) -> np.ndarray | None:
        """States between two; what both hold stays so."""
        many = len(shares)
        x = self._between(np.tile(a, (many, 1)), np.tile(b, (many, 1)), shares[:, None])
        # one order all along the step
        return None if x is None or self._loses_order(a, b, x[many // 2]) else x

    def middles(self, a: np.ndarray, b: np.ndarray) -> np.ndarray | None:
        """States half way from each of a to each of b, [S, n], as `between`; None where one is lacking."""
        x = self._between(a, b, np.full((len(a), 1), 0.5))
        if x is None or any(map(self._loses_order, a, b, x)):
            return None
        return x

    def _between(self, a: np.ndarray, b: np.ndarray, shares: np.ndarray) -> np.ndarray | None:
        want, still = a + shares * (b - a), (a == b) & ((a == 0) | self._at_limit(a))
        x, good = self._closed(want, still)
        if not good.all():  # with gaps held that both states hold
            rows = [
                tuple(c for c in self._contacts(y) if c in self._contacts(z))
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
            if self._jumps(one, y) or self._jumps(y, other):
                return None
        return x

    def _at_limit(self, x: np.ndarray) -> np.ndarray:
        """Return what of states [..., n] is at a fold limit."""
        return np.asarray(self.problem.fold_limits.room(x) <= OUTSIDE)

    def _loses_order(self, a: np.ndarray, b: np.ndarray, y: np.ndarray) -> bool:
        """Whether facets that lie on each other all along a step have no order at a state of it."""
        p = self.problem
        if not (p.contact and ((a == b) & self._at_limit(a)).any()):
            return False
        kind = None if p.crossed(y) else self._go.level.kind(y)
        if kind is None:
            return bool(p.refuses(y))
        if kind not in self._orders:
            self._orders[kind] = bool(p.refuses(y))
        return self._orders[kind]

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

    def path_down(self, state: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
        """Go down step by step, see `kkt.follow`; paths to their ends are kept, as other states ask for them again."""
        key = state.tobytes()
        if (known := self._down.get(key)) is not None:
            return _up_to(known, until)
        try:
            down = follow(
                self.problem,
                state,
                curved=True,
                most_rescues=2,
                until=until,
                leads=lambda x, y: not self._jumps(x, y),
            ).states
        except (ValueError, ArithmeticError):
            down = state[None]
        out = self.cut(list(down))
        out = state[None] if out is None or self.over(state, out).max() > self.floor else out
        if not until(out[-1]):
            self._down[key] = out
        return out

    def quick_path_down(self, state: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
        """Go down by Newton's steps as descents in batches do, made short; as far as they are admissible and lower."""
        key = state.tobytes()
        if key not in self._short:
            self._short[key] = self._short_steps(state)
        return _up_to(self._short[key], until)

    def _short_steps(self, state: np.ndarray) -> np.ndarray:
        p = self.problem
        if not self.usable:
            return state[None]
        x = np.array([state, *self._go.steps(state, self._aside, LONGEST)])
        x = x[np.append(True, np.abs(np.diff(x, axis=0)).max(axis=1) > 0)]
        over, level = self.over(state, x), LEVEL * max(abs(p.energy(state)), p.scale)
        # beside a saddle steps are level: a rise by rounding is none
        good = over - np.minimum.accumulate(over) <= level
        good[1:] &= np.array([not self._jumps(a, b) for a, b in itertools.pairwise(x)], dtype=bool)
        return x[: len(x) if good.all() else max(int(np.argmin(good)), 1)]

    def proved_paths(self, which: Sequence[int]) -> dict[int, tuple[float, np.ndarray, int]]:
        """Paths over the flat state, where all states of no more energy are on its other side.

        Where facets of a flat vertex of all creases must not cross no admissible path leads round it
        (docs/validation/landscapes.md).
        """
        p, flat = self.problem, np.zeros(self.problem.size)
        every = self._pops.around and len(set(self._pops.around[0])) == p.pattern.creases
        if not (every and p.contact and p.pattern.lies_flat) or p.refuses(flat):
            return {}
        energies = p.energies(self.minima)
        side = np.sign(self._pops.sums(np.array([p.expand(x) for x in self.minima]))[:, 0])
        aims = dict[int, int]()
        for k in which:
            others = np.arange(len(side)) != k
            lower = others & (energies <= energies[k] + self.noise[k])
            aim = np.flatnonzero(lower if lower.any() else others)
            if len(aim) and (side[k] * side[aim] < 0).all():
                aims[k] = int(aim[0])
        ends = sorted({*aims, *aims.values()})
        walked = dict(
            zip(
                ends,
                self._walk(self.minima[ends], None, np.tile(flat, (len(ends), 1))),
                strict=True,
            )
        )
        return {
            k: (-float(self.over(flat, self.minima[k])), np.r_[walked[k], walked[to][-2::-1]], to)
            for k, to in aims.items()
            if not (walked[k][-1].any() or walked[to][-1].any())
        }

    def rays(self, which: Sequence[int]) -> list[tuple[int, np.ndarray]]:
        """Go along directions, turn variables, pop vertices, go to the flat state and on, and to other states."""
        flat, n = np.zeros(self.problem.size), self.problem.size
        unit = np.eye(n) if n <= MOST_TURNED else np.zeros((0, n))
        of, along, goals = list[int](), list[np.ndarray](), list[np.ndarray]()
        slots, free = list[tuple[Contact, ...]](), list[bool]()
        for k in which:
            ways = [*self._leaving.get(k, ()), *unit, *-unit]
            aims = [flat, *self.others(k)]
            # contacts of the state are held, and opened, in turn
            rows = self._contacts(self.minima[k])
            for held in (
                (True, False) if rows or at_limits(self.problem, self.minima[k]).any() else (True,)
            ):
                of += [k] * (len(ways) + len(aims))
                along += [*ways, *[flat] * len(aims)]
                goals += [*[np.full(n, math.nan)] * len(ways), *aims]
                slots += [rows if held else ()] * (len(ways) + len(aims))
                free += [not held] * (len(ways) + len(aims))
        if not of:
            return []
        out = list(
            zip(
                of,
                self._walk(
                    self.minima[of], np.array(along), np.array(goals), slots, np.array(free)
                ),
                strict=True,
            )
        )
        for k in which:
            out += [(k, self._popped(self.minima[k], np.array(v))) for v in self._around.get(k, ())]
        return out + over_flat(out) + self._over_flat_vertices(which)

    def _walk(
        self,
        x: np.ndarray,
        along: np.ndarray | None,
        goal: np.ndarray,
        slots: Sequence[tuple[Contact, ...]] = (),
        free: np.ndarray | None = None,
    ) -> list[np.ndarray]:
        """Walk from states [R, n] along directions, or to goals (nan: none), as far as states are admissible."""
        p, at = self.problem, x.copy()
        aimed = np.isfinite(goal).all(axis=1)
        along = np.zeros(x.shape) if along is None else np.where(aimed[:, None], 0.0, along)
        driven = (along != 0).sum(axis=1) == 1  # one variable turns, the others follow
        walked, live, step, gone = [[y] for y in x], np.arange(len(x)), FIRST, 0.0
        while len(live) and gone < FARTHEST:
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
            step = min(2 * step, LARGEST)
        return [np.array(path) for path in walked]

    def walk_to(self, x: np.ndarray, goal: np.ndarray) -> tuple[np.ndarray, bool]:
        """Walk straight from state x [n] to another, over any height: states looked at [S, n]; whether it arrives."""
        (path,) = self._walk(x[None], None, goal[None])
        arrives = bool(np.abs(path[-1] - goal).max() <= NEAR_SINGULAR_TOL)
        if arrives:
            path[-1] = goal
        whole = self.cut(list(path))
        return (x[None], False) if whole is None else (whole, arrives)

    def through_flat(self, path: np.ndarray) -> np.ndarray | None:
        """Add to a path [S, n] the states in which vertices are exactly flat that it takes to their other side.

        Short steps may, see `PopSigns.is_jump`; None where there is no such admissible state beside them.
        """
        sums, out = self.sides(path), [path[0]]
        for k, x in enumerate(path[1:]):
            if (passed := sums[k] * sums[k + 1] < 0).any():
                around = [self._pops.around[v] for v in np.flatnonzero(passed)]
                creases = np.isin(np.arange(self.problem.pattern.creases), np.concatenate(around))
                kept = self.problem.reduce(1.0 * creases) != 0
                middle = self._closed_one(np.where(kept, 0.0, 0.5 * (path[k] + x)), kept)
                if middle is None or np.abs(middle - x).max() > DENSE:
                    return None
                out.append(middle)
            out.append(x)
        return np.array(out)

    def with_tops(self, path: np.ndarray) -> np.ndarray | None:
        """Add states beside those of a path [S, n] that are higher than both neighbours, closer and closer.

        None where there is no admissible state beside them.
        """
        for _ in range(FINER):
            rises = self.over(path[0], path)
            tops = 1 + np.flatnonzero((rises[1:-1] >= rises[:-2]) & (rises[1:-1] >= rises[2:]))
            after = np.unique(np.concatenate([tops, tops + 1]))
            if len(after):
                middles = self.middles(path[after - 1], path[after])
                if middles is None:
                    return None
                path = np.insert(path, after, middles, axis=0)
        return path

    def cut(self, states: Sequence[np.ndarray]) -> np.ndarray | None:
        """Cut steps to `DENSE` and look at each state, [S, n]; None where a step leaves closed admissible states."""
        out = [states[0]]
        for x in states[1:]:
            while self.distance(out[-1], x) > DENSE:
                share = DENSE / self.distance(out[-1], x)
                inner = self.between(out[-1], x, np.array([0.9 * share]))
                if inner is None or self.distance(inner[0], x) >= self.distance(out[-1], x):
                    return None
                if self.distance(inner[0], out[-1]) > 2 * DENSE:
                    return None
                out.append(inner[0])
            out.append(x)
        return np.array(out)

    def passes(self, a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
        """Stationary states between two, with what both hold, or nothing, and those of least energy with a vertex flat.

        Motions of paper pass a vertex that pops where it is flat.
        """
        found, p, middle = list[np.ndarray](), self.problem, (a + b) / 2
        limits = p.fold_limits.contacts(middle, (a == b) & self._at_limit(a))
        both = tuple(c for c in self._contacts(a) if c in self._contacts(b))
        for rows in dict.fromkeys([(*limits, *both), ()]):
            start, _ = project(p, middle, rows)
            done, _ = newton(p, start, rows)
            if done is None or not done.converged or np.abs(done.x - start).max() > PASS_NEAR:
                continue
            if not p.refuses(done.x):
                found.append(done.x)
        if p.orbits is None and p.contact and self._pops.around:
            for v in np.flatnonzero(self._pops.sums(a) * self._pops.sums(b) < 0):
                kept = np.isin(np.arange(len(a)), self._pops.around[v])
                if (x := self._lowest_flat(middle, kept)) is not None:
                    found.append(x)
        return found

    def _over_flat_vertices(self, which: Sequence[int]) -> list[tuple[int, np.ndarray]]:
        """Go from states of least energy with one vertex flat down to both sides: backwards, these are escape paths."""
        out, seen = list[tuple[int, np.ndarray]](), list[np.ndarray]()
        for k, creases in ((j, creases) for j in which for creases in self._around.get(j, ())):
            x = self.minima[k]
            kept = np.isin(np.arange(len(x)), creases)
            flat = self._lowest_flat(x, kept) if x[creases].any() else None
            if flat is None or not flat.any():
                continue
            if any(np.abs(flat - y).max() <= NEAR_SINGULAR_TOL for y in seen):
                continue
            seen.append(flat)
            sides = []
            for y in (x, -x, *self.others(k)):
                starts = (self._closed_one(np.where(kept, POPPED * y, t * flat)) for t in NEARLY)
                beside = next((z for z in starts if z is not None), None)
                if beside is None:
                    continue
                down = self.quick_path_down(beside, lambda _: False)
                if np.abs(self.minima - down[-1]).max(axis=1).min() > NEAR_SINGULAR_TOL:
                    down = self.path_down(beside, lambda _: False)
                sides += [down] * (len(down) > 1)
            for down, other in itertools.permutations(sides, 2):
                apart = np.abs(self.minima - down[-1]).max(axis=1)
                j = int(apart.argmin())
                if apart[j] <= NEAR_SINGULAR_TOL and (kept @ down[0]) * (kept @ other[0]) < 0:
                    back = [self.minima[j], *down[-2::-1], flat, other[0]]
                    self._landed |= {y.tobytes(): self.minima[j] for y in down}
                    self._landed[other[0].tobytes()] = other[-1]
                    out.append((j, np.array(back)))
        return out

    def _lowest_flat(self, x: np.ndarray, kept: np.ndarray) -> np.ndarray | None:
        """Go down from a state with some creases made flat, which stay so, as far as facets do not cross."""
        starts = (self._closed_one(np.where(kept, 0.0, t * x), kept) for t in SHRUNK)
        good = next((y for y in starts if y is not None), None)
        if good is None:
            return None
        for y in descend_by_newton(self.problem, good, kept=kept).path[1:]:
            share = 1.0
            for _ in range(HALVINGS):
                new = self._closed_one(good + share * (y - good), kept)
                if new is not None:
                    good = new
                    break
                share /= 2
            if share < 1.0:
                break
        return good

    def _popped(self, x: np.ndarray, creases: np.ndarray) -> np.ndarray:
        """Go to where the creases round a vertex are flat, and on to their folds turned over."""
        flat = x.copy()
        flat[creases] = 0.0
        (path,) = self._walk(x[None], None, flat[None])
        if np.abs(path[-1][creases]).max() > 0:
            return path
        over = path[-1].copy()
        over[creases] = -x[creases]
        return np.concatenate([path, self._walk(path[-1:], None, over[None])[0][1:]])


def _up_to(path: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
    """Return a path [S, n] up to the first state of which `until` says so."""
    stops = (i for i, x in enumerate(path) if until(x))
    return path[: next(stops, len(path)) + 1]
