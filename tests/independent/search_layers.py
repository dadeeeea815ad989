"""Can the layers of a touching symmetric state be stacked with the symmetry of the scene?

A state of tied fold angles can be foldable only with a stacking that the mirror does not map to
itself, for example two flaps on the mirror plane that pass each other tip by tip, one above the
other.  Such a state is a limit of embedded states, but not of symmetric ones.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from independent.arcs import crossing_margin, nearest_touch
from independent.layering import Walk, combinatorics, stackings
from independent.rotations import fold, spin_sign
from independent.search_manifold import Piece

TOUCH = 2e-6
"""Features this close touch; refined states are known to about 1e-7."""


def symmetries(n: int, half: bool) -> list[tuple[list[int], bool]]:
    """Generators of D1 (half) or D2: where each crease goes, and whether the map is a reflection."""
    mirror = ([(-i) % n for i in range(n)], True)
    return [mirror] if half else [mirror, ([(i + n // 2) % n for i in range(n)], False)]


def symmetrically_admissible(piece: Piece, x: np.ndarray) -> np.ndarray:
    """Tell which closed states x [B, n] have no crossings and layers with the whole symmetry."""
    x = np.atleast_2d(x)
    phi = piece.expand(x)
    ok = (spin_sign(piece.sectors, phi) > 0) & (np.abs(phi) <= math.pi).all(axis=1)
    creases, _ = fold(piece.sectors, phi)
    ok &= crossing_margin(creases) <= TOUCH
    for k in np.flatnonzero(ok & (nearest_touch(creases) <= TOUCH)):
        close = np.linalg.norm(creases[k][:, None] - creases[k][None], axis=2) <= TOUCH
        label = tuple(int(row.argmax()) for row in close)
        key = combinatorics(creases[k], phi[k], TOUCH)
        ok[k] = _stackable(*key, label, piece.half)
    return ok


@lru_cache(maxsize=100_000)
def _stackable(
    walk: Walk,
    sides: tuple[int, ...],
    around: tuple[tuple[int, ...], ...],
    label: tuple[int, ...],
    half: bool,
) -> bool:
    n = len(label)
    strands: list[list[int]] = []
    s = 0
    for i in range(n):  # facet i starts at crease i and ends where crease i + 1 is
        strands.append([s])
        while walk[s][1] != label[(i + 1) % n]:
            s += 1
            strands[-1].append(s)
        s += 1
    maps = []
    for to, reflected in symmetries(n, half):
        strand_to = [0] * len(walk)
        for i in range(n):
            image = strands[to[(i + 1) % n] if reflected else to[i]]
            for a, b in zip(strands[i], image[::-1] if reflected else image, strict=True):
                strand_to[a] = b
        maps.append((strand_to, [label[to[w]] for w in range(n)], reflected))
    return any(
        all(_keeps(stacking, *one) for one in maps) for stacking in stackings(walk, sides, around)
    )


def _keeps(
    stacking: dict[tuple[int, int], tuple[int, ...]],
    strand_to: list[int],
    node_to: list[int],
    reflected: bool,
) -> bool:
    for (u, v), stack in stacking.items():
        image = tuple(strand_to[s] for s in stack)
        start, end = node_to[u], node_to[v]
        if reflected != (start > end):
            image = image[::-1]
        if stacking[min(start, end), max(start, end)] != image:
            return False
    return True
