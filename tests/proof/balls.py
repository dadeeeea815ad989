"""Balls, scenes and their closed states, as several tests of the check use them."""

import math
from collections.abc import Sequence

import numpy as np
from flint import arb, ctx

from origami_nlp.pattern import Scene, Vertex
from origami_nlp.proof.check_domains import VertexChain
from tests.independent.rotations import project, spin_sign
from tests.proof.chains_mp import mp


def scene(degree: int, seed: int) -> Scene:
    rng = np.random.default_rng(seed)
    sectors = rng.uniform(0.5, 1.5, degree)
    sectors *= 2 * math.pi / sectors.sum()
    k, rest = 10 ** rng.uniform(-1, 1, degree), rng.uniform(-3, 3, degree)
    vertex = Vertex(tuple(sectors.tolist()))
    return Scene(
        vertex, tuple(k.tolist()), tuple(rest.tolist()), symmetry="none", contact="fold-limits"
    )


def sheet_of(s: Scene) -> VertexChain:
    return VertexChain(s.vertex.sector_angles, s.stiffness, s.rest_angles)


def closed_states(s: Scene, starts: np.ndarray, pins: Sequence[int]) -> np.ndarray:
    """Closed states of a sheet of paper next to starts [B, N], with some creases pinned; [C, N] with C <= B."""
    sectors, pins = np.array(s.vertex.sector_angles), np.array(pins)
    starts = np.where(pins, np.pi * pins, starts)
    near, off = project(sectors, np.arange(s.degree), starts, held=np.abs(pins))
    return near[(off < 1e-13) & (spin_sign(sectors, near) > 0)]


def exactly(value):
    """A number of 50 digits as a ball of 200 bits."""
    with ctx.workprec(200):
        return arb(mp.nstr(value, 55), 1e-45)


def holds(ball, value) -> bool:
    """Whether a ball holds a number of 50 digits, to 45 of them."""
    with ctx.workprec(200):
        return ball.overlaps(exactly(value))


def at(form, xi):
    """A form at given xi in [-1, 1]."""
    return sum((v * arb(xi[j]) for j, v in form[1].items()), form[0])
