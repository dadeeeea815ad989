"""Which contacts a scene has, and the gap of each as a CasADi expression.

A folded vertex is a closed spherical polygon: facet i is the cone over the arc from c_i to c_{i+1}.
A contact is a gap >= 0 whose value is the sine of an opening angle at the vertex, so that its
multiplier is a moment:

- ``fold-limit``: pi - phi >= 0 or pi + phi >= 0 (adjacent facets; the gap is the angle itself).
- ``mirror``: c_r . m >= 0, a crease of the wedge stays on its side of a mirror plane with inward normal m, or it
  would cross its own mirror image.  Next to a mirror crease this is the fold limit there, so it is
  left out.
- ``axis``: the mirror rays of D_n, n >= 2, stay on their own side of the axis.
- ``facet-pair``: non-adjacent facets i, j do not cross.  Exactly: a plane through the vertex separates them,
  n . c_i, n . c_{i+1} >= 0 >= n . c_j, n . c_{j+1}, |n| = 1 (the form that IPOPT gets).  Where a
  crease c_k of one touches the other facet (c_j, c_{j+1}), the gap det(c_j, c_{j+1}, c_k) /
  sin(alpha_j), with the sign of the side it is on, is the same constraint without n (the form that
  polish and multipliers use).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from origami_nlp.numerics import OUTSIDE, quaternion as quat
from origami_nlp.problem.closure import FoldedExpressions

ContactType = Literal["fold-limit", "mirror", "axis", "facet-pair"]


@dataclass(frozen=True)
class Gap:
    """One possible contact of the modelled piece.

    type: kind of contact (module docstring).
    rays: rays of the piece that take part: (r,) or, for a facet pair, (k, j): ray k on the facet
        that starts at ray j.
    pair: the two facets of a facet pair, as positions of their first rays, else None.
    weight: total opening [rad] in the whole vertex, summed over all images of the contact, for a
        unit gap.  A multiplier of the reduced problem divided by it is the moment at each single contact.

    For ``mirror`` and ``axis`` rays is (r, side): side 0 is the mirror at the first ray, 1 at the last.
    """

    type: ContactType
    rays: tuple[int, ...]
    pair: tuple[int, int] | None
    weight: int


@dataclass(frozen=True)
class LeftOut:
    """Something that was not modelled, and why."""

    what: str
    why: str


def touching_deficit(chain: Sequence[float]) -> float:
    """Return how far apart a chain of arcs holds its ends at least: max(0, 2 longest - sum).

    `chain` holds the sector angles between two facets, on one side of the vertex.
    """
    return max(0.0, 2 * max(chain) - sum(chain))


def can_cross(sector_angles: Sequence[float], i: int, j: int) -> bool:
    """Return whether facets i and j (0-based) of a vertex could ever cross.

    A common point splits the polygon into two closed loops; each closes only if the parts s, t of
    the two facets that belong to it bridge the deficit of its chain.  Both loops share alpha_i +
    alpha_j, so no crossing is possible when the two deficits use all of it (equality: they only
    touch at their ends).
    """
    n = len(sector_angles)
    between = [sector_angles[m % n] for m in range(i + 1, i + (j - i) % n)]
    outside = [sector_angles[m % n] for m in range(j + 1, j + (i - j) % n)]
    spare = sector_angles[i] + sector_angles[j]
    return touching_deficit(between) + touching_deficit(outside) < spare - OUTSIDE


def facet_gap(rays: Sequence[Any], k: int, j: int, sine: Any) -> Any:
    """Return the sine of the angle of ray k off the plane of the facet from ray j to ray j + 1."""
    following = rays[(j + 1) % len(rays)]
    return quat.dot(quat.cross(rays[j], following), rays[k]) / sine


def gap_expression(gap: Gap, piece: FoldedExpressions, sines: Sequence[Any]) -> Any:
    """Return the gap of a mirror, axis or facet-pair contact; facet pairs without their sign."""
    if gap.type == "facet-pair":
        k, j = gap.rays
        return facet_gap(piece.rays, k, j, sines[j % len(sines)])
    r, side = gap.rays
    c = piece.rays[r]
    if side == 0:
        return c[1]
    assert piece.end_normal is not None
    return quat.dot(c, piece.end_normal)
