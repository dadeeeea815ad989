"""What the benchmark solves: the paper's 18 panels, and 30 random vertices of degree 4 to 12."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import get_args

import numpy as np

from origami_nlp.pattern import Contact, Scene, Vertex, examples

RANDOM_VERTICES = 30
DEGREES = range(4, 13)
CONTACTS = get_args(Contact)
SMALLEST_SECTOR, LARGEST_SECTOR = 0.08, 3.0
"""Sector angles of random vertices lie between these [rad]."""
DECADES = 0.5
"""Stiffnesses of random vertices lie within this many powers of ten of 1 N m/rad."""


@dataclass(frozen=True)
class Problem:
    """One scene of the benchmark.  family: ``"panel"`` or ``"random"``."""

    name: str
    family: str
    scene: Scene


def panel_problems() -> list[Problem]:
    """Return the 18 panels of the paper, in its symmetry and with full contact."""
    return [Problem(scene.name or "", "panel", scene) for scene in examples.panels()]


def random_problems(seed: int, count: int = RANDOM_VERTICES) -> list[Problem]:
    """Return random vertices without symmetry: every degree from 4 to 12 with every kind of contact."""
    children = np.random.SeedSequence(seed).spawn(count)
    out = []
    for i, child in enumerate(children):
        degree = DEGREES[i % len(DEGREES)]
        contact: Contact = CONTACTS[(i + i // len(DEGREES)) % len(CONTACTS)]
        scene = random_vertex(np.random.default_rng(child), degree, contact)
        out.append(Problem(f"random {i + 1}, degree {degree}, contact {contact}", "random", scene))
    return out


def random_vertex(
    rng: np.random.Generator, degree: int, contact: Contact, decades: float = DECADES
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


def quick_problems(seed: int) -> list[Problem]:
    """Return a few problems of each kind, for `--quick`."""
    panels = panel_problems()
    random = random_problems(seed)
    return [panels[3], panels[17], random[1], random[9]]
