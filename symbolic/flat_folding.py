"""Flat foldability of a single vertex with a mountain-valley assignment, exactly.

The paper's degree-6 vertex has sector angles alpha, pi - 2 alpha, alpha, alpha, pi - 2 alpha, alpha.
A vertex with an assignment folds flat exactly when repeated crimping of a smallest sector (with two
creases of opposite sign) ends in two opposite sectors with equal creases; runs of equal smallest
sectors may be crimped in any order that the signs allow (Hull; Demaine and O'Rourke).
"""

from __future__ import annotations

from functools import cache
from typing import Any

import sympy as sp


def sectors(part: Any) -> tuple[Any, ...]:
    """Sector angles in units of pi for alpha = part * pi."""
    a, b = part, 1 - 2 * part
    return (a, b, a, a, b, a)


def kawasaki_sum() -> Any:
    """Alternating sum of the sector angles for symbolic alpha."""
    a = sp.Symbol("a")
    return sp.expand(sum((-1) ** i * s for i, s in enumerate(sectors(a))))


def is_flat_foldable(part: Any, assignment: str) -> bool:
    """Whether the assignment ('M'/'V' for creases 1..6) folds the vertex flat at alpha = part pi."""
    return _crimps(sectors(sp.Rational(part)), assignment)


@cache
def _crimps(angles: tuple[Any, ...], creases: str) -> bool:
    """Sector i lies between creases i and i + 1 (cyclically)."""
    n = len(angles)
    if n == 2:
        return bool(angles[0] == angles[1]) and creases[0] == creases[1]
    smallest = min(angles)
    for i in range(n):
        if angles[i] != smallest or creases[i] == creases[(i + 1) % n]:
            continue
        # crimp sector i: its neighbours and it merge into one sector
        order = [(i + 1 + j) % n for j in range(n)]  # starts after sector i
        merged = angles[(i - 1) % n] - angles[i] + angles[(i + 1) % n]
        rest_angles = [angles[j] for j in order[1 : n - 2]] + [merged]
        rest_creases = "".join(creases[j] for j in order[1 : n - 1])
        if _crimps(tuple(rest_angles), rest_creases):
            return True
    return False
