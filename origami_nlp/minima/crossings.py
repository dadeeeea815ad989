"""Which facets cross at many states, and which contact would have kept each crossing from happening."""

from __future__ import annotations

import numpy as np

from origami_nlp.numerics import OUTSIDE, cross
from origami_nlp.programme import OPEN, Folded, Model
from origami_nlp.programme.gaps import first_of_each


class Crossings:
    """Modelled facet pairs, mirrors and the axis of a model.

    Two arcs cross where the four heights of their ends off each other's plane have one sign in turn; the end of
    smallest height has come through last: it names the contact, and its side is where it came from.
    """

    def __init__(self, model: Model) -> None:
        gaps, pairs = model.structure.gaps, model.structure.pairs
        self._walls = np.array(model.walls, dtype=int)
        self._pairs = np.array(pairs, dtype=int).reshape(-1, 2)
        same = first_of_each(gaps)
        first = {g.pair: i for i, g in reversed(list(enumerate(gaps))) if g.pair is not None}
        # rows of a pair (i, j): i on j, i + 1 on j, j on i, j + 1 on i
        order = (2, 3, 0, 1)
        self._rows = np.array(
            [[same[first[p] + o] for o in order] for p in pairs], dtype=int
        ).reshape(-1, 4)
        of_wall = [gaps[i].rays for i in self._walls]
        self._ray = np.array([r for r, _ in of_wall], dtype=int)
        self._last = np.array([side == 1 for _, side in of_wall], dtype=bool)
        self.any = bool(len(self._walls) or len(self._pairs))

    def of(self, at: Folded, slots: np.ndarray, tolerance: float = OUTSIDE):
        """Return for each folded state the deepest crossing's gap (`OPEN` where there is none) and its side."""
        k = len(slots)
        gap, side, depth = np.full(k, OPEN), np.ones(k, dtype=int), np.full(k, tolerance)
        if len(self._pairs):
            rays = at.rays[:, :-4]
            normals = cross(rays, np.roll(rays, -1, axis=1))
            normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-300)
            height = normals @ rays.transpose(0, 2, 1)  # [K, facet, ray]
            i, j = self._pairs.T
            n = rays.shape[1]
            i1, j1 = (i + 1) % n, (j + 1) % n
            v = np.stack(
                [height[:, i, j], -height[:, i, j1], -height[:, j, i], height[:, j, i1]], axis=-1
            )
            deep = np.maximum(v.min(axis=-1), (-v).min(axis=-1))
            which = deep.argmax(axis=1)
            rows = np.arange(k)
            worst = deep[rows, which]
            end = np.abs(v[rows, which]).argmin(axis=1)
            value = v[rows, which, end] * np.array([1, -1, -1, 1])[end]
            bad = worst > depth
            gap[bad] = self._rows[which, end][bad]
            side[bad] = -np.sign(value[bad]).astype(int)
            depth = np.where(bad, worst, depth)
        if len(self._walls):
            normal = cross(at.rays[:, -1], at.rays[:, -2])
            value = np.where(
                self._last,
                np.einsum("krx,kx->kr", at.rays[:, self._ray], normal),
                at.rays[:, self._ray, 1],
            )
            which = value.argmin(axis=1)
            worst = -value[np.arange(k), which]
            bad = worst > depth
            gap[bad], side[bad] = self._walls[which][bad], 1
        return gap, side
