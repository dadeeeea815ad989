"""Escape barriers of the minima of a scene: traced with one freedom, bounded by descents with more."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.kkt import (
    ALONE,
    BOUND,
    FLOOR,
    OPEN,
    TRACED,
    Escape,
    State,
    barriers,
    energy_scale,
    follow,
    level_of,
    newton,
    project,
    ways_out,
)
from origami_nlp.minima.descents import Descents
from origami_nlp.minima.minimum import Minimum
from origami_nlp.minima.one_freedom import Traced
from origami_nlp.minima.samples import Samples
from origami_nlp.minima.traced_passes import TracedPasses, traced_passes
from origami_nlp.numerics import CLOSES, FOLLOWED, LEVEL, SHALLOW
from origami_nlp.programme import Contact, Model

MOST_STATES = 16
"""Minima, images of one another counted once, out of which ways are sought: those of lowest energy."""
MOST_VARIABLES = 12
"""Variables up to which ways out are sought."""
SMALLEST, LARGEST = 1e-3, 0.25
"""First and longest step along a ray [rad]; each is twice the one before."""
NEAREST = 3
"""Other minima that rays lead towards."""
PASS_NEAR = 0.5
"""Newton finds a pass within this distance [rad] of where descents part."""


NOTHING_NEAR = "no other admissible state is near"


class VertexTerrain:
    """Minima of a model with descents between them: what `kkt.ways_out` walks on."""

    def __init__(self, model: Model, minima: np.ndarray, modes: Sequence[np.ndarray]) -> None:
        self.model, self.minima, self._modes = model, minima, modes
        self._descents = Descents(model)
        self._closed: dict[bytes, tuple[Contact, ...]] = {}
        self.floor = FLOOR * energy_scale(np.array(model.scene.stiffness))

    def rise(self, k: int, states: np.ndarray) -> np.ndarray:
        """Energies over that of a minimum."""
        x = self.minima[k]
        return np.array([self.model.energy_change(x, y) for y in states])

    def slope(self, x: np.ndarray) -> float:
        """Norm of the torques, in the metric of all fold angles."""
        gradient = self.model.local(x).gradient / self.model.root
        return self.model.scale * float(np.linalg.norm(gradient))

    def distance(self, a: np.ndarray, b: np.ndarray) -> float:
        """Distance in the metric of all fold angles."""
        return float(np.linalg.norm(self.model.root * (a - b)))

    def _held(self, a: np.ndarray, b: np.ndarray) -> tuple[Contact, ...]:
        """Contacts that two states both hold."""
        one, two = (self._contacts(x) for x in (a, b))
        return tuple(c for c in one if c in two)

    def _contacts(self, x: np.ndarray) -> tuple[Contact, ...]:
        key = x.tobytes()
        if key not in self._closed:
            self._closed[key] = State(self.model, x).contacts.base
        return self._closed[key]

    def is_lower(self, k: int, x: np.ndarray) -> bool:
        """Whether a state has less energy than a minimum."""
        at = self.minima[k]
        return self.model.energy_change(at, x) < -LEVEL * max(self.model.energy(at), self.model.scale)

    def rays(self, k: int) -> list[np.ndarray]:
        """Fold each crease on and back, go along soft modes, towards the flat state and to the nearest minima.

        Contacts of the state are opened, and held, in turn.  Nothing of this depends on how creases are numbered.
        """
        x = self.minima[k]
        apart = np.linalg.norm(self.model.root * (self.minima - x), axis=1)
        apart[k] = math.inf
        others = np.flatnonzero(apart <= np.sort(apart)[min(NEAREST, len(apart)) - 1] * (1 + 1e-6))
        others = others[np.isfinite(apart[others])]
        unit = np.eye(len(x))
        along = [*unit, *-unit, *self._modes[k], *(-mode for mode in self._modes[k])]
        targets = [np.zeros(len(x)), *self.minima[others]]
        out: list[np.ndarray] = []
        for held in dict.fromkeys([(), State(self.model, x).contacts.base]):
            out += self._walk(x, np.array(along), np.array(targets), held)
        return out

    def _walk(
        self, x: np.ndarray, along: np.ndarray, targets: np.ndarray, held: tuple[Contact, ...]
    ) -> list[np.ndarray]:
        """Walk along directions [A, n], and towards targets [T, n], as far as states close and are admissible."""
        model, many = self.model, len(along) + len(targets)
        at, paths = np.tile(x, (many, 1)), [[x] for _ in range(many)]
        live, step, gone = np.arange(many), SMALLEST, 0.0
        while len(live) and gone < math.pi:
            way = np.concatenate([along, targets - at[len(along) :]])[live] * model.root
            left = np.linalg.norm(way, axis=1)
            d = way / np.maximum(left, 1e-300)[:, None] / model.root
            lengths = np.where(live < len(along), step, np.minimum(step, left))[:, None]
            want = np.clip(at[live] + lengths * d, -model.bound, model.bound)
            y, residual = project(model, want, held)
            y = np.clip(y, -model.bound, model.bound)
            moved = np.linalg.norm(y - at[live], axis=1)
            good = (residual <= FOLLOWED) & (moved > 0.05 * step) & (moved < 3 * step)
            good &= np.abs(model.closure(y)[0]).max(axis=1, initial=0.0) <= CLOSES
            good[good] = model.admissible(y[good])
            live = live[good]
            at[live] = y[good]
            for r in live:
                paths[r].append(at[r].copy())
            gone += step
            step = min(2 * step, LARGEST)
        return [np.array(path) for path in paths]

    def between(self, a: np.ndarray, b: np.ndarray, shares: np.ndarray) -> np.ndarray | None:
        """States between two, with the contacts held that both hold."""
        model = self.model
        held = self._held(a, b)
        x, residual = project(model, a + shares[:, None] * (b - a), held)
        x = np.clip(x, -model.bound, model.bound)
        long = np.abs(x - (a + shares[:, None] * (b - a))).max() > np.abs(b - a).max() + CLOSES
        if long or (residual > FOLLOWED).any() or (np.abs(model.closure(x)[0]) > CLOSES).any():
            return None
        # facets that lie on each other along the whole step have one order in it
        crosses = not model.admissible(x).all() or (held and model.refuses(x[len(x) // 2]))
        if crosses:
            return None
        for y in x:  # what a step holds, its middle holds
            self._closed[y.tobytes()] = held
        return x

    def land(self, states: np.ndarray) -> np.ndarray:
        """Where descents in batches end."""
        shut = np.where(np.abs(states) == math.pi, np.sign(states), 0).astype(int)
        shut *= self.model.has_limits
        ends = self._descents.run(Samples.on(states, shut))
        known = ends.converged | ends.settled
        return np.where(known[:, None], ends.samples.x, math.nan)

    def path_down(self, state: np.ndarray, until: Callable[[np.ndarray], bool]) -> np.ndarray:
        """Go down step by step, see `kkt.follow`."""
        try:
            return follow(self.model, state, most_rescues=2, until=until).states
        except ValueError:
            return state[None]

    def passes(self, a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
        """Stationary states that Newton finds between two, with the contacts held that both hold, or none."""
        model = self.model
        held = tuple(sorted(self._held(a, b)))
        found = []
        for rows in dict.fromkeys([held, ()]):
            start, _ = project(model, (a + b) / 2, rows)
            done, _ = newton(model, start, rows)
            if done is None or not done.converged or np.abs(done.x - start).max() > PASS_NEAR:
                continue
            if not model.refuses(done.x):
                found.append(done.x)
        return found


def with_escapes(
    model: Model, minima: Sequence[Minimum], traced: Traced | None = None
) -> list[Minimum]:
    """Add what it takes to leave each minimum.

    Parameters
    ----------
    model
        The programme.
    minima
        All that are known.
    traced
        The curves of a model with one freedom, where they were resolved.

    Returns
    -------
    list of Minimum
        With `escape`.
    """
    states = np.array([model.reduce(np.array(m.fold_angles)) for m in minima])
    states = states.reshape(-1, model.size)
    energies = np.array([m.energy for m in minima])
    isolated = [m.local_dimension == 0 for m in minima]
    scale = energy_scale(np.array(model.scene.stiffness))
    found = None
    if traced is not None and traced.complete and model.has_limits and not model.scene.loads:
        passes = traced_passes(model, traced.curves, traced.branches, states, energies)
        found = passes and _exact(model, passes, energies, isolated, scale)
    if not found:
        found = _bounded(model, minima, states, energies, isolated, scale)
    return [replace(m, escape=e) for m, e in zip(minima, found, strict=True)]


def _exact(
    model: Model,
    passes: TracedPasses,
    energies: np.ndarray,
    isolated: Sequence[bool],
    scale: float,
) -> list[Escape] | None:
    """Read barriers off the merge tree of curves; None where a minimum is on none of them."""
    if not (passes.on_curves | np.array(isolated)).all():
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
    minima: Sequence[Minimum],
    states: np.ndarray,
    energies: np.ndarray,
    isolated: Sequence[bool],
    scale: float,
) -> list[Escape]:
    """Bound barriers by ways out that descents show."""
    why = ""
    if model.scene.loads:
        why = "forces in space: ways out are not sought under them"
    elif model.size > MOST_VARIABLES:
        why = f"more than {MOST_VARIABLES} variables: ways out are not sought"
    loose = [k for k in range(len(minima)) if not isolated[k]]
    sought = [] if why else loose[:MOST_STATES]
    modes = [_modes(model, m) for m in minima]
    ways = ways_out(VertexTerrain(model, states, modes), sought) if len(minima) else {}
    heights = np.full((len(minima),) * 2, math.inf)
    beyond = np.full(len(minima), math.inf)
    for k, way in ways.items():
        if way.to < 0:
            beyond[k] = way.height
        else:
            heights[k, way.to] = energies[k] + way.height
    level = level_of(energies, scale)
    found = []
    for k, (barrier, to) in enumerate(barriers(energies, heights, level, scale)):
        if isolated[k]:
            found.append(Escape(math.inf, ALONE, NOTHING_NEAR))
            continue
        if beyond[k] < barrier:
            barrier, to = float(beyond[k]), -1
        if math.isinf(barrier):
            reason = why or "no descent from beside it ended at a state of lower energy"
            if not why and k not in sought:
                reason = f"more than {MOST_STATES} minima: sought for those of lowest energy"
            elif not why and len(loose) == 1:
                reason = "no other state is known that it could be left for"
            found.append(Escape(math.nan, OPEN, reason))
            continue
        barrier = max(barrier, FLOOR * scale)
        top = model.expand(ways[k].top) if k in ways and ways[k].to == to else ()
        found.append(
            Escape(
                barrier,
                BOUND,
                "an explicit way out climbs so high; lower ones are not excluded",
                to + 1,
                tuple(map(float, top)),
                barrier < SHALLOW * scale,
            )
        )
    return found


def _modes(model: Model, minimum: Minimum) -> list[np.ndarray]:
    """Return the softest mode of a minimum in the model's variables, where it is one."""
    return [model.reduce(np.array(minimum.softest_mode))] if minimum.softest_mode else []
