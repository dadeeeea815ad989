"""How far springs may be off before a state is gone: followed to its event along the worst directions found.

Each stiffness is multiplied by (1 + p)^(+-1), each rest angle (wound angles included) by 1 +- p.  A direction is a sign
for each of these numbers; along it a state is followed as a curve of equilibria, through contacts that close and leave,
to the p at which it ceases to be a minimum.  The worst direction is looked for by descent over the signs: the number is
exact along the direction that is named, and an upper bound of what all directions allow.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.kkt import State, classify
from origami_nlp.minima import full_scene
from origami_nlp.numerics import SETTLED
from origami_nlp.path import ParameterLine, Web
from origami_nlp.pattern import Scene
from origami_nlp.programme import Model, Parameters

MOST = 0.5
"""Largest tolerance that is looked at."""
DRAWS = 8
"""Random directions that the descent over signs begins with."""
FOLLOWS = 120
"""Curves that are followed for one state."""


@dataclass(frozen=True)
class Loss:
    """Where a state is lost.

    Attributes
    ----------
    state
        Its name.
    percent
        How far each stiffness and rest angle is off then [%], or 50 where it is not lost that far.
    event
        What happens: ``fold``, ``nonsmooth-fold``, ...; ``kept``; ``singular`` where it can be followed no
        further, which need not be its end.
    stiffness, rest_angles
        The direction, a sign for each crease, shape [N].
    """

    state: str
    percent: float
    event: str
    stiffness: tuple[float, ...]
    rest_angles: tuple[float, ...]


@dataclass(frozen=True)
class Tolerance:
    """How far the springs of a design may be off.

    Attributes
    ----------
    losses
        Of each state along its worst direction.
    trials, kept
        Random springs within `percent` that were tried, and in how many of them all states were still minima.
    """

    losses: tuple[Loss, ...]
    trials: int = 0
    kept: int = 0

    @property
    def percent(self) -> float:
        """Smallest of all states [%]."""
        return min(loss.percent for loss in self.losses)


def line_of(scene: Scene, stiffness: np.ndarray, rest: np.ndarray) -> ParameterLine:
    """Return the line of programmes at s = ln(1 + p), without symmetry.

    Parameters
    ----------
    scene
        The design.
    stiffness, rest
        A sign for each crease, shape [N].
    """
    model = Model(full_scene(scene))
    p = model.parameters
    still = np.zeros_like(p.load)
    # rest angles: 1 + p = e^s up to s^2 / 2; `percent_of` says p by the angles, stiffness is off by as much or less
    direction = Parameters(np.zeros_like(p.sectors), stiffness, rest * p.rest, still)
    return ParameterLine(model, p, direction)


def lost_at(line: ParameterLine, x: np.ndarray, most: float) -> tuple[float, str]:
    """Follow a minimum x [N] to where it is none, at most to s = `most`; return s and the event, or ``kept``."""
    web = Web(line, 0.0, most, through_folds=False)
    if not web.add(x, 0.0, "minimum"):
        return 0.0, "singular"
    node, s = 0, 0.0
    for _ in range(len(web.arcs) + 1):
        ahead = [
            (a.high, a.end if a.frames[-1].s >= a.frames[0].s else a.start)
            for a in web.arcs
            if a.index == 0 and node in (a.start, a.end) and a.low >= s - SETTLED and a.high > s
        ]
        if not ahead:
            return s, web.nodes[node].type
        s, node = max(ahead)
        if s >= most - SETTLED:
            return most, "kept"
    return s, web.nodes[node].type


def tolerance_of(
    scene: Scene,
    states: dict[str, np.ndarray],
    *,
    seed: int = 0,
    trials: int = 0,
    draws: int = DRAWS,
) -> Tolerance:
    """Find how far the springs of a scene may be off before one of its states is gone.

    Parameters
    ----------
    scene
        The design.
    states
        Fold angles of its minima by name, shape [N].
    seed
        Of the directions.
    trials
        Random springs that are tried within the tolerance that was found.
    draws
        Random directions that the descent begins with.

    Returns
    -------
    Tolerance
        With the worst direction found for each state.
    """
    rng = np.random.default_rng(seed)
    losses = tuple(_worst(scene, name, phi, rng, draws) for name, phi in states.items())
    found = Tolerance(losses)
    if trials:
        kept = sum(_survives(scene, states, found.percent, rng) for _ in range(trials))
        found = replace(found, trials=trials, kept=kept)
    return found


def _worst(scene: Scene, name: str, phi: np.ndarray, rng: np.random.Generator, draws: int) -> Loss:
    """Search over the signs: random ones, then from the worst of them flips of one, as long as one is worse."""
    n = scene.degree
    known: dict[tuple[float, ...], tuple[float, str]] = {}

    def look(signs: np.ndarray, most: float) -> float:
        key = tuple(signs.tolist())
        if key not in known and len(known) < FOLLOWS:
            known[key] = lost_at(line_of(scene, signs[:n], signs[n:]), phi, most)
        return known.get(key, (math.inf, ""))[0]

    most = MOST
    best = np.ones(2 * n)
    for signs in rng.choice([-1.0, 1.0], size=(draws, 2 * n)):
        found = look(signs, most)
        if found < most:
            best, most = signs, found
    better = True
    while better:
        better = False
        for k in rng.permutation(2 * n):
            signs = best.copy()
            signs[k] *= -1.0
            found = look(signs, most)
            if found < most - SETTLED:
                best, most, better = signs, found, True
    event = known.get(tuple(best.tolist()), (MOST, "kept"))[1]
    return Loss(name, 100.0 * most, event, tuple(best[:n].tolist()), tuple(best[n:].tolist()))


def _survives(
    scene: Scene, states: dict[str, np.ndarray], percent: float, rng: np.random.Generator
) -> bool:
    """Try one random change of all springs, at most the tolerance in any of them."""
    n = scene.degree
    off = rng.uniform(-1.0, 1.0, 2 * n)
    most = 0.99 * percent / 100.0
    line = line_of(scene, off[:n], off[n:])
    for phi in states.values():
        if lost_at(line, phi, most)[1] != "kept":
            return False
    return True


def is_minimum_near(scene: Scene, x: np.ndarray) -> bool:
    """Tell whether a state x [N] is a minimum without the symmetry."""
    return classify(State(Model(full_scene(scene)), x)).verdict == "minimum"
