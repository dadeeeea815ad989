"""Which facets cross at many states of a model, and which contact would have kept each crossing from happening."""

from __future__ import annotations

from typing import Any

import numpy as np

from origami_nlp.folding import find_crossings, pair_depths, pair_rows, stack_depths, stack_rule
from origami_nlp.numerics import CONTACT_TOL, OUTSIDE, cross, first_largest
from origami_nlp.problem import OPEN, FoldedRays, Model
from origami_nlp.starts.contact_strata import Row

NAMELESS = -2
"""Something crosses, but no gap of the model undoes it."""


def model_rows(model: Model) -> dict[Row, int]:
    """Return the rows (k, j) of a model, ray k on facet j, with the first of `Structure.gaps` that each is.

    Parameters
    ----------
    model
        Of any scene.

    Returns
    -------
    dict
        Empty where contact is not full.  Rows next to their facet are left out: they are fold limits, or rays
        without a fold.
    """
    rays, gaps = _rays(model), model.structure.gaps
    rows: dict[Row, int] = {}
    for contact in model.gaps:
        if gaps[contact.index].pair is not None:
            k, j = gaps[contact.index].rays
            if not (
                k - j in (-1, 2)
                or (model.structure.kind == "C" and (k - j) % rays in (2, rays - 1))
            ):
                rows[k, j] = contact.index
    return rows


def _rays(model: Model) -> int:
    """Count the rays of the modelled piece, for C_n those of its images as well."""
    s = model.structure
    return len(s.has_crease) * (s.order if s.kind == "C" else 1)


class VertexCrossings:
    """Modelled facet pairs, mirrors and the axis of a model, and without symmetry the stacks that depths do not see.

    Parameters
    ----------
    model
        The posed scene.

    Attributes
    ----------
    any
        Whether there is anything to look at.
    """

    def __init__(self, model: Model) -> None:
        gaps, pairs = model.structure.gaps, model.structure.pairs
        self._pairs = tuple(pairs)
        self._walls = np.array(model.walls, dtype=int)
        of_wall = [gaps[i].rays for i in self._walls]
        self._ray = np.array([r for r, _ in of_wall], dtype=int)
        self._last = np.array([side == 1 for _, side in of_wall], dtype=bool)
        self.any = bool(len(self._walls) or len(self._pairs))
        rays = _rays(model)
        self._gap = np.full((rays, rays), NAMELESS)
        for (k, j), index in model_rows(model).items():
            self._gap[k, j] = index
        self._table = pair_rows(self._pairs, rays)
        self._real = self._gap[self._table[..., 0], self._table[..., 1]] != NAMELESS
        full = bool(len(self._pairs)) and model.scene.group.is_trivial
        self._stack = stack_rule(model.scene.vertex.sector_angles) if full else None

    def tables(self) -> dict[str, Any]:
        """Return what compiled descents read: numbers, and arrays by name."""
        walls = np.stack([self._walls, self._ray, self._last], axis=1)
        stack = np.zeros((0, 3), dtype=int)
        if self._stack is not None:
            stack = np.column_stack([self._stack.end, self._stack.row])
        return {
            "pairs": len(self._table),
            "walls": len(walls),
            "stacks": len(stack),
            "pair": self._table,
            "real": self._real,
            "gap": self._gap,
            "wall": walls,
            "stack": stack,
        }

    def of(
        self, at: FoldedRays, x: np.ndarray, at_limit: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the gap that undoes the deepest crossing of each state (`OPEN`: nothing crosses), and its open side.

        Parameters
        ----------
        at
            K folded states.
        x, at_limit
            Their fold angles, and creases at their fold limits (-1, 0, 1), shape [K, n].
        """
        k = len(x)
        gap, side, depth = np.full(k, OPEN), np.ones(k, dtype=int), np.full(k, OUTSIDE)
        if len(self._pairs):
            self._of_pairs(at, gap, side, depth)
        if len(self._walls):
            self._of_walls(at, gap, side, depth)
        if self._stack is not None and at_limit.any():
            self._of_stacks(x, at_limit, gap, side)
        return gap, side

    def _of_pairs(
        self, at: FoldedRays, gap: np.ndarray, side: np.ndarray, depth: np.ndarray
    ) -> None:
        rays = at.rays[:, :-4]
        deep = pair_depths(rays, self._pairs).max(axis=1)
        bad = np.flatnonzero(deep > depth)
        if not len(bad):
            return
        found = find_crossings(rays[bad], self._pairs, self._real)
        which, rows = first_largest(found.depth), np.arange(len(bad))
        ray, facet = found.row[rows, which].T
        gap[bad] = np.where(ray < 0, NAMELESS, self._gap[ray, facet])
        # the row must change its sign
        side[bad] = -np.sign(found.value[rows, which]).astype(int)
        depth[bad] = deep[bad]

    def _of_walls(
        self, at: FoldedRays, gap: np.ndarray, side: np.ndarray, depth: np.ndarray
    ) -> None:
        # first mirror: the plane y = 0; last one: spanned by the two last rays, as it was carried along
        normal = cross(at.rays[:, -1], at.rays[:, -2])
        rays = at.rays[:, self._ray]
        value = np.where(self._last, (rays @ normal[..., None])[..., 0], rays[..., 1])
        which = first_largest(-value)
        worst = -value[np.arange(len(gap)), which]
        bad = np.flatnonzero(worst > depth)
        gap[bad], side[bad], depth[bad] = self._walls[which[bad]], 1, worst[bad]

    def _of_stacks(
        self, x: np.ndarray, at_limit: np.ndarray, gap: np.ndarray, side: np.ndarray
    ) -> None:
        """Name the row of the deepest violation of the stack rule, where depths see no crossing."""
        assert self._stack is not None
        depths = stack_depths(self._stack, x, at_limit)
        which, rows = first_largest(depths), np.arange(len(gap))
        bad = np.flatnonzero((gap == OPEN) & (depths[rows, which] > CONTACT_TOL))
        row = self._stack.row[which[bad]]
        gap[bad] = np.where(
            depths[bad, which[bad]] >= 1.0, NAMELESS, self._gap[row[:, 0], row[:, 1]]
        )
        side[bad] = at_limit[bad, which[bad]]
