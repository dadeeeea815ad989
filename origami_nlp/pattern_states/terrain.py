"""Stable states of a sheet with descents between them, where facets do not cross if that is asked for."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from origami_nlp.kkt import FARTHEST, GOES, Terrain, energy_scale, over_flat
from origami_nlp.numerics import CLOSURE_TOL, NEAR_SINGULAR_TOL, OUTSIDE, coarse
from origami_nlp.pattern_problem import PatternProblem, PopSigns
from origami_nlp.pattern_states.contact_descents import contact_descent
from origami_nlp.pattern_states.descent import Descended, descend

STEP = 0.25
"""Longest step along a ray, of all creases [rad]."""
FIRST = 0.02
"""First step along a ray [rad]; each is twice the one before."""
LANDED = 6
"""States of a ray from which descents begin, at most."""
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


class PatternTerrain(Terrain):
    """Stable states of a sheet with descents between them: what `kkt.escape_paths` walks on."""

    def __init__(
        self,
        pattern_problem: PatternProblem,
        minima: np.ndarray,
        contact: bool,
        leaving: Mapping[int, list[np.ndarray]],
        around: Mapping[int, Sequence[list[int]]],
        most: int,
    ) -> None:
        super().__init__(pattern_problem, minima, energy_scale(pattern_problem.pattern.stiffness))
        self._around, self._left, self._half = around, most, most / 2
        self.pattern_problem, self.contact, self._leaving = pattern_problem, contact, leaving
        self._pops = PopSigns(pattern_problem.pattern)
        self._landed: dict[bytes, np.ndarray] = {}
        self._gone: dict[bytes, Descended | None] = {}

    def is_admissible(self, x: np.ndarray) -> bool:
        """Whether a closed state is within the fold limits, and no facets cross where that is asked for."""
        within = self.pattern_problem.residual(x) <= CLOSURE_TOL and bool(
            self.pattern_problem.fold_limits.inside(x).all()
        )
        within = within and self.pattern_problem.closure.lifts_to_one(x)
        return within and not (self.contact and self.pattern_problem.crossings.find(x))

    def step(
        self, a: np.ndarray, start: np.ndarray, held: np.ndarray | None = None, jumps: bool = False
    ) -> np.ndarray | None:
        """Close a start beside state a; None where that is no admissible state, or past a vertex's flat state."""
        limits = self.pattern_problem.fold_limits
        start = limits.clip(start)
        at_limit = limits.room(start) <= OUTSIDE
        at_limit = at_limit if held is None else at_limit | held
        x, residual = self.pattern_problem.project(start, at_limit)
        if residual > CLOSURE_TOL and held is None and at_limit.any():
            x, _ = self.pattern_problem.project(start)
        x = limits.clip(x)
        if not self.is_admissible(x):
            return None
        return None if self.contact and not jumps and self._pops.is_jump(a, x) else x

    def beside(self, a: np.ndarray, start: np.ndarray) -> np.ndarray | None:
        """Close a start beside a state [n], on either side of vertices; None where that is no admissible state."""
        return self.step(a, start, jumps=True)

    def between(self, a: np.ndarray, b: np.ndarray, shares: np.ndarray) -> np.ndarray | None:
        """States between two; creases that are fully folded at both stay so."""
        out = []
        at_limit = (self.pattern_problem.fold_limits.room(a) <= OUTSIDE) & (a == b)
        flat = (a == 0) & (b == 0)
        for share in shares:
            start = a + share * (b - a)
            x = self.step(a, start, at_limit | flat)
            x = self.step(a, start) if x is None else x
            if x is None or (self.contact and self._pops.is_jump(x, b)):
                return None
            if np.abs(x - start).max() > np.abs(b - a).max() + CLOSURE_TOL:
                return None
            out.append(x)
        return np.array(out)

    def land(self, states: np.ndarray) -> np.ndarray:
        """Where descents end."""
        out = np.full(states.shape, math.nan)
        for i, x in enumerate(states):
            if x.any():
                key = x.tobytes()
                if key not in self._landed:
                    self._landed[key] = self._down(x)
                out[i] = self._landed[key]
        return out

    def _down(self, x: np.ndarray) -> np.ndarray:
        """Return where a descent ends; nan where it does not arrive, or there were enough of them."""
        self._left -= 1
        if self._left < 0:
            return np.full(len(x), math.nan)
        end = self._descent(x)
        return end.phi if end is not None and end.arrived else np.full(len(x), math.nan)

    def _descent(self, x: np.ndarray) -> Descended | None:
        """Go down from a state, once; None where linear algebra fails on the way."""
        key = x.tobytes()
        if key not in self._gone:
            try:
                end = (
                    contact_descent(self.pattern_problem, x, keep=True)
                    if self.contact
                    else descend(self.pattern_problem, x)
                )
                self._gone[key] = end
            except (np.linalg.LinAlgError, ArithmeticError):
                self._gone[key] = None
        return self._gone[key]

    def path_down(self, state: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
        """Go down step by step; `state` alone where a step leaves closed admissible states, or climbs over it."""
        end = self._descent(state)
        if end is None:
            return state[None]
        out = self.cut([state, *end.path[1:]], until)
        if out is None:
            return state[None]
        return state[None] if self.over(state, out).max() > self.floor else out

    def walk_to(self, x: np.ndarray, goal: np.ndarray) -> tuple[np.ndarray, bool]:
        """Walk straight from state x [n] to another, over any height: states looked at [S, n]; whether it arrives."""
        self.pattern_problem.check_time()
        path = self._walk(x, goal, None)
        arrives = bool(np.abs(path[-1] - goal).max() <= NEAR_SINGULAR_TOL)
        if arrives:
            path[-1] = goal
        whole = self.cut(list(path))
        return (x[None], False) if whole is None else (whole, arrives)

    def through_flat(self, path: np.ndarray) -> np.ndarray | None:
        """Add to a path [S, n] the states in which vertices are exactly flat that it takes to their other side.

        Short steps may, see `PopSigns.is_jump`; None where there is no such admissible state beside them.
        """
        sums, out = self._pops.sums(path), [path[0]]
        for k, x in enumerate(path[1:]):
            if (passed := sums[k] * sums[k + 1] < 0).any():
                around = [self._pops.around[v] for v in np.flatnonzero(passed)]
                kept = np.isin(np.arange(len(x)), np.concatenate(around))
                middle = self.step(
                    path[k], np.where(kept, 0.0, 0.5 * (path[k] + x)), kept, jumps=True
                )
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
            half = np.array([0.5])
            middles = [self.between(path[k - 1], path[k], half) for k in after]
            found = [x for x in middles if x is not None]
            if len(found) < len(middles):
                return None
            path = np.insert(path, after, np.array(found).reshape(-1, path.shape[1]), axis=0)
        return path

    def cut(
        self, states: Sequence[np.ndarray], until: Callable[[np.ndarray], bool] | None = None
    ) -> np.ndarray | None:
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
            if until is not None and until(x):
                break
        return np.array(out)

    def passes(self, a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
        """States of least energy with a vertex flat that pops between two states: motions of paper pass it there."""
        found = []
        for v in np.flatnonzero(self._pops.sums(a) * self._pops.sums(b) < 0):
            kept = np.isin(np.arange(len(a)), self._pops.around[v])
            if (x := self._lowest_flat((a + b) / 2, kept)) is not None:
                found.append(x)
        return found

    def rays(self, which: Sequence[int]) -> list[tuple[int, np.ndarray]]:
        """Go along soft modes, open contacts, pop vertices, go to the flat state and on, and to other states."""
        out = []
        for k in which:
            x = self.minima[k]
            out += [(k, self._walk(x, None, way)) for way in self._leaving[k]]
            out += [(k, self._popped(x, np.array(creases))) for creases in self._around[k]]
            out += [(k, self._walk(x, to, None)) for to in [np.zeros(len(x)), *self.others(k)]]
        out += over_flat(out)
        return [(k, self._thinned(k, path)) for k, path in out] + self._over_flat_vertices(which)

    def _over_flat_vertices(self, which: Sequence[int]) -> list[tuple[int, np.ndarray]]:
        """Go from states of least energy with one vertex flat down to both sides: backwards, these are escape paths."""
        out: list[tuple[int, np.ndarray]] = []
        seen: list[np.ndarray] = []
        for k, creases in ((j, creases) for j in which for creases in self._around[j]):
            x = self.minima[k]
            if self._left < self._half:
                break
            kept = np.isin(np.arange(len(x)), creases)
            self._left -= 1
            flat = self._lowest_flat(x, kept) if x[creases].any() else None
            if (
                flat is None
                or not flat.any()
                or any(np.abs(flat - y).max() <= NEAR_SINGULAR_TOL for y in seen)
            ):
                continue
            seen.append(flat)
            sides = []
            for y in (x, -x, *self.others(k)):
                starts = (
                    self.step(flat, np.where(kept, FIRST * y, t * flat), jumps=True) for t in NEARLY
                )
                beside = next((z for z in starts if z is not None), None)
                self._left -= 1
                if beside is not None and len(d := self.path_down(beside, lambda _: False)) > 1:
                    sides.append(d)
            for down, other in itertools.permutations(sides, 2):
                apart = np.abs(self.minima - down[-1]).max(axis=1)
                j = int(apart.argmin())
                if apart[j] <= NEAR_SINGULAR_TOL and (kept @ down[0]) * (kept @ other[0]) < 0:
                    back = [self.minima[j], *down[-2::-1], flat, other[0]]
                    self._landed |= {y.tobytes(): self.minima[j] for y in down}
                    self._landed[other[0].tobytes()] = other[-1]
                    out.append((j, np.array(back)))
        return out

    def _thinned(self, k: int, path: np.ndarray) -> np.ndarray:
        """Leave out states of a ray, but for the highest ones: a way is cut finer where it is the lowest."""
        if len(path) <= LANDED + 1:
            return path
        tops = np.argsort(self.rise(k, path), kind="stable")[-1:]
        some = np.linspace(0, len(path) - 1, LANDED).round().astype(int)
        flat = [i for i, x in enumerate(path) if self._pops.flat(x).any()]
        return path[np.unique(np.r_[some, tops, flat].astype(int))]

    def _lowest_flat(self, x: np.ndarray, kept: np.ndarray) -> np.ndarray | None:
        """Go down from a state with some creases made flat, which stay so, as far as facets do not cross."""
        starts = (self.step(x, np.where(kept, 0.0, t * x), kept, jumps=True) for t in SHRUNK)
        good = next((y for y in starts if y is not None), None)
        if good is None:
            return None
        for y in descend(self.pattern_problem, good, kept=kept).path[1:]:
            share = 1.0
            for _ in range(HALVINGS):
                new = self.step(good, good + share * (y - good), kept, jumps=True)
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
        path = self._walk(x, flat, None)
        if np.abs(path[-1][creases]).max() > 0:
            return path
        over = path[-1].copy()
        over[creases] = -x[creases]
        return np.concatenate([path, self._walk(path[-1], over, None)[1:]])

    def _walk(self, x: np.ndarray, goal: np.ndarray | None, along: np.ndarray | None) -> np.ndarray:
        """Walk towards a goal, or along a direction, as far as states close and are admissible."""
        path, step, gone = [x], FIRST, 0.0
        while gone < FARTHEST:
            way = along if goal is None else goal - path[-1]
            assert way is not None
            left = float(np.linalg.norm(way))
            if left == 0.0:
                break
            length = step if goal is None else min(step, left)
            held = None if goal is None else (path[-1] == goal) & (goal == 0)
            move = length / left * way
            # straight ahead rounding would grow from step to step
            new = self.step(path[-1], path[-1] + (coarse(move) if goal is None else move), held)
            if new is None:
                break
            moved = float(np.linalg.norm(new - path[-1]))
            if not GOES[0] * length < moved < GOES[1] * length:
                break
            if goal is None:
                along = new - path[-1]
            path.append(new)
            gone += step
            step = min(2 * step, STEP)
        return np.array(path)
