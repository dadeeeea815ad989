"""Facets that lie on each other: can their layers be ordered.

Facets that share a crease at a fold limit lie on the side that its sign says.  Round one vertex the exact test of
`folding.examine` answers; where every crease is open or folded flat, `Stack` does; where facets lie on each other in
other states of several vertices, nothing is decided.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from origami_nlp.errors import OrigamiError
from origami_nlp.folding import examine
from origami_nlp.numerics import ANSWERED
from origami_nlp.pattern import Loop, Pattern, Vertex
from origami_nlp.sheets.sheet import Sheet
from origami_nlp.sheets.stacks import MOST_PAIRS, Stack, is_flat_folded

SLIVER = 1e-6
"""Overlaps of less than this share of the square of the sheet's size are borders that touch."""


@dataclass(frozen=True)
class Layers:
    """What is known of the order of layers.

    Attributes
    ----------
    verdict
        Whether an order exists.
    reason
        Why not, or why it is not known; empty where it exists.
    """

    verdict: Literal["ordered", "crosses", "not decided"]
    reason: str = ""


def order_layers(sheet: Sheet, phi: np.ndarray) -> Layers:
    """Tell whether the layers of a state that closes, and whose facets do not pierce each other, have an order.

    Parameters
    ----------
    sheet
        The programme.
    phi
        Fold angles [rad], [n].

    Returns
    -------
    Layers
        The answer.
    """
    pattern = sheet.pattern
    stacked = overlaps(sheet, phi)
    if not stacked and not (np.abs(phi) == math.pi).any():
        return Layers("ordered")
    if stacked and is_flat_folded(sheet, phi):
        return _of_stack(sheet, phi)
    for loop in pattern.vertices:
        at = round_vertex(pattern, loop)
        if at is None:
            return Layers("not decided", f"not decided: layers round vertex {loop.vertex}")
        try:
            found = examine(at, phi[list(loop.creases)])
        except OrigamiError as error:
            return Layers("not decided", f"not decided: layers round vertex {loop.vertex}: {error}")
        if not found.admissible:
            return Layers("crosses", f"round vertex {loop.vertex}: {found.reason}")
    if not stacked or (len(pattern.vertices) == 1 and _all_round(pattern)):
        return Layers("ordered")
    return Layers(
        "not decided",
        f"layer order not decided: {len(stacked)} pairs of facets without a common crease lie on each other",
    )


def _of_stack(sheet: Sheet, phi: np.ndarray) -> Layers:
    """Order the layers of a state in which every crease is open or folded flat."""
    stack = Stack(sheet, phi)
    if len(stack.pairs) > MOST_PAIRS:
        many = f"{len(stack.pairs):,} pairs of facets overlap, at most {MOST_PAIRS:,} are ordered"
        return Layers("not decided", f"layer order not decided: {many}")
    try:
        order = stack.order()
    except TimeoutError:
        return Layers("not decided", "layer order not decided: the search for one was given up")
    if order is None:
        return Layers("crosses", "flat-folded, and its layers have no order")
    return Layers("ordered")


def _all_round(pattern: Pattern) -> bool:
    """Tell whether every facet is at the only interior vertex: near it they are all there is."""
    creases = list(pattern.vertices[0].creases)
    return (
        len({*pattern.left[creases].tolist(), *pattern.right[creases].tolist()}) == pattern.facets
    )


def round_vertex(pattern: Pattern, loop: Loop) -> Vertex | None:
    """Return an interior vertex with its creases in the order of its loop; None where no `Vertex` describes it."""
    ends = pattern.corners[pattern.ends[list(loop.creases)]]
    here = pattern.corners[loop.vertex]
    out = ends.sum(axis=1) - 2 * here
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    after = np.roll(out, -1, axis=0)
    angles = np.arctan2(
        np.linalg.norm(np.cross(out, after), axis=1), np.einsum("ki,ki->k", out, after)
    )
    if pattern.is_flat and abs(float(angles.sum()) - 2 * math.pi) > ANSWERED:
        return None  # a reflex sector
    try:
        return Vertex(tuple(angles.tolist()))
    except OrigamiError:
        return None


def overlaps(sheet: Sheet, phi: np.ndarray) -> list[tuple[int, int]]:
    """Return the pairs of facets without a common crease that lie on each other, sorted."""
    crossings = sheet.crossings
    x = crossings.placed(phi)
    pairs = crossings.candidates(x, margin=SLIVER * crossings.size)
    if not len(pairs):
        return []
    normal = np.cross(x - x[:, :1], np.roll(x, -1, axis=1) - x[:, :1]).sum(axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    a, b = pairs.T
    off = np.abs(np.einsum("kqi,ki->kq", x[b] - x[a][:, :1], normal[a])).max(axis=1)
    flat = off <= SLIVER * crossings.size
    if not flat.any():
        return []
    from shapely.geometry import Polygon

    found = set()
    for i, j in pairs[flat].tolist():
        u = x[i][1] - x[i][0]
        u = u / np.linalg.norm(u)
        frame = np.array([u, np.cross(normal[i], u)])
        one, other = Polygon((x[i] - x[i][0]) @ frame.T), Polygon((x[j] - x[i][0]) @ frame.T)
        if one.intersection(other).area > SLIVER * crossings.size**2:
            p, q = int(crossings.facet[i]), int(crossings.facet[j])
            found.add((min(p, q), max(p, q)))
    return sorted(found)
