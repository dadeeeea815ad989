"""Which contacts are closed at a state, as rows of inequalities with a definite sign.

Fold limits, mirrors and the axis are one row each.  Two facets that touch are kept apart by either
of two pieces of geometry: the other facet stays on one side of the plane of the first, or the first
on one side of the plane of the second (two arcs do not cross exactly when one of these holds).
Each is a `Branch`: the rows it closes at this state.  Where only one branch is possible, the
feasible set near the state is smooth; where two are, it is their union.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from origami_nlp.folding import SNAP, LayerProblem, fold_vertex, layer_problem
from origami_nlp.numerics import cross
from origami_nlp.programme.compiled import Structure
from origami_nlp.programme.model import Model

CLOSED = 1e-8
"""Gap [rad] below which a contact of a polished state counts as closed."""


@dataclass(frozen=True, order=True)
class Row:
    """One closed contact: side * gap >= 0 (``gap``), or side * phi <= pi (``limit``).

    index: variable of a limit, or position in `Structure.gaps`.
    side: +1 or -1.
    """

    kind: str
    index: int
    side: int


@dataclass(frozen=True)
class Contacts:
    """Closed contacts at a state.

    base: rows that always hold.  branches: for each touching facet pair its possible sets of rows.
    implied: rows that only describe a base row again (crease k lies on a facet because the crease
    between
        them is folded flat), with that base row.
    """

    base: tuple[Row, ...]
    branches: tuple[tuple[tuple[Row, ...], ...], ...]
    implied: tuple[tuple[Row, Row], ...]

    def combinations(self, most: int = 256) -> list[tuple[Row, ...]] | None:
        """Return every choice of branches as one set of rows, or None if there are more than `most`.

        A choice whose rows include those of another describes a part of it and is left out.
        """
        if math.prod(len(b) for b in self.branches) > most:
            return None
        choices = [
            tuple(dict.fromkeys((*self.base, *itertools.chain.from_iterable(choice))))
            for choice in itertools.product(*self.branches)
        ]
        sets = [frozenset(choice) for choice in choices]
        return [
            choice
            for k, choice in enumerate(choices)
            if not any(other < sets[k] for other in sets)
            and not any(sets[m] == sets[k] for m in range(k))
        ]


def row_values(
    model: Model, x: np.ndarray, rows: tuple[Row, ...], gaps: np.ndarray, jac_gaps: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return gaps (>= 0 when open) and their gradients for `rows`, shapes [r], [r, n]."""
    values, gradients = np.zeros(len(rows)), np.zeros((len(rows), model.size))
    for r, row in enumerate(rows):
        if row.kind == "limit":
            values[r] = math.pi - row.side * x[row.index]
            gradients[r, row.index] = -row.side
        else:
            values[r] = row.side * gaps[row.index]
            gradients[r] = row.side * jac_gaps[row.index]
    return values, gradients


def gap_weights(model: Model, rows: tuple[Row, ...], multipliers: np.ndarray) -> np.ndarray:
    """Spread multipliers of rows over `Structure.gaps` for the Hessian of the Lagrangian, [c]."""
    weights = np.zeros(len(model.structure.gaps))
    for row, value in zip(rows, multipliers, strict=True):
        if row.kind == "gap":
            weights[row.index] += row.side * value
    return weights


def closed_contacts(
    model: Model, x: np.ndarray, gaps: np.ndarray, tolerance: float = CLOSED
) -> Contacts:
    """Find every closed contact of a state."""
    base: list[Row] = []
    if model.structure.limits:
        for v in range(model.size):
            if math.pi - abs(x[v]) <= tolerance:
                base.append(Row("limit", v, 1 if x[v] > 0 else -1))
    for index, gap in enumerate(model.structure.gaps):
        if gap.type != "facet-pair" and gaps[index] <= tolerance:
            base.append(Row("gap", index, 1))
    if not model.structure.pairs:
        return Contacts(tuple(base), (), ())
    rays = model.rays(x)
    of_pair: dict[tuple[int, int], list[int]] = {}
    for index, gap in enumerate(model.structure.gaps):
        if gap.pair is not None:
            of_pair.setdefault(gap.pair, []).append(index)
    branches: list[tuple[tuple[Row, ...], ...]] = []
    implied: list[tuple[Row, Row]] = []
    layers = _Layers(model, x, tolerance)
    for indices in of_pair.values():
        options = _pair_branches(model, layers, rays, gaps, indices, tolerance)
        if () in options:
            continue  # the pair is strictly apart
        kept = set()
        for option in options:
            rows = []
            for row in option:
                again = _limit_that_says_the_same(model, row, base)
                if again is None:
                    rows.append(row)
                else:
                    implied.append((row, again))
            kept.add(tuple(rows))
        if () not in kept:
            branches.append(tuple(sorted(kept)))
    return Contacts(tuple(base), tuple(branches), tuple(dict.fromkeys(implied)))


@lru_cache(maxsize=64)
def same_gap(structure: Structure) -> tuple[int, ...]:
    """For each gap, the first one with the same rays: crease k on facet j belongs to two facet pairs."""
    first: dict[tuple[str, tuple[int, ...]], int] = {}
    return tuple(first.setdefault((g.type, g.rays), i) for i, g in enumerate(structure.gaps))


def _pair_branches(
    model: Model,
    layers: _Layers,
    rays: np.ndarray,
    gaps: np.ndarray,
    indices: list[int],
    tolerance: float,
) -> set[tuple[Row, ...]]:
    """Return the ways in which a pair of facets is kept apart; () means strictly apart.

    `indices` are the pair's four gaps: both ends of the first facet off the second, then the reverse.
    Facets that lie on each other have both sides open pointwise; the order of the layers says which are.
    """
    structure = model.structure
    same = same_gap(structure)
    options: set[tuple[Row, ...]] = set()
    flat = bool((np.abs(gaps[indices]) <= tolerance).all())
    sides = layers.sides(structure.gaps[indices[0]].pair) if flat else (0, 0)
    for ends, forced in ((indices[:2], sides[0]), (indices[2:], sides[1])):
        values = gaps[ends]
        _, j = structure.gaps[ends[0]].rays
        for side in (1, -1):
            if (side * values < -tolerance).any() or side == -forced:
                continue
            # a ray counts as touching only if it lies on the facet, not on its plane elsewhere
            touching = [
                e
                for e, value in zip(ends, values, strict=True)
                if abs(value) <= tolerance
                and _on_arc(rays, structure.gaps[e].rays[0], j, tolerance)
            ]
            options.add(tuple(Row("gap", same[e], side) for e in touching))
    if not options:  # crossing within the tolerance of the caller: nothing to say here
        return {()}
    if any(not o for o in options):
        # strictly apart by this plane, unless the facets are collinear and overlap the other way round
        strict = [o for o in options if o]
        if not strict or not _overlap(rays, structure.gaps[indices[0]].pair, tolerance):
            return {()}
        options = set(strict)
    return options


class _Layers:
    """The layer problem of a state, posed when a pair of facets that lie on each other first asks for it."""

    def __init__(self, model: Model, x: np.ndarray, tolerance: float) -> None:
        self._model, self._x, self._tolerance = model, x, tolerance

    @cached_property
    def _problem(self) -> LayerProblem | None:
        fold_angles = self._model.expand(self._x)
        creases, _ = fold_vertex(self._model.scene.vertex, fold_angles)
        return layer_problem(creases, fold_angles, max(self._tolerance, SNAP))

    def sides(self, pair: tuple[int, int] | None) -> tuple[int, int]:
        """Return the side of the second facet on which the first must lie, and the reverse; 0 if either is possible."""
        assert pair is not None
        problem = self._problem
        if problem is None:
            return 0, 0
        first, second = (self._model.facet_of_ray(i) - 1 for i in pair)
        for strands in problem.segments.values():
            one = [(s, d) for s, d in strands if s[0] == first]
            two = [(s, d) for s, d in strands if s[0] == second]
            if one and two:
                left = problem.forced_side(one[0][0], two[0][0])
                # the normal c_j x c_{j+1} of a facet points to the left of its direction, seen from outside
                return left * two[0][1], -left * one[0][1]
        return 0, 0


def _on_arc(rays: np.ndarray, k: int, j: int, tolerance: float) -> bool:
    """Tell whether ray k lies on the arc from ray j to the next, ends included (given: in its plane)."""
    a, b, c = rays[j], rays[(j + 1) % len(rays)], rays[k]
    normal = cross(a, b)
    return bool(cross(a, c) @ normal >= -tolerance and cross(c, b) @ normal >= -tolerance)


def _overlap(rays: np.ndarray, pair: tuple[int, int] | None, tolerance: float) -> bool:
    """Tell whether an end of one facet of the pair lies on the other."""
    assert pair is not None
    i, j = pair
    n = len(rays)
    for a, b in ((i, j), (j, i)):
        normal = cross(rays[b], rays[(b + 1) % n])
        normal = normal / np.linalg.norm(normal)
        for k in (a, (a + 1) % n):
            if abs(rays[k] @ normal) <= tolerance and _on_arc(rays, k, b, tolerance):
                return True
    return False


def _limit_that_says_the_same(model: Model, row: Row, base: list[Row]) -> Row | None:
    """Return the fold limit that makes a ray-on-facet row redundant, if there is one.

    Ray k lies on facet j because both belong to the two facets at a crease m folded to +-pi.  The
    opening of the two contacts is then the same angle.
    """
    k, j = model.structure.gaps[row.index].rays
    n = len(model.structure.has_crease) if model.structure.kind == "D" else model.scene.degree
    closed = model.structure.kind == "C"
    for m, far in (
        (j, j - 1),
        (j + 1, j + 2),
    ):  # crease m bounds facet j; `far` ends its other facet
        if closed:
            m, far = m % n, far % n
        if k != far:
            continue
        if model.structure.kind == "D":
            if not (0 < m < n - 1):
                continue
            variable = sum(model.structure.has_crease[:m])
        else:
            variable = m % model.size
        for limit in base:
            if limit.kind == "limit" and limit.index == variable:
                # a valley turns the walk around the vertex to the left: the other facet opens on that side
                return limit if row.side == limit.side else None
    return None


def row_name(model: Model, row: Row) -> str:
    """Say which contact a row is."""
    if row.kind == "gap":
        return model.gap_name(model.structure.gaps[row.index])
    creases = model.creases_of(row.index)
    sign = "+" if row.side > 0 else "-"
    return f"phi = {sign}pi at crease{'s' * (len(creases) > 1)} " + ", ".join(map(str, creases))


def row_weight(model: Model, row: Row) -> int:
    """Return how many single contacts of the vertex one row stands for."""
    if row.kind == "gap":
        return model.structure.gaps[row.index].weight
    return int(model.multiplicity[row.index])
