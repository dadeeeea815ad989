"""How the copies of a cell that curls lie round an axis.

The walks from a facet to its copies along both lattice vectors move them by motions that commute where all vertices
close: screws about one axis, each by a turn and an advance.  A facet's copy (i, j) is turned by i and j times both, and
advanced so; p copies along the first vector and q along the second lead once round a closed tube.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.numerics import PLACES
from origami_nlp.pattern_problem.poses import Poses

MOST_COPIES = 10_000
"""Of a cell, within reach of it, that are asked whether they come near."""


@dataclass(frozen=True)
class Screws:
    """Two screws about one axis.

    Attributes
    ----------
    frame
        Two directions across the axis and its own, [3, 3]: a state curls, or turns by positive angles, about it.
    point
        On the axis, [3].
    turns
        Of both about the axis [rad], within +-pi, [2].
    advances
        Of both along it [unit of the coordinates], [2].
    """

    frame: np.ndarray
    point: np.ndarray
    turns: np.ndarray
    advances: np.ndarray

    def seen(self, x: np.ndarray) -> np.ndarray:
        """Return points [..., 3] by the frame, from the axis."""
        return np.asarray((x - self.point) @ self.frame.T)

    def moved(self, x: np.ndarray, copy: tuple[int, int]) -> np.ndarray:
        """Return where points [..., 3] by the frame come to lie in a copy."""
        turn, advance = float(self.turns @ copy), float(self.advances @ copy)
        c, s = math.cos(turn), math.sin(turn)
        return np.asarray(x @ [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]] + [0.0, 0.0, advance])


def copy_motions(poses: Poses, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return rotations [2, 3, 3] and translations [2, 3] that take the cell in space to its copies."""
    cell, p = poses.cell, poses.pattern
    assert cell is not None
    turn, shift = poses.motions(phi)
    places = [cell.home, *(cell.copies.index(way) for way in ((1, 0), (0, 1)))]
    home, *ways = (int(p.facet_of[k * len(cell.polygons)]) for k in places)
    r = np.stack([turn[f] @ turn[home].T for f in ways])
    s = np.stack([turn[f] @ a + shift[f] for f, a in zip(ways, cell.lattice, strict=True)])
    return r, s - r @ shift[home]


def find_screws(poses: Poses, phi: np.ndarray) -> Screws | None:
    """Return how copies of a cell lie round an axis at a closed state; None where they do not turn."""
    r, s = copy_motions(poses, phi)
    across = [r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]]
    axes = 0.5 * np.stack(across, axis=1)
    cosines = 0.5 * (np.trace(r, axis1=1, axis2=2) - 1.0)
    angles = np.arctan2(np.linalg.norm(axes, axis=1), cosines)
    # of both that which turns more, of equal ones the first
    k = int(angles[1] > angles[0] * (1 + PLACES))
    if angles[k] <= PLACES:
        return None
    u = axes[k]
    if cosines[k] < 0:
        # R + R' - 2 cos = 2 (1 - cos) u u': its largest column, also of half a turn, which is one either way
        both = r[k] + r[k].T - 2 * cosines[k] * np.eye(3)
        u = both[:, int(np.diag(both).argmax())]
        same = float(u @ axes[k])
        u = -u if same < -PLACES or (same <= PLACES and u[np.abs(u).argmax()] < 0) else u
    u = u / np.linalg.norm(u)
    # two directions across it
    side = np.eye(3)[int(np.abs(u).argmin())]
    e = side - (side @ u) * u
    e /= np.linalg.norm(e)
    frame = np.array([e, np.cross(u, e), u])
    turns = np.array([math.atan2(float(frame[1] @ one @ e), float(e @ one @ e)) for one in r])
    aside = s[k] - (s[k] @ u) * u
    point = 0.5 * (aside + np.cross(u, aside) / math.tan(0.5 * turns[k]))
    return Screws(frame, point, turns, s @ u)


def advance_of_a_cell(screws: Screws, tube: tuple[int, int]) -> float:
    """Return by how much each cell makes a closed tube longer; the sign says which way the second vector leads."""
    p, q = tube
    return float(screws.advances[1] / p if p else -screws.advances[0] / q)


def near_copies(cell: Any, screws: Screws, high: float) -> Iterator[tuple[int, int]] | None:
    """Go through the copies of a tube that are no further along it than `high`; None where these are too many."""
    p, q = cell.tube
    step = abs(advance_of_a_cell(screws, cell.tube))
    most = high / step if step else math.inf
    if not most * math.hypot(p, q) <= MOST_COPIES:
        return None
    wide = int(math.sqrt(0.25 * (p * p + q * q) + most**2 / (p * p + q * q))) + 1
    every = ((i, j) for i in range(-wide, wide + 1) for j in range(-wide, wide + 1))
    return (c for c in every if c == cell.around(c) and abs(p * c[1] - q * c[0]) <= most)
