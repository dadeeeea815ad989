"""Boxes of vertices of degree four on whose branches the energy has two maxima at most: grown, and checked.

From the flat state to a limit, half of a branch, f is the slope of the energy.  Springs at rest within 180 degrees make
it a mixture, with weights >= 0, of the eight w = phi_i' (phi_i -+ pi).  Take two functions u1 > 0 and u2 with Wronskian
W(u1, u2) > 0, h = W(u1, u2, w)/W(u1, u2).  If there is a number gamma at each place with

    h' + gamma h > 0  for all eight,

then h of the mixture goes through 0 once at most, from - to +; so f/u1, as a function of u2/u1, is concave, then
convex, and comes down through 0 once at most: one maximum on each half, two on the branch.

With theta from 0 (flat) to pi/2 (the limit) and c = cos(theta), as in `one_maximum`, the speeds of the four folds are
(leading, neighbour, opposite, neighbour) linear functions of c over two denominators,

    1/Q, (1 + tau c)/R, c/Q, (c + tau)/R,  Q = 1 - q c^2,  R = (c + tau)^2 + beta (1 - c^2),

tau = tanh(d), beta = (1 - tau^2)/(1 - q').  All are multiplied by Q R (that adds a multiple of h to h').  u1 is the
speed of the last, (c + tau) Q, and u2 = (c + shift) R: of the opposite crease, shift 0, or less that of the leading
one, shift -1.  What is looked at is s^5 h' and s^3 h, s = sin(theta), where they are differentiated by c: polynomials
in c and angles, and 1/Q, 1/R.

Boxes are halved where they are not shown, in sectors 1 and 2 together, 1 and 4 together, or 1: a tree, written in one
line.  At each box stand "a" or "b" if the first branch is shown with the first or second shift, "A" or "B" for the
second, then "0", "1" or "2" for what is halved, and both halves; "." leaves a box.
`python -m tests.independent.two_maxima 1/2 FILE` grows it.
"""

from __future__ import annotations

import ctypes
import json
import sys
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from math import prod
from pathlib import Path
from textwrap import wrap
from typing import Any, NamedTuple

from tests.independent.one_maximum import ALL, compiled

SHIFTS = (0.0, -1.0)
LETTERS = "ab", "AB"
CELLS, FINEST = 16, 0.01
"""Cells of places, and half width [rad] of the smallest."""
WIDEST = 8.0
"""Of boxes [deg] that are looked at."""
HOPELESS = 16
"""Boxes about a vertex without a gamma are halved if they have so many times the least volume."""


@cache
def _library() -> Any:
    real, whole = ctypes.c_double, ctypes.c_int
    found = compiled("two_maxima")
    some = ctypes.POINTER(real)
    found.argtypes = [some, some, whole, real, whole, real, ctypes.POINTER(whole)]
    return found


class Box(NamedTuple):
    """Lower and upper ends [deg] of the sum of sectors 1 and 2, that of 1 and 4, and sector 1; dyadic, so exact."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    @property
    def widths(self) -> tuple[float, ...]:
        return tuple(b - a for a, b in zip(self.low, self.high, strict=True))

    def halves(self, k: int) -> tuple[Box, Box]:
        middle = (self.low[k] + self.high[k]) / 2
        one, two = list(self.high), list(self.low)
        one[k] = two[k] = middle
        return Box(self.low, (one[0], one[1], one[2])), Box((two[0], two[1], two[2]), self.high)

    def sectors(self) -> list[tuple[float, float]]:
        """Return bounds of the four sectors."""
        (x, y, z), (x1, y1, z1) = self
        return [(z, z1), (x - z1, x1 - z), (360 - x1 - y1 + z, 360 - x - y + z1), (y - z1, y1 - z)]

    def all_vertices(self) -> bool:
        """Whether all sectors of all of it are between 0 and 180 degrees."""
        return all(a > 0 and b < 180 for a, b in self.sectors())

    def no_use(self) -> bool:
        """Whether none of it is a vertex numbered so that creases 1 and 2 lead, or others stand for all of it.

        1 and 2 lead where sectors 1 and 2, 1 and 4, 1 and 3 have sums below 180 degrees, or all above it: the second
        are the first with each sector a replaced by 180 - a, and have the same q, q' and d.  Mirror images have
        sectors 2 and 4 exchanged.
        """
        (x, y, z), (x1, y1, _) = self
        beyond = x >= 180 or y >= 180 or x1 + y1 - 2 * z <= 180
        return beyond or x >= y1 or any(b <= 0 or a >= 180 for a, b in self.sectors())

    def volume(self) -> Fraction:
        """Volume [deg^3] of the part in which the fourth sector is not below the second."""
        (x, y, z), (x1, y1, z1) = (tuple(map(Fraction, ends)) for ends in self)
        before = max(min(x1, y) - x, Fraction(0)) * (y1 - y)
        a, b = max(x, y), min(x1, y1)
        across = (b - a) * (y1 - (a + b) / 2) if b > a else Fraction(0)
        return (before + across) * (z1 - z)


WHOLE = Box((0.0, 0.0, 0.0), (360.0, 360.0, 180.0))


def proves(box: Box, branch: int, shift: float) -> tuple[int, int]:
    """Return 1 if one half of this branch has one maximum at most, for all vertices of a box; which side to halve."""
    if not box.all_vertices():
        return 0, -1
    x, y, z = ((a + b) / 2 for a, b in zip(*box, strict=True))
    middle, half = (z, x - z, 360 - x - y + z, y - z), [w / 2 for w in box.widths]
    where = ctypes.c_int(-1)
    four, three = (ctypes.c_double * 4)(*middle), (ctypes.c_double * 3)(*half)
    found = _library()(four, three, branch, shift, CELLS, FINEST, ctypes.byref(where))
    return found, where.value


def grow(box: Box, least: float, shown: str = "") -> str:
    """Return the tree below a box; halves are of at least so many deg^3.  shown: letters of boxes around."""
    side, hopeless, marks = -1, False, ""
    if box.no_use():
        return "."
    if max(box.widths) <= WIDEST:
        for branch, letters in enumerate(LETTERS):
            if not any(letter in shown for letter in letters):
                hopeless = True
                for letter, shift in zip(letters, SHIFTS, strict=True):
                    found, side = proves(box, branch, shift)
                    if found == 1:
                        marks += letter
                        break
                    hopeless &= found < 0
                else:
                    break
        if len(shown + marks) == 2:
            return marks
    if prod(box.widths) < (HOPELESS if hopeless else 2) * least:
        return "."
    if side < 0 or max(box.widths) > WIDEST:
        side = box.widths.index(max(box.widths))
    below = [grow(part, least, shown + marks) for part in box.halves(side)]
    return "." if below == [".", "."] else "".join([marks, str(side), *below])


def check(tree: str, box: Box = WHOLE) -> Iterator[Box]:
    """Yield the boxes of a tree that have two maxima at most on both branches."""
    marks = iter(tree)
    yield from _below(marks, box, set())
    if next(marks, None) is not None:
        raise ValueError("more than a tree")


def _below(marks: Iterator[str], box: Box, shown: set[int]) -> Iterator[Box]:
    shown = set(shown)
    while len(shown) < 2:
        mark = next(marks, None)
        if mark is None:
            raise ValueError("less than a tree")
        if mark == ".":
            return
        if mark in "012":
            for part in box.halves(int(mark)):
                yield from _below(marks, part, shown)
            return
        if mark not in "".join(LETTERS):
            raise ValueError(f"no mark: {mark}")
        branch = int(mark in LETTERS[1])
        if proves(box, branch, SHIFTS[LETTERS[branch].index(mark)])[0] != 1:
            raise ValueError(f"not shown: {box}")
        shown.add(branch)
    yield box


def share(boxes: Iterator[Box]) -> Fraction:
    """Share of all vertices in boxes, their mirror images, and those with sectors 180 - a [deg] of both."""
    return 4 * sum((box.volume() for box in boxes), Fraction(0)) / ALL


if __name__ == "__main__":
    grown = grow(WHOLE, float(Fraction(sys.argv[1])))
    data = {"least": sys.argv[1], "tree": wrap(grown, 120)}
    Path(sys.argv[2]).write_text(json.dumps(data, indent=1) + "\n")
