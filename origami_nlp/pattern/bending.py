"""Facets that bend: diagonals as creases with a stiffness per length."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.errors import SceneError
from origami_nlp.numerics import INPUT_TOL, cross
from origami_nlp.pattern.cells import make_cell
from origami_nlp.pattern.sheet import Pattern, make_pattern

DIAGONALS = ("short", "long")
"""Which diagonal of a facet with four corners bends."""


def with_bending(pattern: Pattern, stiffness: float, diagonal: str = "short") -> Pattern:
    """Return a pattern whose facets with more than three corners bend about diagonals.

    Each such facet is cut into triangles by diagonals, and these are creases with a linear spring that rests flat.  As
    the stiffness grows states tend to those of rigid facets, at a distance of one over it.

    Parameters
    ----------
    pattern
        Of facets that are one convex polygon each.
    stiffness
        Of a diagonal, per length of it [N/rad].
    diagonal
        ``"short"`` or ``"long"``: which one is cut first; of equal ones the one through the corner of lowest number.

    Returns
    -------
    Pattern
        With the creases of the pattern first, in their order, then the diagonals; `notes` says how many and which.

    Raises
    ------
    SceneError
        If the stiffness is not positive, a facet is of several pieces or not convex, or no facet has four corners.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import with_bending
    >>> soft = with_bending(o.examples.pattern("miura", 2, 2), 0.5)
    >>> soft.facets, soft.creases
    (8, 8)
    """
    k = check_number("stiffness", stiffness, 0.0)
    if diagonal not in DIAGONALS:
        raise SceneError(f"diagonal = {diagonal!r} must be short or long")
    if pattern.facets < len(pattern.polygons):
        raise SceneError(
            "facets of several pieces do not bend: draw their inner edges as creases, or merge the pieces"
        )
    if pattern.orders:
        raise SceneError(
            "faceOrders of a folded state are of whole facets: leave them out where facets bend"
        )
    polygons: list[tuple[int, ...]] = []
    cuts: list[tuple[int, int]] = []
    for number, polygon in enumerate(pattern.polygons, start=1):
        pieces, cut = _cut(pattern.corners, polygon, diagonal == "long", number)
        polygons += pieces
        cuts += cut
    if not cuts:
        raise SceneError("no facet has more than three corners: triangles do not bend")
    sides = [(a, b) for a, b in pattern.ends.tolist()]
    springs = dict(zip(sides, pattern.stiffness.tolist(), strict=True))
    long = [float(np.linalg.norm(pattern.corners[a] - pattern.corners[b])) for a, b in cuts]
    springs |= {side: k * length for side, length in zip(cuts, long, strict=True)}
    least = int(pattern.numbers.max(initial=-1)) + 1

    def of(values: np.ndarray, new: Any) -> dict[tuple[int, int], Any]:
        return dict(zip(sides, values.tolist(), strict=True)) | dict.fromkeys(cuts, new)

    make = partial(make_cell, lattice=pattern.cell.lattice) if pattern.cell else make_pattern
    made = make(
        pattern.corners,
        polygons,
        assignment=dict(zip(sides, pattern.assignment, strict=True)) | dict.fromkeys(cuts, "F"),
        fold_angles=of(pattern.reference, 0.0),
        numbers=dict(zip(sides, pattern.numbers.tolist(), strict=True))
        | {side: least + i for i, side in enumerate(cuts)},
        stiffness=springs,
        rest=of(pattern.rest, 0.0),
        limits=of(pattern.limit_angles.T, (-math.pi, math.pi)) if pattern.limits else None,
        name=pattern.name,
        notes=[
            *pattern.notes,
            f"facets bend: {len(cuts)} {diagonal} diagonals are creases of {k:g} N/rad per length, which rest flat; "
            "about the other diagonals facets do not bend",
        ],
    )
    return made.with_laws([*pattern.laws, *[None] * len(cuts)]) if pattern.laws else made


def _cut(
    corners: np.ndarray, polygon: tuple[int, ...], longest: bool, number: int
) -> tuple[list[tuple[int, ...]], list[tuple[int, int]]]:
    """Cut a convex polygon into triangles, ear by ear at the shortest diagonal; return them and the diagonals."""
    p, cuts, pieces = list(polygon), list[tuple[int, int]](), list[tuple[int, ...]]()
    x = corners[p]
    turns = cross(np.roll(x, -1, axis=0) - x, np.roll(x, -2, axis=0) - np.roll(x, -1, axis=0))
    if len(p) > 3 and (turns @ turns[0]).min() < -INPUT_TOL * float(turns[0] @ turns[0]):
        raise SceneError(
            f"facet {number} is not convex: where it bends is not decided; draw the creases"
        )
    while len(p) > 3:
        n = len(p)
        size = [
            float(np.linalg.norm(corners[p[i - 1]] - corners[p[(i + 1) % n]])) for i in range(n)
        ]
        best = max(size) if longest else min(size)
        # of diagonals that are equal but for rounding the one through the corner of lowest number
        equal = [i for i in range(n) if abs(size[i] - best) <= INPUT_TOL * best]
        i = min(equal, key=lambda i: (min(p[i - 1], p[(i + 1) % n]), max(p[i - 1], p[(i + 1) % n])))
        a, b = p[i - 1], p[(i + 1) % n]
        cuts.append((min(a, b), max(a, b)))
        pieces.append((a, p[i], b))
        del p[i]
    return [*pieces, tuple(p)], cuts
