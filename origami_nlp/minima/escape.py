"""Escape barriers of the minima of a scene: traced with one degree of freedom, bounded by descents with more."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.kkt import (
    ALONE,
    FARTHEST,
    GOES,
    LONGEST,
    TRACED,
    TREE,
    Escape,
    EscapePath,
    Method,
    Terrain,
    barriers,
    bounds,
    energy_scale,
    escape_paths,
    follow,
    level_of,
    newton,
    over_flat,
    project,
)
from origami_nlp.minima.canonical import canonical_model
from origami_nlp.minima.compiled_projection import project_many
from origami_nlp.minima.descents import Descents
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.one_dof import CandidateMinima
from origami_nlp.minima.traced_passes import TracedPasses, traced_passes
from origami_nlp.numerics import (
    CLOSURE_TOL,
    CONTACT_TOL,
    DUPLICATE_TOL,
    NONZERO,
    OUTSIDE,
    RESOLVED,
    SHALLOW,
    coarse,
)
from origami_nlp.pattern import Relabelling, symmetries
from origami_nlp.problem import Contact, Model, closed_anyway
from origami_nlp.starts import Samples

MOST_STATES = 8
"""Minima out of which ways are sought: those of lowest energy."""
MOST_VARIABLES = 12
"""Variables up to which escape paths are sought."""
SMALLEST, LARGEST = 1e-3, 0.25
"""First and longest step along a ray [rad]; each is twice the one before."""
MOST_STEPS = 12
"""Of a projection: where it takes more, the ray has come to a singular state."""
PASS_NEAR = 0.5
"""Newton finds a pass within this distance [rad] of where descents part."""


DIGITS = 11
"""After the point [rad], of minima that ways begin at: ten times `OUTSIDE`."""
NOTHING_NEAR = "no other admissible state is near"


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
        known = ends.converged | ends.settled
        out[some[known]] = ends.samples.x[known]

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
        at_limit = model.fold_limits.near(state[None], 0.0) * model.has_limits
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            self._descents.run(Samples.on(state[None], at_limit), paths)
        x = np.array([state, *paths[0]])
        x = x[np.append(True, np.abs(np.diff(x, axis=0)).max(axis=1) > 0)]
        good = model.admissible(x) & (np.abs(model.closure(x)[0]).max(axis=1) <= CLOSURE_TOL)
        good[1:] &= np.diff(self.over(state, x)) < 0
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


def with_escapes(
    model: Model, minima: Sequence[JudgedState], traced: CandidateMinima | None = None
) -> list[JudgedState]:
    """Add what it takes to leave each minimum.

    Parameters
    ----------
    model
        The problem.
    minima
        All that are known.
    traced
        The curves of a model with one degree of freedom, where they were resolved.

    Returns
    -------
    list of JudgedState
        With `escape`.
    """
    states = np.array([model.reduce(np.array(m.fold_angles)) for m in minima])
    states = states.reshape(-1, model.size)
    energies = np.array([m.energy for m in minima])
    isolated = np.array([m.local_dimension == 0 for m in minima], dtype=bool)
    scale = energy_scale(np.array(model.scene.stiffness))
    # exact where every curve of states is known: barriers are then read off a finite graph
    found = None
    if traced is not None and traced.complete and model.has_limits and not model.parameters.dead:
        passes = traced_passes(model, traced.curves, traced.branches, states, energies)
        found = passes and _exact(model, passes, energies, isolated, scale)
    if not found:
        found = _bounded(model, minima, states, energies, isolated, scale)
    return [replace(m, escape=e) for m, e in zip(minima, found, strict=True)]


def with_merge_tree(
    model: Model,
    minima: Sequence[JudgedState],
    heights: np.ndarray,
    why: str,
    method: Method = TREE,
    beyond: np.ndarray | None = None,
) -> list[JudgedState]:
    """Add what a merge tree of a graph of states says of leaving each minimum.

    Parameters
    ----------
    model
        The problem.
    minima
        Its minima.
    heights
        Energy of the lowest pass between two of them, [M, M]; inf where there is none.
    why, method
        What that rests on.
    beyond
        What a way from each to a lower state that is not listed climbs, [M]; inf for none.

    Returns
    -------
    list of JudgedState
        With `escape` where the tree knows an escape path from a minimum; the others as they were.
    """
    energies = np.array([m.energy for m in minima])
    scale = energy_scale(np.array(model.scene.stiffness))
    listed = barriers(energies, heights, level_of(energies, scale), scale, beyond)
    return [
        replace(m, escape=Escape(barrier, method, why, to + 1, (), barrier < SHALLOW * scale))
        if math.isfinite(barrier)
        else m
        for m, (barrier, to) in zip(minima, listed, strict=True)
    ]


def _exact(
    model: Model,
    passes: TracedPasses,
    energies: np.ndarray,
    isolated: np.ndarray,
    scale: float,
) -> list[Escape] | None:
    """Read barriers off the merge tree of curves; None where a minimum is on none of them."""
    if not (passes.on_curves | isolated).all():
        return None
    found = []
    listed = barriers(energies, passes.heights(), level_of(energies, scale), scale)
    for k, (barrier, to) in enumerate(listed):
        if isolated[k]:
            found.append(Escape(math.inf, ALONE, NOTHING_NEAR))
        elif to < 0:
            why = "its curve leads to no state of no higher energy: it ends at limits, contacts or itself"
            found.append(Escape(math.inf, TRACED, why))
        else:
            why = "the lowest pass of the curves of closed states, both ways, admissible all along"
            top = tuple(model.expand(passes.top(k, to)).tolist())
            found.append(Escape(barrier, TRACED, why, to + 1, top, barrier < SHALLOW * scale))
    return found


def _bounded(
    model: Model,
    minima: Sequence[JudgedState],
    states: np.ndarray,
    energies: np.ndarray,
    isolated: np.ndarray,
    scale: float,
) -> list[Escape]:
    """Bound barriers by escape paths that descents show."""
    why = ""
    if model.scene.loads:
        why = "forces in space: escape paths are not sought under them"
    elif model.size > MOST_VARIABLES:
        why = f"more than {MOST_VARIABLES} variables: escape paths are not sought"
    loose = [k for k in range(len(minima)) if not isolated[k]]
    images = _images(model, states)
    lowest = [] if why else loose[:MOST_STATES]
    sought = [k for k in lowest if k not in images]
    modes = [_modes(model, m) for m in minima]
    ways = _ways(model, states, modes, sought) if sought else {}
    # an image may be that of an image: earlier ones first
    for k, (first, move, to) in sorted(images.items(), key=lambda item: item[0]):
        if k in lowest and (way := ways.get(first)):
            top = _moved(model, move, way.top)
            ways[k] = way._replace(top=top, to=int(to[way.to]) if way.to >= 0 else -1)
    reported = {k: Escape(math.inf, ALONE, NOTHING_NEAR) for k in np.flatnonzero(isolated).tolist()}

    def unknown(k: int) -> str:
        if not why and k not in lowest:
            return f"more than {MOST_STATES} minima: sought for those of lowest energy"
        if not why and len(loose) == 1:
            return "no other state is known that it could be left for"
        return why or "no descent from near it ended at a state of lower energy"

    group = model.scene.group
    kept = "" if group.is_trivial else f"; among states with symmetry {group.name}"
    heights = np.full((len(minima),) * 2, math.inf)
    found = bounds(energies, ways, heights, scale, reported, unknown, kept)
    return [
        replace(e, top=tuple(model.expand(np.array(e.top)).tolist())) if e.top else e for e in found
    ]


def _ways(
    model: Model, states: np.ndarray, modes: Sequence[list[np.ndarray]], which: Sequence[int]
) -> dict[int, EscapePath]:
    """Find escape paths from minima [M, n] of some numbers, under labels that do not depend on the scene's."""
    posed = canonical_model(model)
    if posed is None:
        return escape_paths(VertexTerrain(model, states, modes), which)
    other, labels = posed

    def there(x: np.ndarray) -> np.ndarray:
        return np.asarray(other.reduce(labels.sign * model.expand(x)[..., labels.creases]))

    # to the last bit, whatever rounding left; creases that are flat or at a limit stay so
    exact = there(states)
    still = (other.fold_limits.near(exact, OUTSIDE) != 0) | (np.abs(exact) <= OUTSIDE)
    exact = project(other, np.where(still, exact, np.round(exact, DIGITS)), frozen=still)[0]
    kept = [[coarse(there(m)) for m in of] for of in modes]
    terrain = VertexTerrain(other, exact, kept)
    unit = float(np.mean(model.scene.stiffness))
    return {
        k: EscapePath(unit * way.height, model.reduce(labels.back(other.expand(way.top))), way.to)
        for k, way in escape_paths(terrain, which).items()
    }


def _images(model: Model, states: np.ndarray) -> dict[int, tuple[int, Relabelling, np.ndarray]]:
    """Return which states [M, n] are images of earlier ones: of which, by which symmetry, and where that takes each.

    Symmetries are those of creases and springs that take all states to one another.
    """
    found: dict[int, tuple[int, Relabelling, np.ndarray]] = {}
    for move in symmetries(model.scene) if len(states) > 1 else ():
        apart = np.abs(_moved(model, move, states)[:, None] - states).max(axis=2)
        to = apart.argmin(axis=1)
        if len(set(to.tolist())) < len(to) or apart.min(axis=1).max() > DUPLICATE_TOL:
            continue
        for first, k in enumerate(to.tolist()):
            if first < k and first not in found and k not in found:
                found[k] = first, move, to
    return found


def _moved(model: Model, move: Relabelling, x: np.ndarray) -> np.ndarray:
    """Return the states, in the model's variables [..., n], to which a symmetry takes others."""
    return np.asarray(model.reduce(move.back(model.expand(x))))


def _modes(model: Model, minimum: JudgedState) -> list[np.ndarray]:
    """Return the softest mode of a minimum in the model's variables, where it is one."""
    return [model.reduce(np.array(minimum.softest_mode))] if minimum.softest_mode else []
