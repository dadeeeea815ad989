"""Random vertices that have a point group by construction, anywhere in their numbering."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp import Scene, Vertex


def _shares(rng: np.random.Generator, count: int, total: float, least: float) -> np.ndarray:
    """Return `count` angles >= least that sum to `total`."""
    return least + rng.dirichlet(np.full(count, 2.0)) * (total - count * least)


def _springs(rng: np.random.Generator, count: int, decades: float) -> tuple[np.ndarray, np.ndarray]:
    stiffness = 10.0 ** rng.uniform(-decades, decades, count)
    return stiffness, rng.uniform(-math.pi, math.pi, count)


def cyclic(
    rng: np.random.Generator, order: int, period: int, decades: float = 0.5
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return sectors, stiffness and rest angles of a vertex with C_order and order*period creases."""
    while True:
        a = _shares(rng, period, 2 * math.pi / order, 0.08)
        if a.max() < 3.0:
            break
    k, rest = _springs(rng, period, decades)
    return np.tile(a, order), np.tile(k, order), np.tile(rest, order)


def dihedral(
    rng: np.random.Generator,
    order: int,
    inner: int,
    ends: tuple[bool, bool] = (True, True),
    decades: float = 0.5,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return sectors, stiffness and rest angles of a vertex with D_order.

    inner: creases inside the wedge.  ends: whether its two mirrors lie on creases (else they run
    through the middle of a facet).
    """
    while True:
        gap = _shares(rng, inner + 1, math.pi / order, 0.04)
        k, rest = _springs(rng, inner + 2, decades)
        ring = [*range(inner + 2), *range(inner, 0, -1)] * order
        after = [*gap, *gap[::-1]] * order
        crease = [0 < r <= inner or ends[r > 0] for r in ring]
        sectors: list[float] = []
        for has, angle in zip(crease, after, strict=True):
            if has:
                sectors.append(angle)
            elif sectors:
                sectors[-1] += angle
        if not crease[0]:
            sectors[-1] += after[0]
        if max(sectors) < 3.0:
            break
    kept = [r for r, has in zip(ring, crease, strict=True) if has]
    return np.array(sectors), k[kept], rest[kept]


SHAPES = [
    *(
        ("C", n, m)
        for n, m in ((1, 4), (1, 5), (1, 6), (1, 7), (2, 2), (2, 3), (2, 4), (3, 2), (3, 3))
    ),
    *(("D", 1, m, ends) for m in (2, 3) for ends in ((True, True), (True, False), (False, False))),
    ("D", 1, 1, (True, True)),
    *(("D", 2, m, ends) for m in (1, 2) for ends in ((True, True), (True, False), (False, False))),
    *(("D", 3, m, ends) for m in (1,) for ends in ((True, True), (True, False), (False, False))),
    ("D", 2, 0, (True, True)),
    ("D", 3, 0, (True, True)),
]
"""Group, order, size of the piece, and for D_n what the mirrors run through."""


def degree(shape: tuple) -> int:
    if shape[0] == "C":
        return shape[1] * shape[2]
    return shape[1] * (2 * shape[2] + sum(shape[3]))


def build(
    rng: np.random.Generator, shape: tuple, contact: str = "full", decades: float = 0.5
) -> Scene:
    """Return a random scene of a shape, its creases numbered from a random one, group imposed."""
    make = cyclic if shape[0] == "C" else dihedral
    arrays = make(rng, *shape[1:], decades=decades)
    shift = int(rng.integers(len(arrays[0])))
    a, k, rest = (np.roll(v, shift) for v in arrays)
    name = "none" if shape[:2] == ("C", 1) else f"{shape[0]}{shape[1]}"
    return Scene(Vertex(tuple(a.tolist())), k, rest, name, contact)


SHAPES = [s for s in SHAPES if degree(s) >= 4]


def rational(rng: np.random.Generator) -> Scene:
    """Return a scene of degree 4 to 6 whose sectors are small multiples of one angle, no symmetry."""
    n = int(rng.integers(4, 7))
    while True:
        m = rng.integers(1, 6, n)
        if 2 * m.max() < m.sum():
            break
    rest = rng.choice([-math.pi, math.pi, -math.pi / 2, math.pi / 2, 0.5], n)
    sectors = tuple((2 * math.pi / m.sum() * m).tolist())
    return Scene(Vertex(sectors), 10.0 ** rng.uniform(-1, 1, n), rest, "none", "full")
