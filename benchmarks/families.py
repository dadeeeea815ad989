"""Families of scenes on which searches are measured: (family, number) says which scene, on every machine."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from origami_nlp.pattern import Contact, Scene, Vertex, examples

SMALLEST_SECTOR, LARGEST_SECTOR = 0.08, 3.0
"""Sector angles of random vertices lie between these [rad]."""


def random_vertex(
    rng: np.random.Generator, degree: int, contact: Contact, decades: float = 0.5
) -> Scene:
    """Draw sector angles, stiffness (10^-decades to 10^decades) and rest angles of a vertex without symmetry."""
    while True:
        spare = 2 * math.pi - degree * SMALLEST_SECTOR
        sectors = SMALLEST_SECTOR + rng.dirichlet(np.full(degree, 2.0)) * spare
        if sectors.max() < LARGEST_SECTOR:
            break
    stiffness = 10.0 ** rng.uniform(-decades, decades, degree)
    rest = rng.uniform(-math.pi, math.pi, degree)
    vertex = Vertex(tuple(sectors.tolist()))
    return Scene(vertex, tuple(stiffness.tolist()), tuple(rest.tolist()), "none", contact)


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
    return random_vertex(np.random.default_rng([number, key]), degree, contact, 1.0)


def panel(number: int) -> Scene:
    """Return one of the paper's 18 panels."""
    return examples.panels()[number]


FAMILIES: dict[str, Callable[[int], Scene]] = {
    "panels": panel,
    "fold-limits": fold_limits,
    "large": large,
    "full-contact": full_contact,
}


def family_scene(family: str, number: int) -> Scene:
    """Return scene `number` (0-based) of a family, with its name, 1-based as people count."""
    return replace(FAMILIES[family](number), name=f"{family} {number + 1}")
