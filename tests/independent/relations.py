"""Sector angles as the exact numbers that they stand for.

Typed or computed in double precision, sectors such as pi/3 or a, a, pi - a, pi - a satisfy their
relations to 1e-16 only, and a state that exists because of such a relation closes to 1e-16 only.
Relations that hold to rounding are made exact with many digits: sectors that are equal, and sums
of consecutive sectors with any signs that are whole multiples of pi (creases that are collinear, or
that coincide when those between them are fully folded; Kawasaki's; the flat sheet's).  Everything else is
taken as the doubles are.
"""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import mpmath as mp
import numpy as np

DIGITS = 80
ROUNDING = 3e-14
"""Relations that hold to this [rad] are those of exact numbers: a few roundings of angles up to pi."""


def exact_sectors(sectors: np.ndarray) -> list[mp.mpf]:
    """Return the nearest sectors for which all relations that hold to rounding hold exactly."""
    sectors = np.asarray(sectors, dtype=float)
    rows = _independent(_relations(sectors))
    with mp.workdps(DIGITS):
        a = mp.matrix([mp.mpf(v) for v in sectors.tolist()])
        if not rows:
            return list(a)
        r = mp.matrix([[int(c) for c in row[:-1]] for row in rows])
        gap = mp.matrix([int(row[-1]) * mp.pi for row in rows]) - r * a
        return list(a + r.T * mp.lu_solve(r * r.T, gap))


def _relations(sectors: np.ndarray) -> list[tuple[int, ...]]:
    """Rows (coefficients, multiple of pi) of the relations that hold to rounding."""
    n = len(sectors)
    rows = []
    for i, j in itertools.combinations(range(n), 2):
        row = [0] * (n + 1)
        row[i], row[j] = 1, -1
        rows.append(row)
    for start, length in itertools.product(range(n), range(1, n + 1)):
        for signs in itertools.product((1, -1), repeat=length - 1):
            row = [0] * (n + 1)
            for k, sign in enumerate((1, *signs)):
                row[(start + k) % n] = sign
            rows.append(row)
    table = np.array(rows)
    value = table[:, :n] @ sectors / math.pi
    multiple = np.rint(value)
    table[:, n] = multiple
    return [tuple(row) for row in table[np.abs(value - multiple) * math.pi <= ROUNDING].tolist()]


def _independent(rows: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """Keep rows until they span all, by elimination in fractions."""
    kept, reduced = [], []
    for row in sorted(set(rows), key=lambda r: sum(map(abs, r))):
        rest = [Fraction(c) for c in row]
        for pivot, other in reduced:
            rest = [a - rest[pivot] * b for a, b in zip(rest, other, strict=True)]
        pivot = next((k for k, c in enumerate(rest[:-1]) if c), None)
        if pivot is None:
            continue
        reduced.append((pivot, [c / rest[pivot] for c in rest]))
        kept.append(row)
    return kept
