"""Families of scenes on which searches are measured: (family, number) says which scene, on every machine."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks.designed import design, interior_states
from benchmarks.problems import random_vertex
from origami_nlp.pattern import Contact, Scene, Vertex, examples

DECADES = 1.0
"""Stiffnesses of the random families lie within this many powers of ten of 1 N m/rad: two decades in all."""
STARVED = (
    1.1565741972372854,
    1.2228548905335712,
    1.5075365007928707,
    0.3556159675251444,
    1.4134908833544877,
    0.6271128677362272,
)
"""Sector angles [rad] of a vertex whose designed states a search from random starts can miss."""


def fold_limits(number: int) -> Scene:
    """Draw a generic vertex of degree 4 to 8 (5 scenes a round) whose adjacent facets must not cross."""
    return _drawn(number, 4 + number % 5, "fold-limits", 1)


def large(number: int) -> Scene:
    """Draw a generic vertex of degree 9 or 10 whose adjacent facets must not cross."""
    return _drawn(number, 9 + number % 2, "fold-limits", 2)


def full_contact(number: int) -> Scene:
    """Draw a generic vertex of degree 4 to 8 (5 scenes a round) whose facets must not cross."""
    return _drawn(number, 4 + number % 5, "full", 3)


def _drawn(number: int, degree: int, contact: Contact, key: int) -> Scene:
    return random_vertex(np.random.default_rng([number, key]), degree, contact, DECADES)


def designed(number: int) -> Scene:
    """Choose springs that hold a vertex in two states: `STARVED` and random ones of degree 4 to 6 by turns."""
    return design_of(number)[0]


def design_of(number: int) -> tuple[Scene, list[np.ndarray]]:
    """Return a designed scene and the two states [N] that its springs hold."""
    rng = np.random.default_rng([number, 4])
    while True:
        if number % 2 == 0:
            vertex = Vertex(STARVED)
        else:
            vertex = random_vertex(rng, 4 + number % 3, "full").vertex
        n = vertex.degree
        unit = Scene(vertex, (1.0,) * n, (0.0,) * n, "none", "full")
        states = interior_states(unit, rng)
        springs = design(unit, states)
        if springs is not None:
            stiffness, rest = (tuple(v.tolist()) for v in springs)
            return replace(unit, stiffness=stiffness, rest_angles=rest), states


def one_dof(number: int) -> Scene:
    """Return vertices of degree 4: one planted state, five states, a cross of 90 degrees with six, then random ones.

    The second one's sectors and springs make it multistable in the sense of Waitukaitis and others (Physical Review
    Letters 114, 055503, 2015).
    """
    if number == 0:
        sectors = (0.7784849122786709, 2.291547160916454, 1.0231515757129965, 2.1900016582714645)
        stiffness: tuple[float, ...] = (0.022816280794769387, 0.03205546964080397)
        stiffness += (0.04387824855836886, 0.0012500010060577914)
        rest: tuple[float, ...] = (
            -0.2369412983168271,
            1.0889080776221243,
            3.141592485901434,
            3.1415921923256085,
        )
        return Scene(Vertex(sectors), stiffness, rest, "none", "full")
    if number == 1:
        vertex = Vertex((1.34035, 1.72886, 1.73407, 2 * math.pi - 1.34035 - 1.72886 - 1.73407))
        stiffness = (0.91922, 0.024246, 0.028457, 2.42197)
        return Scene(vertex, stiffness, (-2.32067, 1.93939, 2.09308, 1.60176), "none", "full")
    if number == 2:
        stiffness, rest = (1.0, 1.3, 0.7, 1.1), (1.5, -0.9, 0.8, 0.3)
        return Scene(Vertex((math.pi / 2,) * 4), stiffness, rest, "none", "full")
    return _drawn(number, 4, "full", 5)


def crowded(number: int) -> Scene:
    """Return vertices of many equal sectors, folded far: what people try first.

    Eight sectors of 45 degrees (the middle of a bird base), six of 60, then the middle of a frog base, sixteen
    creases at 22.5 degrees, with all but 8, 10, 12 or 14 of them left out.
    """
    if number == 0:
        rest: tuple[float, ...] = (-math.pi, -math.pi / 2, math.pi, math.pi / 2) * 2
        return Scene(Vertex((math.pi / 4,) * 8), (1.0,) * 8, rest, "none", "full")
    if number == 1:
        rest = (math.pi, -math.pi) * 3
        return Scene(Vertex((math.pi / 3,) * 6), (1.0,) * 6, rest, "none", "full")
    degree = 8 + 2 * ((number - 2) % 4)
    rng = np.random.default_rng([number, 6])
    while True:
        rays = np.sort(rng.choice(16, degree, replace=False))
        steps = np.diff(np.append(rays, rays[0] + 16))
        if steps.max() <= 4:  # no facet wider than a right angle
            break
    rest = tuple(rng.choice([-math.pi, -math.pi / 2, math.pi / 2, math.pi], degree).tolist())
    sectors = tuple((math.pi / 8 * steps).tolist())
    return Scene(Vertex(sectors), (1.0,) * degree, rest, "none", "full")


def panel(number: int) -> Scene:
    """Return one of the paper's 18 panels."""
    return examples.panels()[number]


FAMILIES: dict[str, Callable[[int], Scene]] = {
    "panels": panel,
    "fold-limits": fold_limits,
    "large": large,
    "full-contact": full_contact,
    "designed": designed,
    "one-dof": one_dof,
    "crowded": crowded,
}


def family_scene(family: str, number: int) -> Scene:
    """Return scene `number` (0-based) of a family, with its name."""
    scene = FAMILIES[family](number)
    return replace(scene, name=scene_name(family, number))


def scene_name(family: str, number: int) -> str:
    """Return the name of a scene of a family, 1-based as people count."""
    return f"{family} {number + 1}"
