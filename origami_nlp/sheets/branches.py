"""Ways out of the flat state of a pattern whose vertices have degree four or less: its tangent cone, enumerated.

To first order the fold angles round a flat vertex obey sum phi_i b_i = 0, to second order also
sum_(i<j) phi_i phi_j (b_i x b_j) = 0: for degree four that leaves two lines, its modes.
A way out of the flat state folds every vertex along one of its modes (or not at all), which is linear once modes are
chosen: all choices are gone through, and those with nothing left are cut off early.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import RANK, cross, null_space
from origami_nlp.pattern import Loop, Pattern

MOST_CHOICES = 300
"""Choices of modes of some vertices that are carried on to the others."""


SAME_WAY = 1e-5
"""Unit directions that differ by less are one."""


@dataclass(frozen=True, eq=False)
class Branches:
    """Ways out of the flat state.

    Attributes
    ----------
    lines
        Unit directions of ways with one freedom, [L, n].
    families
        Orthonormal bases of ways with more, [n, k] each.
    reason
        Why the list is not complete; empty where it is.
    """

    lines: np.ndarray
    families: tuple[np.ndarray, ...]
    reason: str = ""


def list_branches(pattern: Pattern) -> Branches:
    """Enumerate the ways out of the flat state.

    Parameters
    ----------
    pattern
        The pattern.

    Returns
    -------
    Branches
        Candidates to second order at each vertex: whether states follow is seen when they are walked.
    """
    n = pattern.creases
    nothing = np.zeros((0, n))
    if not pattern.is_flat:
        return Branches(nothing, (), "the reference state is not flat")
    if pattern.holes:
        return Branches(nothing, (), "ways round holes are not enumerated")
    modes = [_modes(pattern, loop) for loop in pattern.vertices]
    if any(m is None for m in modes):
        degree = max(len(loop.creases) for loop in pattern.vertices)
        return Branches(nothing, (), f"vertices of degree {degree} have no modes to be enumerated")
    level = [np.eye(n)]
    for v in _order(pattern):
        creases = list(pattern.vertices[v].creases)
        after = []
        for basis in level:
            for mode in modes[v] or ():
                here = basis[creases]
                after.append(basis @ null_space(here - mode @ (mode.T @ here), RANK))
        level = _largest(
            [b for b in after if b.shape[1]]
        )  # what lies in another leads to nothing else
        if len(level) > MOST_CHOICES:
            return Branches(nothing, (), f"more than {MOST_CHOICES:,} choices of modes stay open")
    kept = level
    lines = [b[:, 0] for b in kept if b.shape[1] == 1]
    return Branches(np.array(lines).reshape(-1, n), tuple(b for b in kept if b.shape[1] > 1))


def _modes(pattern: Pattern, loop: Loop) -> list[np.ndarray] | None:
    """Return bases [d, k] of the modes of a flat vertex; None where they are no subspaces."""
    b = np.array(loop.signs)[:, None] * pattern.directions[list(loop.creases)]
    kernel = null_space(b.T, RANK)
    products = cross(b[:, None], b[None])
    # of any plane: all products are along its normal
    axis = products.reshape(-1, 3)[np.linalg.norm(products.reshape(-1, 3), axis=1).argmax()]
    size = float(np.linalg.norm(axis))
    if size == 0.0:
        return [kernel]
    form = np.triu(products @ (axis / size), 1)
    form = kernel.T @ (form + form.T) @ kernel
    dimension = kernel.shape[1]
    zero = np.zeros((len(b), 0))
    if not form.size or np.abs(form).max() <= RANK:
        return [kernel] if dimension else [zero]
    if dimension == 1:
        return [zero]
    if dimension > 2:
        return None
    values, vectors = np.linalg.eigh(form)
    if values[0] * values[1] > RANK**2:
        return [zero]
    low, high = np.sqrt(np.abs(values))  # y'Fy = 0: high y_2 = +-low y_1 in its axes
    lines = [kernel @ vectors @ np.array([high, s * low]) for s in (1.0, -1.0)]
    return [(u / np.linalg.norm(u))[:, None] for u in lines]


def _order(pattern: Pattern) -> list[int]:
    """Order the vertices so that each shares as many creases as can be with those before it."""
    left = list(range(len(pattern.vertices)))
    known: set[int] = set()
    order = []
    while left:
        best = max(left, key=lambda v: (len(known & set(pattern.vertices[v].creases)), -v))
        left.remove(best)
        order.append(best)
        known |= set(pattern.vertices[best].creases)
    return order


def _largest(subspaces: list[np.ndarray]) -> list[np.ndarray]:
    """Keep the subspaces that lie in no other."""
    kept: list[np.ndarray] = []
    for b in sorted(subspaces, key=lambda b: -b.shape[1]):
        if not any(np.abs(b - k @ (k.T @ b)).max() < SAME_WAY for k in kept):
            kept.append(b)
    return kept
