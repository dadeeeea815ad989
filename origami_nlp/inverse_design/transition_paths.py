"""One degree of freedom: the closed states between two states as a curve, and what barriers ask of the springs there.

Energies and slopes at given states are linear in stiffness and torque, so that a pass that stands where it is
prescribed has conditions as linear as those of a well.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from origami_nlp.continuation import evaluate, follow_boundary
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.equilibrium import SpringRows, bounded
from origami_nlp.inverse_design.targets import EnergyBounds, Targets
from origami_nlp.kkt import State, project
from origami_nlp.numerics import (
    CLOSURE_TOL,
    EQUAL,
    LEVEL,
    POSITIVE,
    SAMPLED,
    SETTLED,
    ConeRows,
)
from origami_nlp.pattern_problem import PatternProblem

CANDIDATES = 15
"""Places between two wells at which the pass may be prescribed."""
MOST_CANDIDATES = 300
"""Choices of passes for all pairs together."""
BESIDE_PASS = 0.1
"""Curvature of a prescribed pass, over the margin."""

Pair = tuple[str, str]
"""Names of two states."""


@dataclass(frozen=True)
class TransitionPath:
    """Admissible closed states from one state to another.

    Attributes
    ----------
    states
        From the first to the last, shape [m, n].
    tangents, bends
        First and second derivative by arclength in the metric, 0 where the curve is singular, shape [m, n].
    """

    states: np.ndarray
    tangents: np.ndarray
    bends: np.ndarray

    @property
    def regular(self) -> np.ndarray:
        """Where the curve has a tangent, shape [m]."""
        return np.asarray(np.linalg.norm(self.tangents, axis=1) > 0.5)


def arms(model: PatternProblem, x: np.ndarray) -> list[np.ndarray]:
    """Return both sides of the curve of closed states through x [n], outwards, up to a flat or flat-folded state.

    A state without a curve, as the flat one, is an arm by itself.
    """
    held = State(model, x).on(())
    first = evaluate(held)
    curve = follow_boundary(held, stop_at_release=False) if first and first.dimension == 1 else None
    if curve is None:
        return [np.array([x, x])]
    at = curve.states
    i = int(np.abs(at - x).max(axis=1).argmin())
    sides = [at[i:], at[i::-1]]
    if curve.end == "closed curve":
        ring = np.roll(at[:-1], -i, axis=0)
        sides = [ring, np.roll(ring[::-1], 1, axis=0)]
    out = []
    for side in sides:
        off = np.abs(side - math.pi * np.round(side / math.pi)).max(axis=1)
        corner = np.flatnonzero(off[1:] <= SAMPLED)  # (other curves may cross this one there)
        side = side[: corner[0] + 2] if len(corner) else side
        out += [np.vstack([x, side[1:]])] if len(side) > 1 else []
    return out


def path_between(model: PatternProblem, a: np.ndarray, b: np.ndarray) -> TransitionPath | None:
    """Return the shortest way from a to b on the curves of a model with one degree of freedom.

    Parameters
    ----------
    model
        With `dof` 1.
    a, b
        Closed states, shape [n].

    Returns
    -------
    TransitionPath or None
        None where no curve joins them, except through a singular state that is not flat.
    """
    of_a, of_b = arms(model, a), arms(model, b)
    found = [way for arm in of_a for way in _until(arm, b)]
    found = found or [way[::-1] for arm in of_b for way in _until(arm, a)]
    for one, two in itertools.product(of_a, of_b) if not found else ():
        corner = math.pi * np.round(one[-1] / math.pi)
        near = max(np.abs(one[-1] - corner).max(), np.abs(two[-1] - corner).max())
        if near <= SAMPLED and np.abs(model.closure(corner)[0]).max() <= CLOSURE_TOL:
            found.append(np.vstack([one[:-1], corner, two[-2::-1]]))
    return _way(model, min(found, key=len)) if found else None


def _until(arm: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
    """Return an arm up to a state on it; nothing where the state is not on it."""
    steps = np.diff(arm, axis=0)
    # nearest point of each step of the polyline to b
    share = np.einsum("ij,ij->i", b - arm[:-1], steps)
    share = share / np.maximum(np.einsum("ij,ij->i", steps, steps), SETTLED**2)
    off = np.abs(arm[:-1] + np.clip(share, 0, 1)[:, None] * steps - b).max(axis=1)
    j = int(off.argmin())
    return [np.vstack([arm[: j + 1], b])] if off[j] <= SAMPLED else []


def _way(model: PatternProblem, states: np.ndarray) -> TransitionPath:
    """Give a way its tangents; samples that stand on the one before are dropped, the ends kept."""
    last = states[-1]
    apart = np.abs(np.diff(states, axis=0)).max(axis=1) > SETTLED
    inner = apart[:-1] & (np.abs(states[1:-1] - last).max(axis=1) > SETTLED)
    states = states[np.r_[True, inner, True]]
    tangents, bends = np.zeros_like(states), np.zeros_like(states)
    for k, x in enumerate(states):
        before, after = states[max(k - 1, 0)], states[min(k + 1, len(states) - 1)]
        point = evaluate(State(model, x).on(()))
        if point is None or point.dimension != 1:
            continue
        sign = math.copysign(1.0, float(point.tangent @ (model.root * (after - before))))
        tangents[k], bends[k] = sign * point.tangent, point.bend
    return TransitionPath(states, tangents, bends)


def height(model: PatternProblem, way: TransitionPath) -> tuple[float, np.ndarray]:
    """Return the highest energy on a way [J], and the closed state [n] where it is.

    Parameters
    ----------
    model
        Of the scene with its springs.
    way
        On a curve of its closed states.
    """
    energies = model.energies(way.states)
    k = int(np.argmax(energies))
    if k in (0, len(energies) - 1) or not way.regular[k]:
        return float(energies[k]), way.states[k]

    def at(share: float) -> np.ndarray:
        i = int(share)
        return project(model, way.states[i] + (share - i) * (way.states[i + 1] - way.states[i]))[0]

    top = minimize_scalar(
        lambda share: -float(model.energy(at(share))), bounds=(k - 1, k + 1), method="bounded"
    )
    x = at(top.x) if -top.fun > energies[k] else way.states[k]
    return float(model.energy(x)), x


class Passes:
    """What the barriers of a question ask of its springs, for each choice of where the passes stand.

    Parameters
    ----------
    targets
        With barriers, and one degree of freedom.
    """

    def __init__(self, targets: Targets) -> None:
        self.targets, self.springs = targets, SpringRows(targets.model, targets.kinds)
        self.asks: dict[Pair, list[EnergyBounds]] = {}
        for ask in targets.barriers:
            pair = (ask.first, ask.second)
            self.asks.setdefault(pair[::-1] if pair[::-1] in self.asks else pair, []).append(ask)
        at = {p.target.name: p.state.x for p in targets.placed}
        self.ways: dict[Pair, TransitionPath] = {}
        for one, two in self.asks:
            way = path_between(targets.model, at[one], at[two])
            if way is None or len(way.states) < 3:
                why = "no curve of closed states joins them" if way is None else "the same state"
                raise OptionError(f"[[barriers]] {one!r} to {two!r}: {why}")
            self.ways[one, two] = way
        # states that bound a height from above: samples of the way, and tops that were seen between them
        self.tops = {pair: [*way.states[1:-1]] for pair, way in self.ways.items()}

    def choices(self) -> list[dict[Pair, int | None]]:
        """Return where passes may stand: a sample of each way, or None where only a height is bounded from above."""
        options: list[list[int | None]] = []
        share = max(2, int(MOST_CANDIDATES ** (1 / len(self.asks))))
        for pair, asks in self.asks.items():
            m = len(self.ways[pair].states)
            where = np.linspace(0, m - 1, min(CANDIDATES, share) + 2)[1:-1]
            at = np.unique(np.clip(np.round(where), 1, m - 2).astype(int)).tolist()
            options.append(at if any(a.least > 0.0 for a in asks) else [None])
        every = itertools.islice(itertools.product(*options), MOST_CANDIDATES)
        return [dict(zip(self.asks, c, strict=True)) for c in every]

    def rows(self, choice: dict[Pair, int | None]) -> list[ConeRows]:
        """Return the rows of a choice."""
        out: list[ConeRows] = []
        scale = np.eye(self.springs.places.size)[self.springs.places.scale]
        for pair, asks in self.asks.items():
            p = choice[pair]
            out += [] if p is None else self._pass(pair, p)
            top = self.tops[pair] if p is None else [self.ways[pair].states[p]]
            for ask in asks:
                start = self.springs.energy(self.ways[pair].states[-(ask.first != pair[0])])
                rises = np.array([self.springs.energy(x) - start for x in top])
                words = f"barrier from {ask.first} to {ask.second}"
                least = ask.least if ask.least > 0.0 else -math.inf
                out += bounded(rises, scale, least, ask.most, words)
        return out

    def see(self, model: PatternProblem) -> bool:
        """Note the tops of ways between samples that are too high in a scene; False where all are low enough."""
        new = False
        for pair, asks in self.asks.items():
            top, x = height(model, self.ways[pair])
            starts = [self.ways[pair].states[-(ask.first != pair[0])] for ask in asks]
            rises = [top - float(model.energy(x)) for x in starts]
            if any(r > a.most * (1 + LEVEL) for r, a in zip(rises, asks, strict=True)):
                self.tops[pair].append(x)
                new = True
        return new

    def _pass(self, pair: Pair, p: int) -> list[ConeRows]:
        """Rows of a pass at sample p: up to it, stationary there and bent down, down from it: the only top."""
        way, root, springs = self.ways[pair], self.targets.model.root, self.springs
        slopes = [springs.slope(x, t / root) for x, t in zip(way.states, way.tangents, strict=True)]
        words = f"the only pass between {pair[0]} and {pair[1]} is the one prescribed"
        inner = [k for k in range(1, len(slopes) - 1) if k != p and way.regular[k]]
        out = []
        if inner:
            rising = [math.copysign(1.0, p - k) * slopes[k] for k in inner]
            out.append(ConeRows.of(POSITIVE, rising, words))
        if way.regular[p]:
            # paper, eq. 3.6: t . K t + grad U . y'', linear in k and tau where the curve is given
            bend = -springs.slope(way.states[p], way.bends[p] / root)
            stiffness = springs.places.stiffness.start + springs.kind
            np.add.at(bend, stiffness, -(way.tangents[p] ** 2))
            bend[springs.places.margin] -= BESIDE_PASS
            out.append(ConeRows.of(EQUAL, slopes[p], f"{words}: level there"))
            out.append(ConeRows.of(POSITIVE, bend, f"{words}: bends down there"))
        return out
