"""Minima of a vertex with descents between them, where these are compiled."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from origami_nlp.kkt import (
    FARTHEST,
    GOES,
    LONGEST,
    Terrain,
    energy_scale,
    follow,
    newton,
    over_flat,
    project,
)
from origami_nlp.minima.compiled_projection import project_many
from origami_nlp.minima.descents import Descents
from origami_nlp.numerics import (
    CLOSURE_TOL,
    CONTACT_TOL,
    LEVEL,
    NEAR_SINGULAR_TOL,
    NONZERO,
    RESOLVED,
)
from origami_nlp.problem import Contact, Model, closed_anyway
from origami_nlp.starts import Samples

SMALLEST, LARGEST = 1e-3, 0.25
"""First and longest step along a ray [rad]; each is twice the one before."""
MOST_STEPS = 12
"""Of a projection: where it takes more, the ray has come to a singular state."""
PASS_NEAR = 0.5
"""Newton finds a pass within this distance [rad] of where descents part."""
MOST_SHORT = 200
"""Steps of a descent; short ones, as long ones jump over what lies between."""


class VertexTerrain(Terrain):
    """Minima of a model with descents between them: what `kkt.escape_paths` walks on."""

    together = 64

    def __init__(self, model: Model, minima: np.ndarray, modes: Sequence[list[np.ndarray]]) -> None:
        super().__init__(model, minima, energy_scale(np.array(model.scene.stiffness)))
        self.model, self._modes = model, modes
        self._descents = Descents(model, steps=MOST_SHORT, longest=LONGEST)
        self._closed: dict[bytes, tuple[Contact, ...]] = {}
        self._landed: dict[bytes, np.ndarray] = {}
        self._down: dict[bytes, np.ndarray] = {}
        self._short: dict[bytes, np.ndarray] = {}

    def _held(self, a: np.ndarray, b: np.ndarray) -> list[tuple[Contact, ...]]:
        """Contacts that both of two states hold, of each pair of [S, n]."""
        pairs = zip(self._contacts(a), self._contacts(b), strict=True)
        return [one if one is two else tuple(c for c in one if c in two) for one, two in pairs]

    def _contacts(self, x: np.ndarray) -> list[tuple[Contact, ...]]:
        """Contacts of states [S, n] that are closed whichever way facets pass."""
        keys = [y.tobytes() for y in x]
        new = {key: i for i, key in enumerate(keys) if key not in self._closed}
        if new:
            gaps = self.model.local(x[list(new.values())]).gaps
            for (key, i), g in zip(new.items(), gaps, strict=True):
                self._closed[key] = closed_anyway(self.model, x[i], g, CONTACT_TOL)
        return [self._closed[key] for key in keys]

    def rays(self, which: Sequence[int]) -> list[tuple[int, np.ndarray]]:
        """Fold each crease on and back, go along soft modes, to the flat state and on from there, and to other minima.

        Contacts of the state are opened, and held, in turn.  Nothing of this depends on how creases are numbered.
        """
        if not len(which):
            return []
        jobs, flat = [], np.zeros(self.model.size)
        for k in which:
            x = self.minima[k]
            unit, modes = np.eye(len(x)), self._modes[k]
            along = [*unit, *-unit, *modes, *(-mode for mode in modes)]
            jobs.append((k, np.array(along), np.array([flat, *self.others(k)])))
        held = dict(zip(which, self._contacts(self.minima[list(which)]), strict=True))
        holds = [job for job in jobs if held[job[0]]]
        out = self._walk([*jobs, *holds], [()] * len(jobs) + [held[k] for k, _, _ in holds])
        return out + over_flat(out)

    def proved_paths(self, which: Sequence[int]) -> dict[int, tuple[float, np.ndarray, int]]:
        """Paths over the flat state, where all states of no more energy are on its other side.

        With full contact no admissible path leads round it (docs/validation/landscapes.md).
        """
        model, flat = self.model, np.zeros(self.model.size)
        if not (model.scene.vertex.flat and model.scene.contact == "full") or model.refuses(flat):
            return {}
        energies, side = model.energies(self.minima), np.sign(model.expand(self.minima).sum(axis=1))
        aims = dict[int, int]()
        for k in which:
            others = np.arange(len(side)) != k
            lower = others & (energies <= energies[k] + self.noise[k])
            aim = np.flatnonzero(lower if lower.any() else others)
            if len(aim) and (side[k] * side[aim] < 0).all():
                aims[k] = int(aim[0])
        ends = sorted({*aims, *aims.values()})
        jobs = [(k, np.zeros((0, len(flat))), flat[None]) for k in ends]
        walked = dict(self._walk(jobs, [()] * len(jobs))) if jobs else {}
        return {
            k: (-float(self.over(flat, self.minima[k])), np.r_[walked[k], walked[to][-2::-1]], to)
            for k, to in aims.items()
            if not (walked[k][-1].any() or walked[to][-1].any())
        }

    def _walk(
        self,
        jobs: Sequence[tuple[int, np.ndarray, np.ndarray]],
        held: Sequence[tuple[Contact, ...]],
    ) -> list[tuple[int, np.ndarray]]:
        """Walk from minima along directions, and towards targets, as far as states close and are admissible.

        held: contacts that stay closed, of each job.
        """
        model, none = self.model, np.zeros((0, self.model.size))
        many = [len(a) + len(t) for _, a, t in jobs]
        owner = np.repeat([k for k, _, _ in jobs], many)
        rows = np.repeat(np.arange(len(jobs)), many)
        at = self.minima[owner].copy()
        aimed = np.concatenate([np.r_[np.zeros(len(a)), np.ones(len(t))] for _, a, t in jobs]) > 0
        goal = np.concatenate([none, *(part for _, a, t in jobs for part in (a, t))])
        driven = ((goal != 0).sum(axis=1) == 1) & ~aimed  # one crease turns, the others follow
        walked, rays = [at.copy()], [np.arange(len(at))]
        live, step, gone = np.arange(len(at)), SMALLEST, 0.0
        while len(live) and gone < FARTHEST:
            way = (goal[live] - at[live] * aimed[live, None]) * model.root
            left = np.linalg.norm(way, axis=1)
            length = np.where(aimed[live], np.minimum(step, left), step)[:, None]
            move = length * way / np.maximum(left, NONZERO)[:, None] / model.root
            want = model.fold_limits.clip(at[live] + move)
            arrives = aimed[live] & (left <= step)
            # nothing beside it: at the flat state closure has no rank, and rounding would choose a side
            want[arrives] = goal[live][arrives]
            still = (goal[live] != 0) & driven[live, None]
            y, good = project_many(self._descents, want, held, rows[live], still, MOST_STEPS)
            moved = np.linalg.norm(y - at[live], axis=1)
            # a target that is reached ends its ray
            good &= (left > 0) & (moved > GOES[0] * length[:, 0]) & (moved < GOES[1] * step)
            live, y = live[good], y[good]
            ahead = ~(aimed | driven)[live]
            goal[live[ahead]] = (y - at[live])[ahead]  # a mode is gone on straight ahead
            at[live] = y
            walked.append(y)
            rays.append(live)
            # a ray has left its state once it is lower; to the flat state it goes on: it is gone back from others
            left_for_good = self.over(self.minima[owner[live]], y) < -self.noise[owner[live]]
            live = live[~left_for_good | ~goal[live].any(axis=1)]
            gone += step
            step = min(2 * step, LARGEST)
        order = np.argsort(np.concatenate(rays), kind="stable")
        ends = np.cumsum(np.bincount(np.concatenate(rays)))[:-1]
        paths = np.split(np.concatenate(walked)[order], ends)
        return list(zip(owner.tolist(), paths, strict=True))

    def between(self, a: np.ndarray, b: np.ndarray, shares: np.ndarray) -> np.ndarray | None:
        """States between two, with the contacts held that both hold."""
        held = self._held(a[None], b[None])[0]
        longest = np.full(len(shares), np.abs(b - a).max())
        x = self._closed_at(a + shares[:, None] * (b - a), longest, [held] * len(shares))
        # facets that lie on each other along the whole step have one order in it
        return None if x is None or (held and self.model.refuses(x[len(x) // 2])) else x

    def middles(self, a: np.ndarray, b: np.ndarray) -> np.ndarray | None:
        """States half way from each of a to each of b, [S, n], as `between`; None where one is lacking."""
        held = self._held(a, b)
        step = b - a
        x = self._closed_at(a + 0.5 * step, np.abs(step).max(axis=1), held)
        if x is None or any(h and self.model.refuses(y) for h, y in zip(held, x, strict=True)):
            return None
        return x

    def _closed_at(
        self, want: np.ndarray, longest: np.ndarray, held: Sequence[tuple[Contact, ...]]
    ) -> np.ndarray | None:
        """Close states [S, n], what each holds held, moved by `longest` [S] at most; None where one is no state."""
        number = {rows: i for i, rows in enumerate(dict.fromkeys(held))}
        of = np.array([number[rows] for rows in held])
        x, good = project_many(self._descents, want, list(number), of)
        if not good.all() or (np.abs(x - want).max(axis=1) > longest + CLOSURE_TOL).any():
            return None
        for y, rows in zip(x, held, strict=True):  # what a step holds, its middle holds
            self._closed[y.tobytes()] = rows
        return x

    def land(self, states: np.ndarray) -> np.ndarray:
        """Where descents in batches end."""
        at_limit = self.model.fold_limits.near(states, 0.0)
        at_limit *= self.model.has_limits
        out = np.full(states.shape, math.nan)
        if not self._descents.usable:
            return out
        # at the flat state closure has no rank, steps no direction: rounding would choose one
        left = np.abs(states).max(axis=1) > RESOLVED
        for y in self.minima:
            stays = left & (np.abs(states - y).max(axis=1) <= RESOLVED)
            out[stays], left[stays] = y, False
        # rays share states: to the flat state, and from there
        keys = [x.tobytes() for x in states]
        new = {keys[i]: i for i in np.flatnonzero(left) if keys[i] not in self._landed}
        self._land(states, at_limit, np.array(sorted(new.values()), dtype=int), out)
        self._landed |= {key: out[i] for key, i in new.items()}
        for i in np.flatnonzero(left):
            out[i] = self._landed[keys[i]]
        return out

    def _land(
        self, states: np.ndarray, at_limit: np.ndarray, some: np.ndarray, out: np.ndarray
    ) -> None:
        """Go down from some states; one at which linear algebra fails, as beside singular ones, ends nowhere."""
        if not len(some):
            return
        try:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                ends = self._descents.run(Samples.on(states[some], at_limit[some]))
        except np.linalg.LinAlgError:
            if len(some) > 1:
                for half in np.array_split(some, 2):
                    self._land(states, at_limit, half, out)
            return
        x = ends.samples.x
        apart = np.abs(x[:, None] - self.minima).max(axis=2)
        known = ends.converged | ends.settled | (apart <= NEAR_SINGULAR_TOL).any(axis=1)
        out[some[known]] = x[known]

    def path_down(self, state: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
        """Go down step by step, see `kkt.follow`; paths to their ends are kept, as other states ask for them again."""
        key = state.tobytes()
        if (known := self._down.get(key)) is not None:
            return _cut(known, until)
        try:
            down = follow(self.model, state, most_rescues=2, until=until).states
        except ValueError:
            down = state[None]
        if not until(down[-1]):
            self._down[key] = down
        return down

    def quick_path_down(self, state: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
        """Go down by Newton's steps as descents in batches do, made short; as far as they are admissible and lower."""
        key = state.tobytes()
        if key not in self._short:
            self._short[key] = self._short_steps(state)
        return _cut(self._short[key], until)

    def _short_steps(self, state: np.ndarray) -> np.ndarray:
        model, paths = self.model, list[np.ndarray]()
        if not self._descents.usable:
            return state[None]
        at_limit = model.fold_limits.near(state[None], 0.0) * model.has_limits
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            self._descents.run(Samples.on(state[None], at_limit), paths)
        x = np.array([state, *paths[0]])
        x = x[np.append(True, np.abs(np.diff(x, axis=0)).max(axis=1) > 0)]
        good = model.admissible(x) & (np.abs(model.closure(x)[0]).max(axis=1) <= CLOSURE_TOL)
        over, level = self.over(state, x), LEVEL * max(abs(model.energy(state)), model.scale)
        # beside a saddle steps are level: a rise by rounding is none
        good &= over - np.minimum.accumulate(over) <= level
        return x[: len(x) if good.all() else max(int(np.argmin(good)), 1)]

    def passes(self, a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
        """Stationary states that Newton finds between two, with the contacts held that both hold, or none."""
        model = self.model
        held = tuple(sorted(self._held(a[None], b[None])[0]))
        found = []
        for rows in dict.fromkeys([held, ()]):
            start, _ = project(model, (a + b) / 2, rows)
            done, _ = newton(model, start, rows)
            if done is None or not done.converged or np.abs(done.x - start).max() > PASS_NEAR:
                continue
            if not model.refuses(done.x):
                found.append(done.x)
        return found


def _cut(path: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
    """Return a path [S, n] up to the first state of which `until` says so."""
    stops = (i for i, x in enumerate(path) if until(x))
    return path[: next(stops, len(path)) + 1]
